"""The package and all that it needs, for a robot without internet: one archive of site-packages.

For a robot like this computer the packages are copied from here, in the versions that run here.
For another processor or Python they come as wheels from PyPI, by uv or pip on this computer.
"""

import asyncio
import hashlib
import platform as this_platform
import re
import shutil
import subprocess
import sys
import tarfile
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Final

import pioneer3
from pioneer3.distribution import (
    NAME,
    NOT_SHIPPED,
    added_by,
    find_uv,
    own_files,
    own_metadata,
    requirements,
)
from pioneer3.errors import ConfigError

OLDEST_PYTHON: Final = (3, 11)
MANYLINUX: Final = ((2, 17), (2, 28), (2, 31), (2, 34))
"""The levels of glibc for which wheels are made (PEP 600)."""
MACHINES: Final = ("x86_64", "aarch64")
"""Processors for which the packages have wheels."""


@dataclass(frozen=True, slots=True)
class Platform:
    """The platform that packages have to fit: the processor as `uname -m` says, and versions."""

    machine: str
    python: tuple[int, int]
    glibc: tuple[int, int]

    @property
    def packages(self) -> str:
        """Path of the packages in a virtual environment."""
        return f"lib/python{self.python[0]}.{self.python[1]}/site-packages"


@dataclass(frozen=True, slots=True)
class Bundle:
    """An archive for one platform; its name tells version and contents."""

    name: str
    path: Path
    platform: Platform


def here() -> Platform:
    """Return the platform of this computer."""
    return Platform(
        machine=this_platform.machine(),
        python=sys.version_info[:2],
        glibc=version_pair(this_platform.libc_ver()[1]) or (0, 0),
    )


def version_pair(text: str) -> tuple[int, int] | None:
    """Return the first two numbers of a version."""
    found = re.match(r"(\d+)\.(\d+)", text)
    return (int(found[1]), int(found[2])) if found else None


def suits(ours: Platform, theirs: Platform) -> bool:
    """Return whether packages of this computer run there as they are."""
    same = (ours.machine, ours.python) == (theirs.machine, theirs.python)
    return same and sys.platform == "linux" and theirs.glibc >= ours.glibc > (0, 0)


class Bundler:
    """Makes the archives of one deployment in `folder`, each once, with extras such as `nav`."""

    def __init__(self, folder: Path, extras: Sequence[str] = ()) -> None:
        self._folder, self._extras = folder, tuple(sorted(extras))
        self._made: dict[Platform, Bundle] = {}
        self._making = asyncio.Lock()

    async def bundle(self, platform: Platform) -> Bundle:
        """Return the archive for a platform; ConfigError if a package is missing here or there."""
        async with self._making:
            if platform not in self._made:
                self._made[platform] = await asyncio.to_thread(self._make, platform)
            return self._made[platform]

    def _make(self, platform: Platform) -> Bundle:
        with tempfile.TemporaryDirectory(dir=self._folder) as temporary:
            tree = Path(temporary)
            if suits(here(), platform):
                for name in installed(NAME, self._extras):
                    copy_distribution(name, tree)
            else:
                _load(platform, _wanted(self._extras), tree)
            _copy_own(tree)
            name = f"{pioneer3.__version__}-{_digest(tree, platform)}"
            path = self._folder / f"{name}.tar.gz"
            with tarfile.open(path, "w:gz", compresslevel=3) as archive:
                for item in sorted(tree.iterdir()):
                    archive.add(item, item.name, filter=_nobodys)
        return Bundle(name, path, platform)


def _wanted(extras: Sequence[str]) -> list[str]:
    """Return the requirements of this package on a robot, without the parts of other extras."""
    from packaging.requirements import Requirement

    others = metadata.metadata(NAME).get_all("Provides-Extra") or ()
    optional = {Requirement(line).name for extra in others for line in added_by(extra)}
    chosen = {Requirement(line).name for extra in extras for line in added_by(extra)}
    left_out = optional - chosen - {"packaging"}  # errors say by it how to get what is missing
    lines = requirements(NAME, extras)
    return [line for line in lines if Requirement(line).name not in left_out]


def installed(name: str, extras: Sequence[str]) -> list[str]:
    """Return the names of all packages that an installed one needs, in the order of the alphabet.

    Raises:
        ConfigError: One is not installed here.
    """
    from packaging.requirements import Requirement

    found: set[str] = set()
    waiting = [
        (line, name) for line in (_wanted(extras) if name == NAME else requirements(name, extras))
    ]
    while waiting:
        line, by = waiting.pop()
        requirement = Requirement(line)
        if requirement.name.lower() in found:
            continue
        try:
            more = requirements(requirement.name, tuple(requirement.extras))
        except metadata.PackageNotFoundError:
            raise ConfigError(
                f"{requirement.name}, which {by} needs, is not installed here"
            ) from None
        found.add(requirement.name.lower())
        waiting += [(each, requirement.name) for each in more]
    return sorted(found)


def copy_distribution(name: str, tree: Path) -> None:
    """Copy the files of an installed package; its programs stay here."""
    distribution = metadata.distribution(name)
    for file in distribution.files or ():
        source = Path(str(file.locate()))
        inside = ".." not in file.parts and not file.is_absolute()
        if inside and not NOT_SHIPPED & set(file.parts) and source.is_file():
            target = tree / file
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(source, target)


def _copy_own(tree: Path) -> None:
    """Copy this package as it runs here, and what `importlib.metadata` knows of it."""
    for name, source in own_files():
        target = tree / name
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(source, target)
    about = tree / f"{NAME}-{pioneer3.__version__}.dist-info"
    for name, text in own_metadata():
        (about / name).parent.mkdir(parents=True, exist_ok=True)
        (about / name).write_text(text, encoding="utf-8")


def _load(platform: Platform, requirements: Sequence[str], tree: Path) -> None:
    """Load wheels for another platform; ConfigError if there are none, or nothing that could."""
    if platform.machine not in MACHINES:
        problem = f"there are no packages for its processor {platform.machine}"
        raise ConfigError(f"{problem}; for {', '.join(MACHINES)}")
    python = ".".join(map(str, platform.python))
    levels = [level for level in MANYLINUX if level <= platform.glibc]
    uv = find_uv()
    if uv is not None:
        level = "_".join(map(str, max((each for each in levels), default=MANYLINUX[0])))
        words = [uv, "pip", "install", "--quiet", "--no-config", "--target", str(tree)]
        words += ["--python-version", python, "--only-binary", ":all:"]
        words += ["--python-platform", f"{platform.machine}-manylinux_{level}"]
    else:
        words = [sys.executable, "-m", "pip", "install", "--quiet", "--target", str(tree)]
        words += ["--python-version", python, "--only-binary=:all:", "--no-compile"]
        words += [f"--platform=manylinux_{a}_{b}_{platform.machine}" for a, b in levels]
    done = subprocess.run([*words, *requirements], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        last = " ".join(done.stderr.split())[-300:]
        raise ConfigError(
            f"no packages for Python {python} on {platform.machine} (glibc "
            f"{platform.glibc[0]}.{platform.glibc[1]}) are to be had from here: {last}"
        )


def _digest(tree: Path, platform: Platform) -> str:
    """Return a short digest of all files and the platform; the same files give the same."""
    digest = hashlib.sha256(repr(platform).encode())
    for path in sorted(path for path in tree.rglob("*") if path.is_file()):
        digest.update(f"\0{path.relative_to(tree)}\0".encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()[:8]


def _nobodys(item: tarfile.TarInfo) -> tarfile.TarInfo:
    item.uid = item.gid = 0
    item.uname = item.gname = ""
    return item
