"""The one table of what CONFIG means."""

from msgspec.structs import fields

from pioneer3.arcos.reports import Config
from pioneer3.robot.config_table import GROUPS, NOT_SENT, explained

SHORT = Config(family="Pioneer", model="p3at-sh", serial_number="42")


def test_every_field_has_exactly_one_meaning() -> None:
    listed = [field for members in GROUPS.values() for field in members]
    assert sorted(listed) == sorted(f.name for f in fields(Config) if f.name != "extra")
    assert all(meaning for members in GROUPS.values() for meaning in members.values())


def test_what_the_robot_did_not_send_is_said_so() -> None:
    values = {row.field: row.value for row in explained(SHORT)}
    assert values["serial_number"] == "42"
    assert values["sip_cycle"] == values["gyro_firmware_version"] == NOT_SENT


def test_values_carry_their_unit_and_names_do_not() -> None:
    config = Config(
        family="Pioneer",
        model="p3at-sh",
        serial_number="",
        low_battery_decivolts=115,
        speed_top_mm_s=1500,
        rotation_accel_deg_s2=100,
        host_baud_code=2,
        aux1_baud_code=9,
        ticks_per_mm=138,
        pwm_max_raw=500,
    )
    rows = {row.field: (row.value, row.unit) for row in explained(config)}
    assert rows["low_battery"] == ("11.5", "V")
    assert rows["speed_top"] == ("1500", "mm/s")
    assert rows["rotation_accel"] == ("100", "deg/s²")
    assert rows["host_baud"] == ("38400", "baud")
    assert rows["aux1_baud"] == ("9", "code")
    assert rows["ticks_per_mm"] == ("138", "1/mm")
    assert rows["pwm_max"] == ("500", "")
    assert rows["serial_number"] == ("(empty)", "")
