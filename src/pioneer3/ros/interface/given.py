"""Values of ROS parameters, checked: anybody can write anything there."""

from collections.abc import Mapping
from enum import StrEnum
from math import isfinite
from typing import TypeGuard, TypeVar

from pioneer3.errors import ConfigError

E = TypeVar("E", bound=StrEnum)
Given = Mapping[str, object]
"""What is written below the node's name."""


def number(given: Given, name: str, usual: float, low: float, high: float) -> float:
    """Return a number between `low` and `high`.

    Raises:
        ConfigError: it is none, or out of range; so do all of these.
    """
    value = given.get(name, usual)
    if not _is_number(value) or not low <= value <= high:
        raise ConfigError(f"~{name} must be a number from {low:g} to {high:g}, not {value!r}")
    return float(value)


def numbers(given: Given, name: str, usual: tuple[float, ...]) -> tuple[float, ...]:
    """Return a list of positive numbers, as many as are usual."""
    value = given.get(name, list(usual))
    several = value if isinstance(value, list) else []
    good = [float(each) for each in several if _is_number(each) and each > 0]
    if not len(usual) == len(several) == len(good):
        raise ConfigError(f"~{name} must be a list of {len(usual)} positive numbers, not {value!r}")
    return tuple(good)


def flag(given: Given, name: str, *, usual: bool) -> bool:
    """Return true or false."""
    value = given.get(name, usual)
    if not isinstance(value, bool):
        raise ConfigError(f"~{name} must be true or false, not {value!r}")
    return value


def choice(given: Given, name: str, usual: E) -> E:
    """Return one of the words that `usual` is one of."""
    value = given.get(name, usual)
    kinds = type(usual)
    try:
        return kinds(str(value))
    except ValueError:
        raise ConfigError(f"~{name} must be {' or '.join(kinds)}, not {value!r}") from None


def words(given: Given, name: str) -> tuple[str, ...]:
    """Return a list of words; none where there is no such parameter."""
    value = given.get(name, [])
    if not isinstance(value, list) or not all(isinstance(each, str) and each for each in value):
        raise ConfigError(f"~{name} must be a list of names, not {value!r}")
    return tuple(value)


def frame(given: Given, name: str, usual: str) -> str:
    """Return the name of a frame; today's tf knows none with a leading slash."""
    value = given.get(name, usual)
    if not isinstance(value, str) or not value.strip("/"):
        raise ConfigError(f"~{name} must be the name of a frame, not {value!r}")
    return value.lstrip("/")


def _is_number(value: object) -> TypeGuard[float]:
    return not isinstance(value, bool) and isinstance(value, int | float) and isfinite(value)
