"""The parts of an installed ROS package that are the same in ROS 1 and ROS 2."""

import shlex
from collections.abc import Collection, Mapping
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


def launcher(python: str, *arguments: str) -> str:
    """Return a program that runs `pioneer3` with these arguments, and with its own after them."""
    command = shlex.join([python, "-m", "pioneer3", *filter(None, arguments)])
    return f'#!/bin/sh\nexec {command} "$@"\n'


def urdf_files(folder: Path) -> dict[Path, str]:
    """Return a description of each of `MODELS`, by its path in `folder`."""
    return {folder / f"{name}.urdf": _urdf(name) for name in MODELS}


def write_files(files: Mapping[Path, str], programs: Collection[Path], folder: Path) -> None:
    """Write texts to their paths in `folder`; those in `programs` can be executed.

    Raises:
        ConfigError: they cannot be written there.
    """
    try:
        for path, text in files.items():
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        for program in programs:
            program.chmod(0o755)
    except OSError as error:
        raise ConfigError(f"cannot write the package to {folder}: {error}") from error


def _urdf(name: str) -> str:
    model, frames = load_model(name), Frames()
    return describe(model, tree_of(model, frames), frames, laser=False)
