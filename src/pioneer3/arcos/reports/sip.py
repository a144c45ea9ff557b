"""The standard information packet, once per cycle (arcos.md 4), in the robot's own units.

What the raw units are worth depends on the robot model: multiply `x_raw` by DistConvFactor,
wheel speeds by VelConvFactor, sonar ranges by RangeConvFactor.
"""

from dataclasses import dataclass
from typing import ClassVar, Final

from pioneer3.arcos.reports.flags import Fault, SipFlag, SipFlag3

SIP_STOPPED: Final = 0x32
SIP_MOVING: Final = 0x33
SIP_NUMBERS: Final = range(0x30, 0x35)
"""What Player accepts; ARIA takes 0x32 and 0x33 only."""

NO_TEMPERATURE: Final = -128
"""What `temperature_celsius` is without a sensor (AMRISim sends -127)."""

NO_FLAGS: Final = SipFlag(0)


@dataclass(frozen=True, slots=True)
class SonarReading:
    """One sonar's range.

    Attributes:
        number: Of the transducer, 0 is front left.
        range_raw: [RangeConvFactor mm].
    """

    number: int
    range_raw: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Sip:
    """The standard report (0x32 stopped, 0x33 moving).

    The fields from `analog_port` on are `None` where the packet ends before; it may end before
    `analog_port` and before every field from `battery_decivolts_wide` on.

    Attributes:
        number: Id of the packet, 0x30..0x34.
        x_raw: [DistConvFactor mm], of which the low 15 bits count.
        y_raw: Likewise.
        heading_raw: Counter-clockwise, 4096 to a turn, signed.
        left_speed_raw: [VelConvFactor mm/s], signed.
        right_speed_raw: Likewise.
        battery_decivolts: [0.1 V].
        left_stall_rear_bumpers: Bit 0 left motor stalled, bits 1..7 rear bumpers, right to left.
        right_stall_front_bumpers: Bit 0 right motor stalled, bits 1..7 front ones, left to right.
        control_raw: The firmware's heading set-point, 4096 to a turn.
        compass_raw: [2 degrees].
        analog_port: Number of the analog input that `analog` shows.
        gripper_state: Bits of :class:`GripperSwitch`.
        analog: 0..255 for 0..5 V.
        digital_in: Bits, 1 is high.
        digital_out: Bits, 1 is high.
        battery_decivolts_wide: [0.1 V], for batteries above 25.5 V.
        charge_state: 0 not charging, 1 bulk, 2 overcharge, 3 float, 4 balance.
        turn_rate_decidegrees: [0.1 degree/s], counter-clockwise.
        lateral_speed_mm: [mm/s], left.
        temperature_celsius: [degrees Celsius], -128 without sensor.
        charge_percent: 0 if the robot cannot tell.
        timestamp_us: [us], MTX only.
        flags3: MTX only.
        extra: Bytes that belong to no field.
    """

    ID: ClassVar[int] = SIP_STOPPED
    number: int = SIP_STOPPED
    x_raw: int = 0
    y_raw: int = 0
    heading_raw: int = 0
    left_speed_raw: int = 0
    right_speed_raw: int = 0
    battery_decivolts: int = 0
    left_stall_rear_bumpers: int = 0
    right_stall_front_bumpers: int = 0
    control_raw: int = 0
    flags: SipFlag = NO_FLAGS
    compass_raw: int = 0
    sonar: tuple[SonarReading, ...] = ()
    analog_port: int | None = None
    gripper_state: int | None = None
    analog: int | None = None
    digital_in: int | None = None
    digital_out: int | None = None
    battery_decivolts_wide: int | None = None
    charge_state: int | None = None
    turn_rate_decidegrees: int | None = None
    faults: Fault | None = None
    lateral_speed_mm: int | None = None
    temperature_celsius: int | None = None
    charge_percent: int | None = None
    timestamp_us: int | None = None
    flags3: SipFlag3 | None = None
    extra: bytes = b""

    @property
    def moving(self) -> bool:
        """Whether the firmware reports that it moves the robot."""
        return self.number == SIP_MOVING
