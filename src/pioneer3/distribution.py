"""The distribution that this package was installed from: its files, its requirements, its extras.

It is on no package index: it comes as a wheel, or runs from a clone.
"""

import os
import shutil
import sys
from collections.abc import Iterator, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Final

NAME: Final = "pioneer3"
"""Name of the distribution, and of the package in it."""
PACKAGE: Final = Path(__file__).parent
"""Folder of the package."""
CLONE: Final = PACKAGE.parents[1]
"""Folder of the clone where the package runs from one."""
SETUP: Final = CLONE / "scripts/setup"
"""Exists where the package runs from a clone."""
PIPX_MARK: Final = "pipx_metadata.json"
"""File of an environment that pipx has made."""
NOT_SHIPPED: Final = frozenset({"__pycache__"})
"""Folders of a package that belong to one computer."""


def version() -> str:
    """Return the version of the distribution."""
    from importlib import metadata  # loads slowly, and most programs never ask

    return metadata.version(NAME)


def how_to_get(extra: str) -> str:
    """Return the command that installs an optional part, in the way this package was installed."""
    return f"the extra `{extra}` is missing; run: {_command(extra)}"


def _command(extra: str) -> str:
    if SETUP.is_file() and os.name == "posix":
        return str(SETUP)
    # the packages and not the extra: the wheel may be here no more
    return how_to_add(*(f'"{line}"' for line in added_by(extra)))


def how_to_add(*packages: str) -> str:
    """Return the command that installs packages beside this one, as it was installed itself."""
    wanted = " ".join(packages)
    if (Path(sys.prefix) / PIPX_MARK).is_file():
        return f"pipx inject {NAME} {wanted}"
    if find_spec("pip") is not None:
        return f'"{sys.executable}" -m pip install {wanted}'
    return f'uv pip install --python "{sys.executable}" {wanted}'


def added_by(extra: str) -> list[str]:
    """Return what an extra needs on this computer, one requirement for each package."""
    from packaging.requirements import Requirement

    lines = (Requirement(line) for line in _requires(NAME))
    return [
        f"{line.name}{line.specifier}"
        for line in lines
        if line.marker is not None
        and line.marker.evaluate({"extra": extra})
        and not line.marker.evaluate({"extra": ""})
    ]


def requirements(name: str, extras: Sequence[str] = ()) -> list[str]:
    """Return the requirements of an installed distribution that count here with these extras."""
    from packaging.requirements import Requirement

    found = []
    for line in _requires(name):
        requirement = Requirement(line)
        marker = requirement.marker
        if marker is None or any(marker.evaluate({"extra": extra}) for extra in ("", *extras)):
            requirement.marker = None
            found.append(str(requirement))
    return found


def required_anywhere() -> list[str]:
    """Return the requirements without extras, on any computer, with their markers."""
    return [line for line in _requires(NAME) if "extra ==" not in line]


def _requires(name: str) -> Sequence[str]:
    from importlib import metadata

    return metadata.requires(name) or ()


def find_uv() -> str | None:
    """Return the path of uv, `None` if it is not on this computer."""
    candidates = (
        shutil.which("uv"),
        Path(sys.executable).with_name("uv"),
        Path.home() / ".local/bin/uv",
        CLONE / ".tools/bin/uv",
    )
    return next((str(path) for path in candidates if path and Path(path).is_file()), None)


def own_files() -> Iterator[tuple[str, Path]]:
    """Yield the files of this package as it runs here, each with its name below site-packages."""
    for path in sorted(PACKAGE.rglob("*")):
        inside = path.relative_to(PACKAGE)
        if path.is_file() and not NOT_SHIPPED & set(inside.parts):
            yield f"{NAME}/{inside.as_posix()}", path


def own_metadata() -> Iterator[tuple[str, str]]:
    """Yield the name and the text of each file that tells installers of this distribution."""
    from importlib import metadata

    distribution = metadata.distribution(NAME)
    for name in ("METADATA", "entry_points.txt"):
        yield name, distribution.read_text(name) or ""
    for name in distribution.metadata.get_all("License-File") or ():
        text = distribution.read_text(f"licenses/{name}")
        if text is None and (CLONE / name).is_file():
            text = (CLONE / name).read_text(encoding="utf-8")
        if text is not None:
            yield f"licenses/{name}", text
