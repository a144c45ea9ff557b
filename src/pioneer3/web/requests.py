"""Messages from the page to the server: checked when decoded, told apart by `type`."""

from typing import Annotated, Literal

import msgspec
from msgspec import Meta

from pioneer3.behaviors.modes import AnyMode
from pioneer3.behaviors.modes.group import AnyGroupMode
from pioneer3.errors import Refusal
from pioneer3.maps.edit import NewRole

Input = Literal["gamepad", "keyboard", "touch", "tilt"]
"""A way to drive."""

Metre = Annotated[float, Meta(ge=-1e4, le=1e4)]
"""A coordinate in the map [m]."""
Radian = Annotated[float, Meta(ge=-100.0, le=100.0)]
Side = Annotated[float, Meta(ge=0.1, le=20.0)]
"""Side of a box [m]."""
Speed = Annotated[float, Meta(gt=0.0, le=5.0)]
"""Highest speed [m/s]."""
Share = Annotated[float, Meta(ge=0.0, le=1.0)]
FileName = Annotated[str, Meta(pattern=r"^[A-Za-z0-9][A-Za-z0-9 _-]{0,39}$(?!\n)")]
"""Name of a file, without its ending."""
ObjectName = Annotated[str, Meta(pattern=r'^[^\s"]([^"\t\r\n]{0,38}[^\s"])?$(?!\n)')]
"""Name of a place, a line or an area of a map."""
ObjectNameOrNone = Annotated[str, Meta(pattern=r'^([^\s"]([^"\t\r\n]{0,38}[^\s"])?)?$(?!\n)')]
Path = Annotated[tuple[tuple[Metre, Metre], ...], Meta(min_length=1, max_length=20)]


class Request(msgspec.Struct, tag_field="type", forbid_unknown_fields=True):
    """Any message of the page."""


class RobotRequest(Request, kw_only=True):
    """A request about a robot: `robot` is its number on the page; null means the first."""

    robot: int | None = None


class VelocityRequest(RobotRequest, tag="drive"):
    """Hold this velocity [m/s, rad/s] with `input` until it expires; 0, 0 lets go.

    The robots `also` hold the same.
    """

    v: float
    w: float
    input: Input = "touch"
    also: Annotated[tuple[int, ...], Meta(max_length=100)] = ()


class StopRequest(RobotRequest, tag="stop"):
    """Stop the robot, whoever drives."""


class EmergencyStop(RobotRequest, tag="emergency_stop"):
    """Stop as hard as possible until it is reset; without a number, stop all robots."""


class ResetEmergencyStop(RobotRequest, tag="reset_emergency_stop"):
    """End the emergency stop. The motors stay off."""


class SwitchMotors(RobotRequest, tag="motors"):
    """Switch the motors' power."""

    on: bool


class TakeControl(RobotRequest, tag="take_control"):
    """Take control if it is free, and keep it."""


class TakeOver(RobotRequest, tag="take_over"):
    """Stop the robot, then take control, whoever has it now."""


class HandOver(RobotRequest, tag="hand_over"):
    """Stop the robot, and pass control on to the client of number `to`."""

    to: int


class ReleaseControl(RobotRequest, tag="release_control"):
    """Release control; the robot stops."""


class StartMode(RobotRequest, tag="start_mode"):
    """Stop, then start a mode; the place of a `goto` is in odometry's frame."""

    mode: AnyMode


class StartGroupMode(Request, tag="start_group_mode"):
    """Start a mode of several robots, of which one may be the leader; it is left to its driver."""

    robots: Annotated[tuple[int, ...], Meta(min_length=2, max_length=100)]
    mode: AnyGroupMode
    leader: int | None = None


class GotoPlace(RobotRequest, tag="goto"):
    """Drive to a place of the map, and turn to a heading there if one is given.

    A robot with a laser drives along a planned way, one without drives straight. People are told
    the `name` of the place, if the map has it.
    """

    x: Metre
    y: Metre
    heading: Radian | None = None
    name: str = ""
    speed: Speed = 0.3


class Stopover(msgspec.Struct, forbid_unknown_fields=True):
    """A place of a patrol, with a heading to turn to there if one is given, and its name."""

    x: Metre
    y: Metre
    heading: Radian | None = None
    name: str = ""


class Patrol(RobotRequest, tag="patrol"):
    """Drive from place to place of the map, and begin anew after the last one, until stopped."""

    places: Annotated[tuple[Stopover, ...], Meta(min_length=2, max_length=20)]
    speed: Speed = 0.3


class LookAround(RobotRequest, tag="look_around"):
    """Drive about slowly until the robot is sure where it is on the map."""


class PlaceRobot(RobotRequest, tag="place_robot"):
    """Tell where the robot is on the map; without a heading it may look anywhere."""

    x: Metre
    y: Metre
    heading: Radian | None = None


class PlanWay(RobotRequest, tag="plan_way"):
    """Ask for the way to a place of the map; the answer is a `way`. Nothing drives."""

    x: Metre
    y: Metre
    heading: Radian | None = None
    name: str = ""
    speed: Speed = 0.3


class MakeMap(RobotRequest, tag="make_map"):
    """Begin a map, explore, or end it: save it under `name` in the server's folder, or not.

    `name_place` makes the place where the robot is a goal of the map. `update` goes on with the map
    in use instead; `finish` shows what has changed, and `save` replaces it then.
    """

    step: Literal["begin", "update", "explore", "name_place", "finish", "save", "discard"]
    name: FileName = "map"
    speed: Speed = 0.4


class Calibrate(RobotRequest, tag="calibrate"):
    """Begin a calibration, by laser if there is one, or `by_tape`; drive its next step, or end it.

    `measure` gives the `answers` to what the step asks [m, rad], by their names; `skip` leaves the
    step out, `undo` forgets the last one, and `write` writes the robot's own file.
    """

    step: Literal["begin", "drive", "measure", "skip", "undo", "write", "end"]
    by_tape: bool = False
    answers: Annotated[dict[str, float], Meta(max_length=8)] = {}


class EndMode(RobotRequest, tag="end_mode"):
    """End the mode; its motion ends at once."""


class WatchDetails(RobotRequest, tag="watch_details"):
    """Open the details of the robot in place of any other's, or close them."""

    on: bool


class AskConfig(RobotRequest, tag="ask_config"):
    """Ask the robot for its CONFIG."""


class WatchLasers(Request, tag="watch_lasers"):
    """Subscribe to the lasers' sweeps, or end that; lasers are on while anybody subscribes."""

    on: bool


class PlayRequest(Request, tag="play"):
    """Play or pause a replay, change its speed, or go to a time [s since 1970]; null leaves it."""

    playing: bool | None = None
    speed: Annotated[float, Meta(ge=0.1, le=32.0)] | None = None
    at: Annotated[float, Meta(ge=0.0, le=1e11)] | None = None


class PingRequest(Request, tag="ping"):
    """Ask for a pong with the same `t`."""

    t: float


class AddBox(Request, tag="add_box"):
    """Put a box into the simulated world; x, y is its middle."""

    x: Metre
    y: Metre
    theta: Radian
    length: Side
    width: Side


class AddPerson(Request, tag="add_person"):
    """Put a person into the simulated world, who stands at a point or walks along several."""

    path: Path


class AddRobot(Request, tag="add_robot"):
    """Put one more robot, of a shipped model, into the simulated world."""

    model: str
    x: Metre
    y: Metre
    theta: Radian


class MoveRequest(Request, tag="move"):
    """Put a thing somewhere else."""

    id: int
    x: Metre
    y: Metre
    theta: Radian


class Remove(Request, tag="remove"):
    """Take a thing out of the simulated world."""

    id: int


class PressStopButton(Request, tag="stop_button"):
    """Press or release the red button on a simulated robot."""

    id: int
    pressed: bool


class PlugCable(Request, tag="cable"):
    """Pull the cable out of a simulated robot, or put it in again."""

    id: int
    plugged: bool


class SetCharge(Request, tag="charge"):
    """Drain or fill the battery of a simulated robot, to this share of its capacity."""

    id: int
    charge: Share


class PauseRequest(Request, tag="pause"):
    """Stop simulated time, or let it pass again."""

    paused: bool


class StepRequest(Request, tag="step"):
    """Let some simulated time pass [s], then stand still."""

    seconds: Annotated[float, Meta(ge=0.02, le=1.0)]


class SetSpeed(Request, tag="speed"):
    """Let simulated time pass so many times as fast as real time."""

    speed: Annotated[float, Meta(ge=0.25, le=10.0)]


class EraseWalls(Request, tag="erase_walls"):
    """Erase the walls of the map that lie in a box whole, given by two corners."""

    x0: Metre
    y0: Metre
    x1: Metre
    y1: Metre


class DrawWall(Request, tag="draw_wall"):
    """Add a wall to the map, from one point to another."""

    x0: Metre
    y0: Metre
    x1: Metre
    y1: Metre


class Forbid(Request, tag="forbid"):
    """Forbid a line between two points of the map, or an area between two corners."""

    x0: Metre
    y0: Metre
    x1: Metre
    y1: Metre
    shape: Literal["line", "area"]
    name: ObjectNameOrNone = ""


class NamePlace(Request, tag="name_place"):
    """Add a place to the map, or move the place of that name; docks and homes have a heading."""

    role: NewRole
    name: ObjectName
    x: Metre
    y: Metre
    heading: Radian | None = None


class RenameObject(Request, tag="rename_object"):
    """Give a place, line or area of the draft `version` another name; `number` counts from 0.

    The version of the map that robots use is that of the last draft.
    """

    number: Annotated[int, Meta(ge=0)]
    version: int
    name: ObjectName


class RemoveObject(Request, tag="remove_object"):
    """Remove a place, line or area of the draft `version`; `number` counts from 0."""

    number: Annotated[int, Meta(ge=0)]
    version: int


class UndoMapEdit(Request, tag="undo_map_edit"):
    """Undo the last edit of the map that is not saved."""


class DiscardMapEdits(Request, tag="discard_map_edits"):
    """Undo all edits of the map that are not saved."""


class SaveMap(Request, tag="save_map"):
    """Save the edited map in the server's folder under a new name; robots use it from then on."""

    name: FileName
    format: Literal[".map", ".yaml", ".toml"] = ".map"


class PauseRobots(Request, tag="pause_robots"):
    """Stop a robot of the class, or all without a number, and let nobody drive; or end that."""

    paused: bool
    robot: int | None = None


class PutBack(Request, tag="put_back"):
    """Stop a simulated robot of the class and put it where it began; without a number, all."""

    robot: int | None = None


class FreeSeat(Request, tag="free_seat"):
    """Show the student of a robot out, so that another can have it."""

    robot: int


class LockJoining(Request, tag="lock_joining"):
    """Let no more students join the class, or let them again."""

    locked: bool


class ShareAddresses(Request, tag="share_addresses"):
    """Let several students join the class from one network address, or one from each."""

    shared: bool


class RecordRun(Request, tag="record_run"):
    """Record a run of a robot of the class, end the recording, hand it in, or drop it.

    Handing in ends it. `robot` is null for a student's own.
    """

    step: Literal["begin", "end", "hand_in", "discard"]
    robot: int | None = None


DriveRequest = VelocityRequest | StopRequest | EmergencyStop | ResetEmergencyStop | SwitchMotors
"""Drives or stops one robot."""
ControlRequest = TakeControl | TakeOver | HandOver | ReleaseControl
"""Changes who has control of a robot."""
ModeRequest = StartMode | GotoPlace | MakeMap | Calibrate | EndMode
"""Starts or ends a mode."""
MapRequest = Patrol | LookAround | PlaceRobot
"""Needs a map on which the robot can be found."""
ViewRequest = WatchDetails | AskConfig | WatchLasers | PlanWay
"""Concerns this client alone."""
FOR_ALL = (StopRequest, EmergencyStop, PingRequest, WatchDetails, AskConfig, WatchLasers)
"""Requests that viewers may make; the others are for drivers."""
Edit = (
    AddBox
    | AddPerson
    | AddRobot
    | MoveRequest
    | Remove
    | PressStopButton
    | PlugCable
    | SetCharge
    | PauseRequest
    | StepRequest
    | SetSpeed
)
"""Changes the simulated world."""
MapChange = EraseWalls | DrawWall | Forbid | NamePlace | RenameObject | RemoveObject
"""Changes the draft of the map."""
MapEdit = MapChange | UndoMapEdit | DiscardMapEdits | SaveMap
"""Concerns the draft of the map."""
ClassRequest = PauseRobots | PutBack | FreeSeat | LockJoining | ShareAddresses | RecordRun
"""Concerns a class."""
RobotAction = DriveRequest | ControlRequest | ModeRequest | MapRequest
AnyRequest = (
    RobotAction
    | StartGroupMode
    | ViewRequest
    | PingRequest
    | Edit
    | MapEdit
    | ClassRequest
    | PlayRequest
)
FOR_REPLAYS = (PlayRequest, PingRequest, WatchDetails, AskConfig, WatchLasers)
"""Requests about a replay."""
FOR_STUDENTS = (
    *(VelocityRequest, StopRequest, EmergencyStop, ResetEmergencyStop, SwitchMotors),
    *(TakeControl, TakeOver, ReleaseControl),
    *(StartMode, GotoPlace, EndMode, Patrol, LookAround, PlaceRobot, PlanWay),
    *(WatchDetails, AskConfig, WatchLasers, PingRequest, RecordRun),
)
"""Requests that the students of a class may make, about their own robots."""
ONLY_DRIVERS = "you are a viewer: you may look, and stop the robot"
REPLAYED = "this is a replay: nothing in it can be driven or changed"
NOT_REPLAYED = "this is no replay: nothing can be played here"
ONLY_TEACHERS = "only your teacher may do this"
NOT_YOURS = "this is not your robot"
TOO_DEEP = "nested too deeply"
_decoder: msgspec.json.Decoder[AnyRequest] = msgspec.json.Decoder(AnyRequest)
_stops: msgspec.json.Decoder[StopRequest | EmergencyStop] = msgspec.json.Decoder(
    StopRequest | EmergencyStop
)


def decode(text: str) -> AnyRequest:
    """Return the request in `text`.

    Raises:
        msgspec.MsgspecError: it is no request; the message says why.
    """
    try:
        return _decoder.decode(text)
    except RecursionError:
        raise msgspec.ValidationError(TOO_DEEP) from None


def refusal_for_student(request: AnyRequest, robot: int | None) -> Refusal | None:
    """Return the refusal of this request of the student of `robot`, or `None`."""
    if not isinstance(request, FOR_STUDENTS):
        return Refusal(ONLY_TEACHERS)
    if isinstance(request, WatchLasers | PingRequest):
        return None
    alone = not isinstance(request, VelocityRequest) or not request.also
    return None if request.robot == robot is not None and alone else Refusal(NOT_YOURS)


def is_stop(text: bytes) -> bool:
    """Return whether `text` is a request to stop; any other is rejected at its tag."""
    try:
        _stops.decode(text)
    except (msgspec.MsgspecError, RecursionError):
        return False
    return True
