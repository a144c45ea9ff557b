"""Reads a robot model from TOML: the fields of `RobotModel` in SI, angles in degrees.

Keys that hold an angle end in `_deg`; `heading_units` counts the heading units of a full turn.
"""

import re
import tomllib
from dataclasses import fields
from difflib import get_close_matches
from math import tau
from typing import get_args

from pioneer3.errors import ConfigError
from pioneer3.geometry import wrap
from pioneer3.models.model import (
    BEARING,
    BOUNDS,
    Bounds,
    Drive,
    LaserMount,
    RobotModel,
    SonarMount,
)
from pioneer3.names import printable
from pioneer3.units import DEGREE

_ANGLES = {
    "max_turn_rate_deg": "max_turn_rate",
    "turn_acceleration_deg": "turn_acceleration",
    "turn_deceleration_deg": "turn_deceleration",
    "turn_braking_deg": "turn_braking",
    "theta_deg": "theta",
}
_HEADING_UNITS = Bounds(64, 1_000_000)
_KEYS = {field: key for key, field in _ANGLES.items()} | {
    "heading_factor": "heading_units",
    "masked": "masked_deg",
}

Table = dict[str, object]

MOST_PARTS = 16
"""Most parts of a dotted key: tomllib needs memory by their square, 8 GB for 50 thousand."""
_PART = r"""(?:[\w-]++|"[^"\n]*+"|'[^'\n]*+')[ \t]*+\.[ \t]*+"""
_LONG_KEY = re.compile(rf"""(?<![\w"'-])(?:{_PART}){{{MOST_PARTS}}}""")


def load_toml(text: str) -> Table:
    """Return the tables in the text of a TOML file.

    Raises:
        ValueError: It is not valid, or nested too deeply.
    """
    if long := _LONG_KEY.search(text):
        line = text.count("\n", 0, long.start()) + 1
        raise ValueError(f"a key of more than {MOST_PARTS} parts (at line {line})")
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise ValueError("nested too deeply") from None


def parse_toml(text: str, source: str) -> RobotModel:
    """Read the text of a model file.

    Args:
        text: The whole file.
        source: Its name, for messages.

    Raises:
        ConfigError: Naming file and key.
    """
    try:
        table = load_toml(text)
        return _convert(_in_radians(table, RobotModel))
    except ConfigError as error:
        raise ConfigError(f"{source}: {error}") from error
    except ValueError as error:
        raise ConfigError(f"{source}: not valid TOML: {error}") from error


def _convert(table: Table) -> RobotModel:
    import msgspec  # 60 ms that only those who read a file pay

    try:
        return msgspec.convert(table, RobotModel)
    except msgspec.ValidationError as error:
        raise ConfigError(_reword(str(error))) from error


def _in_radians(table: Table, kind: type, where: str = "") -> Table:
    """Return `table` with the keys and units of the dataclass `kind`; refuse unknown keys."""
    known = [_KEYS.get(field.name, field.name) for field in fields(kind)]
    result: Table = {}
    for key, value in table.items():
        place = f"{where}{key}"
        if key not in known:
            raise ConfigError(f"{where}{_unknown(key, known)}")
        if key in _ANGLES:
            result[_ANGLES[key]] = _angle(place, value, BOUNDS.get(_ANGLES[key], BEARING))
        elif key == "heading_units":
            result["heading_factor"] = tau / _number(place, value, _HEADING_UNITS)
        elif key == "masked_deg" and isinstance(value, list):
            result["masked"] = [_sector(f"{place}[{i}]", item) for i, item in enumerate(value)]
        elif key == "laser" and isinstance(value, dict):
            result[key] = _in_radians(value, LaserMount, "laser.")
        elif key == "sonars" and isinstance(value, list):
            result[key] = [
                _in_radians(item, SonarMount, f"sonars[{i}].") if isinstance(item, dict) else item
                for i, item in enumerate(value)
            ]
        else:
            result[key] = value
    return result


def _unknown(key: str, known: list[str]) -> str:
    close = get_close_matches(_KEYS.get(key, key), known, n=1)
    hint = f"did you mean {close[0]}?" if close else f"expected one of {', '.join(known)}"
    return f"{printable(key)}: unknown key, {hint}"


def _number(place: str, value: object, bounds: Bounds, unit: float = 1.0) -> float:
    """Return `value` times `unit` [SI] if it is a number within `bounds` [SI]."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ConfigError(f"{place}: expected a number, got {value!r}")
    if not bounds.low / unit <= value <= bounds.high / unit:
        raise ConfigError(f"{place}: {bounds.complaint(value, unit)}")
    return value * unit


def _angle(place: str, value: object, bounds: Bounds) -> float:
    angle = _number(place, value, bounds, DEGREE)
    return wrap(angle) if bounds is BEARING else angle


def _sector(place: str, value: object) -> list[float]:
    if not isinstance(value, list) or len(value) != len(("first", "last")):
        raise ConfigError(f"{place}: expected two directions in degrees, such as [-135, -120]")
    return [_angle(place, end, BEARING) for end in value]


def _reword(message: str) -> str:
    """Turn msgspec's "problem - at `$.path`" into "path: problem"."""
    problem, _, path = message.partition(" - at `$")
    path = path.rstrip("`").lstrip(".")
    missing = re.search(r"missing required field `(\w+)`", problem)
    if missing:
        path = f"{path}." if path else ""
        return f"{path}{_KEYS.get(missing[1], missing[1])}: missing, add it"
    if path == "drive":
        problem = f"{problem}, expected {' or '.join(get_args(Drive))}"
    problem = problem.replace("`", "")
    return f"{path}: {problem}" if path else problem
