"""Finds the model of a robot: shipped ones by name, others from a file."""

import re
from collections.abc import Mapping
from dataclasses import replace
from difflib import get_close_matches
from functools import cache
from importlib.resources import files
from math import radians
from pathlib import Path
from typing import Any, NamedTuple

from pioneer3.errors import ConfigError
from pioneer3.models.aria import parse_aria
from pioneer3.models.model import (
    BOUNDS,
    CAREFUL_BRAKING,
    CAREFUL_TURN_BRAKING,
    OwnFile,
    RobotModel,
    UnknownModel,
)
from pioneer3.names import printable
from pioneer3.tables import Source, converted, load, table_of
from pioneer3.text import read_bytes, wrong
from pioneer3.units import MM

LIKE = "like"
"""Key of a model's file: the shipped model whose numbers count where it has none."""
_SHIPPED = "robots.toml"
_SUBTYPE = re.compile("[a-z0-9_+-]+")
"""A robot or the network tells it, and it becomes part of fleet files: never a path."""
_SPEED = 0.75
_TURN_RATE = radians(100)
_LARGEST_FILE = 1024 * 1024


def model_names() -> tuple[str, ...]:
    """Return the names of the shipped models, sorted."""
    return tuple(sorted(_shipped()[1]))


def find_model(subtype: str) -> RobotModel | None:
    """Return the shipped model of the subtype that a robot reports, or `None` if there is none.

    A name such as `p3at-sh-lidar`, a shipped one that ends in `-sh` and more, is that robot with
    another laser.
    """
    wanted = subtype.strip().lower()
    if not _SUBTYPE.fullmatch(wanted):
        return None
    names = model_names()
    kin = (name for name in names if name.endswith("-sh") and wanted.startswith(f"{name}-"))
    name = wanted if wanted in names else next(kin, None)
    return _shipped_model(name) if name else None


def load_model(name_or_path: str | Path) -> RobotModel:
    """Return a shipped model by its name, with or without `-sh`, or that in a `.toml` or `.p` file.

    Raises:
        ConfigError: No such model or file, or the file is wrong; one line that names it, and the
            line and key where there is one.
    """
    path = Path(name_or_path)
    match path.suffix.lower():
        case ".toml":
            return parse_model(read_model_text(path), _shown(path))
        case ".p":
            return parse_aria(read_model_text(path), _shown(path), _printable(path.stem))
    model = find_model(str(name_or_path)) or find_model(f"{name_or_path}-sh")
    if model is None:
        raise ConfigError(_no_such_model(str(name_or_path)))
    return model


def parse_model(text: str, name: str) -> RobotModel:
    """Read the text of the TOML file `name`: the fields of `RobotModel`, angles in degrees.

    One that is `like` a shipped model needs only the fields that differ.

    Raises:
        ConfigError: It is wrong; names file, line and key.
    """
    return parse_own(text, name).model


def parse_own(text: str, name: str, kin: RobotModel | None = None) -> OwnFile:
    """Read the text of a model's file that may have lasers and a camera, too.

    Args:
        text: The whole file.
        name: Its name, for messages.
        kin: The model that it is like if it does not say; `None` if it has to be complete then.

    Raises:
        ConfigError: It is wrong; names file, line and key.
    """
    source = Source(name, text)
    own = converted(source, _table_like(source, kin), OwnFile)
    first = own.lasers[0].mount if own.lasers else own.model.laser
    return replace(own, model=replace(own.model, laser=first))


def _table_like(source: Source, kin: RobotModel | None) -> dict[str, object]:
    """Return the table of a model's file, on top of that of the model that it is `like`."""
    table = load(source)
    if LIKE in table:
        name = table.pop(LIKE)
        kin = find_model(name) if isinstance(name, str) else None
        if kin is None:
            raise source.wrong(LIKE, _no_such_model(str(name)))
    if kin is None and not table.keys() & {"name", "distance_factor"}:
        raise source.wrong(LIKE, 'missing; it names the type with all other numbers: "p3at-sh"')
    return table_of(kin) | table if kin else table


class Fallback(NamedTuple):
    """A model that counts if the type that the robot names is not known: itself, a name, a file."""

    model: RobotModel | str | Path


GivenModel = RobotModel | Fallback | str | Path | None
"""The model that somebody names, if any: before the robot's own word, a fallback after it."""


def loaded_model(given: GivenModel) -> RobotModel | Fallback | None:
    """Return `given` with names and files read; ConfigError as of :func:`load_model`."""
    match given:
        case str() | Path():
            return load_model(given)
        case Fallback(str() | Path() as name):
            return Fallback(load_model(name))
    return given


def generic_model(name: str, *, max_speed: float, max_turn_rate: float) -> UnknownModel:
    """Return a model for an unknown robot, made of values in its CONFIG.

    Factors are a P3-DX-SH's, sizes a P3-AT's, the largest of the shipped models; no sonar mount
    is known. It never fails: a value of 0 (CONFIG has none) or NaN becomes that of a real P3-AT
    (protocol.md 5.1), a value out of range the nearest allowed.
    """
    name = _printable(name)
    return UnknownModel(
        name=name,
        title=f"unknown robot type {name}",
        radius=0.5,
        width=0.505,
        length_front=0.313,
        length_rear=0.313,
        wheel_base=0.357142857143,
        distance_factor=MM,
        max_speed=_usable("max_speed", max_speed, _SPEED),
        max_turn_rate=_usable("max_turn_rate", max_turn_rate, _TURN_RATE),
        braking=CAREFUL_BRAKING,
        turn_braking=CAREFUL_TURN_BRAKING,
        settable_speed=False,
        settable_acceleration=False,
    )


@cache
def _shipped() -> tuple[Source, Mapping[str, Mapping[str, Any]]]:
    """Return the file of the shipped models, and their tables by their names."""
    source = Source(_SHIPPED, files(__package__).joinpath(_SHIPPED).read_text(encoding="utf-8"))
    tables: dict[str, Mapping[str, Any]] = {}
    for name, own in load(source).items():
        tables[name] = {**tables.get(own.pop(LIKE, ""), {}), "name": name, **own}
    return source, tables


@cache
def _shipped_model(name: str) -> RobotModel:
    source, tables = _shipped()
    return converted(source, tables[name], RobotModel, name)


def _printable(name: str) -> str:
    return "".join(filter(str.isprintable, name)) or "unknown"


def _usable(field: str, value: float, default: float) -> float:
    bounds = BOUNDS[field]
    return min(max(value, bounds.low), bounds.high) if value > 0 else default


def read_model_text(path: Path) -> str:
    """Return the text of a model's file, whose comments need not be UTF-8; ConfigError for none."""
    data = read_bytes(path, _LARGEST_FILE, "model")
    if b"\0" in data:
        raise wrong(path, " not a text file, expected a robot model")
    return data.decode("utf-8-sig", errors="replace")


def _shown(path: Path) -> str:
    return printable(str(path))


def _no_such_model(wanted: str) -> str:
    close = get_close_matches(wanted.lower(), model_names(), n=1)
    hint = f"did you mean {close[0]}?" if close else "known are p3at-sh, p3dx and others:"
    return (
        f"{wanted!r}: no such robot model, {hint} `pioneer3 model list` shows all; files end in"
        " .toml or .p"
    )
