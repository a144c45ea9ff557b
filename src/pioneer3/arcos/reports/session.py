"""Handshake, configuration and the end of a session (protocol.md 2.1, 2.4, 5.1)."""

from typing import Annotated, ClassVar

from pioneer3.arcos.layout import Report
from pioneer3.arcos.wire import S8, S16, U8, U16, U32, PacketId, Rest, Text

__all__ = [
    "Config",
    "LinkLost",
    "SyncEcho",
    "SyncIdentity",
]

SYNC_NUMBERS = (0, 1, 2)
LINK_LOST_NUMBERS = (0xFE, 0xFF)


class SyncEcho(Report, frozen=True):
    """Echo of a SYNC (0, 1; AMRISim also 2).

    Attributes:
        number: Of the SYNC.
    """

    ID: ClassVar[int] = 0
    number: Annotated[int, PacketId(SYNC_NUMBERS)]


class SyncIdentity(Report, frozen=True):
    """The answer to SYNC2 (2): the robot's identity.

    Attributes:
        name: Given by its owner; simulators say `MobileSim`.
        family: `Pioneer` for every P2, P3, PeopleBot and AmigoBot.
        model: Parameter-file name such as `p3at-sh`, in any case of letters.
    """

    ID: ClassVar[int] = 2
    name: Text
    family: Text
    model: Text
    extra: Rest = b""


class LinkLost(Report, frozen=True):
    """The end of the session (0xFE, 0xFF).

    Attributes:
        number: 0xFE or 0xFF.
    """

    ID: ClassVar[int] = 0xFF
    number: Annotated[int, PacketId(LINK_LOST_NUMBERS)] = 0xFF
    extra: Rest = b""


class Config(Report, frozen=True, kw_only=True):
    """The settings of the firmware (0x20), as an answer to CONFIG.

    Fields are `None` where the packet ends before; older firmware ends early. `top` names a hard
    limit, `max` the present one. `_raw` marks fields whose unit no source tells.

    Attributes:
        family: `Pioneer` (ARIA: Type).
        model: Parameter-file name such as `p3at-sh` (ARIA: Subtype).
        serial_number: Simulators say `SIM`.
        four_motors: ARIA drops it.
        host_baud_code: As in :class:`pioneer3.arcos.commands.Baud`.
        rev_count_ticks: By which the encoders differ after half a turn.
        watchdog_ms: Silence after which the robot stops; 0 is never.
        normal_motor_packets: 0 with the alternate report of P2OS.
        stall_pwm: PWM that counts as a stall.
        stall_count_ms: Time to recover after a stall.
        charger: 0 none, else its type.
        autobaud: 2 if the host may switch its baud rate.
        gyro_type: 0 none, 1 corrected by the host, 2 and more by the controller.
        drift_factor_8192nds: Correction of the left encoder.
        kinematics_delay_ms: Odometry's lag behind the wheels.
        high_temperature_shutdown_celsius: -128 without sensor.
        power_bits: Bit 1 laser power can be switched, bit 9 second laser.
        battery_type: 2 if the robot reports its state of charge.
        config_flags: 0 is bootloader, 1 and 2 can download firmware and bootloader, 3 not the
            legacy gyro, 4 MTX configuration system.
    """

    ID: ClassVar[int] = 0x20
    family: Text
    model: Text
    serial_number: Text
    four_motors: U8 | None = None
    rotation_top_deg_s: U16 | None = None
    speed_top_mm_s: U16 | None = None
    rotation_accel_top_deg_s2: U16 | None = None
    accel_top_mm_s2: U16 | None = None
    pwm_max_raw: U16 | None = None
    name: Text | None = None
    sip_cycle_ms: U8 | None = None
    host_baud_code: U8 | None = None
    aux1_baud_code: U8 | None = None
    has_gripper: U16 | None = None
    has_front_sonar: U16 | None = None
    has_rear_sonar: U8 | None = None
    low_battery_decivolts: U16 | None = None
    rev_count_ticks: U16 | None = None
    watchdog_ms: U16 | None = None
    normal_motor_packets: U8 | None = None
    stall_pwm: U16 | None = None
    stall_count_ms: U16 | None = None
    joystick_speed_mm_s: U16 | None = None
    joystick_rotation_deg_s: U16 | None = None
    rotation_max_deg_s: U16 | None = None
    speed_max_mm_s: U16 | None = None
    rotation_accel_deg_s2: U16 | None = None
    rotation_decel_deg_s2: U16 | None = None
    rotation_kp_raw: U16 | None = None
    rotation_kv_raw: U16 | None = None
    rotation_ki_raw: U16 | None = None
    accel_mm_s2: U16 | None = None
    decel_mm_s2: U16 | None = None
    translation_kp_raw: U16 | None = None
    translation_kv_raw: U16 | None = None
    translation_ki_raw: U16 | None = None
    front_bumpers: U8 | None = None
    rear_bumpers: U8 | None = None
    charger: U8 | None = None
    sonar_cycle_ms: U8 | None = None
    autobaud: U8 | None = None
    gyro_type: U8 | None = None
    drift_factor_8192nds: S16 | None = None
    aux2_baud_code: U8 | None = None
    aux3_baud_code: U8 | None = None
    ticks_per_mm: U16 | None = None
    shutdown_decivolts: U16 | None = None
    firmware_version: Text | None = None
    gyro_cw_raw: U16 | None = None
    gyro_ccw_raw: U16 | None = None
    kinematics_delay_ms: U8 | None = None
    lateral_speed_top_mm_s: U16 | None = None
    lateral_accel_top_mm_s2: U16 | None = None
    lateral_speed_max_mm_s: U16 | None = None
    lateral_accel_mm_s2: U16 | None = None
    lateral_decel_mm_s2: U16 | None = None
    charge_threshold_raw: U16 | None = None
    pdb_port: U8 | None = None
    gyro_rate_limit_raw: U16 | None = None
    high_temperature_shutdown_celsius: S8 | None = None
    power_bits: U16 | None = None
    battery_type: U8 | None = None
    charge_low_percent: U16 | None = None
    charge_shutdown_percent: U16 | None = None
    bootloader_version: Text | None = None
    config_flags: U32 | None = None
    gyro_firmware_version: S16 | None = None
    extra: Rest = b""
