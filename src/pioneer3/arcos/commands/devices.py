"""Sensors, inputs and outputs, gripper, serial ports, sounds and batteries (protocol.md 3.2)."""

from dataclasses import dataclass
from enum import IntEnum
from typing import Annotated, ClassVar

from pioneer3.arcos.commands.arguments import (
    POSITIVE,
    TWENTY_MS,
    WORD,
    Bits,
    Celsius,
    Data,
    Decivolts,
    High,
    Low,
    LowOn,
    On,
    RequestModeCode,
    String,
    Word,
)
from pioneer3.arcos.lists import Record, Repeated
from pioneer3.arcos.wire import U8, Enumerated, Integer, Scaled, Switch

__all__ = [
    "AdSel",
    "BatTest",
    "BumpStall",
    "DigOut",
    "DigTempTest",
    "GetAux",
    "GetAux2",
    "GetAux3",
    "Gripper",
    "GripperAction",
    "GripperPacRequest",
    "GripperVal",
    "Gyro",
    "GyroCCW",
    "GyroCW",
    "GyroMode",
    "IoRequest",
    "JoyInfo",
    "Polling",
    "RequestBatteryInfo",
    "RequestEncoders",
    "SafetyStateInfo",
    "Say",
    "SetPbioPort",
    "Sonar",
    "SpoofAnalogTemp",
    "Tcm2",
    "Tcm2Mode",
    "Tone",
    "Tty2",
    "Tty3",
    "Tty4",
]


@dataclass(frozen=True, slots=True)
class Sonar:
    """Switch sonar on or off (ARCOS 28, SONAR).

    `array` is 1..4, on firmware that tells arrays apart; 0 means all of them.
    """

    ID: ClassVar[int] = 28
    on: Annotated[bool, Switch(Bits(0, 1))]
    array: Annotated[int, Bits(1, 3, continues=True)] = 0


@dataclass(frozen=True, slots=True)
class Polling:
    """Set the order in which sonars fire (ARCOS 3, POLLING).

    `numbers` are those of the transducers; here the first one is 1.
    """

    ID: ClassVar[int] = 3
    numbers: Annotated[tuple[int, ...], String(Repeated(Integer(1)))]


@dataclass(frozen=True, slots=True)
class BumpStall:
    """Choose which bumpers count as a stall (ARCOS 44, BUMPSTALL)."""

    ID: ClassVar[int] = 44
    front: Annotated[bool, Switch(Bits(0, 1))]
    rear: Annotated[bool, Switch(Bits(1, 1, continues=True))]


class GyroMode(IntEnum):
    """The correction of the heading."""

    OFF = 0
    ON = 1
    ONLY = 2


@dataclass(frozen=True, slots=True)
class Gyro:
    """Choose the correction of the heading (ARCOS 58, GYRO)."""

    ID: ClassVar[int] = 58
    mode: Annotated[GyroMode, Enumerated(WORD, GyroMode)]


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


class Tcm2Mode(IntEnum):
    """Modes of the compass module."""

    OFF = 0
    SIP_ONLY = 1
    ONCE = 2
    STREAM = 3
    USER_CALIBRATION = 4
    AUTO_CALIBRATION = 5
    STOP_CALIBRATION = 6
    SOFT_RESET = 7


@dataclass(frozen=True, slots=True)
class Tcm2:
    """Control the compass module (ARCOS 45, TCM2)."""

    ID: ClassVar[int] = 45
    mode: Annotated[Tcm2Mode, Enumerated(WORD, Tcm2Mode)]


@dataclass(frozen=True, slots=True)
class JoyInfo:
    """Ask for the joystick (ARCOS 17, JOYINFO)."""

    ID: ClassVar[int] = 17
    how: RequestModeCode


@dataclass(frozen=True, slots=True)
class RequestEncoders:
    """Ask for the encoder counts (ARCOS 19, ENCODER)."""

    ID: ClassVar[int] = 19
    how: RequestModeCode


@dataclass(frozen=True, slots=True)
class IoRequest:
    """Ask for the states of all inputs and outputs (ARCOS 40, IOREQUEST)."""

    ID: ClassVar[int] = 40
    how: RequestModeCode


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


class GripperAction(IntEnum):
    """Motions of the gripper."""

    OPEN = 1
    CLOSE = 2
    STOP = 3
    LIFT_UP = 4
    LIFT_DOWN = 5
    LIFT_STOP = 6
    STORE = 7
    DEPLOY = 8
    HALT = 15
    PRESSURE = 16
    LIFT_CARRY = 17


@dataclass(frozen=True, slots=True)
class Gripper:
    """Move the gripper (ARCOS 33, GRIPPER)."""

    ID: ClassVar[int] = 33
    action: Annotated[GripperAction, Enumerated(WORD, GripperAction)]


@dataclass(frozen=True, slots=True)
class GripperVal:
    """Set how long PRESSURE or LIFT_CARRY last [s] (ARCOS 36, GRIPPERVAL)."""

    ID: ClassVar[int] = 36
    duration: Annotated[float, Scaled(POSITIVE, TWENTY_MS)]


@dataclass(frozen=True, slots=True)
class GripperPacRequest:
    """Ask for the state of the gripper (ARCOS 37, GRIPPERPACREQUEST)."""

    ID: ClassVar[int] = 37
    how: RequestModeCode


@dataclass(frozen=True, slots=True)
class Tty2:
    """Send `data` out of serial port AUX1 (ARCOS 42, TTY2)."""

    ID: ClassVar[int] = 42
    data: Data


@dataclass(frozen=True, slots=True)
class Tty3:
    """Send `data` out of serial port AUX2 (ARCOS 66, TTY3)."""

    ID: ClassVar[int] = 66
    data: Data


@dataclass(frozen=True, slots=True)
class Tty4:
    """Send `data` out of serial port AUX3 (ARCOS 60, TTY4)."""

    ID: ClassVar[int] = 60
    data: Data


@dataclass(frozen=True, slots=True)
class GetAux:
    """Ask for `count` bytes received on AUX1; 0 forgets them (ARCOS 43, GETAUX)."""

    ID: ClassVar[int] = 43
    count: Word


@dataclass(frozen=True, slots=True)
class GetAux2:
    """Ask for `count` bytes received on AUX2; 0 forgets them (ARCOS 67, GETAUX2)."""

    ID: ClassVar[int] = 67
    count: Word


@dataclass(frozen=True, slots=True)
class GetAux3:
    """Ask for `count` bytes received on AUX3; 0 forgets them (ARCOS 61, GETAUX3)."""

    ID: ClassVar[int] = 61
    count: Word


@dataclass(frozen=True, slots=True)
class Tone:
    """One tone of SAY.

    `half_cycle` is half the period of the wave [raw]; the greater, the lower; 0 is silence.
    """

    duration: Annotated[float, Scaled(Integer(1), TWENTY_MS)]
    half_cycle: U8


@dataclass(frozen=True, slots=True)
class Say:
    """Play up to 20 tones one after the other (ARCOS 15, SAY)."""

    ID: ClassVar[int] = 15
    tones: Annotated[tuple[Tone, ...], String(Repeated(Record(Tone)), limit=40)]


@dataclass(frozen=True, slots=True)
class RequestBatteryInfo:
    """Ask for the batteries' own measurements (ARCOS 62, BATTERYINFO)."""

    ID: ClassVar[int] = 62
    how: RequestModeCode


@dataclass(frozen=True, slots=True)
class SafetyStateInfo:
    """Ask for the safety state; MTX (ARCOS 214, SAFETY_STATE_INFO)."""

    ID: ClassVar[int] = 214
    how: RequestModeCode


@dataclass(frozen=True, slots=True)
class BatTest:
    """Pretend a battery of `voltage` [V]; 0 ends it (ARCOS 250, BATTEST)."""

    ID: ClassVar[int] = 250
    voltage: Decivolts


@dataclass(frozen=True, slots=True)
class DigTempTest:
    """Pretend a high motor temperature (ARCOS 251, DIGTEMPTEST)."""

    ID: ClassVar[int] = 251
    on: On


@dataclass(frozen=True, slots=True)
class SpoofAnalogTemp:
    """Pretend a motor temperature [degrees Celsius]; -128 ends it (ARCOS 252)."""

    ID: ClassVar[int] = 252
    celsius: Celsius
