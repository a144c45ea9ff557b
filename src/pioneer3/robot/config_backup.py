"""Backups of CONFIG as files, and the commands that restore what a host may set.

A backup is a TOML file: who the robot is and when it was asked, and CONFIG with the names and units
of :class:`~pioneer3.arcos.reports.Config`. The folder is `~/.local/state/pioneer3/config`.
"""

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from itertools import count
from math import degrees
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final

from msgspec.structs import fields, replace

from pioneer3.arcos import commands
from pioneer3.arcos.commands import Command, named
from pioneer3.arcos.reports import Config
from pioneer3.errors import CommandError, ConfigError
from pioneer3.models import EncoderNumbers, RobotModel
from pioneer3.names import printable
from pioneer3.robot.supervisor import RobotInfo
from pioneer3.tables import Source, converted, load, table_of, written
from pioneer3.text import decoded, read_bytes, shown, state_folder, write_bytes
from pioneer3.units import DEGREE, MM

SUFFIX: Final = ".toml"
"""End of the names of backups."""
NAME: Final = re.compile(r"\d{4}-\d\d-\d\dT\d\d-\d\d-\d\dZ-[\w-]{1,60}(\.\d{1,6})?\.toml", re.ASCII)
"""Form of the names: time (UTC), name and serial number of the robot, number if there are more."""
LARGEST: Final = 1 << 16
"""Larger files are no backups [bytes]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ConfigBackup:
    """CONFIG of one robot at one time.

    Attributes:
        name: Of the robot, as it said; `serial_number` and `model` likewise.
        made: Time (UTC).
    """

    name: str
    serial_number: str
    model: str
    made: str
    config: Config

    def is_of(self, info: RobotInfo) -> bool:
        """Whether this is the robot."""
        said = (info.identity.name, info.config.serial_number if info.config else "")
        return (self.name, self.serial_number) == tuple(map(printable, said))


def backups_folder() -> Path:
    """Return the folder of the backups, which may not be there yet."""
    return state_folder() / "config"


def save_backup(info: RobotInfo, config: Config, now: float) -> Path:
    """Write a backup of a robot's CONFIG, of a Unix time [s]; return its path, or ConfigError."""
    when = datetime.fromtimestamp(now, UTC)
    backup = ConfigBackup(
        name=printable(info.identity.name),
        serial_number=printable(config.serial_number),
        model=printable(info.identity.model),
        made=f"{when:%Y-%m-%d %H:%M:%S} UTC",
        config=_as_kept(config),
    )
    words = "-".join(re.findall(r"\w+", f"{backup.name} {backup.serial_number}", re.ASCII))
    stem = f"{when:%Y-%m-%dT%H-%M-%SZ}-{words[:60].strip('-') or 'robot'}"
    names = (f"{stem}{f'.{number}' if number > 1 else ''}{SUFFIX}" for number in count(1))
    folder = backups_folder()
    path = next(folder / name for name in names if not (folder / name).exists())
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    except OSError as error:
        raise ConfigError(f"{folder}: cannot be made: {error.strerror}") from None
    robot = {key: value for key, value in table_of(backup).items() if key != "config"}
    write_bytes(path, written({"robot": robot, "config": table_of(backup.config)}).encode())
    return path


def read_backup(path: Path) -> ConfigBackup:
    """Read a backup; ConfigError if it cannot be read, or is wrong."""
    source = Source.of(path, decoded(read_bytes(path, LARGEST, "backup")))
    tables = load(source)
    config, robot = tables.pop("config", None), tables.pop("robot", None)
    if tables or not isinstance(config, dict) or not isinstance(robot, dict) or "config" in robot:
        raise source.wrong("", "not a backup of CONFIG: expected the tables [robot] and [config]")
    return converted(source, robot | {"config": config}, ConfigBackup)


def user_backups() -> list[Path]:
    """Return the paths of the backups, the oldest first; none where the folder cannot be read."""
    try:
        found = [path for path in backups_folder().iterdir() if NAME.fullmatch(path.name)]
    except OSError:
        return []
    return sorted(found, key=lambda path: (path.name[:20], len(path.name), path.name))


def find_backup(name: str) -> ConfigBackup:
    """Return the backup of a name: a file that is there, or one that has it as a part of its name.

    Of several the newest counts.

    Raises:
        ConfigError: There is none, or it is wrong.
    """
    if "/" in name and Path(name).is_file():
        return read_backup(Path(name))
    found = [path for path in user_backups() if name and name in path.name]
    if not found:
        raise ConfigError(f"{shown(name)}: names no backup; `pioneer3 config list` shows them")
    return read_backup(found[-1])


def last_backup(info: RobotInfo) -> ConfigBackup | None:
    """Return the newest backup of a robot that can be read, or `None`."""
    for path in reversed(user_backups()):
        try:
            backup = read_backup(path)
        except ConfigError:
            continue
        if backup.is_of(info):
            return backup
    return None


def defaults_of(model: RobotModel) -> dict[str, int]:
    """Return the fields of CONFIG that a model has numbers for."""
    return {
        "four_motors": int(model.drive == "skid"),
        "speed_top_mm_s": round(model.max_speed / MM),
        "rotation_top_deg_s": round(degrees(model.max_turn_rate)),
        "accel_mm_s2": round(model.acceleration / MM),
        "decel_mm_s2": round(model.deceleration / MM),
        "rotation_accel_deg_s2": round(degrees(model.turn_acceleration)),
        "rotation_decel_deg_s2": round(degrees(model.turn_deceleration)),
        "has_front_sonar": int(any(sonar.x > 0 for sonar in model.sonars)),
        "has_rear_sonar": int(any(sonar.x < 0 for sonar in model.sonars)),
        "front_bumpers": model.front_bumpers,
        "rear_bumpers": model.rear_bumpers,
        **_encoder_fields(model),
    }


def with_defaults(config: Config, model: RobotModel) -> Config:
    """Return CONFIG with the numbers of a model in it."""
    usual: Any = defaults_of(model)
    return replace(config, **usual)


def with_encoders(config: Config, model: RobotModel) -> Config:
    """Return CONFIG with the numbers of encoders that a robot's own file has."""
    own: Any = _encoder_fields(model)
    return replace(config, **own)


def encoders_of(config: Config | None) -> EncoderNumbers | None:
    """Return the numbers of the controller; `None` if it tells none."""
    if config is None or not config.ticks_per_mm or not config.rev_count_ticks:
        return None
    return EncoderNumbers(
        ticks_mm=config.ticks_per_mm,
        rev_count=config.rev_count_ticks,
        drift_factor=config.drift_factor_8192nds or 0,
    )


def _encoder_fields(model: RobotModel) -> dict[str, int]:
    if model.encoders is None:
        return {}
    return {
        "ticks_per_mm": model.encoders.ticks_mm,
        "rev_count_ticks": model.encoders.rev_count,
        "drift_factor_8192nds": model.encoders.drift_factor,
    }


Setting = Callable[[int], Command]
SETTINGS: Final[Mapping[str, Setting]] = MappingProxyType(
    {
        "speed_max_mm_s": lambda value: commands.SetV(value * MM),
        "rotation_max_deg_s": lambda value: commands.SetRV(value * DEGREE),
        "accel_mm_s2": lambda value: commands.SetA(value * MM),
        "decel_mm_s2": lambda value: commands.SetA(-value * MM),
        "rotation_accel_deg_s2": lambda value: commands.SetRA(value * DEGREE),
        "rotation_decel_deg_s2": lambda value: commands.SetRA(-value * DEGREE),
        "rotation_kp_raw": lambda value: named("ROTKP", value),
        "rotation_kv_raw": lambda value: named("ROTKV", value),
        "rotation_ki_raw": lambda value: named("ROTKI", value),
        "translation_kp_raw": lambda value: named("TRANSKP", value),
        "translation_kv_raw": lambda value: named("TRANSKV", value),
        "translation_ki_raw": lambda value: named("TRANSKI", value),
        "rev_count_ticks": commands.RevCount,
        "drift_factor_8192nds": commands.DriftFactor,
        "ticks_per_mm": commands.TicksMM,
        "gyro_cw_raw": commands.GyroCW,
        "gyro_ccw_raw": commands.GyroCCW,
    }
)
"""Commands that set a field of CONFIG (protocol.md 3)."""
MAY_BE_NOTHING: Final = frozenset(
    {
        "rotation_kv_raw",
        "rotation_ki_raw",
        "translation_kv_raw",
        "translation_ki_raw",
        "drift_factor_8192nds",
    }
)
"""Settings of which 0 is a value; of the others it says that the robot told none."""
SPEEDS: Final = frozenset({"speed_max_mm_s", "rotation_max_deg_s"})
"""Settings that some robots must not be sent; ACCELERATIONS are those of others."""
ACCELERATIONS: Final = frozenset(
    {"accel_mm_s2", "decel_mm_s2", "rotation_accel_deg_s2", "rotation_decel_deg_s2"}
)


def restoring(wanted: Config, present: Config, model: RobotModel) -> Iterator[tuple[str, Command]]:
    """Yield each field that a host may set and that differs, with the command that restores it.

    Raises:
        CommandError: A value of the backup does not fit the protocol.
    """
    for field, command in SETTINGS.items():
        value = getattr(wanted, field)
        if value is None or value == getattr(present, field):
            continue
        if (value == 0 and field not in MAY_BE_NOTHING) or not _is_settable(field, model):
            continue
        try:
            made = command(value)
            commands.to_payload(made)
        except CommandError as error:
            raise CommandError(f"{field} = {value} of the backup: {error}") from None
        yield field, made


def _is_settable(field: str, model: RobotModel) -> bool:
    if field in SPEEDS:
        return model.settable_speed
    return model.settable_acceleration or field not in ACCELERATIONS


def differing(left: Config, right: Config) -> set[str]:
    """Return the names of the fields that differ."""
    left, right = _as_kept(left), _as_kept(right)
    return {
        each.name
        for each in fields(Config)
        if getattr(left, each.name) != getattr(right, each.name)
    }


def _as_kept(config: Config) -> Config:
    """Return CONFIG as a file has it: its texts printable, without what follows its fields."""
    texts = ("family", "model", "serial_number", "name", "firmware_version", "bootloader_version")
    told = {each: getattr(config, each) for each in texts}
    kept: Any = {each: printable(text) for each, text in told.items() if text}
    return replace(config, extra=b"", **kept)
