"""Sensors, inputs and outputs of the controller (arcos.md 3.2)."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

from pioneer3.arcos.commands.arguments import Bits, String
from pioneer3.arcos.commands.choices import GyroMode, Tcm2Mode
from pioneer3.arcos.commands.quantities import WORD, High, How, Low, LowOn, Word
from pioneer3.arcos.lists import Repeated
from pioneer3.arcos.wire import Enumerated, Integer, Rest, Switch

__all__ = [
    "AccelInfo",
    "AdSel",
    "BumpStall",
    "CalComp",
    "DigOut",
    "Gyro",
    "GyroCCW",
    "GyroCW",
    "HeadingInfo",
    "IoRequest",
    "JoyInfo",
    "Polling",
    "RequestImu",
    "SetPbioPort",
    "Sonar",
    "Tcm2",
    "TorqueInfo",
    "WheelInfoRequest",
]


@dataclass(frozen=True, slots=True)
class Polling:
    """Set the order in which sonars fire (ARCOS 3, POLLING).

    Attributes:
        numbers: Of the transducers; here the first one is 1.
    """

    ID: ClassVar[int] = 3
    numbers: Annotated[tuple[int, ...], String(Repeated(Integer(1)))]


@dataclass(frozen=True, slots=True)
class JoyInfo:
    """Ask for the joystick (ARCOS 17, JOYINFO)."""

    ID: ClassVar[int] = 17
    how: How


@dataclass(frozen=True, slots=True)
class RequestImu:
    """Ask for the inertial sensor; Seekur only (ARCOS 26, IMUREQUEST)."""

    ID: ClassVar[int] = 26
    how: How


@dataclass(frozen=True, slots=True)
class Sonar:
    """Switch sonar on or off (ARCOS 28, SONAR).

    Attributes:
        on: Whether it shall ping.
        array: Which array, 1..4, on firmware that tells them apart; 0 means all of them.
    """

    ID: ClassVar[int] = 28
    on: Annotated[bool, Switch(Bits(0, 1))]
    array: Annotated[int, Bits(1, 3, continues=True)] = 0


@dataclass(frozen=True, slots=True)
class DigOut:
    """Set those digital outputs that `mask` selects to the bits of `values` (ARCOS 30, DIGOUT)."""

    ID: ClassVar[int] = 30
    mask: High
    values: Low


@dataclass(frozen=True, slots=True)
class SetPbioPort:
    """Switch an output of the controller, port 11 being laser power (ARCOS 31, SETPBIOPORT)."""

    ID: ClassVar[int] = 31
    port: High
    on: LowOn


@dataclass(frozen=True, slots=True)
class AdSel:
    """Choose the analog `port` that the standard report carries (ARCOS 35, ADSEL)."""

    ID: ClassVar[int] = 35
    port: Word


@dataclass(frozen=True, slots=True)
class GyroCW:
    """Calibrate the gyro for clockwise turns [raw] (ARCOS 38, GyroCW)."""

    ID: ClassVar[int] = 38
    calibration: Word


@dataclass(frozen=True, slots=True)
class GyroCCW:
    """Calibrate the gyro for counter-clockwise turns [raw] (ARCOS 39, GyroCCW)."""

    ID: ClassVar[int] = 39
    calibration: Word


@dataclass(frozen=True, slots=True)
class IoRequest:
    """Ask for the states of all inputs and outputs (ARCOS 40, IOREQUEST)."""

    ID: ClassVar[int] = 40
    how: How


@dataclass(frozen=True, slots=True)
class BumpStall:
    """Choose which bumpers count as a stall (ARCOS 44, BUMPSTALL)."""

    ID: ClassVar[int] = 44
    front: Annotated[bool, Switch(Bits(0, 1))]
    rear: Annotated[bool, Switch(Bits(1, 1, continues=True))]


@dataclass(frozen=True, slots=True)
class Tcm2:
    """Control the compass module (ARCOS 45, TCM2)."""

    ID: ClassVar[int] = 45
    mode: Annotated[Tcm2Mode, Enumerated(WORD, Tcm2Mode)]


@dataclass(frozen=True, slots=True)
class Gyro:
    """Choose what the heading is corrected with (ARCOS 58, GYRO)."""

    ID: ClassVar[int] = 58
    mode: Annotated[GyroMode, Enumerated(WORD, GyroMode)]


@dataclass(frozen=True, slots=True)
class CalComp:
    """Calibrate the compass: `step` is undocumented (ARCOS 65, CALCOMP)."""

    ID: ClassVar[int] = 65
    step: Word


@dataclass(frozen=True, slots=True)
class AccelInfo:
    """Ask for accelerations; Seekur, MTX (ARCOS 123, ACCELINFO)."""

    ID: ClassVar[int] = 123
    how: How


@dataclass(frozen=True, slots=True)
class TorqueInfo:
    """Ask for torques; Seekur, MTX (ARCOS 124, TORQUEINFO)."""

    ID: ClassVar[int] = 124
    how: How


@dataclass(frozen=True, slots=True)
class HeadingInfo:
    """Ask for headings; Seekur, MTX (ARCOS 149, HEADINGINFO)."""

    ID: ClassVar[int] = 149
    how: How


@dataclass(frozen=True, slots=True)
class WheelInfoRequest:
    """Ask for wheel states; MTX, arguments unknown (ARCOS 218, WHEELINFO_REQUEST)."""

    ID: ClassVar[int] = 218
    arguments: Rest = b""
