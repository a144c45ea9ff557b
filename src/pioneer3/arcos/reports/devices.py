"""Sensors, gripper, serial ports, batteries, arm, safety and texts (protocol.md 5.2 to 5.12)."""

from enum import IntFlag
from typing import Annotated, ClassVar

from msgspec import Struct

from pioneer3.arcos.layout import Report
from pioneer3.arcos.lists import Counted, Record, Repeated, SizedRecords
from pioneer3.arcos.wire import S8, S16, S32, U8, U16, Enumerated, Integer, PacketId, Rest, Text

__all__ = [
    "ArmInfo",
    "ArmJoint",
    "ArmStatus",
    "BatteryInfo",
    "Compass",
    "Encoders",
    "FirmwareText",
    "GripperState",
    "GripperSwitch",
    "GyroRates",
    "GyroSample",
    "Imu",
    "Io",
    "IrRing",
    "Joystick",
    "LaserLog",
    "Playlist",
    "SafetyState",
    "SafetyWarning",
    "SerialAux",
    "SmartBattery",
]

_U8 = Integer(1)
_S8 = Integer(1, signed=True)
_U16 = Integer(2)
AUX_NUMBERS = (0xB0, 0xB8, 0xC8)


class Encoders(Report, frozen=True):
    """Encoder counts (0x90), as an answer to ENCODER."""

    ID: ClassVar[int] = 0x90
    left_counts: S32
    right_counts: S32
    extra: Rest = b""


class Io(Report, frozen=True):
    """All inputs and outputs (0xF0), as an answer to IOREQUEST.

    Attributes:
        digital_in: Bytes of 8 inputs each.
        digital_out: Bytes of 8 outputs each.
        analog_raw: Of which 12 bits count, [4.8828 mV].
    """

    ID: ClassVar[int] = 0xF0
    digital_in: Annotated[tuple[int, ...], Counted(_U8, _U8)]
    digital_out: Annotated[tuple[int, ...], Counted(_U8, _U8)]
    analog_raw: Annotated[tuple[int, ...], Counted(_U8, _U16)]
    extra: Rest = b""


class GyroSample(Struct, frozen=True):
    """One sample of the gyro, 25 ms after the one before.

    Attributes:
        rate_raw: 0..1023; 512 stands still, less is counter-clockwise.
        temperature_raw: Uncalibrated.
    """

    rate_raw: S16
    temperature_raw: U8


class GyroRates(Report, frozen=True):
    """Samples of a gyro that the host corrects the heading with (0x98)."""

    ID: ClassVar[int] = 0x98
    samples: Annotated[tuple[GyroSample, ...], Counted(_S8, Record(GyroSample))]
    extra: Rest = b""


class Compass(Report, frozen=True, kw_only=True):
    """The TCM2 compass (0xC0).

    Attributes:
        heading_decidegrees: [0.1 degree], clockwise from magnetic north; pitch, roll likewise.
        magnetic_x_hundredths: [0.01] of the field's unit; y, z likewise.
        temperature_decicelsius: [0.1 degree Celsius].
        error: Bits of the module.
        calibration_h: Score of the horizontal calibration.
        calibration_v: Score of the vertical calibration.
        calibration_m_hundredths: Score of the magnetic calibration [0.01].
    """

    ID: ClassVar[int] = 0xC0
    heading_decidegrees: S16
    pitch_decidegrees: S16
    roll_decidegrees: S16
    magnetic_x_hundredths: S16
    magnetic_y_hundredths: S16
    magnetic_z_hundredths: S16
    temperature_decicelsius: S16
    error: S16
    calibration_h: S8
    calibration_v: S8
    calibration_m_hundredths: S16
    extra: Rest = b""


class Joystick(Report, frozen=True, kw_only=True):
    """The joystick at the robot (0xF8), as an answer to JOYINFO.

    Attributes:
        button1: 1 if pressed.
        button2: Likewise.
        x_raw: 0..1023, 512 is the centre, less is right.
        y_raw: 0..1023, 512 is the centre, more is forward.
        throttle_raw: 0..1023.
    """

    ID: ClassVar[int] = 0xF8
    button1: U8
    button2: U8
    x_raw: U16
    y_raw: U16
    throttle_raw: U16
    extra: Rest = b""


class IrRing(Report, frozen=True):
    """A ring of 91 infrared range finders (0x10).

    Attributes:
        port: Where it is connected.
        ranges_raw: [1/2.88 mm]; the i-th looks to -81 + 1.8 i degrees.
    """

    ID: ClassVar[int] = 0x10
    port: S16
    ranges_raw: Annotated[tuple[int, ...], Repeated(_U16, 91)]
    extra: Rest = b""


class Imu(Report, frozen=True):
    """An inertial sensor (0x9A), undecoded: only an example of ARIA reads it."""

    ID: ClassVar[int] = 0x9A
    data: Rest = b""


class GripperSwitch(IntFlag):
    """The gripper as ARIA reads it; LOW marks those that mean something when they are 0."""

    OPEN_LOW = 1 << 0
    LIFT_LIMIT_LOW = 1 << 1
    OUTER_BEAM_BROKEN = 1 << 2
    INNER_BEAM_BROKEN = 1 << 3
    LEFT_PADDLE_LOW = 1 << 4
    RIGHT_PADDLE_LOW = 1 << 5
    LIFT_MOVING = 1 << 6
    GRIP_MOVING = 1 << 7


class GripperState(Report, frozen=True):
    """The gripper (0xE0), as an answer to GRIPPERPACREQUEST.

    Attributes:
        gripper_type: 1 on the user inputs, 2 on the general inputs, else none.
        switches: The bits of its sensors.
        grasp_time_20ms: Time between grasping and stopping [20 ms].
    """

    ID: ClassVar[int] = 0xE0
    gripper_type: U8
    switches: Annotated[GripperSwitch, Enumerated(_U8, GripperSwitch)]
    grasp_time_20ms: U8
    extra: Rest = b""


class SerialAux(Report, frozen=True):
    """Bytes received on an auxiliary serial port, as an answer to GETAUX.

    Attributes:
        number: 0xB0 for AUX1, 0xB8 for AUX2, 0xC8 for AUX3.
        data: The bytes.
    """

    ID: ClassVar[int] = 0xB0
    number: Annotated[int, PacketId(AUX_NUMBERS)]
    data: Rest

    @property
    def port(self) -> int:
        """Number of the serial port, 1..3."""
        return AUX_NUMBERS.index(self.number) + 1


class SmartBattery(Struct, frozen=True, kw_only=True):
    """One battery that measures itself; `extra` are bytes without a known meaning."""

    flags1: U8
    flags2: U8
    flags3: U8
    relative_charge_percent: U8
    absolute_charge_percent: U8
    extra: Rest = b""


class BatteryInfo(Report, frozen=True):
    """The batteries' own measurements (0xFA), as an answer to BATTERYINFO."""

    ID: ClassVar[int] = 0xFA
    batteries: Annotated[tuple[SmartBattery, ...], SizedRecords(SmartBattery, 5)]
    extra: Rest = b""


class ArmStatus(Report, frozen=True):
    """The arm's state (0xA0), as an answer to ARM_STATUS.

    Attributes:
        status: Bit 0 power, bit 1 connected.
        moving: Bit i: joint i + 1 moves.
        positions_raw: Servo positions of the six joints.
    """

    ID: ClassVar[int] = 0xA0
    status: U8
    moving: U8
    positions_raw: Annotated[tuple[int, ...], Repeated(_U8, 6)]
    extra: Rest = b""


class ArmJoint(Struct, frozen=True, kw_only=True):
    """One joint of the arm, in servo positions."""

    speed_raw: U8
    home_raw: U8
    minimum_raw: U8
    center_raw: U8
    maximum_raw: U8
    ticks_per_90_degrees: U8


class ArmInfo(Report, frozen=True):
    """A description of the arm (0xA1), as an answer to ARM_INFO."""

    ID: ClassVar[int] = 0xA1
    version: Text
    joints: Annotated[tuple[ArmJoint, ...], Counted(_U8, Record(ArmJoint))]
    extra: Rest = b""


class SafetyState(Report, frozen=True):
    """The safety systems of MTX robots (0xD6), as an answer to SAFETY_STATE_INFO.

    Attributes:
        state: Of the whole.
        estop_system: 0 unknown, 0x10 failure, 0x20 warning, 0x40 commissioned, 0x50 disabled.
        laser_system: Likewise.
    """

    ID: ClassVar[int] = 0xD6
    state: U8
    estop_system: U8
    laser_system: U8
    extra: Rest = b""


class SafetyWarning(Report, frozen=True):
    """A safety warning of MTX robots (0xD9); no program reads its data."""

    ID: ClassVar[int] = 0xD9
    data: Rest = b""


class FirmwareText(Report, frozen=True):
    """Text for debugging (0xD3)."""

    ID: ClassVar[int] = 0xD3
    text: Text
    extra: Rest = b""


class Playlist(Report, frozen=True):
    """Names of sounds (0xD0), as an answer to PLAYLIST, undecoded: no program reads them."""

    ID: ClassVar[int] = 0xD0
    data: Rest = b""


class LaserLog(Report, frozen=True):
    """Data of ARIA's laser logger (0x96), undecoded."""

    ID: ClassVar[int] = 0x96
    data: Rest = b""
