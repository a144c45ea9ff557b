"""The distributions of ROS 2, as far as they differ on the wire."""

import tomllib
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Final

from pioneer3.errors import ConfigError

DEFAULT: Final = "jazzy"
"""Taken where nobody names one."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Distro:
    """A distribution; its facts are in `distros.toml`, with their sources.

    Its Nav2 sends TwistStamped unless told otherwise if it has stamped commands.
    """

    name: str
    gid_bytes: int
    type_hashes: bool
    stamped_commands: bool


@cache
def distros() -> dict[str, Distro]:
    """Return the distributions by name, oldest first."""
    text = files("pioneer3.ros.ros2").joinpath("distros.toml").read_text()
    return {name: Distro(name=name, **facts) for name, facts in tomllib.loads(text).items()}


def distro_of(name: str) -> Distro:
    """Return the distribution called `name`; ConfigError if there is none."""
    known = distros()
    if name not in known:
        raise ConfigError(f"ROS 2 has no distribution {name!r} here: choose of {', '.join(known)}")
    return known[name]
