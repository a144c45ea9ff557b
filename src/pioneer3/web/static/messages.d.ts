// Made by docs/reference/message_types.py from pioneer3.web.messages and requests.

/** The robots that the receiver sees: all of them, or in a class a student's own. `models` is null where the receiver cannot change the world, `class` without a class. */
export interface Hello {
  type: "hello";
  version: string;
  robots: ListedRobot[];
  models: Model[] | null;
  gamepad: Scheme;
  class: ClassMember | null;
}

/** A robot; one of a `REPLAY` cannot be driven. `shape` and `limits` are null at first. It `plans` ways where it has a map, a laser or sonars, and what navigation needs; `forbids` says why nothing drives to places of a map without. Pictures of its `camera` are got over the HTTP API. */
export interface ListedRobot {
  id: number;
  name: string;
  kind: "REPLAY" | "ROBOT" | "SIMULATOR";
  url: string;
  shape: Shape | null;
  limits: SpeedLimits | null;
  laser: boolean;
  scans: boolean;
  plans: boolean;
  forbids: string;
  camera: boolean;
}

/** A robot's type and outline [m]; `sonar_max` is the longest range that is drawn [m]. */
export interface Shape {
  name: string;
  model: string;
  title: string;
  length_front: number;
  length_rear: number;
  width: number;
  sonars: SonarMount[];
  front_bumpers: number;
  rear_bumpers: number;
  sonar_max: number;
}

/** Position [m] and direction [rad] of a sonar transducer, in the robot's frame. */
export interface SonarMount {
  x: number;
  y: number;
  theta: number;
}

/** Highest speeds, and those that a page begins with [m/s, rad/s]. */
export interface SpeedLimits {
  speed: number;
  turn_rate: number;
  default_speed: number;
  default_turn_rate: number;
}

/** A type of robot that can be added to the simulated world. */
export interface Model {
  name: string;
  title: string;
}

/** The buttons, and the speeds. */
export interface Scheme {
  deadman: number;
  turbo: number;
  stop: number;
  emergency_stop: number;
  reset: number;
  forward_axis: number;
  turn_axis: number;
  dead_zone: number;
  speed: number;
  turn_rate: number;
  turbo_speed: number;
  turbo_turn_rate: number;
}

/** The receiver's part in a class: a teacher, or the student of one `robot`. */
export interface ClassMember {
  teacher: boolean;
  robot: number | null;
}

/** The state of the connection to a robot. */
export interface Status {
  type: "status";
  robot: number;
  state: Connection;
  message: string;
}

/** State of the connection to the robot. */
export type Connection = "closed" | "connected" | "connecting" | "lost";

/** New snapshots, of one or several robots. */
export interface Robots {
  type: "robots";
  snapshots: SnapshotMessage[];
}

/** A snapshot of a robot, ten times a second. `why` is the reason for the robot to stand still, `standing` the kind of that reason, and `symptom` the page of the book about it. Where something stopped it, `stop` says what, briefly. `decided` says which action of the `mode` decides what; `commanded` is the last command sent. `parting` is null while a robot does what its twin does, and of a robot without one. */
export interface SnapshotMessage {
  robot: number;
  sequence: number;
  robot_in_map: Pose2;
  robot_in_odom: Pose2;
  twist: Twist2;
  sonar: SonarRanges;
  bumpers: Bumpers;
  battery: Battery;
  motors: DriveState;
  link: LinkQuality;
  faults: string[];
  why: string | null;
  standing: ReasonKind | null;
  symptom: Symptom | null;
  stop: string | null;
  emergency_stop: boolean;
  driver: Driver | null;
  mode: string | null;
  decided: string[];
  ended: ModeEnd | null;
  commanded: Twist2 | null;
  target: Target | null;
  parting: PartingState | null;
}

/** Position [m] and heading [rad] in some frame. */
export interface Pose2 {
  x: number;
  y: number;
  theta: number;
}

/** Body velocity: `v` forward [m/s], `w` counter-clockwise [rad/s]. */
export interface Twist2 {
  v: number;
  w: number;
}

/** Ranges from the front left on [m]; null where nothing echoed. */
export interface SonarRanges {
  ranges: (number | null)[];
  enabled: boolean;
}

/** Contact by segment; front from left to right, rear from right to left (protocol.md 4.7). */
export interface Bumpers {
  front: boolean[];
  rear: boolean[];
}

/** The battery and its charger. */
export interface Battery {
  voltage: number;
  charge: number | null;
  charging: Charging;
  low: boolean;
}

/** States of the charger (protocol.md 4.2). */
export type Charging = "balance" | "bulk" | "float" | "not charging" | "overcharge" | "unknown";

/** The drive. */
export interface DriveState {
  enabled: boolean;
  stalled: boolean;
  moving: boolean;
  stop_button: boolean;
}

/** Quality of the reception. */
export interface LinkQuality {
  reports: number;
  bad_checksums: number;
  bytes_skipped: number;
  rate: number;
  sessions: number;
}

/** Kinds of reasons to stand still. */
export type ReasonKind = "fault" | "idle" | "normal" | "stopped";

/** Symptoms that a user sees, each by the name of its page in docs/troubleshooting. */
export type Symptom = "command-not-found" | "does-not-move" | "drives-in-circles" | "emergency-stop" | "it-beeps" | "loses-the-link" | "no-answer" | "no-laser" | "no-port" | "no-way" | "not-sure-where-it-is" | "page-does-not-open" | "page-is-slow" | "ros-topic-silent" | "sonar-is-wrong" | "stops-by-itself" | "unknown-robot" | "wrong-distances";

/** A driver; `id` is the number of a client, null for a script or an action. */
export interface Driver {
  id: number | null;
  name: string;
}

/** The mode that ended last, whether it was done, and the reason. `place` is the name of the place that it went to, or empty. */
export interface ModeEnd {
  mode: string;
  done: boolean;
  why: string;
  place: string;
}

/** The place that a mode drives to, in the map; `person` if it follows a person there. */
export interface Target {
  x: number;
  y: number;
  heading: number | null;
  person: boolean;
}

/** The reason that a robot does not do what its simulated twin does, and where that is. */
export interface PartingState {
  why: string;
  twin_in_map: Pose2;
}

/** New sweeps, of one or several lasers, for clients that subscribed to them. */
export interface Scans {
  type: "scans";
  scans: LaserSweep[];
}

/** A sweep of a laser. `laser` is its number on the robot, from 0; its pose is in whole millimetres and milliradians; `ranges` are in millimetres, 0 where nothing answered, from angle `first` on in steps of `step` [rad]. */
export interface LaserSweep {
  robot: number;
  laser: number;
  sensor_in_map: [number, number, number];
  first: number;
  step: number;
  ranges: number[];
}

/** The map, null where none is known. */
export interface Map {
  type: "map";
  map: Drawing | null;
}

/** A map: walls as lines x0, y0, x1, y1 [m], grids, named places, solids, and its changes. Walls are `wall_height` [m] high, or as `heights` says of each; 0 for an outline of a solid. */
export interface Drawing {
  name: string;
  walls: [number, number, number, number][];
  cells: MapCells[];
  objects: DrawnObject[];
  wall_height: number;
  heights: number[];
  solids: MapSolid[];
  changes: DrawnChange[];
}

/** A grid as a grey PNG picture in base64; its first row is the lowest, which `corner` is at. */
export interface MapCells {
  png: string;
  side: number;
  corner: [number, number, number];
}

/** A named place, line or area; `heads` if its heading `theta` means anything. */
export interface DrawnObject {
  role: "area" | "dock" | "goal" | "home" | "line" | "place";
  kind: string;
  name: string;
  x: number;
  y: number;
  theta: number;
  heads: boolean;
  forbidden: boolean;
  solid: boolean;
  points: [number, number][];
}

/** A solid with heights; `ground` if robots drive over it. `outline` is as seen from above. */
export interface MapSolid {
  kind: string;
  ground: boolean;
  outline: [number, number][];
  shapes: MapShape[];
}

/** A shape of a solid, at x, y, z [m] and a heading [rad]. A `block`, `wedge` or `column` stands there on the middle of its foot, with a length, width and height; a wedge rises along its x axis. A `mesh` has `numbers`, x, y and z of each of its points, and three `corners` of each triangle. A `terrain` has the heights of a grid of so many `columns` above its foot as `numbers`, the lowest row first. */
export interface MapShape {
  form: "block" | "column" | "mesh" | "terrain" | "wedge";
  at: [number, number, number, number];
  size: [number, number, number];
  numbers: number[];
  corners: number[];
  columns: number;
}

/** Walls that have come, or gone, since a map was saved: their middle, and that of each cell. */
export interface DrawnChange {
  text: string;
  gone: boolean;
  x: number;
  y: number;
  cells: [number, number][];
}

/** The map as edited but not saved, null without edits; `steps` can be undone. `version` counts the drafts: requests about an object of `map` name it. */
export interface MapDraft {
  type: "map_draft";
  map: Drawing | null;
  version: number;
  steps: number;
}

/** Changes of the simulated world. `things` are new or have changed, `moved` are only somewhere else (id, x, y, theta), `gone` are the ids of those removed. With `all` set, `things` is complete. */
export interface WorldChanges {
  type: "world";
  all: boolean;
  things: (BoxThing | PersonThing | RobotThing)[];
  moved: [number, number, number, number][];
  gone: number[];
  clock: SimulatedTime | null;
}

/** A box of some height [m]. */
export interface BoxThing {
  kind: "box";
  walks: boolean;
  height: number;
  id: number;
  name: string;
  front: number;
  rear: number;
  side: number;
  thing_in_map: [number, number, number];
}

/** A person of some height [m]. */
export interface PersonThing {
  kind: "person";
  walks: boolean;
  height: number;
  id: number;
  name: string;
  front: number;
  rear: number;
  side: number;
  thing_in_map: [number, number, number];
}

/** A simulated robot; `own` is the number of a robot that the page drives, null of others. */
export interface RobotThing {
  kind: "robot";
  id: number;
  name: string;
  front: number;
  rear: number;
  side: number;
  thing_in_map: [number, number, number];
  model: string;
  title: string;
  url: string;
  own: number | null;
  connected: boolean;
  stop_button: boolean;
  plugged: boolean;
  charge: number;
}

/** The simulated time [s], null while it runs, and how fast it runs. */
export interface SimulatedTime {
  paused: boolean;
  speed: number;
  factor: number;
  time: number | null;
}

/** The receiving client, the operators who have control, and all clients. */
export interface People {
  type: "people";
  id: number;
  name: string;
  role: Role;
  control: Holder[];
  clients: ClientInfo[];
}

/** Permissions. Viewers look, and stop robots. Drivers do the rest as well. Students of a class look at their own robot only, and drive it. */
export type Role = "driver" | "student" | "viewer";

/** The operator who has control of a robot; `id` is null for a script. */
export interface Holder {
  robot: number;
  id: number | null;
  name: string;
}

/** A client of the page. */
export interface ClientInfo {
  id: number;
  name: string;
  role: Role;
}

/** The class. Students get their own seat and runs only, and no `join_url`. `paused` says that the teacher has paused all robots, `locked` that nobody else can join, `shared` that several may join from one network address, and `lan` that other devices can reach `join_url`. */
export interface Class {
  type: "class";
  paused: boolean;
  locked: boolean;
  shared: boolean;
  lan: boolean;
  join_url: string | null;
  seats: Seat[];
  handed_in: HandedIn[];
}

/** A robot of a class and its student: `name` is null while nobody has joined. `online` counts the student's open pages. `program` is the address of the program that has the robot, null without; programs connect to `url`. The teacher has `paused` it. A student of the class may drive it from the page unless `refusal` says why not. */
export interface Seat {
  robot: number;
  name: string | null;
  online: number;
  program: string | null;
  paused: boolean;
  refusal: string;
  recording: Recording | null;
  url: string;
}

/** A recorded run that is not handed in; `ended` says why it has ended by itself, or is empty. `began` is the Unix time [s]; `seconds` is its length, null while it goes on. */
export interface Recording {
  began: number;
  seconds: number | null;
  ended: string;
}

/** A run that was handed in; `at` is the Unix time [s], `seconds` its length. */
export interface HandedIn {
  file: string;
  student: string;
  robot: number;
  at: number;
  seconds: number;
  size: number;
}

/** New small snapshots of a class's robots, five times a second. */
export interface ClassRobots {
  type: "class_robots";
  snapshots: SmallSnapshot[];
}

/** A robot of a class at one instant, for the teacher's page. `driver` is null while nobody drives. `by` is the kind of driver: a student's page, the teacher's, a program at the robot's port, or a mode or script. `battery` is in volts. */
export interface SmallSnapshot {
  robot: number;
  robot_in_map: [number, number, number];
  v: number;
  battery: number;
  stalled: boolean;
  emergency_stop: boolean;
  connected: boolean;
  by: "mode" | "program" | "student" | "teacher" | null;
  driver: string | null;
  why: string | null;
}

/** The way to the place x, y, for the client that asked for it; or the reason why there is none. `points` are in the map; `length` is in metres, `seconds` a guess of the time it takes. `closed` says what closes the way now: a robot sets out all the same, and waits before it for a while. */
export interface PlannedWay {
  type: "way";
  robot: number;
  x: number;
  y: number;
  points: [number, number][];
  length: number;
  seconds: number;
  refusal: string;
  closed: string;
}

/** A robot's knowledge of its place on the map, and the rest of its way. `robot_in_map` is the most likely pose; `ellipse` is around the places where the robot is with 95 %: its half axes [m] and the angle of the longer one [rad]. `agreement` is the share of the readings that agree with the map, 0 to 1; `reason` says why the robot is `sure` of its place, or is not. `left` is in metres, `seconds` a guess; `problem` says why the robot does not come on. */
export interface Navigation {
  type: "navigation";
  robot: number;
  sure: boolean;
  reason: string;
  agreement: number;
  problem: string;
  place: string;
  robot_in_map: Pose2 | null;
  ellipse: [number, number, number] | null;
  way: [number, number][];
  left: number | null;
  seconds: number | null;
}

/** Progress of a goal that this client has sent, as an action server tells it. `text` is the reason of its end, or of a wait on the way. */
export interface GoalProgress {
  type: "goal";
  robot: number;
  status: "aborted" | "accepted" | "canceled" | "executing" | "succeeded";
  text: string;
}

/** The map that is being made with a robot; only where one can be made. `driven` is in metres, `area` in square metres; `edges` is the number of edges that are left to explore, null before they are known; `way` leads to the next; `saved` is the file saved last; `remarks` are sentences about the map. While one `waits`, that says what for. `no_update` is the reason that the map in use is not updated, empty if it can be, and null without one. `updates` is the file of the one that is; it `asks` whether the new one is kept. */
export interface Mapping {
  type: "mapping";
  robot: number;
  making: boolean;
  exploring: boolean;
  driven: number;
  area: number;
  loops: number;
  edges: number | null;
  way: [number, number][];
  saved: string;
  remarks: string[];
  waits: string;
  no_update: string | null;
  updates: string;
  asks: boolean;
}

/** The calibration of a robot that goes on, or the end of the last one. The present step is the one with a `number`, from 1, of so many `steps`; its `title` is empty after the last one. It `needs` some room, and `asks` for measurements once it was driven. While the robot `waits`, that says what for. The `lines` tell what was measured; the `note` is about the last request. */
export interface CalibrationState {
  type: "calibration";
  robot: number;
  going: boolean;
  number: number;
  steps: number;
  title: string;
  needs: string;
  asks: CalibrationQuestion[];
  waits: string;
  note: string;
  lines: string[];
}

/** A length [m] or an `angle` [rad] that somebody measures, and may leave out if `optional`. */
export interface CalibrationQuestion {
  name: string;
  text: string;
  angle: boolean;
  optional: boolean;
}

/** News for this client alone. */
export interface Told {
  type: "told";
  message: string;
}

/** The reason to refuse a request. */
export interface Refused {
  type: "refused";
  message: string;
}

/** The reason to refuse a change of the simulated world or of the map. */
export interface EditRefused {
  type: "edit_refused";
  message: string;
}

/** The number of the thing that was added to the simulated world. */
export interface Added {
  type: "added";
  id: number | null;
}

/** The answer to a ping. */
export interface Pong {
  type: "pong";
  t: number;
}

/** More about a robot than a snapshot has; `baud` is null where the link has none. */
export interface Details {
  type: "details";
  robot: number;
  known: true;
  findings: Finding[];
  robot_in_encoder: Pose2;
  wheels: Sides;
  stalls: Stalls;
  temperature: number | null;
  compass: number | null;
  flags: string[];
  faults: string[] | null;
  charger_power: boolean;
  baud: number | null;
  lines: LineValues;
  sensors: SensorDetails[];
}

/** One check and its outcome. */
export interface Finding {
  check: string;
  level: Level;
  found: string;
  meaning: string;
  advice: string;
  code: number;
  symptom: Symptom | null;
}

/** Severity of a finding. */
export type Level = "fail" | "ok" | "warn";

/** Speeds of the left and the right wheel [m/s]. */
export interface Sides {
  left: number;
  right: number;
}

/** Whether the left and the right wheels are blocked. */
export interface Stalls {
  left: boolean;
  right: boolean;
}

/** Digital and analog lines; `analog` [V] is null where the robot does not tell them all. */
export interface LineValues {
  digital_in: boolean[];
  digital_out: boolean[];
  analog: number[] | null;
  selected: AnalogPort;
}

/** The selected analog port and its voltage [V]. */
export interface AnalogPort {
  port: number;
  voltage: number;
}

/** A sensor: its presence in words, and its values while it sends readings. */
export interface SensorDetails {
  name: string;
  words: string;
  values: SensorValue[];
}

/** A value of a sensor, with its unit. */
export interface SensorValue {
  label: string;
  text: string;
}

/** The robot is not connected. */
export interface NoDetails {
  type: "details";
  robot: number;
  known: false;
}

/** The robot's CONFIG, and the reason for not asking it anew, or null. */
export interface ConfigMessage {
  type: "config";
  robot: number;
  rows: ConfigRow[];
  error: string | null;
}

/** One field of CONFIG, for people. */
export interface ConfigRow {
  group: string;
  field: string;
  value: string;
  unit: string;
  meaning: string;
}

/** The time `at` which logs are shown, of all between `began` and `ended` [s since 1970]. `jumps` counts how often somebody went elsewhere; `looked` is the share of the logs that was looked through for marks, 0 to 1. */
export interface ReplayState {
  type: "replay";
  began: number;
  ended: number;
  at: number;
  speed: number;
  playing: boolean;
  jumps: number;
  looked: number;
}

/** The events that have been found so far. */
export interface ReplayMarks {
  type: "replay_marks";
  marks: ReplayMark[];
}

/** An event of a log at a time [s since 1970], of a `robot` or, null, of all. */
export interface ReplayMark {
  at: number;
  robot: number | null;
  kind: "emergency" | "goal" | "link" | "mode" | "note" | "stall";
  text: string;
}

/** Hold this velocity [m/s, rad/s] with `input` until it expires; 0, 0 lets go. The robots `also` hold the same. */
export interface VelocityRequest {
  type: "drive";
  v: number;
  w: number;
  input?: "gamepad" | "keyboard" | "tilt" | "touch";
  also?: number[];
  robot?: number | null;
}

/** Stop the robot, whoever drives. */
export interface StopRequest {
  type: "stop";
  robot?: number | null;
}

/** Stop as hard as possible until it is reset; without a number, stop all robots. */
export interface EmergencyStop {
  type: "emergency_stop";
  robot?: number | null;
}

/** End the emergency stop. The motors stay off. */
export interface ResetEmergencyStop {
  type: "reset_emergency_stop";
  robot?: number | null;
}

/** Switch the motors' power. */
export interface SwitchMotors {
  type: "motors";
  on: boolean;
  robot?: number | null;
}

/** Take control if it is free, and keep it. */
export interface TakeControl {
  type: "take_control";
  robot?: number | null;
}

/** Stop the robot, then take control, whoever has it now. */
export interface TakeOver {
  type: "take_over";
  robot?: number | null;
}

/** Stop the robot, and pass control on to the client of number `to`. */
export interface HandOver {
  type: "hand_over";
  to: number;
  robot?: number | null;
}

/** Release control; the robot stops. */
export interface ReleaseControl {
  type: "release_control";
  robot?: number | null;
}

/** Stop, then start a mode; the place of a `goto` is in odometry's frame. */
export interface StartMode {
  type: "start_mode";
  mode: Wander | Follow | Goto | Turn;
  robot?: number | null;
}

/** Drive about and keep clear of obstacles. */
export interface Wander {
  mode: "wander";
  preset?: "aria" | "explore" | "lab";
  speed?: number | null;
  seconds?: number;
}

/** Follow the person in front by laser or sonar. It backs up from a person who comes nearer. Stand 0.6 m in front of it, then walk, not faster than 0.4 m/s. */
export interface Follow {
  mode: "follow";
  rule?: "auto" | "lab" | "legs" | "tracking";
  keep?: number | null;
  seconds?: number;
}

/** Drive to a place and stop; slow down and turn aside for obstacles. The place counts from where the robot is and looks when the connection opens. It is found by the wheels, which drift. */
export interface Goto {
  mode: "goto";
  x: number;
  y: number;
  heading?: number | null;
  speed?: number;
  seconds?: number;
}

/** Turn on the spot and stop. See that its corners are free: nothing looks out for obstacles. */
export interface Turn {
  mode: "turn";
  angle: number;
  rate?: number;
  seconds?: number;
}

/** Drive to a place of the map, and turn to a heading there if one is given. A robot with a laser drives along a planned way, one without drives straight. People are told the `name` of the place, if the map has it. */
export interface GotoPlace {
  type: "goto";
  x: number;
  y: number;
  heading?: number | null;
  name?: string;
  speed?: number;
  robot?: number | null;
}

/** Begin a map, explore, or end it: save it under `name` in the server's folder, or not. `name_place` makes the place where the robot is a goal of the map. `update` goes on with the map in use instead; `finish` shows what has changed, and `save` replaces it then. */
export interface MakeMap {
  type: "make_map";
  step: "begin" | "discard" | "explore" | "finish" | "name_place" | "save" | "update";
  name?: string;
  speed?: number;
  robot?: number | null;
}

/** Begin a calibration, by laser if there is one, or `by_tape`; drive its next step, or end it. `measure` gives the `answers` to what the step asks [m, rad], by their names; `skip` leaves the step out, `undo` forgets the last one, and `write` writes the robot's own file. */
export interface Calibrate {
  type: "calibrate";
  step: "begin" | "drive" | "end" | "measure" | "skip" | "undo" | "write";
  by_tape?: boolean;
  answers?: object;
  robot?: number | null;
}

/** End the mode; its motion ends at once. */
export interface EndMode {
  type: "end_mode";
  robot?: number | null;
}

/** Drive from place to place of the map, and begin anew after the last one, until stopped. */
export interface Patrol {
  type: "patrol";
  places: Stopover[];
  speed?: number;
  robot?: number | null;
}

/** A place of a patrol, with a heading to turn to there if one is given, and its name. */
export interface Stopover {
  x: number;
  y: number;
  heading?: number | null;
  name?: string;
}

/** Drive about slowly until the robot is sure where it is on the map. */
export interface LookAround {
  type: "look_around";
  robot?: number | null;
}

/** Tell where the robot is on the map; without a heading it may look anywhere. */
export interface PlaceRobot {
  type: "place_robot";
  x: number;
  y: number;
  heading?: number | null;
  robot?: number | null;
}

/** Start a mode of several robots, of which one may be the leader; it is left to its driver. */
export interface StartGroupMode {
  type: "start_group_mode";
  robots: number[];
  mode: Form | FollowLeader | Spread;
  leader?: number | null;
}

/** Keep a formation around a leader. The followers drive to their places at once, each to the one that is near, and keep them while the leader drives. In a column they keep to its track. */
export interface Form {
  mode: "form";
  formation?: "column" | "line" | "wedge";
  spacing?: number;
  seconds?: number;
}

/** Follow the track of a leader, one behind the other. The robot that is nearest to the leader follows first. They cut no corners. */
export interface FollowLeader {
  mode: "follow-leader";
  distance?: number;
  seconds?: number;
}

/** Drive apart until all are far enough from each other. Each is done once no other robot is nearer. A wall may be in the way: then it stands there. */
export interface Spread {
  mode: "spread";
  apart?: number;
  speed?: number;
  seconds?: number;
}

/** Open the details of the robot in place of any other's, or close them. */
export interface WatchDetails {
  type: "watch_details";
  on: boolean;
  robot?: number | null;
}

/** Ask the robot for its CONFIG. */
export interface AskConfig {
  type: "ask_config";
  robot?: number | null;
}

/** Subscribe to the lasers' sweeps, or end that; lasers are on while anybody subscribes. */
export interface WatchLasers {
  type: "watch_lasers";
  on: boolean;
}

/** Ask for the way to a place of the map; the answer is a `way`. Nothing drives. */
export interface PlanWay {
  type: "plan_way";
  x: number;
  y: number;
  heading?: number | null;
  name?: string;
  speed?: number;
  robot?: number | null;
}

/** Ask for a pong with the same `t`. */
export interface PingRequest {
  type: "ping";
  t: number;
}

/** Put a box into the simulated world; x, y is its middle. */
export interface AddBox {
  type: "add_box";
  x: number;
  y: number;
  theta: number;
  length: number;
  width: number;
}

/** Put a person into the simulated world, who stands at a point or walks along several. */
export interface AddPerson {
  type: "add_person";
  path: [number, number][];
}

/** Put one more robot, of a shipped model, into the simulated world. */
export interface AddRobot {
  type: "add_robot";
  model: string;
  x: number;
  y: number;
  theta: number;
}

/** Put a thing somewhere else. */
export interface MoveRequest {
  type: "move";
  id: number;
  x: number;
  y: number;
  theta: number;
}

/** Take a thing out of the simulated world. */
export interface Remove {
  type: "remove";
  id: number;
}

/** Press or release the red button on a simulated robot. */
export interface PressStopButton {
  type: "stop_button";
  id: number;
  pressed: boolean;
}

/** Pull the cable out of a simulated robot, or put it in again. */
export interface PlugCable {
  type: "cable";
  id: number;
  plugged: boolean;
}

/** Drain or fill the battery of a simulated robot, to this share of its capacity. */
export interface SetCharge {
  type: "charge";
  id: number;
  charge: number;
}

/** Stop simulated time, or let it pass again. */
export interface PauseRequest {
  type: "pause";
  paused: boolean;
}

/** Let some simulated time pass [s], then stand still. */
export interface StepRequest {
  type: "step";
  seconds: number;
}

/** Let simulated time pass so many times as fast as real time. */
export interface SetSpeed {
  type: "speed";
  speed: number;
}

/** Erase the walls of the map that lie in a box whole, given by two corners. */
export interface EraseWalls {
  type: "erase_walls";
  x0: number;
  y0: number;
  x1: number;
  y1: number;
}

/** Add a wall to the map, from one point to another. */
export interface DrawWall {
  type: "draw_wall";
  x0: number;
  y0: number;
  x1: number;
  y1: number;
}

/** Forbid a line between two points of the map, or an area between two corners. */
export interface Forbid {
  type: "forbid";
  x0: number;
  y0: number;
  x1: number;
  y1: number;
  shape: "area" | "line";
  name?: string;
}

/** Add a place to the map, or move the place of that name; docks and homes have a heading. */
export interface NamePlace {
  type: "name_place";
  role: "dock" | "goal" | "home";
  name: string;
  x: number;
  y: number;
  heading?: number | null;
}

/** Give a place, line or area of the draft `version` another name; `number` counts from 0. The version of the map that robots use is that of the last draft. */
export interface RenameObject {
  type: "rename_object";
  number: number;
  version: number;
  name: string;
}

/** Remove a place, line or area of the draft `version`; `number` counts from 0. */
export interface RemoveObject {
  type: "remove_object";
  number: number;
  version: number;
}

/** Undo the last edit of the map that is not saved. */
export interface UndoMapEdit {
  type: "undo_map_edit";
}

/** Undo all edits of the map that are not saved. */
export interface DiscardMapEdits {
  type: "discard_map_edits";
}

/** Save the edited map in the server's folder under a new name; robots use it from then on. */
export interface SaveMap {
  type: "save_map";
  name: string;
  format?: ".map" | ".toml" | ".yaml";
}

/** Stop a robot of the class, or all without a number, and let nobody drive; or end that. */
export interface PauseRobots {
  type: "pause_robots";
  paused: boolean;
  robot?: number | null;
}

/** Stop a simulated robot of the class and put it where it began; without a number, all. */
export interface PutBack {
  type: "put_back";
  robot?: number | null;
}

/** Show the student of a robot out, so that another can have it. */
export interface FreeSeat {
  type: "free_seat";
  robot: number;
}

/** Let no more students join the class, or let them again. */
export interface LockJoining {
  type: "lock_joining";
  locked: boolean;
}

/** Let several students join the class from one network address, or one from each. */
export interface ShareAddresses {
  type: "share_addresses";
  shared: boolean;
}

/** Record a run of a robot of the class, end the recording, hand it in, or drop it. Handing in ends it. `robot` is null for a student's own. */
export interface RecordRun {
  type: "record_run";
  step: "begin" | "discard" | "end" | "hand_in";
  robot?: number | null;
}

/** Play or pause a replay, change its speed, or go to a time [s since 1970]; null leaves it. */
export interface PlayRequest {
  type: "play";
  playing?: boolean | null;
  speed?: number | null;
  at?: number | null;
}

export type ToPage = Hello | Status | Robots | Scans | Map | MapDraft | WorldChanges | People | Class | ClassRobots | PlannedWay | Navigation | GoalProgress | Mapping | CalibrationState | Told | Refused | EditRefused | Added | Pong | Details | NoDetails | ConfigMessage | ReplayState | ReplayMarks;

export type ToServer = VelocityRequest | StopRequest | EmergencyStop | ResetEmergencyStop | SwitchMotors | TakeControl | TakeOver | HandOver | ReleaseControl | StartMode | GotoPlace | MakeMap | Calibrate | EndMode | Patrol | LookAround | PlaceRobot | StartGroupMode | WatchDetails | AskConfig | WatchLasers | PlanWay | PingRequest | AddBox | AddPerson | AddRobot | MoveRequest | Remove | PressStopButton | PlugCable | SetCharge | PauseRequest | StepRequest | SetSpeed | EraseWalls | DrawWall | Forbid | NamePlace | RenameObject | RemoveObject | UndoMapEdit | DiscardMapEdits | SaveMap | PauseRobots | PutBack | FreeSeat | LockJoining | ShareAddresses | RecordRun | PlayRequest;
