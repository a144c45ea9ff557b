"""Driving (arcos.md 3.1). Forward and counter-clockwise are positive, unless a class says more."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

from pioneer3.arcos.commands.arguments import Prefixed
from pioneer3.arcos.commands.quantities import (
    DEGREES,
    MILLI,
    Number,
    On,
    SignedDegrees,
    SignedHigh,
    SignedLow,
    SignedMillis,
)
from pioneer3.arcos.wire import Integer, Scaled

__all__ = [
    "DCHead",
    "DHead",
    "EStop",
    "Enable",
    "Head",
    "LatVel",
    "Move",
    "QStop",
    "RVel",
    "Rotate",
    "SetO",
    "Stop",
    "Vel",
    "Vel2",
]

_S16 = Integer(2, signed=True)


@dataclass(frozen=True, slots=True)
class Enable:
    """Give the motors power or take it away (ARCOS 4, ENABLE)."""

    ID: ClassVar[int] = 4
    on: On


@dataclass(frozen=True, slots=True)
class SetO:
    """Set the odometry (ARCOS 7, SETO).

    Robots take no arguments and set it to zero. AMRISim also takes a pose, of which missing parts
    are zero.

    Attributes:
        x: [m].
        y: [m].
        heading: [rad].
    """

    ID: ClassVar[int] = 7
    x: Annotated[float, Prefixed(Scaled(_S16, MILLI), 0x3B)] | None = None
    y: Annotated[float, Scaled(_S16, MILLI)] | None = None
    heading: Annotated[float, Scaled(_S16, DEGREES)] | None = None


@dataclass(frozen=True, slots=True)
class Move:
    """Drive `distance` [m] straight, within the limits of SETV and SETA (ARCOS 8, MOVE)."""

    ID: ClassVar[int] = 8
    distance: SignedMillis


@dataclass(frozen=True, slots=True)
class Rotate:
    """Turn at `rate` [rad/s]: the old synonym of RVEL (ARCOS 9, ROTATE)."""

    ID: ClassVar[int] = 9
    rate: SignedDegrees


@dataclass(frozen=True, slots=True)
class Vel:
    """Drive at `speed` [m/s] (ARCOS 11, VEL)."""

    ID: ClassVar[int] = 11
    speed: SignedMillis


@dataclass(frozen=True, slots=True)
class Head:
    """Turn to the absolute `heading` [rad] of the odometry (ARCOS 12, HEAD)."""

    ID: ClassVar[int] = 12
    heading: SignedDegrees


@dataclass(frozen=True, slots=True)
class DHead:
    """Turn by `angle` [rad] (ARCOS 13, DHEAD)."""

    ID: ClassVar[int] = 13
    angle: SignedDegrees


@dataclass(frozen=True, slots=True)
class RVel:
    """Turn at `rate` [rad/s] (ARCOS 21, RVEL)."""

    ID: ClassVar[int] = 21
    rate: SignedDegrees


@dataclass(frozen=True, slots=True)
class DCHead:
    """Set Colbert's `heading` set-point [rad] (ARCOS 22, DCHEAD)."""

    ID: ClassVar[int] = 22
    heading: SignedDegrees


@dataclass(frozen=True, slots=True)
class Stop:
    """Brake to a stand with the set decelerations (ARCOS 29, STOP)."""

    ID: ClassVar[int] = 29


@dataclass(frozen=True, slots=True)
class Vel2:
    """Set the speed of each wheel (ARCOS 32, VEL2).

    Attributes:
        left_units: -128..127, in units of the model's Vel2Divisor (P2, P3: 20 mm/s).
        right_units: Likewise.
    """

    ID: ClassVar[int] = 32
    left_units: SignedHigh
    right_units: SignedLow


@dataclass(frozen=True, slots=True)
class EStop:
    """Stop with the greatest deceleration (ARCOS 55, ESTOP).

    Attributes:
        argument: Ignored by the robot; ARIA sends 0 or 1, the manual has none.
    """

    ID: ClassVar[int] = 55
    argument: Number = 1


@dataclass(frozen=True, slots=True)
class QStop:
    """Stop with the greatest deceleration: AMRISim's second number (ARCOS 57, QSTOP).

    Attributes:
        argument: Ignored.
    """

    ID: ClassVar[int] = 57
    argument: Number = 1


@dataclass(frozen=True, slots=True)
class LatVel:
    """Drive sideways at `speed` [m/s], left positive; Seekur only (ARCOS 110, LATVEL)."""

    ID: ClassVar[int] = 110
    speed: SignedMillis
