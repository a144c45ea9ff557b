"""Wheels of all that this package needs, for laptops of all kinds in a room without internet.

uv chooses the wheels for each system and each Python; they are loaded once, and compared by their
digests. A wheelhouse that is complete asks nobody for anything.
"""

import hashlib
import re
import subprocess
import sys
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Final
from urllib.error import URLError
from urllib.parse import unquote, urlsplit
from urllib.request import urlopen

import msgspec

from pioneer3.distribution import find_uv, required_anywhere
from pioneer3.errors import ConfigError

SYSTEMS: Final = {
    "Linux x86-64": "x86_64-unknown-linux-gnu",
    "Linux arm64": "aarch64-unknown-linux-gnu",
    "macOS arm64": "aarch64-apple-darwin",
    "macOS x86-64": "x86_64-apple-darwin",
    "Windows x86-64": "x86_64-pc-windows-msvc",
}
"""Kinds of laptops, with their names in uv."""
PYTHONS: Final = ("3.11", "3.12", "3.13", "3.14")
"""Versions of Python on them."""
CONTENTS: Final = "wheelhouse.json"
"""File that tells what a wheelhouse has."""
WHEEL_NAME: Final = re.compile(r"[A-Za-z0-9][A-Za-z0-9._+!-]*\.whl", re.ASCII)
"""Name of a wheel; nothing of it leads to another folder."""
BLOCK: Final = 1 << 18
"""Piece of a file that is loaded at once [bytes]."""
SILENCE: Final = 60.0
"""Longest time until a server goes on [s]."""
UNSOLVED: Final = 1
"""Exit code of uv where there are no wheels; it is 2 where there is no network."""


class Kit(msgspec.Struct, frozen=True):
    """The wheels for one kind of laptop; or the problem that there are none."""

    system: str
    python: str
    wheels: list[str] = []
    problem: str = ""


class Contents(msgspec.Struct, frozen=True):
    """Contents of a wheelhouse that was filled for these requirements."""

    requires: list[str]
    kits: list[Kit]


class LockedWheel(msgspec.Struct, frozen=True):
    """A wheel in a lock file (PEP 751); one of this computer has no URL."""

    url: str = ""
    size: int = 0
    hashes: dict[str, str] = {}

    @property
    def name(self) -> str:
        """Name of the file, the last part of its address."""
        return unquote(urlsplit(self.url).path).rpartition("/")[2]


class LockedPackage(msgspec.Struct, frozen=True):
    """A package in a lock file, with the wheels that fit."""

    name: str
    wheels: list[LockedWheel] = []


class LockFile(msgspec.Struct, frozen=True):
    """The packages for one kind of laptop, as uv writes them."""

    packages: list[LockedPackage] = []


class Wheelhouse:
    """The wheels in a folder; `tell` gets each line of progress, `stopped` ends a long work."""

    def __init__(
        self, folder: Path, tell: Callable[[str], None], stopped: Callable[[], bool]
    ) -> None:
        self._folder, self._tell, self._stopped = folder, tell, stopped

    def open(self) -> dict[str, Path]:
        """Load what is missing; return all wheels by name.

        Raises:
            ConfigError: Nothing is there, and nothing can be loaded.
        """
        contents = self._contents()
        if contents is None or not self._is_complete(contents):
            try:
                contents = self._fill()
            except ConfigError as error:
                if not self._files():
                    raise
                self._tell(f"WARNING: the wheelhouse is not complete: {error}")
        files = self._files()
        size = sum(path.stat().st_size for path in files.values()) / 1e9
        self._tell(f"Wheelhouse {self._folder}: {len(files)} wheels, {size:.1f} GB")
        for line in described(contents.kits) if contents is not None else ():
            self._tell(f"  {line}")
        return files

    def _files(self) -> dict[str, Path]:
        return {path.name: path for path in sorted(self._folder.glob("*.whl")) if path.is_file()}

    def _contents(self) -> Contents | None:
        try:
            return msgspec.json.decode((self._folder / CONTENTS).read_bytes(), type=Contents)
        except (OSError, msgspec.MsgspecError):
            return None

    def _is_complete(self, contents: Contents) -> bool:
        named = {name for kit in contents.kits for name in kit.wheels}
        asked = {(kit.system, kit.python) for kit in contents.kits}
        wanted = {(system, python) for system in SYSTEMS for python in PYTHONS}
        same = contents.requires == required_anywhere() and wanted <= asked
        return same and named <= self._files().keys()

    def _fill(self) -> Contents:
        """Ask for the wheels of all kinds, and load those that are missing."""
        uv = find_uv()
        if uv is None:
            raise ConfigError("--wheelhouse needs uv: python -m pip install uv")
        self._make_folder()
        kits, remote = [], dict[str, LockedWheel]()
        for system, platform in SYSTEMS.items():
            self._tell(f"Asking for the wheels for {system} ...")
            for python in PYTHONS:
                self._check_stop()
                found = _resolve(uv, platform, python)
                if isinstance(found, str):
                    kits.append(Kit(system, python, problem=found))
                    continue
                remote |= {wheel.name: wheel for wheel in found}
                kits.append(Kit(system, python, [wheel.name for wheel in found]))
        self._load([wheel for wheel in remote.values() if not self._has(wheel)])
        contents = Contents(required_anywhere(), kits)
        (self._folder / CONTENTS).write_bytes(msgspec.json.format(msgspec.json.encode(contents)))
        return contents

    def _make_folder(self) -> None:
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise ConfigError(f"{self._folder}: no folder for wheels: {error.strerror}") from None

    def _has(self, wheel: LockedWheel) -> bool:
        path = self._folder / wheel.name
        return path.is_file() and path.stat().st_size == wheel.size

    def _load(self, wheels: list[LockedWheel]) -> None:
        total = sum(wheel.size for wheel in wheels) / 1e6
        loaded, told = 0.0, 0
        for number, wheel in enumerate(wheels, 1):
            self._load_one(wheel)
            loaded += wheel.size / 1e6
            if (tenth := int(10 * loaded / total)) > told:
                told = tenth
                self._tell(
                    f"Loaded {number} of {len(wheels)} wheels, {loaded:.0f} of {total:.0f} MB"
                )

    def _load_one(self, wheel: LockedWheel) -> None:
        digest, path = hashlib.sha256(), self._folder / wheel.name
        part = path.with_suffix(".part")
        try:
            with urlopen(wheel.url, timeout=SILENCE) as source, part.open("wb") as file:
                while block := source.read(BLOCK):
                    self._check_stop()
                    digest.update(block)
                    file.write(block)
            if digest.hexdigest() != wheel.hashes.get("sha256"):
                raise ConfigError(f"{wheel.name} was damaged on its way: start the class once more")
            part.replace(path)
        except OSError as error:
            reason = error.reason if isinstance(error, URLError) else error.strerror or error
            raise ConfigError(f"{wheel.name} could not be loaded: {reason}") from None
        finally:
            part.unlink(missing_ok=True)

    def _check_stop(self) -> None:
        if self._stopped():
            raise ConfigError("it was ended before all wheels were there; those that are stay")


def _resolve(uv: str, platform: str, python: str) -> list[LockedWheel] | str:
    """Return the wheels for a system and a Python, or the problem that there are none.

    Raises:
        ConfigError: The index does not answer.
    """
    words = [uv, "pip", "compile", "-", "--quiet", "--format", "pylock.toml"]
    words += ["--only-binary", ":all:", "--python", sys.executable]
    words += ["--python-platform", platform, "--python-version", python]
    text = "\n".join(required_anywhere())
    done = subprocess.run(words, input=text, capture_output=True, text=True, check=False)
    said = " ".join(done.stderr.split())
    if done.returncode == UNSOLVED:
        return said.rpartition("cause: ")[2].partition(" hint: ")[0][:300]
    if done.returncode != 0:
        raise ConfigError(f"the package index does not answer: {said[-300:]}")
    locked = msgspec.convert(tomllib.loads(done.stdout), LockFile)
    return [wheel for package in locked.packages for wheel in _checked(package)]


def _checked(package: LockedPackage) -> list[LockedWheel]:
    """Return the wheels of a package; ConfigError if one is on no index."""
    for wheel in package.wheels:
        web = urlsplit(wheel.url).scheme in {"http", "https"}
        if not web or not WHEEL_NAME.fullmatch(wheel.name):
            raise ConfigError(f"{package.name}: its wheel is on no index: {wheel.url!r}")
    return package.wheels


def described(kits: list[Kit]) -> Iterator[str]:
    """Yield a line for each system with its Pythons, and one for each problem."""
    for system in dict.fromkeys(kit.system for kit in kits):
        good = [kit.python for kit in kits if kit.system == system and not kit.problem]
        if good:
            yield f"for {system} with Python {', '.join(good)}"
    for kit in kits:
        if kit.problem:
            yield f"NOT for {kit.system} with Python {kit.python}: {kit.problem}"
