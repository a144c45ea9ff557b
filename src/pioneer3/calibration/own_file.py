"""Writes what was measured into the robot's own file; comments and all else in it stay."""

import json
import re
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass
from math import degrees
from pathlib import Path

from pioneer3.calibration.estimate import NAMES
from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.models import EncoderNumbers, OdometryCorrection, RobotModel, find_model
from pioneer3.models.catalog import parse_own, read_model_text
from pioneer3.models.own import ARIA, ODOMETRY_EXAMPLE, TOML, new_own_text, own_path
from pioneer3.robot.supervisor import RobotInfo
from pioneer3.tables import Source, load, written
from pioneer3.text import shown, write_bytes

OLD = ".old"
"""Ending of the copy of the file as it was before."""
ABOVE = "[above all tables]"
"""Stands for the heading that the keys at the beginning of a file do not have."""
HEADING = re.compile(r"\s*\[")
ODOMETRY = re.compile(r"\s*\[\s*odometry\s*\]\s*(#.*)?$")
ENCODERS = re.compile(r"\s*\[\s*encoders\s*\]\s*(#.*)?$")
LASER = re.compile(r"\s*\[\[\s*lasers\s*\]\]\s*(#.*)?$")

Keys = Mapping[str, float | str]


@dataclass(frozen=True, slots=True, kw_only=True)
class Numbers:
    """Numbers for a robot's own file.

    Attributes:
        odometry: Correction of its odometry.
        laser: Place of its first laser; `None` to leave it.
        delay: Time by which the scans of that are late [s]; `None` to leave it.
        gyro_scaler: Factor on the rates of its gyro; `None` to leave it.
        encoders: Numbers of its controller that the correction counts on top of; `None` to leave
            them.
        serial_number: Of the robot; empty to leave it.
    """

    odometry: OdometryCorrection
    laser: Pose2 | None = None
    delay: float | None = None
    gyro_scaler: float | None = None
    encoders: EncoderNumbers | None = None
    serial_number: str = ""

    @property
    def of_robot(self) -> Keys:
        """The keys above all tables."""
        keys: dict[str, float | str] = {}
        if self.gyro_scaler is not None:
            keys["gyro_scaler"] = round(self.gyro_scaler, 4)
        if self.serial_number:
            keys["serial_number"] = self.serial_number
        return keys

    @property
    def of_odometry(self) -> dict[str, float]:
        """The keys of the table of odometry."""
        return {name: round(getattr(self.odometry, name), 5) for name in NAMES}

    @property
    def of_laser(self) -> dict[str, float]:
        """The keys of a laser."""
        keys: dict[str, float] = {}
        if self.laser is not None:
            keys["x"], keys["y"] = round(self.laser.x, 4), round(self.laser.y, 4)
            keys["theta_deg"] = round(degrees(self.laser.theta), 2)
        if self.delay is not None:
            keys["delay"] = round(self.delay, 3)
        return keys

    @property
    def text(self) -> str:
        """The tables as they stand in a file."""
        keys = "".join(f"{line}\n\n" for line in _lines(self.of_robot))
        tables = written({"odometry": self.of_odometry})
        if self.encoders is not None:
            tables += f"\n{written({'encoders': asdict(self.encoders)})}"
        lasers = f"\n{written({'lasers': [self.of_laser]})}" if self.of_laser else ""
        return keys + tables + lasers


def file_of(info: RobotInfo) -> Path:
    """Return the own file of a robot: the one that it has, or that by its name.

    Raises:
        ConfigError: It is ARIA's, or no file can have the robot's name.
    """
    path = info.own.path if info.own is not None else own_path(info.identity.name)
    if path is None:
        raise ConfigError(f"{shown(info.identity.name)}: no file can have the name of this robot")
    if path.suffix == ARIA:
        own = path.with_suffix(TOML)
        raise ConfigError(
            f"{path} is ARIA's, which has no place for these numbers: make {own.name} beside it by "
            "pioneer3 robot init --force, which counts before it; write into it what your file of "
            "ARIA has beyond the robot's type, and calibrate again"
        )
    return path


def write_numbers(info: RobotInfo, numbers: Numbers) -> tuple[Path, Path | None]:
    """Write numbers into the own file of a robot; return it, and the copy of the one before.

    Raises:
        ConfigError: It cannot be written, or not without changing more than the numbers.
    """
    path = file_of(info)
    old = read_model_text(path) if path.exists() else None
    text = old
    if text is None:
        new_text = new_own_text(info.identity.name, info.identity.model, (), None)
        text = new_text.replace(ODOMETRY_EXAMPLE, "")
    kin = find_model(info.identity.model) or info.model
    new = with_numbers(text, numbers, path, kin)
    before = path.with_name(path.name + OLD) if old is not None else None
    if before is not None and old is not None:
        write_bytes(before, old.encode())
    with suppress(OSError):  # the file cannot be written then, and that tells why
        path.parent.mkdir(parents=True, exist_ok=True)
    write_bytes(path, new.encode())
    return path, before


def with_numbers(text: str, numbers: Numbers, path: Path, kin: RobotModel | None = None) -> str:
    """Return the text of an own file with numbers; those of a laser only if it has one.

    Raises:
        ConfigError: It would not be read as it is now, with the numbers.
    """
    new = _with_keys(text, ODOMETRY, numbers.of_odometry, "[odometry]")
    expected = load(Source.of(path, text))
    if numbers.of_robot:
        new = _with_keys(f"{ABOVE}\n{new}", re.compile(re.escape(ABOVE)), numbers.of_robot, None)
        new = new.removeprefix(f"{ABOVE}\n")
        expected |= numbers.of_robot
    expected["odometry"] = {**expected.get("odometry", {}), **numbers.of_odometry}
    if numbers.encoders is not None:
        expected["encoders"] = asdict(numbers.encoders)
        new = _with_keys(new, ENCODERS, expected["encoders"], "[encoders]")
    if numbers.of_laser and expected.get("lasers"):
        new = _with_keys(new, LASER, numbers.of_laser, None)
        expected["lasers"][0].update(numbers.of_laser)
    try:
        fits = load(Source.of(path, new)) == expected
        parse_own(new, str(path), kin)
    except ConfigError:
        fits = False
    if not fits:
        raise ConfigError(f"{path}: has a form of its own; write into it yourself:\n{numbers.text}")
    return new


def _with_keys(text: str, heading: re.Pattern[str], keys: Keys, new: str | None) -> str:
    """Return a text with keys in its first table of a heading, or in a `new` one at its end."""
    lines = text.splitlines()
    at = next((number for number, line in enumerate(lines) if heading.match(line)), None)
    if at is None:
        if new is None:
            return text
        return "\n".join([*lines, "", new, *_lines(keys), ""])
    end = next((n for n in range(at + 1, len(lines)) if HEADING.match(lines[n])), len(lines))
    left = dict(keys)
    last = at
    for number in range(at + 1, end):
        entry = re.match(r"(\s*)(\w+)(\s*=\s*)([^#\s]+)(.*)$", lines[number])
        if entry is None:
            continue
        last = number
        if entry[2] in left:
            value = left.pop(entry[2])
            lines[number] = f"{entry[1]}{entry[2]}{entry[3]}{json.dumps(value)}{entry[5]}"
    lines[last + 1 : last + 1] = _lines(left)
    return "\n".join(lines) + "\n"


def _lines(keys: Keys) -> list[str]:
    return [f"{key} = {json.dumps(value)}" for key, value in keys.items()]
