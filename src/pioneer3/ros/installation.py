"""The parts of an installed ROS package that are the same in ROS 1 and ROS 2."""

import re
import shlex
from collections.abc import Collection, Mapping
from importlib.resources import files
from pathlib import Path
from typing import Final

from pioneer3.errors import ConfigError
from pioneer3.models import load_model
from pioneer3.models.description.tree import Frames, tree_of
from pioneer3.models.description.urdf import describe

NAME: Final = "pioneer3"
"""Name of the package."""
MODELS: Final = ("p3at", "p3at-sh", "p3dx", "p3dx-sh")
"""Those that the package has a description of; a node describes whatever robot it has."""
TRANSDUCERS: Final = 16
"""Transducers of a Pioneer with both rows of sonars."""
DEMOS = ("robots", "wander", "follow", "rob_key", "rob_key_multi", "android_teleop", "p3_sonar")
"""Programs on topics, which are commands of the same names."""
PLACEHOLDER: Final = re.compile(r"@([a-z_]+)@")


def launcher(python: str, *arguments: str) -> str:
    """Return a program that runs `pioneer3` with these arguments, and with its own after them."""
    command = shlex.join([python, "-m", "pioneer3", *filter(None, arguments)])
    return f'#!/bin/sh\nexec {command} "$@"\n'


def rendered(package: str, name: str, values: Mapping[str, str]) -> str:
    """Return a template of `pioneer3.ros.{package}` with values for each `@key@`; else KeyError."""
    path = files(f"pioneer3.ros.{package}").joinpath("templates", f"{name}.in")
    return PLACEHOLDER.sub(lambda found: values[found[1]], path.read_text(encoding="utf-8"))


def rviz_config(package: str) -> str:
    """Return the configuration of RViz, with a display for each transducer."""
    displays = (
        rendered(package, "rviz/range.rviz", {"number": str(number)})
        for number in range(TRANSDUCERS)
    )
    return rendered(package, f"rviz/{NAME}.rviz", {"ranges": "".join(displays).rstrip()})


def urdf_files(folder: Path) -> dict[Path, str]:
    """Return a description of each of `MODELS`, by its path in `folder`."""
    return {folder / f"{name}.urdf": _urdf(name) for name in MODELS}


def write_files(contents: Mapping[Path, str], programs: Collection[Path], folder: Path) -> None:
    """Write texts to their paths, `programs` executable; ConfigError if they cannot be there."""
    try:
        for path, text in contents.items():
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        for program in programs:
            program.chmod(0o755)
    except OSError as error:
        raise ConfigError(f"cannot write the package to {folder}: {error}") from error


def _urdf(name: str) -> str:
    model, frames = load_model(name), Frames()
    return describe(model, tree_of(model, frames), frames, laser=False)
