"""What the API is asked and answers. SI units, angles counter-clockwise [rad]."""

from typing import Annotated, Literal

import msgspec
from msgspec import Meta

from pioneer3.web.access.role import Role

Name = Annotated[str, Meta(max_length=40)]


class Body(msgspec.Struct, forbid_unknown_fields=True):
    """Anything a request carries."""


class Velocity(Body):
    """Forward speed `v` [m/s] and turn rate `w` [rad/s]; 0, 0 lets go."""

    v: float
    w: float = 0.0


class Switch(Body):
    """Something on or off."""

    on: bool


class Wanted(Body):
    """Whether to take the wheel from who has it: the robot stops first."""

    take_over: bool = False


class Answered(msgspec.Struct):
    """It was done. `why` says why the robot stands still, and is null while it moves."""

    why: str | None


class Robot(msgspec.Struct):
    """A robot and how it is connected; `number` is its place in the paths."""

    number: int
    name: str
    model: str
    title: str
    url: str
    connection: str
    max_speed: float
    max_turn_rate: float


class Pose(msgspec.Struct):
    """A place: x, y [m], theta [rad]."""

    x: float
    y: float
    theta: float


class Sonar(msgspec.Struct):
    """Ranges [m] from the front left on; null where nothing echoed."""

    enabled: bool
    ranges: list[float | None]


class Battery(msgspec.Struct):
    """Voltage [V] and charge, from 0 to 1 or null where the robot cannot tell."""

    voltage: float
    charge: float | None
    charging: str
    low: bool


class Motors(msgspec.Struct):
    """The drive."""

    enabled: bool
    stalled: bool
    moving: bool
    stop_button: bool


class Bumpers(msgspec.Struct):
    """Contact by segment: front from left to right, rear from right to left."""

    front: list[bool]
    rear: list[bool]


class Snapshot(msgspec.Struct):
    """One reading of everything; `sequence` counts them. Poses are in odometry's frame."""

    sequence: int
    pose: Pose
    velocity: Velocity
    sonar: Sonar
    battery: Battery
    motors: Motors
    bumpers: Bumpers
    faults: list[str]
    emergency_stop: bool
    why: str | None
    driver: str | None


class ModeState(msgspec.Struct):
    """The mode that runs, and who decides what in it; how the last one ended, in words."""

    mode: str | None
    decided: list[str]
    ended: str | None
    done: bool


class WheelState(msgspec.Struct):
    """Who has the wheel, null for nobody, and whether that is you."""

    holder: str | None
    yours: bool


class Pairing(Body):
    """A one-time token, the name to be shown by, and the role if it shall be less than offered."""

    token: Annotated[str, Meta(max_length=128)]
    name: Name = ""
    role: Role | None = None


class Me(msgspec.Struct):
    """Who you are here. `invites` says whether you may let others in, `urls` where they come in."""

    id: str
    name: str
    role: Role
    invites: bool
    urls: tuple[str, ...]


class SessionInfo(msgspec.Struct):
    """Somebody who is in; `idle` is how long ago they were last heard of [s]."""

    id: str
    name: str
    role: Role
    kind: Literal["browser", "script"]
    idle: float
    yours: bool


class Invite(Body):
    """What the one who comes may do."""

    role: Role = Role.DRIVER


class Invitation(msgspec.Struct):
    """An address to open on a phone, good once and for some seconds; `svg` is it as a QR code."""

    url: str
    svg: str
    role: Role
    seconds: float


class TokenWish(Body):
    """What the script is called, and what it may do."""

    name: Name = "script"
    role: Role = Role.DRIVER


class Token(msgspec.Struct):
    """A bearer token. It is shown this once."""

    id: str
    name: str
    role: Role
    token: str
