"""Meaning and group of each field of CONFIG, from which every table of CONFIG is made.

Sources: protocol.md 5.1 and :class:`pioneer3.arcos.reports.Config`.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

from pioneer3.arcos.commands import Baud
from pioneer3.arcos.reports import Config

NOT_SENT: Final = "not sent"

GROUPS: Final[Mapping[str, Mapping[str, str]]] = MappingProxyType(
    {
        "Identity": {
            "family": "family of robots",
            "model": "robot type, parameter file",
            "serial_number": "serial number; simulators say SIM",
            "name": "name given by its owner",
            "four_motors": "1 with four motors",
            "firmware_version": "firmware of the controller",
            "bootloader_version": "bootloader of the controller",
            "config_flags": "bit 0 bootloader, 1 and 2 updatable, 3 new gyro, 4 MTX",
        },
        "Hard limits": {
            "speed_top_mm_s": "highest speed that can be set",
            "rotation_top_deg_s": "highest turn rate that can be set",
            "accel_top_mm_s2": "highest acceleration",
            "rotation_accel_top_deg_s2": "highest turn acceleration",
            "pwm_max_raw": "most power the motors get",
            "lateral_speed_top_mm_s": "sideways, for robots that can",
            "lateral_accel_top_mm_s2": "sideways, for robots that can",
        },
        "Motion": {
            "speed_max_mm_s": "present top speed",
            "rotation_max_deg_s": "present top turn rate",
            "accel_mm_s2": "present acceleration",
            "decel_mm_s2": "present deceleration",
            "rotation_accel_deg_s2": "present turn acceleration",
            "rotation_decel_deg_s2": "present turn deceleration",
            "lateral_speed_max_mm_s": "present top speed sideways",
            "lateral_accel_mm_s2": "present acceleration sideways",
            "lateral_decel_mm_s2": "present deceleration sideways",
            "joystick_speed_mm_s": "top speed with the joystick",
            "joystick_rotation_deg_s": "top turn rate with the joystick",
            "translation_kp_raw": "speed control, proportional gain",
            "translation_kv_raw": "speed control, derivative gain",
            "translation_ki_raw": "speed control, integral gain",
            "rotation_kp_raw": "turn control, proportional gain",
            "rotation_kv_raw": "turn control, derivative gain",
            "rotation_ki_raw": "turn control, integral gain",
            "watchdog_ms": "stops after this silence; 0 never",
            "stall_pwm": "power that counts as a stall",
            "stall_count_ms": "time to recover after a stall",
        },
        "Odometry": {
            "ticks_per_mm": "encoder ticks to a millimetre",
            "rev_count_ticks": "encoder difference of half a turn",
            "drift_factor_8192nds": "correction of the left wheel, in 1/8192",
            "kinematics_delay_ms": "lag of odometry behind the wheels",
            "gyro_type": "0 none, 1 host corrects, 2 robot does",
            "gyro_cw_raw": "gyro calibration, clockwise",
            "gyro_ccw_raw": "gyro calibration, counter-clockwise",
            "gyro_rate_limit_raw": "fastest turn the gyro can follow",
            "gyro_firmware_version": "firmware of the gyro",
        },
        "Sensors and accessories": {
            "has_front_sonar": "1 with front sonar",
            "has_rear_sonar": "1 with rear sonar",
            "sonar_cycle_ms": "pause between two pings",
            "front_bumpers": "segments of the front bumper",
            "rear_bumpers": "segments of the rear bumper",
            "has_gripper": "1 with a gripper",
            "power_bits": "bit 1 laser power, bit 9 second laser",
            "high_temperature_shutdown_celsius": "motors shut down; -128 no sensor",
        },
        "Battery": {
            "low_battery_decivolts": "alarm below this voltage",
            "shutdown_decivolts": "robot shuts down below this",
            "battery_type": "2 if it reports its state of charge",
            "charge_low_percent": "alarm below this charge",
            "charge_shutdown_percent": "shutdown below this charge",
            "charge_threshold_raw": "PowerBot: charging ends here",
            "charger": "0 none, else its type",
            "pdb_port": "port of the power distribution board",
        },
        "Communication": {
            "sip_cycle_ms": "between two information packets",
            "host_baud_code": "host's serial port at start",
            "aux1_baud_code": "serial port AUX1",
            "aux2_baud_code": "serial port AUX2",
            "aux3_baud_code": "serial port AUX3",
            "autobaud": "2 if the host may switch the speed",
            "normal_motor_packets": "0 with P2OS's alternate report",
        },
    }
)

UNITS: Final[tuple[tuple[str, str, float], ...]] = (
    ("_mm_s2", "mm/s²", 1),
    ("_deg_s2", "deg/s²", 1),
    ("_mm_s", "mm/s", 1),
    ("_deg_s", "deg/s", 1),
    ("_ticks_per_mm", "1/mm", 1),
    ("_decivolts", "V", 0.1),
    ("_celsius", "°C", 1),
    ("_percent", "%", 1),
    ("_ticks", "ticks", 1),
    ("_ms", "ms", 1),
    ("_8192nds", "", 1),
    ("_code", "baud", 1),
    ("_raw", "", 1),
)
"""End of a field's name, unit shown, factor."""


@dataclass(frozen=True, slots=True)
class ConfigRow:
    """One field of CONFIG, for people.

    Attributes:
        group: Key in :data:`GROUPS`.
        field: Its name in :class:`Config`, without the unit.
        value: In `unit`, or `not sent`.
        unit: Empty for counts, flags and texts.
    """

    group: str
    field: str
    value: str
    unit: str
    meaning: str


def explained(config: Config) -> tuple[ConfigRow, ...]:
    """Return every field of `config`, group by group."""
    return tuple(rows_by_field(config).values())


def rows_by_field(config: Config) -> dict[str, ConfigRow]:
    """Return the row of each field of `config` by its name in :class:`Config`, group by group."""
    return {
        field: _row(group, field, getattr(config, field), meaning)
        for group, members in GROUPS.items()
        for field, meaning in members.items()
    }


def _row(group: str, field: str, value: str | int | None, meaning: str) -> ConfigRow:
    ending, unit, factor = next((u for u in UNITS if f"_{field}".endswith(u[0])), ("", "", 1))
    name = f"_{field}".removesuffix(ending).removeprefix("_") or field
    if value is None:
        return ConfigRow(group, name, NOT_SENT, "", meaning)
    if ending == "_code":
        return ConfigRow(group, name, *_speed(int(value)), meaning)
    if isinstance(value, str):
        return ConfigRow(group, name, value or "(empty)", unit, meaning)
    return ConfigRow(
        group, name, f"{value * factor:g}" if factor != 1 else str(value), unit, meaning
    )


def _speed(code: int) -> tuple[str, str]:
    """Return value and unit of a baud code; an unknown code stays a number."""
    if code in {baud.value for baud in Baud}:
        return Baud(code).name.removeprefix("B"), "baud"
    return str(code), "code"
