"""Messages from the server to the page: JSON, one object each, told apart by `type`.

The order of the fields is the order on the wire. Units are SI, angles counter-clockwise [rad];
numbers that are not finite become null.
"""

from typing import Literal

import msgspec

from pioneer3 import state
from pioneer3.doctor.facts import Finding
from pioneer3.errors import Symptom
from pioneer3.geometry import Pose2, Twist2
from pioneer3.maps.line_map import Role as ObjectRole
from pioneer3.models.model import SonarMount
from pioneer3.robot.config_table import ConfigRow
from pioneer3.robot.explain import ReasonKind
from pioneer3.robot.supervisor import Connection
from pioneer3.teleop.gamepad import Scheme
from pioneer3.web.access.sessions import Role

Placed = tuple[float, float, float]
"""x, y [m], theta [rad], to a millimetre."""
_encoder = msgspec.json.Encoder()


class Part(msgspec.Struct, gc=False, frozen=True):
    """A part of a message."""


class Message(msgspec.Struct, tag_field="type", frozen=True):
    """Any message to the page."""


def encode(message: msgspec.Struct) -> str:
    """Return the JSON text of a message or a part of one."""
    return _encoder.encode(message).decode()


# -- the robots and their connections


class Shape(Part, frozen=True):
    """A robot's type and outline [m]; `sonar_max` is the longest range that is drawn [m]."""

    name: str
    model: str
    title: str
    length_front: float
    length_rear: float
    width: float
    sonars: tuple[SonarMount, ...]
    front_bumpers: int
    rear_bumpers: int
    sonar_max: float


class SpeedLimits(Part, frozen=True):
    """Highest speeds, and those that a page begins with [m/s, rad/s]."""

    speed: float
    turn_rate: float
    default_speed: float
    default_turn_rate: float


class ListedRobot(Part, frozen=True):
    """A robot; one of a `REPLAY` cannot be driven. `shape` and `limits` are null at first.

    It `plans` ways where it has a map, a laser or sonars, and what navigation needs; `forbids` says
    why nothing drives to places of a map without. Pictures of its `camera` are got over the HTTP
    API.
    """

    id: int
    name: str
    kind: Literal["ROBOT", "SIMULATOR", "REPLAY"]
    url: str
    shape: Shape | None
    limits: SpeedLimits | None
    laser: bool = False
    scans: bool = False
    plans: bool = False
    forbids: str = ""
    camera: bool = False


class Model(Part, frozen=True):
    """A type of robot that can be added to the simulated world."""

    name: str
    title: str


class ClassMember(Part, frozen=True):
    """The receiver's part in a class: a teacher, or the student of one `robot`."""

    teacher: bool
    robot: int | None


class Hello(Message, tag="hello", frozen=True):
    """The robots that the receiver sees: all of them, or in a class a student's own.

    `models` is null where the receiver cannot change the world, `class` without a class.
    """

    version: str
    robots: tuple[ListedRobot, ...]
    models: tuple[Model, ...] | None
    gamepad: Scheme
    class_: ClassMember | None = msgspec.field(name="class")


class Status(Message, tag="status", frozen=True):
    """The state of the connection to a robot."""

    robot: int
    state: Connection
    message: str


# -- snapshots


class SonarRanges(Part, frozen=True):
    """Ranges from the front left on [m]; null where nothing echoed."""

    ranges: tuple[float | None, ...]
    enabled: bool


class DriveState(Part, frozen=True):
    """The drive."""

    enabled: bool
    stalled: bool
    moving: bool
    stop_button: bool


class Driver(Part, frozen=True):
    """A driver; `id` is the number of a client, null for a script or an action."""

    id: int | None
    name: str


class ModeEnd(Part, frozen=True):
    """The mode that ended last, whether it was done, and the reason.

    `place` is the name of the place that it went to, or empty.
    """

    mode: str
    done: bool
    why: str
    place: str = ""


class ModeState(Part, frozen=True):
    """The running mode with the decisions of its actions, and how the last one ended."""

    mode: str | None = None
    decided: tuple[str, ...] = ()
    ended: ModeEnd | None = None


class Target(Part, frozen=True):
    """The place that a mode drives to, in the map; `person` if it follows a person there."""

    x: float
    y: float
    heading: float | None
    person: bool


class PartingState(Part, frozen=True):
    """The reason that a robot does not do what its simulated twin does, and where that is."""

    why: str
    twin_in_map: Pose2


class SnapshotMessage(Part, frozen=True):
    """A snapshot of a robot, ten times a second.

    `why` is the reason for the robot to stand still, `standing` the kind of that reason, and
    `symptom` the page of the book about it. Where something stopped it, `stop` says what, briefly.
    `decided` says which action of the `mode` decides what; `commanded` is the last command sent.
    `parting` is null while a robot does what its twin does, and of a robot without one.
    """

    robot: int
    sequence: int
    robot_in_map: Pose2
    robot_in_odom: Pose2
    twist: Twist2
    sonar: SonarRanges
    bumpers: state.Bumpers
    battery: state.Battery
    motors: DriveState
    link: state.LinkQuality
    faults: tuple[str, ...]
    why: str | None
    standing: ReasonKind | None
    symptom: Symptom | None
    stop: str | None
    emergency_stop: bool
    driver: Driver | None
    mode: str | None
    decided: tuple[str, ...]
    ended: ModeEnd | None
    commanded: Twist2 | None
    target: Target | None
    parting: PartingState | None = None


class PlannedWay(Message, tag="way", frozen=True):
    """The way to the place x, y, for the client that asked for it; or the reason why there is none.

    `points` are in the map; `length` is in metres, `seconds` a guess of the time it takes. `closed`
    says what closes the way now: a robot sets out all the same, and waits before it for a while.
    """

    robot: int
    x: float
    y: float
    points: tuple[tuple[float, float], ...] = ()
    length: float = 0.0
    seconds: int = 0
    refusal: str = ""
    closed: str = ""


class Navigation(Message, tag="navigation", frozen=True):
    """A robot's knowledge of its place on the map, and the rest of its way.

    `robot_in_map` is the most likely pose; `ellipse` is around the places where the robot is with
    95 %: its half axes [m] and the angle of the longer one [rad]. `agreement` is the share of the
    readings that agree with the map, 0 to 1; `reason` says why the robot is `sure` of its place, or
    is not. `left` is in metres, `seconds` a guess; `problem` says why the robot does not come on,
    `remark` that its laser is mounted askew.
    """

    robot: int
    sure: bool
    reason: str
    agreement: float = 0.0
    problem: str = ""
    remark: str = ""
    place: str = ""
    robot_in_map: Pose2 | None = None
    ellipse: tuple[float, float, float] | None = None
    way: tuple[tuple[float, float], ...] = ()
    left: float | None = None
    seconds: int | None = None


class GoalProgress(Message, tag="goal", frozen=True):
    """Progress of a goal that this client has sent, as an action server tells it.

    `text` is the reason of its end, or of a wait on the way.
    """

    robot: int
    status: Literal["accepted", "executing", "succeeded", "aborted", "canceled"]
    text: str


class Mapping(Message, tag="mapping", frozen=True):
    """The map that is being made with a robot; only where one can be made.

    `driven` is in metres, `area` in square metres; `edges` is the number of edges that are left to
    explore, null before they are known; `way` leads to the next; `saved` is the file saved last;
    `remarks` are sentences about the map. While one `waits`, that says what for.

    `no_update` is the reason that the map in use is not updated, empty if it can be, and null
    without one. `updates` is the file of the one that is; it `asks` whether the new one is kept.
    """

    robot: int
    making: bool
    exploring: bool = False
    driven: float = 0.0
    area: float = 0.0
    loops: int = 0
    edges: int | None = None
    way: tuple[tuple[float, float], ...] = ()
    saved: str = ""
    remarks: tuple[str, ...] = ()
    waits: str = ""
    no_update: str | None = None
    updates: str = ""
    asks: bool = False


class CalibrationQuestion(Part, frozen=True):
    """A length [m] or an `angle` [rad] that somebody measures, and may leave out if `optional`."""

    name: str
    text: str
    angle: bool
    optional: bool


class CalibrationState(Message, tag="calibration", frozen=True):
    """The calibration of a robot that goes on, or the end of the last one.

    The present step is the one with a `number`, from 1, of so many `steps`; its `title` is empty
    after the last one. It `needs` some room, and `asks` for measurements once it was driven. While
    the robot `waits`, that says what for. The `lines` tell what was measured; the `note` is about
    the last request.
    """

    robot: int
    going: bool
    number: int = 0
    steps: int = 0
    title: str = ""
    needs: str = ""
    asks: tuple[CalibrationQuestion, ...] = ()
    waits: str = ""
    note: str = ""
    lines: tuple[str, ...] = ()


class Robots(Message, tag="robots", frozen=True):
    """New snapshots, of one or several robots."""

    snapshots: tuple[SnapshotMessage, ...]


class LaserSweep(Part, frozen=True):
    """A sweep of a laser.

    `laser` is its number on the robot, from 0; its pose is in whole millimetres and milliradians;
    `ranges` are in millimetres, 0 where nothing answered, from angle `first` on in steps of `step`
    [rad].
    """

    robot: int
    laser: int
    sensor_in_map: tuple[int, int, int]
    first: float
    step: float
    ranges: tuple[int, ...]


class Scans(Message, tag="scans", frozen=True):
    """New sweeps, of one or several lasers, for clients that subscribed to them."""

    scans: tuple[LaserSweep, ...]


# -- the world


class MapCells(Part, frozen=True):
    """A grid as a grey PNG picture in base64; its first row is the lowest, which `corner` is at."""

    png: str
    side: float
    corner: Placed


class DrawnObject(Part, frozen=True):
    """A named place, line or area; `heads` if its heading `theta` means anything."""

    role: ObjectRole
    kind: str
    name: str
    x: float
    y: float
    theta: float
    heads: bool
    forbidden: bool
    solid: bool
    points: tuple[tuple[float, float], ...]


class MapShape(Part, frozen=True):
    """A shape of a solid, at x, y, z [m] and a heading [rad].

    A `block`, `wedge` or `column` stands there on the middle of its foot, with a length, width and
    height; a wedge rises along its x axis. A `mesh` has `numbers`, x, y and z of each of its
    points, and three `corners` of each triangle. A `terrain` has the heights of a grid of so many
    `columns` above its foot as `numbers`, the lowest row first.
    """

    form: Literal["block", "wedge", "column", "mesh", "terrain"]
    at: tuple[float, float, float, float]
    size: tuple[float, float, float] = (0.0, 0.0, 0.0)
    numbers: tuple[float, ...] = ()
    corners: tuple[int, ...] = ()
    columns: int = 0


class MapSolid(Part, frozen=True):
    """A solid with heights; `ground` if robots drive over it. `outline` is as seen from above."""

    kind: str
    ground: bool
    outline: tuple[tuple[float, float], ...]
    shapes: tuple[MapShape, ...]


class DrawnChange(Part, frozen=True):
    """Walls that have come, or gone, since a map was saved: their middle, and that of each cell."""

    text: str
    gone: bool
    x: float
    y: float
    cells: tuple[tuple[float, float], ...]


class Drawing(Part, frozen=True):
    """A map: walls as lines x0, y0, x1, y1 [m], grids, named places, solids, and its changes.

    Walls are `wall_height` [m] high, or as `heights` says of each; 0 for an outline of a solid.
    """

    name: str
    walls: tuple[tuple[float, float, float, float], ...]
    cells: tuple[MapCells, ...]
    objects: tuple[DrawnObject, ...]
    wall_height: float
    heights: tuple[float, ...]
    solids: tuple[MapSolid, ...]
    changes: tuple[DrawnChange, ...]


class Map(Message, tag="map", frozen=True):
    """The map, null where none is known."""

    map: Drawing | None


class MapDraft(Message, tag="map_draft", frozen=True):
    """The map as edited but not saved, null without edits; `steps` can be undone.

    `version` counts the drafts: requests about an object of `map` name it.
    """

    map: Drawing | None
    version: int
    steps: int


class Thing(msgspec.Struct, tag_field="kind", kw_only=True, frozen=True):
    """A thing of the simulated world; its size from the pose to the front, the rear, a side [m]."""

    id: int
    name: str
    front: float
    rear: float
    side: float
    thing_in_map: Placed


class BoxThing(Thing, tag="box", frozen=True):
    """A box of some height [m]."""

    walks: bool
    height: float


class PersonThing(Thing, tag="person", frozen=True):
    """A person of some height [m]."""

    walks: bool
    height: float


class RobotThing(Thing, tag="robot", kw_only=True, frozen=True):
    """A simulated robot; `own` is the number of a robot that the page drives, null of others."""

    model: str
    title: str
    url: str
    own: int | None
    connected: bool
    stop_button: bool
    plugged: bool
    charge: float


class SimulatedTime(Part, frozen=True):
    """The simulated time [s], null while it runs, and how fast it runs."""

    paused: bool
    speed: float
    factor: float
    time: float | None


class WorldChanges(Message, tag="world", frozen=True):
    """Changes of the simulated world.

    `things` are new or have changed, `moved` are only somewhere else (id, x, y, theta), `gone` are
    the ids of those removed. With `all` set, `things` is complete.
    """

    all: bool
    things: tuple[BoxThing | PersonThing | RobotThing, ...]
    moved: tuple[tuple[int, float, float, float], ...]
    gone: tuple[int, ...]
    clock: SimulatedTime | None


# -- the clients


class ClientInfo(Part, frozen=True):
    """A client of the page."""

    id: int
    name: str
    role: Role


class Holder(Part, frozen=True):
    """The operator who has control of a robot; `id` is null for a script."""

    robot: int
    id: int | None
    name: str


class People(Message, tag="people", frozen=True):
    """The receiving client, the operators who have control, and all clients."""

    id: int
    name: str
    role: Role
    control: tuple[Holder, ...]
    clients: tuple[ClientInfo, ...]


class Told(Message, tag="told", frozen=True):
    """News for this client alone."""

    message: str


class Refused(Message, tag="refused", frozen=True):
    """The reason to refuse a request."""

    message: str


class EditRefused(Message, tag="edit_refused", frozen=True):
    """The reason to refuse a change of the simulated world or of the map."""

    message: str


class Added(Message, tag="added", frozen=True):
    """The number of the thing that was added to the simulated world."""

    id: int | None


class Pong(Message, tag="pong", frozen=True):
    """The answer to a ping."""

    t: float


# -- a replay of logs

MarkKind = Literal["emergency", "stall", "link", "mode", "goal", "note"]


class ReplayState(Message, tag="replay", frozen=True):
    """The time `at` which logs are shown, of all between `began` and `ended` [s since 1970].

    `jumps` counts how often somebody went elsewhere; `looked` is the share of the logs that was
    looked through for marks, 0 to 1.
    """

    began: float
    ended: float
    at: float
    speed: float
    playing: bool
    jumps: int
    looked: float


class ReplayMark(Part, frozen=True):
    """An event of a log at a time [s since 1970], of a `robot` or, null, of all."""

    at: float
    robot: int | None
    kind: MarkKind
    text: str


class ReplayMarks(Message, tag="replay_marks", frozen=True):
    """The events that have been found so far."""

    marks: tuple[ReplayMark, ...]


# -- details of one robot, for clients that subscribed to them


class Sides(Part, frozen=True):
    """Speeds of the left and the right wheel [m/s]."""

    left: float
    right: float


class Stalls(Part, frozen=True):
    """Whether the left and the right wheels are blocked."""

    left: bool
    right: bool


class AnalogPort(Part, frozen=True):
    """The selected analog port and its voltage [V]."""

    port: int
    voltage: float


class LineValues(Part, frozen=True):
    """Digital and analog lines; `analog` [V] is null where the robot does not tell them all."""

    digital_in: tuple[bool, ...]
    digital_out: tuple[bool, ...]
    analog: tuple[float, ...] | None
    selected: AnalogPort


class SensorValue(Part, frozen=True):
    """A value of a sensor, with its unit."""

    label: str
    text: str


class SensorDetails(Part, frozen=True):
    """A sensor: its presence in words, and its values while it sends readings."""

    name: str
    words: str
    values: tuple[SensorValue, ...]


class NoDetails(Message, tag="details", frozen=True):
    """The robot is not connected."""

    robot: int
    known: Literal[False] = False


class Details(Message, tag="details", kw_only=True, frozen=True):
    """More about a robot than a snapshot has; `baud` is null where the link has none."""

    robot: int
    known: Literal[True] = True
    findings: tuple[Finding, ...]
    robot_in_encoder: Pose2
    wheels: Sides
    stalls: Stalls
    temperature: int | None
    compass: float | None
    flags: tuple[str, ...]
    faults: tuple[str, ...] | None
    charger_power: bool
    baud: int | None
    lines: LineValues
    sensors: tuple[SensorDetails, ...]


class ConfigMessage(Message, tag="config", frozen=True):
    """The robot's CONFIG, and the reason for not asking it anew, or null."""

    robot: int
    rows: tuple[ConfigRow, ...]
    error: str | None


# -- a class: each student has a robot


class HandedIn(Part, frozen=True):
    """A run that was handed in; `at` is the Unix time [s], `seconds` its length."""

    file: str
    student: str
    robot: int
    at: float
    seconds: float
    size: int


class Recording(Part, frozen=True):
    """A recorded run that is not handed in; `ended` says why it has ended by itself, or is empty.

    `began` is the Unix time [s]; `seconds` is its length, null while it goes on.
    """

    began: float
    seconds: float | None
    ended: str = ""


class Seat(Part, frozen=True):
    """A robot of a class and its student: `name` is null while nobody has joined.

    `online` counts the student's open pages. `program` is the address of the program that has the
    robot, null without; programs connect to `url`. The teacher has `paused` it. A student of the
    class may drive it from the page unless `refusal` says why not.
    """

    robot: int
    name: str | None
    online: int
    program: str | None
    paused: bool
    refusal: str
    recording: Recording | None
    url: str


class Class(Message, tag="class", frozen=True):
    """The class. Students get their own seat and runs only, and no `join_url`.

    `paused` says that the teacher has paused all robots, `locked` that nobody else can join,
    `shared` that several may join from one network address, and `lan` that other devices can reach
    `join_url`.
    """

    paused: bool
    locked: bool
    shared: bool
    lan: bool
    join_url: str | None
    seats: tuple[Seat, ...]
    handed_in: tuple[HandedIn, ...]


class SmallSnapshot(Part, frozen=True):
    """A robot of a class at one instant, for the teacher's page.

    `driver` is null while nobody drives. `by` is the kind of driver: a student's page, the
    teacher's, a program at the robot's port, or a mode or script. `battery` is in volts.
    """

    robot: int
    robot_in_map: Placed
    v: float
    battery: float
    stalled: bool
    emergency_stop: bool
    connected: bool
    by: Literal["student", "teacher", "program", "mode"] | None
    driver: str | None
    why: str | None


class ClassRobots(Message, tag="class_robots", frozen=True):
    """New small snapshots of a class's robots, five times a second."""

    snapshots: tuple[SmallSnapshot, ...]


EVERY = (
    *(Hello, Status, Robots, Scans, Map, MapDraft, WorldChanges, People, Class, ClassRobots),
    *(PlannedWay, Navigation, GoalProgress, Mapping, CalibrationState, Told, Refused),
    *(EditRefused, Added, Pong),
    *(Details, NoDetails, ConfigMessage, ReplayState, ReplayMarks),
)
"""All messages."""
