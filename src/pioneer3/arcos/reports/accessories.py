"""Batteries, gripper, arm, serial ports, texts and safety (arcos.md 5.5, 5.6, 5.9, 5.11, 5.12)."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

from pioneer3.arcos.lists import Counted, Record, Repeated, SizedRecords
from pioneer3.arcos.reports.flags import GripperSwitch
from pioneer3.arcos.wire import U8, Enumerated, Integer, Number, Rest, Text

_U8 = Integer(1)
AUX_NUMBERS = (0xB0, 0xB8, 0xC8)


@dataclass(frozen=True, slots=True)
class SerialAux:
    """Bytes received on an auxiliary serial port, as an answer to GETAUX.

    Attributes:
        number: 0xB0 for AUX1, 0xB8 for AUX2, 0xC8 for AUX3.
        data: What was received.
    """

    ID: ClassVar[int] = 0xB0
    number: Annotated[int, Number(AUX_NUMBERS)]
    data: Rest

    @property
    def port(self) -> int:
        """Number of the serial port, 1..3."""
        return AUX_NUMBERS.index(self.number) + 1


@dataclass(frozen=True, slots=True)
class GripperState:
    """The gripper (0xE0), as an answer to GRIPPERPACREQUEST.

    Attributes:
        gripper_type: 1 on the user inputs, 2 on the general inputs, else none.
        switches: What its sensors see.
        grasp_time_20ms: Time between grasping and stopping [20 ms].
        extra: Bytes that belong to no field.
    """

    ID: ClassVar[int] = 0xE0
    gripper_type: U8
    switches: Annotated[GripperSwitch, Enumerated(_U8, GripperSwitch)]
    grasp_time_20ms: U8
    extra: Rest = b""


@dataclass(frozen=True, slots=True)
class ArmStatus:
    """The arm's state (0xA0), as an answer to ARM_STATUS.

    Attributes:
        status: Bit 0 power, bit 1 connected.
        moving: Bit i: joint i + 1 moves.
        positions_raw: Servo positions of the six joints.
        extra: Bytes that belong to no field.
    """

    ID: ClassVar[int] = 0xA0
    status: U8
    moving: U8
    positions_raw: Annotated[tuple[int, ...], Repeated(_U8, 6)]
    extra: Rest = b""


@dataclass(frozen=True, slots=True, kw_only=True)
class ArmJoint:
    """One joint of the arm, in servo positions."""

    speed_raw: U8
    home_raw: U8
    minimum_raw: U8
    center_raw: U8
    maximum_raw: U8
    ticks_per_90_degrees: U8


@dataclass(frozen=True, slots=True)
class ArmInfo:
    """What the arm is (0xA1), as an answer to ARM_INFO."""

    ID: ClassVar[int] = 0xA1
    version: Text
    joints: Annotated[tuple[ArmJoint, ...], Counted(_U8, Record(ArmJoint))]
    extra: Rest = b""


@dataclass(frozen=True, slots=True, kw_only=True)
class SmartBattery:
    """One battery that measures itself; `extra` are bytes without a known meaning."""

    flags1: U8
    flags2: U8
    flags3: U8
    relative_charge_percent: U8
    absolute_charge_percent: U8
    extra: Rest = b""


@dataclass(frozen=True, slots=True)
class BatteryInfo:
    """What the batteries say themselves (0xFA), as an answer to BATTERYINFO."""

    ID: ClassVar[int] = 0xFA
    batteries: Annotated[tuple[SmartBattery, ...], SizedRecords(SmartBattery, 5)]
    extra: Rest = b""


@dataclass(frozen=True, slots=True)
class FirmwareText:
    """Text for debugging (0xD3)."""

    ID: ClassVar[int] = 0xD3
    text: Text
    extra: Rest = b""


@dataclass(frozen=True, slots=True)
class SafetyState:
    """The safety systems of MTX robots (0xD6), as an answer to SAFETY_STATE_INFO.

    Attributes:
        state: Of the whole.
        estop_system: 0 unknown, 0x10 failure, 0x20 warning, 0x40 commissioned, 0x50 disabled.
        laser_system: Likewise.
        extra: Bytes that belong to no field.
    """

    ID: ClassVar[int] = 0xD6
    state: U8
    estop_system: U8
    laser_system: U8
    extra: Rest = b""


@dataclass(frozen=True, slots=True)
class SafetyWarning:
    """A safety warning of MTX robots (0xD9); no program reads its data."""

    ID: ClassVar[int] = 0xD9
    data: Rest = b""


@dataclass(frozen=True, slots=True)
class LaserLog:
    """Data of ARIA's laser logger (0x96), undecoded."""

    ID: ClassVar[int] = 0x96
    data: Rest = b""


@dataclass(frozen=True, slots=True)
class Playlist:
    """Names of sounds (0xD0), as an answer to PLAYLIST, undecoded: no program reads them."""

    ID: ClassVar[int] = 0xD0
    data: Rest = b""
