"""Reads single values that somebody has written on the ROS parameter server."""

from collections.abc import Mapping
from enum import StrEnum
from math import isfinite
from typing import TypeGuard, TypeVar

from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.units import ANGLE, LENGTH

E = TypeVar("E", bound=StrEnum)
UNITS = LENGTH, LENGTH, ANGLE
RawParameters = Mapping[str, object]
"""Parameters as somebody has written them below the node's name: anything may be there."""


def number(raw: RawParameters, name: str, default: float, low: float, high: float) -> float:
    """Return a number between `low` and `high`.

    Raises:
        ConfigError: it is not a number, or out of range; so do all of these.
    """
    value = raw.get(name, default)
    if not _is_number(value) or not low <= value <= high:
        raise ConfigError(f"~{name} must be a number from {low:g} to {high:g}, not {value!r}")
    return float(value)


def numbers(raw: RawParameters, name: str, default: tuple[float, ...]) -> tuple[float, ...]:
    """Return a list of positive numbers, as many as in `default`."""
    value = raw.get(name, list(default))
    several = value if isinstance(value, list) else []
    good = [float(each) for each in several if _is_number(each) and each > 0]
    if not len(default) == len(several) == len(good):
        raise ConfigError(
            f"~{name} must be a list of {len(default)} positive numbers, not {value!r}"
        )
    return tuple(good)


def flag(raw: RawParameters, name: str, *, default: bool) -> bool:
    """Return true or false."""
    value = raw.get(name, default)
    if not isinstance(value, bool):
        raise ConfigError(f"~{name} must be true or false, not {value!r}")
    return value


def choice(raw: RawParameters, name: str, default: E) -> E:
    """Return a member of the enumeration of `default`."""
    value = raw.get(name, default)
    kinds = type(default)
    try:
        return kinds(str(value))
    except ValueError:
        raise ConfigError(f"~{name} must be {' or '.join(kinds)}, not {value!r}") from None


def words(raw: RawParameters, name: str) -> tuple[str, ...]:
    """Return a list of words; none where there is no such parameter."""
    value = raw.get(name, [])
    if not isinstance(value, list) or not all(isinstance(each, str) and each for each in value):
        raise ConfigError(f"~{name} must be a list of names, not {value!r}")
    return tuple(value)


def text(raw: RawParameters, name: str) -> str | None:
    """Return a text; `None` where there is none, or an empty one."""
    value = raw.get(name) or None
    if value is not None and not isinstance(value, str):
        raise ConfigError(f"~{name} must be text, not {value!r}")
    return value


def place(words: str) -> Pose2 | str:
    """Return the pose `x,y,heading` in metres and degrees, unless another unit is given.

    Words that begin with no number are the name of a place.
    """
    if not words.lstrip(" +-.")[:1].isdigit():
        return words
    parts = words.split(",")
    if len(parts) not in (2, 3):
        raise ConfigError(f"start {words}: give x,y or x,y,heading, or the name of a place")
    try:
        return Pose2(*(unit.read(part) for unit, part in zip(UNITS, parts, strict=False)))
    except ValueError as error:
        raise ConfigError(f"start {words}: {error}") from None


def frame(raw: RawParameters, name: str, default: str) -> str:
    """Return the name of a frame; tf2 has none with a leading slash."""
    value = raw.get(name, default)
    if not isinstance(value, str) or not value.strip("/"):
        raise ConfigError(f"~{name} must be the name of a frame, not {value!r}")
    return value.lstrip("/")


def _is_number(value: object) -> TypeGuard[float]:
    return not isinstance(value, bool) and isinstance(value, int | float) and isfinite(value)
