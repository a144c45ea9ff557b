"""Bodies of requests and answers of the API. SI units, angles counter-clockwise [rad]."""

from typing import Annotated, Literal

import msgspec
from msgspec import Meta

from pioneer3.behaviors.modes.group import AnyGroupMode
from pioneer3.web.access.sessions import Role
from pioneer3.web.messages import HandedIn, Recording
from pioneer3.web.requests import Metre, Radian
from pioneer3.web.requests import Speed as MapSpeed

Name = Annotated[str, Meta(max_length=40)]


class RequestBody(msgspec.Struct, forbid_unknown_fields=True):
    """The body of a request."""


class LogNote(RequestBody):
    """A note to what is saved, such as why."""

    note: Annotated[str, Meta(max_length=200)] = ""


class LoggedRun(msgspec.Struct):
    """A log; `began` is the Unix time [s], `seconds` its length, `size` in bytes.

    `end` is why it ended; while it `goes_on`, a program writes it. A `note` is of a saved one. A
    long one goes on in `more` files.
    """

    file: str
    more: tuple[str, ...]
    began: float
    seconds: float
    size: int
    robot: str
    end: str
    note: str
    pinned: bool
    goes_on: bool


class Velocity(RequestBody):
    """Forward speed `v` [m/s] and turn rate `w` [rad/s]; 0, 0 lets go."""

    v: float
    w: float = 0.0


class WheelSpeeds(RequestBody):
    """Speeds of the wheels of each side [m/s], forwards; 0, 0 lets go."""

    left: float
    right: float


class MotorPower(RequestBody):
    """The motors' power."""

    on: bool


class Group(RequestBody):
    """A mode of several robots, by their numbers; `leader` is one of them, null without one."""

    robots: Annotated[tuple[int, ...], Meta(min_length=2, max_length=100)]
    mode: AnyGroupMode
    leader: int | None = None


class ControlRequest(RequestBody):
    """Whether to take control from another who has it: the robot stops first."""

    take_over: bool = False


class WantedPlace(RequestBody):
    """A place of the map: its `name`, or `x` and `y` [m] with a `heading` to turn to [rad]."""

    name: Annotated[str, Meta(max_length=80)] | None = None
    x: Metre | None = None
    y: Metre | None = None
    heading: Radian | None = None
    speed: MapSpeed = 0.3


class MapPlace(msgspec.Struct):
    """A place of the map that has a name; `heading` is null where any will do."""

    name: str
    x: float
    y: float
    heading: float | None


class CommandResult(msgspec.Struct):
    """Success of a command. `why` is the reason to stand still, null while the robot moves."""

    why: str | None


class ControlState(msgspec.Struct):
    """Name of the operator who has control, null for nobody, and whether that is you."""

    holder: str | None
    yours: bool


Side = Literal["left", "right"]
Triple = tuple[float, float, float]


class DescribedSolid(msgspec.Struct):
    """A box, or a cylinder that stands on its z axis, with its middle `at` a point of its link [m].

    `size` is along x, y and z [m], `turned` roll, pitch and yaw [rad], `color` red, green and blue
    from 0 to 1.
    """

    shape: Literal["box", "cylinder"]
    color: Triple
    size: Triple
    at: Triple
    turned: Triple


class DescribedLink(msgspec.Struct):
    """A part of a robot `at` a point of its base [m], turned by `yaw` [rad].

    A `wheel` turns about its y axis.
    """

    at: Triple
    yaw: float
    wheel: Side | None
    solids: tuple[DescribedSolid, ...]


class RobotBody(msgspec.Struct):
    """The body of a type of robot. Its origin is on the floor, in the centre of its rotation."""

    model: str
    links: tuple[DescribedLink, ...]


class PairingRequest(RequestBody):
    """A one-time token, the name to show, and the role if it shall be less than the token's."""

    token: Annotated[str, Meta(max_length=128)]
    name: Name = ""
    role: Role | None = None


class Me(msgspec.Struct):
    """Your session; whether it may invite others, and the addresses of the page for them."""

    id: str
    name: str
    role: Role
    invites: bool
    urls: tuple[str, ...]


class SessionInfo(msgspec.Struct):
    """A session; `idle` is the time since its last use [s]."""

    id: str
    name: str
    role: Role
    kind: Literal["browser", "script"]
    idle: float
    yours: bool


class InvitationRequest(RequestBody):
    """The role of the new session."""

    role: Role = Role.DRIVER


class Invitation(msgspec.Struct):
    """An address to open on a phone, good once and for some seconds; `svg` is it as a QR code."""

    url: str
    svg: str
    role: Role
    seconds: float


class TokenRequest(RequestBody):
    """The name of the script, and its role."""

    name: Name = "script"
    role: Role = Role.DRIVER


class Token(msgspec.Struct):
    """A bearer token. It is shown only once."""

    id: str
    name: str
    role: Role
    token: str


class JoinRequest(RequestBody):
    """The class's token, and the student's name."""

    token: Annotated[str, Meta(max_length=128)]
    name: Annotated[str, Meta(min_length=1, max_length=40)]


class Joined(msgspec.Struct):
    """The student's robot and name; programs of the student connect to `url`."""

    robot: int
    name: str
    url: str


class Installation(msgspec.Struct):
    """The line that installs pioneer3 from a class, and files that the class hands out.

    Attributes:
        command: The line, for a terminal.
        offline: Whether it needs no package index.
        programs: Names of programs, at `/programs/NAME` with the address of the own robot.
        book: Whether the book is at `/book/`.
    """

    command: str
    offline: bool
    programs: list[str]
    book: bool


class ClassLink(msgspec.Struct):
    """The address for students, and as a QR code; `lan` says that other devices can reach it."""

    url: str
    svg: str
    lan: bool


class Paused(RequestBody):
    """Whether the robots are to stand still."""

    paused: bool


class Locked(RequestBody):
    """Whether no more students can join."""

    locked: bool


class Shared(RequestBody):
    """Whether several students may join from one network address."""

    shared: bool


class RecordingStep(RequestBody):
    """The next step of a recording; handing in ends it."""

    step: Literal["begin", "end", "hand_in", "discard"]


class RecordingState(msgspec.Struct):
    """The recording of a robot's run, null without one, and the run that was handed in now."""

    recording: Recording | None
    handed_in: HandedIn | None
