"""Sensors, inputs and outputs, gripper, serial ports, sounds and batteries (protocol.md 3.2)."""

from enum import IntEnum
from typing import Annotated, ClassVar

from msgspec import Struct

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
from pioneer3.arcos.layout import Command
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


class Sonar(Command, frozen=True):
    """Switch sonar on or off (ARCOS 28, SONAR).

    `array` is 1..4, on firmware that tells arrays apart; 0 means all of them.
    """

    ID: ClassVar[int] = 28
    on: Annotated[bool, Switch(Bits(0, 1))]
    array: Annotated[int, Bits(1, 3, continues=True)] = 0


class Polling(Command, frozen=True):
    """Set the order in which sonars fire (ARCOS 3, POLLING).

    `numbers` are those of the transducers; here the first one is 1.
    """

    ID: ClassVar[int] = 3
    numbers: Annotated[tuple[int, ...], String(Repeated(Integer(1)))]


class BumpStall(Command, frozen=True):
    """Choose which bumpers count as a stall (ARCOS 44, BUMPSTALL)."""

    ID: ClassVar[int] = 44
    front: Annotated[bool, Switch(Bits(0, 1))]
    rear: Annotated[bool, Switch(Bits(1, 1, continues=True))]


class GyroMode(IntEnum):
    """The correction of the heading."""

    OFF = 0
    ON = 1
    ONLY = 2


class Gyro(Command, frozen=True):
    """Choose the correction of the heading (ARCOS 58, GYRO)."""

    ID: ClassVar[int] = 58
    mode: Annotated[GyroMode, Enumerated(WORD, GyroMode)]


class GyroCW(Command, frozen=True):
    """Calibrate the gyro for clockwise turns [raw] (ARCOS 38, GyroCW)."""

    ID: ClassVar[int] = 38
    calibration: Word


class GyroCCW(Command, frozen=True):
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


class Tcm2(Command, frozen=True):
    """Control the compass module (ARCOS 45, TCM2)."""

    ID: ClassVar[int] = 45
    mode: Annotated[Tcm2Mode, Enumerated(WORD, Tcm2Mode)]


class JoyInfo(Command, frozen=True):
    """Ask for the joystick (ARCOS 17, JOYINFO)."""

    ID: ClassVar[int] = 17
    how: RequestModeCode


class RequestEncoders(Command, frozen=True):
    """Ask for the encoder counts (ARCOS 19, ENCODER)."""

    ID: ClassVar[int] = 19
    how: RequestModeCode


class IoRequest(Command, frozen=True):
    """Ask for the states of all inputs and outputs (ARCOS 40, IOREQUEST)."""

    ID: ClassVar[int] = 40
    how: RequestModeCode


class DigOut(Command, frozen=True):
    """Set those digital outputs that `mask` selects to the bits of `values` (ARCOS 30, DIGOUT)."""

    ID: ClassVar[int] = 30
    mask: High
    values: Low


class SetPbioPort(Command, frozen=True):
    """Switch an output of the controller, port 11 being laser power (ARCOS 31, SETPBIOPORT)."""

    ID: ClassVar[int] = 31
    port: High
    on: LowOn


class AdSel(Command, frozen=True):
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


class Gripper(Command, frozen=True):
    """Move the gripper (ARCOS 33, GRIPPER)."""

    ID: ClassVar[int] = 33
    action: Annotated[GripperAction, Enumerated(WORD, GripperAction)]


class GripperVal(Command, frozen=True):
    """Set how long PRESSURE or LIFT_CARRY last [s] (ARCOS 36, GRIPPERVAL)."""

    ID: ClassVar[int] = 36
    duration: Annotated[float, Scaled(POSITIVE, TWENTY_MS)]


class GripperPacRequest(Command, frozen=True):
    """Ask for the state of the gripper (ARCOS 37, GRIPPERPACREQUEST)."""

    ID: ClassVar[int] = 37
    how: RequestModeCode


class Tty2(Command, frozen=True):
    """Send `data` out of serial port AUX1 (ARCOS 42, TTY2)."""

    ID: ClassVar[int] = 42
    data: Data


class Tty3(Command, frozen=True):
    """Send `data` out of serial port AUX2 (ARCOS 66, TTY3)."""

    ID: ClassVar[int] = 66
    data: Data


class Tty4(Command, frozen=True):
    """Send `data` out of serial port AUX3 (ARCOS 60, TTY4)."""

    ID: ClassVar[int] = 60
    data: Data


class GetAux(Command, frozen=True):
    """Ask for `count` bytes received on AUX1; 0 forgets them (ARCOS 43, GETAUX)."""

    ID: ClassVar[int] = 43
    count: Word


class GetAux2(Command, frozen=True):
    """Ask for `count` bytes received on AUX2; 0 forgets them (ARCOS 67, GETAUX2)."""

    ID: ClassVar[int] = 67
    count: Word


class GetAux3(Command, frozen=True):
    """Ask for `count` bytes received on AUX3; 0 forgets them (ARCOS 61, GETAUX3)."""

    ID: ClassVar[int] = 61
    count: Word


class Tone(Struct, frozen=True):
    """One tone of SAY.

    `half_cycle` is half the period of the wave [raw]; the greater, the lower; 0 is silence.
    """

    duration: Annotated[float, Scaled(Integer(1), TWENTY_MS)]
    half_cycle: U8


class Say(Command, frozen=True):
    """Play up to 20 tones one after the other (ARCOS 15, SAY)."""

    ID: ClassVar[int] = 15
    tones: Annotated[tuple[Tone, ...], String(Repeated(Record(Tone)), limit=40)]


class RequestBatteryInfo(Command, frozen=True):
    """Ask for the batteries' own measurements (ARCOS 62, BATTERYINFO)."""

    ID: ClassVar[int] = 62
    how: RequestModeCode


class SafetyStateInfo(Command, frozen=True):
    """Ask for the safety state; MTX (ARCOS 214, SAFETY_STATE_INFO)."""

    ID: ClassVar[int] = 214
    how: RequestModeCode


class BatTest(Command, frozen=True):
    """Pretend a battery of `voltage` [V]; 0 ends it (ARCOS 250, BATTEST)."""

    ID: ClassVar[int] = 250
    voltage: Decivolts


class DigTempTest(Command, frozen=True):
    """Pretend a high motor temperature (ARCOS 251, DIGTEMPTEST)."""

    ID: ClassVar[int] = 251
    on: On


class SpoofAnalogTemp(Command, frozen=True):
    """Pretend a motor temperature [degrees Celsius]; -128 ends it (ARCOS 252)."""

    ID: ClassVar[int] = 252
    celsius: Celsius
