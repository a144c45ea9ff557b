"""A ROS 2 that is not ours: rclpy and Fast DDS of the package index, in an environment apart.

`python -m tests.ros2.foreign [DISTRO...]` makes the environments before tests need them. The wheels
are those of a third party, for CPython on Linux with x86-64 only.
"""

import contextlib
import fcntl
import os
import platform
import shutil
import subprocess
import sys
import time
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Final

import pytest

MESSAGES: Final = ("geometry-msgs", "nav-msgs", "sensor-msgs", "diagnostic-msgs")
PINNED: Final[Mapping[str, tuple[str, ...]]] = {
    "jazzy": (
        "ros-jazzy-rclpy==7.1.6",
        "ros-jazzy-rmw-fastrtps-cpp==8.4.3",
        *(f"ros-jazzy-{each}==5.3.6" for each in (*MESSAGES, "std-srvs")),
        "ros-jazzy-lifecycle-msgs==2.0.3",
    ),
    "kilted": (
        "ros-rclpy==9.1.2",
        "ros-rmw-fastrtps-cpp==9.3.3",
        *(f"ros-{each}==5.5.1" for each in (*MESSAGES, "std-srvs")),
        "ros-lifecycle-msgs==2.3.0",
    ),
}
"""Packages by distribution. They lack tf2_msgs, command-line tools and all other middlewares."""
PYTHONS: Final = ((3, 11), (3, 12), (3, 13))
LIBRARIES: Final = Path("lib") / f"python{sys.version_info.major}.{sys.version_info.minor}"
TOOLS: Final = Path(__file__).parents[2] / ".tools/bin/uv"
MINUTES: Final = 600.0
"""Longest time to install [s]."""
SHARED_MEMORY: Final = Path("/dev/shm")
HALF_MADE: Final = 60.0
"""Age at which an empty file of shared memory will not be filled any more [s]."""


class UnavailableError(Exception):
    """This computer cannot have it; a sentence says why."""


@dataclass(frozen=True)
class Foreign:
    """An environment with a ROS 2.

    Attributes:
        distro: Such as `jazzy`.
        folder: Where it is.
    """

    distro: str
    folder: Path

    @property
    def python(self) -> str:
        """Its Python."""
        return str(self.folder / "bin/python")

    @property
    def variables(self) -> dict[str, str]:
        """What `source setup.bash` sets, and that nothing leaves this computer.

        Its packages come after those of this Python, whose version is the same.
        """
        packages = self.folder / LIBRARIES / "site-packages"
        libraries = [self.folder / "lib", *sorted(packages.glob("*.libs"))]
        ours = [each for each in sys.path if each.endswith("site-packages")]
        return {
            "AMENT_PREFIX_PATH": str(self.folder),
            "LD_LIBRARY_PATH": os.pathsep.join(map(str, libraries)),
            "PYTHONPATH": os.pathsep.join([*ours, str(packages)]),
            "ROS_DISTRO": self.distro,
            "RMW_IMPLEMENTATION": "rmw_fastrtps_cpp",
            "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        }


def foreign(distro: str) -> Foreign:
    """Return the environment, made if need be; skip the test where it cannot be had."""
    made = environment(distro)
    if isinstance(made, Foreign):
        return made
    if has_wheels() and os.environ.get("CI") == "true":
        pytest.fail(made)
    pytest.skip(made)


def has_wheels() -> bool:
    """Return whether there are wheels for this computer and Python."""
    system = (sys.platform, platform.machine(), platform.libc_ver()[0])
    return system == ("linux", "x86_64", "glibc") and sys.version_info[:2] in PYTHONS


@cache
def environment(distro: str) -> Foreign | str:
    """Return the environment, or the reason why there is none; both once in each process."""
    _forget_half_made_ports()
    try:
        return make(distro)
    except UnavailableError as error:
        return str(error)


def make(distro: str) -> Foreign:
    """Return the environment of a distribution; make it unless it is there.

    Raises:
        UnavailableError: no wheels are for this computer, or they cannot be fetched.
    """
    if not has_wheels():
        raise UnavailableError(
            "there is no ROS 2 for this computer: its wheels are for CPython 3.11 to 3.13 on Linux"
            " with x86-64"
        )
    home = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "pioneer3/ros2"
    home.mkdir(parents=True, exist_ok=True)
    wanted = "\n".join((*PINNED[distro], sys.version, sys.base_prefix))
    folder = home / f"{distro}-{zlib.crc32(wanted.encode()):08x}"
    with (home / f"{distro}.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not (folder / "bin/python").exists():
            part = home / f"{distro}.part"
            shutil.rmtree(part, ignore_errors=True)  # of somebody who was ended meanwhile
            _install(part, PINNED[distro])
            part.rename(folder)
    return Foreign(distro, folder)


def _forget_half_made_ports() -> None:
    """Remove shared memory that somebody was killed in the making of: Fast DDS waits for it."""
    for port in SHARED_MEMORY.glob("fast*_port*"):
        with contextlib.suppress(OSError):
            age = time.time() - port.stat().st_mtime
            if not port.name.endswith("_el") and port.stat().st_size == 0 and age > HALF_MADE:
                port.unlink()
                port.with_name(f"sem.{port.name}_mutex").unlink()


def _install(folder: Path, packages: tuple[str, ...]) -> None:
    """Make an environment with these packages.

    Raises:
        UnavailableError: a command fails; the sentence ends with its last line.
    """
    uv = shutil.which("uv") or (str(TOOLS) if TOOLS.exists() else None)
    python = str(folder / "bin/python")
    if uv is not None:
        empty: list[str] = [uv, "venv", "--python", sys.executable, str(folder)]
        install = [uv, "pip", "install", "--python", python]
    else:
        empty = [sys.executable, "-m", "venv", str(folder)]
        install = [python, "-m", "pip", "install"]
    for command in (empty, [*install, *packages]):
        try:
            subprocess.run(command, check=True, capture_output=True, text=True, timeout=MINUTES)
        except (OSError, subprocess.SubprocessError) as error:
            lines = str(getattr(error, "stderr", "") or error).strip().splitlines()
            raise UnavailableError(
                f"the wheels of ROS 2 cannot be installed: {lines[-1].strip()}"
            ) from error


if __name__ == "__main__":
    try:
        for name in sys.argv[1:] or PINNED:
            sys.stdout.write(f"ROS 2 {name}: {make(name).folder}\n")
    except UnavailableError as reason:
        sys.exit(f"The tests with a real ROS 2 are skipped: {reason}")
