"""Limits, accelerations, controller gains and calibration of the drive (arcos.md 3.1)."""

from dataclasses import dataclass
from typing import ClassVar

from pioneer3.arcos.commands.quantities import (
    Degrees,
    Millis,
    Number,
    On,
    SignedDegrees,
    SignedMillis,
    Word,
)
from pioneer3.arcos.wire import Rest

__all__ = [
    "AbsoluteMaxes",
    "DriftFactor",
    "EStall",
    "LatAccel",
    "RecenterWheels",
    "RevCount",
    "RotKI",
    "RotKP",
    "RotKV",
    "RotVelClosedLoopEnable",
    "Seekur119",
    "SetA",
    "SetRA",
    "SetRV",
    "SetRVDir",
    "SetV",
    "TicksMM",
    "TransKI",
    "TransKP",
    "TransKV",
]


@dataclass(frozen=True, slots=True)
class SetA:
    """Set the translational acceleration or deceleration (ARCOS 5, SETA).

    Attributes:
        acceleration: [m/s^2]; a negative value is the deceleration, and leaves the acceleration.
    """

    ID: ClassVar[int] = 5
    acceleration: SignedMillis


@dataclass(frozen=True, slots=True)
class SetV:
    """Limit the translational speed to `speed` [m/s]; MOVE uses it too (ARCOS 6, SETV)."""

    ID: ClassVar[int] = 6
    speed: Millis


@dataclass(frozen=True, slots=True)
class SetRV:
    """Limit the rotational speed to `rate` [rad/s] (ARCOS 10, SETRV)."""

    ID: ClassVar[int] = 10
    rate: Degrees


@dataclass(frozen=True, slots=True)
class SetRVDir:
    """Limit the rotational speed in one direction (ARCOS 20, SETRVDIR).

    Attributes:
        rate: [rad/s]; positive limits left turns, negative right turns; 1 degree/s means 0.
    """

    ID: ClassVar[int] = 20
    rate: SignedDegrees


@dataclass(frozen=True, slots=True)
class SetRA:
    """Set the rotational acceleration or deceleration (ARCOS 23, SETRA).

    Attributes:
        acceleration: [rad/s^2]; a negative value is the deceleration, and leaves the acceleration.
    """

    ID: ClassVar[int] = 23
    acceleration: SignedDegrees


@dataclass(frozen=True, slots=True)
class LatAccel:
    """Set the lateral acceleration or deceleration; Seekur only (ARCOS 113, LATACCEL).

    Attributes:
        acceleration: [m/s^2]; a negative value is the deceleration, and leaves the acceleration.
    """

    ID: ClassVar[int] = 113
    acceleration: SignedMillis


@dataclass(frozen=True, slots=True)
class RotKP:
    """Set the proportional gain of the rotation controller [raw] (ARCOS 82, ROTKP)."""

    ID: ClassVar[int] = 82
    gain: Word


@dataclass(frozen=True, slots=True)
class RotKV:
    """Set the velocity gain of the rotation controller [raw] (ARCOS 83, ROTKV)."""

    ID: ClassVar[int] = 83
    gain: Word


@dataclass(frozen=True, slots=True)
class RotKI:
    """Set the integral gain of the rotation controller [raw] (ARCOS 84, ROTKI)."""

    ID: ClassVar[int] = 84
    gain: Word


@dataclass(frozen=True, slots=True)
class TransKP:
    """Set the proportional gain of the translation controller [raw] (ARCOS 85, TRANSKP)."""

    ID: ClassVar[int] = 85
    gain: Word


@dataclass(frozen=True, slots=True)
class TransKV:
    """Set the velocity gain of the translation controller [raw] (ARCOS 86, TRANSKV)."""

    ID: ClassVar[int] = 86
    gain: Word


@dataclass(frozen=True, slots=True)
class TransKI:
    """Set the integral gain of the translation controller [raw] (ARCOS 87, TRANSKI)."""

    ID: ClassVar[int] = 87
    gain: Word


@dataclass(frozen=True, slots=True)
class RevCount:
    """Set by how many `ticks` the encoders differ after half a turn (ARCOS 88, REVCOUNT)."""

    ID: ClassVar[int] = 88
    ticks: Word


@dataclass(frozen=True, slots=True)
class DriftFactor:
    """Set what is added to the left encoder [1/8192 of its count] (ARCOS 89, DRIFTFACTOR)."""

    ID: ClassVar[int] = 89
    correction: Number


@dataclass(frozen=True, slots=True)
class TicksMM:
    """Set the encoder ticks per millimetre of wheel travel (ARCOS 93, TICKSMM)."""

    ID: ClassVar[int] = 93
    ticks_per_mm: Word


@dataclass(frozen=True, slots=True)
class RecenterWheels:
    """Straighten the wheels; Seekur only (ARCOS 120, RECENTERWHEELS)."""

    ID: ClassVar[int] = 120


@dataclass(frozen=True, slots=True)
class RotVelClosedLoopEnable:
    """Control the rotational speed in closed loop; MTX only (ARCOS 150)."""

    ID: ClassVar[int] = 150
    on: On


@dataclass(frozen=True, slots=True)
class AbsoluteMaxes:
    """Set the absolute maxima; MTX only, arguments unknown (ARCOS 213, ABSOLUTE_MAXES)."""

    ID: ClassVar[int] = 213
    arguments: Rest = b""


@dataclass(frozen=True, slots=True)
class EStall:
    """Undocumented; arguments unknown (ARCOS 56, ESTALL)."""

    ID: ClassVar[int] = 56
    arguments: Rest = b""


@dataclass(frozen=True, slots=True)
class Seekur119:
    """Undocumented and without a name; Seekur only (ARCOS 119)."""

    ID: ClassVar[int] = 119
    arguments: Rest = b""
