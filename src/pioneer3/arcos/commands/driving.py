"""Session, motion and limits (protocol.md 3.1): forward and counter-clockwise are positive."""

from typing import Annotated, ClassVar

from pioneer3.arcos.commands.arguments import (
    DEGREES,
    MILLI,
    Degrees,
    Millis,
    Number,
    On,
    Prefixed,
    SignedDegrees,
    SignedHigh,
    SignedLow,
    SignedMillis,
    Word,
)
from pioneer3.arcos.layout import Command
from pioneer3.arcos.wire import Integer, Scaled

__all__ = [
    "Close",
    "DHead",
    "DriftFactor",
    "EStop",
    "Enable",
    "Head",
    "Move",
    "Open",
    "Pulse",
    "QStop",
    "RVel",
    "RequestConfig",
    "RevCount",
    "Rotate",
    "SetA",
    "SetO",
    "SetRA",
    "SetRV",
    "SetV",
    "Stop",
    "TicksMM",
    "Vel",
    "Vel2",
]

_S16 = Integer(2, signed=True)


class Pulse(Command, frozen=True):
    """Do nothing but restart the watchdog (ARCOS 0, PULSE; SYNC0 before the session is open).

    ARIA's SETLATV has number 0 too, with an argument that is ignored.
    """

    ID: ClassVar[int] = 0


class Open(Command, frozen=True):
    """Start the reports (ARCOS 1, OPEN; SYNC1 without argument before the session is open).

    Robots ignore `argument`; ARIA sends 1, Player none.
    """

    ID: ClassVar[int] = 1
    argument: Number = 1


class Close(Command, frozen=True):
    """Stop everything and wait for SYNC0 (ARCOS 2, CLOSE; SYNC2 while shaking hands).

    Robots ignore `argument`; ARIA sends 1, Player none.
    """

    ID: ClassVar[int] = 2
    argument: Number = 1


class RequestConfig(Command, frozen=True):
    """Ask for one configuration report (ARCOS 18, CONFIG)."""

    ID: ClassVar[int] = 18
    argument: Number = 1


class Enable(Command, frozen=True):
    """Give the motors power or take it away (ARCOS 4, ENABLE)."""

    ID: ClassVar[int] = 4
    on: On


class Vel(Command, frozen=True):
    """Drive at `speed` [m/s] (ARCOS 11, VEL)."""

    ID: ClassVar[int] = 11
    speed: SignedMillis


class RVel(Command, frozen=True):
    """Turn at `rate` [rad/s] (ARCOS 21, RVEL)."""

    ID: ClassVar[int] = 21
    rate: SignedDegrees


class Stop(Command, frozen=True):
    """Brake to a stand with the set decelerations (ARCOS 29, STOP)."""

    ID: ClassVar[int] = 29


class EStop(Command, frozen=True):
    """Stop with the greatest deceleration (ARCOS 55, ESTOP).

    Robots ignore `argument`; ARIA sends 0 or 1, the manual has none.
    """

    ID: ClassVar[int] = 55
    argument: Number = 1


class QStop(Command, frozen=True):
    """Stop with the greatest deceleration: AMRISim's second number (ARCOS 57, QSTOP)."""

    ID: ClassVar[int] = 57
    argument: Number = 1


class Vel2(Command, frozen=True):
    """Set the speed of each wheel (ARCOS 32, VEL2).

    Speeds are -128..127, in units of the model's Vel2Divisor (P2, P3: 20 mm/s).
    """

    ID: ClassVar[int] = 32
    left_units: SignedHigh
    right_units: SignedLow


class Rotate(Command, frozen=True):
    """Turn at `rate` [rad/s]: the old synonym of RVEL (ARCOS 9, ROTATE)."""

    ID: ClassVar[int] = 9
    rate: SignedDegrees


class Move(Command, frozen=True):
    """Drive `distance` [m] straight, within the limits of SETV and SETA (ARCOS 8, MOVE)."""

    ID: ClassVar[int] = 8
    distance: SignedMillis


class Head(Command, frozen=True):
    """Turn to the absolute `heading` [rad] of the odometry (ARCOS 12, HEAD)."""

    ID: ClassVar[int] = 12
    heading: SignedDegrees


class DHead(Command, frozen=True):
    """Turn by `angle` [rad] (ARCOS 13, DHEAD)."""

    ID: ClassVar[int] = 13
    angle: SignedDegrees


class SetO(Command, frozen=True):
    """Set the odometry (ARCOS 7, SETO).

    Robots take no arguments and set it to zero. AMRISim also takes a pose [m, rad], with zero in
    place of missing parts.
    """

    ID: ClassVar[int] = 7
    x: Annotated[float, Prefixed(Scaled(_S16, MILLI), 0x3B)] | None = None
    y: Annotated[float, Scaled(_S16, MILLI)] | None = None
    heading: Annotated[float, Scaled(_S16, DEGREES)] | None = None


class SetV(Command, frozen=True):
    """Limit the translational speed to `speed` [m/s]; MOVE uses it too (ARCOS 6, SETV)."""

    ID: ClassVar[int] = 6
    speed: Millis


class SetRV(Command, frozen=True):
    """Limit the rotational speed to `rate` [rad/s] (ARCOS 10, SETRV)."""

    ID: ClassVar[int] = 10
    rate: Degrees


class SetA(Command, frozen=True):
    """Set the translational acceleration or deceleration (ARCOS 5, SETA).

    A negative value [m/s^2] is the deceleration, and leaves the acceleration.
    """

    ID: ClassVar[int] = 5
    acceleration: SignedMillis


class SetRA(Command, frozen=True):
    """Set the rotational acceleration or deceleration (ARCOS 23, SETRA).

    A negative value [rad/s^2] is the deceleration, and leaves the acceleration.
    """

    ID: ClassVar[int] = 23
    acceleration: SignedDegrees


class RevCount(Command, frozen=True):
    """Set by how many `ticks` the encoders differ after half a turn (ARCOS 88, REVCOUNT)."""

    ID: ClassVar[int] = 88
    ticks: Word


class DriftFactor(Command, frozen=True):
    """Set the correction of the left encoder [1/8192 of its count] (ARCOS 89, DRIFTFACTOR)."""

    ID: ClassVar[int] = 89
    correction: Number


class TicksMM(Command, frozen=True):
    """Set the encoder ticks per millimetre of wheel travel (ARCOS 93, TICKSMM)."""

    ID: ClassVar[int] = 93
    ticks_per_mm: Word
