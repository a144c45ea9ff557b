"""Backups of CONFIG: files that cannot leave their folder, and the commands that restore them."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from msgspec import structs

from pioneer3.arcos import commands
from pioneer3.arcos.reports import Config
from pioneer3.errors import CommandError, ConfigError
from pioneer3.models import EncoderNumbers, load_model
from pioneer3.names import printable
from pioneer3.robot.config_backup import (
    SETTINGS,
    backups_folder,
    defaults_of,
    differing,
    find_backup,
    last_backup,
    read_backup,
    restoring,
    save_backup,
    user_backups,
    with_defaults,
    with_encoders,
)
from pioneer3.robot.limits import limits_for
from pioneer3.robot.supervisor import RobotInfo
from pioneer3.state import Identity
from pioneer3.units import DEGREE, MM

MODEL = load_model("p3at-sh")
CONFIG = Config(
    family="Pioneer",
    model="p3at-sh",
    serial_number="42",
    accel_mm_s2=300,
    decel_mm_s2=400,
    rotation_kp_raw=40,
    drift_factor_8192nds=-65,
    ticks_per_mm=138,
    watchdog_ms=2000,
    high_temperature_shutdown_celsius=-128,
)
NOON = 1_764_244_800.0


def robot(name: str = "rosie", config: Config = CONFIG) -> RobotInfo:
    return RobotInfo(
        identity=Identity(name=name, family="Pioneer", model="p3at-sh"),
        model=MODEL,
        limits=limits_for(MODEL, None),
        config=config,
        url="serial:/dev/ttyUSB0",
        speed=38400,
    )


def filled(config: Config, value: int) -> Config:
    every: Any = dict.fromkeys(SETTINGS, value)
    return structs.replace(config, **every)


def test_a_backup_is_read_as_it_was_written() -> None:
    path = save_backup(robot(), CONFIG, NOON)
    assert path.name == "2025-11-27T12-00-00Z-rosie-42.toml"
    kept = read_backup(path)
    assert (kept.config, kept.name, kept.made) == (CONFIG, "rosie", "2025-11-27 12:00:00 UTC")
    assert kept.is_of(robot())
    assert not kept.is_of(robot("rosa"))


@pytest.mark.parametrize("name", ["../../x", "/etc/passwd", "a\0b", "..", "\x1b[2J", "é" * 300, ""])
def test_no_name_leaves_the_folder(name: str) -> None:
    hostile = structs.replace(CONFIG, serial_number=name)
    path = save_backup(robot(name, hostile), hostile, NOON)
    assert path.parent == backups_folder()
    assert user_backups() == [path]
    found = last_backup(robot(name, hostile))
    assert found is not None
    assert found.name == printable(name)
    assert not differing(found.config, hostile)


def test_two_of_one_second_are_two_and_the_newest_counts() -> None:
    first, second = (
        save_backup(robot(), structs.replace(CONFIG, accel_mm_s2=accel), NOON) for accel in (1, 2)
    )
    assert user_backups() == [first, second]
    newest = find_backup("rosie")
    assert newest.config.accel_mm_s2 == 2
    assert last_backup(robot()) == newest
    assert find_backup(str(first)).config.accel_mm_s2 == 1


def test_what_cannot_be_read_is_passed_over_for_the_one_before() -> None:
    kept = save_backup(robot(), CONFIG, NOON)
    save_backup(robot(), CONFIG, NOON + 1).write_bytes(b"\xff" * 70_000)
    assert last_backup(robot()) == read_backup(kept)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "config = 1\nrobot = 2",
        "[robot]\nconfig = {}\n[config]",
        "[robot]\nname = 'r'\n[config]",
        "[config]\nfamily = 1\n[robot]",
        "x = " + "[" * 5000,
    ],
)
def test_a_file_that_is_no_backup_is_an_error(text: str, tmp_path: Path) -> None:
    path = tmp_path / "x.toml"
    path.write_text(text)
    with pytest.raises(ConfigError, match=r"x\.toml"):
        find_backup(str(path))


def test_only_what_differs_is_sent_and_only_what_a_host_may_set() -> None:
    present = structs.replace(CONFIG, decel_mm_s2=1500, drift_factor_8192nds=0, watchdog_ms=0)
    assert dict(restoring(CONFIG, present, MODEL)) == {
        "decel_mm_s2": commands.SetA(-400 * MM),
        "drift_factor_8192nds": commands.DriftFactor(-65),
    }


def test_numbers_of_encoders_in_its_own_file_count_before_those_of_a_backup() -> None:
    own = replace(MODEL, encoders=EncoderNumbers(ticks_mm=140, rev_count=22500))
    present = structs.replace(CONFIG, ticks_per_mm=150, rev_count_ticks=1, drift_factor_8192nds=7)
    assert dict(restoring(with_encoders(CONFIG, own), present, own)) == {
        "ticks_per_mm": commands.TicksMM(140),
        "rev_count_ticks": commands.RevCount(22500),
        "drift_factor_8192nds": commands.DriftFactor(0),
    }
    assert with_defaults(CONFIG, own).ticks_per_mm == 140, "it is told and compared as they are"
    assert with_encoders(CONFIG, MODEL) == CONFIG


def test_every_setting_has_a_command_of_its_own_number_and_sign() -> None:
    full = filled(CONFIG, 7)
    sent = dict(restoring(full, Config(family="", model="", serial_number=""), MODEL))
    assert set(sent) == set(SETTINGS)
    assert len({commands.to_payload(each) for each in sent.values()}) == len(SETTINGS)
    assert sent["rotation_decel_deg_s2"] == commands.SetRA(-7 * DEGREE)
    assert commands.to_payload(sent["translation_kv_raw"]) == bytes([86, 0x3B, 7, 0])
    assert not any(map(commands.moves, sent.values()))


def test_a_zero_that_means_nothing_is_never_sent() -> None:
    zeros = filled(CONFIG, 0)
    ones = filled(CONFIG, 1)
    sent = {field for field, _ in restoring(zeros, ones, MODEL)}
    assert sent == {
        "rotation_kv_raw",
        "rotation_ki_raw",
        "translation_kv_raw",
        "translation_ki_raw",
        "drift_factor_8192nds",
    }


def test_a_robot_that_must_not_be_sent_speeds_is_not() -> None:
    quiet = replace(MODEL, settable_speed=False, settable_acceleration=False)
    full = filled(CONFIG, 7)
    sent = {field for field, _ in restoring(full, CONFIG, quiet)}
    assert {"rotation_kp_raw", "ticks_per_mm"} <= sent
    assert not {each for each in sent if "_s" in each}


def test_a_value_beyond_the_protocol_is_told_before_anything_is_sent() -> None:
    with pytest.raises(CommandError, match="accel_mm_s2 = 60000 of the backup"):
        list(restoring(structs.replace(CONFIG, accel_mm_s2=60000), CONFIG, MODEL))


def test_defaults_are_fields_of_config_within_their_ranges() -> None:
    usual = defaults_of(MODEL)
    assert set(usual) <= {field.name for field in structs.fields(Config)}
    assert usual["decel_mm_s2"] == round(MODEL.deceleration * 1000)
