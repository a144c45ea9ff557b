"""The service of this computer: runs pioneer3 from when it is switched on."""

import os
import shlex
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from getpass import getuser
from pathlib import Path
from typing import Final, Self

from pioneer3.doctor.facts import Finding, Level, LinkFacts, warning
from pioneer3.doctor.port_checks import check_port
from pioneer3.doctor.ports import find_port
from pioneer3.errors import ConfigError, FilePermissionError, PortNotFoundError, RemoteError
from pioneer3.fleet.unit import SERVICE, USER_UNIT, WATCHED, WITH_ROOT, WRITTEN_BY, SystemdUnit
from pioneer3.text import write_bytes

COMMANDS: Final = ("run", "ros1", "ros2", "bridge")
"""Commands that a service may run: they go on until they are stopped."""
COMMAND: Final = "pioneer3 setup service"
BOOTED: Final = Path("/run/systemd/system")
"""Folder that is there where systemd runs the system (sd_booted(3))."""
STEPS_SINCE: Final = 254
"""The version of systemd that knows longer and longer pauses."""
PAUSES: Final = {
    False: ("RestartSec=5",),
    True: ("RestartSec=1", "RestartSteps=5", "RestartMaxDelaySec=30"),
}
"""When the program is started again, by whether systemd knows longer pauses."""
AGAIN: Final = "ended, and is started again"
"""The state between two attempts."""
LOG_LINES: Final = 5
"""Lines of the service's output that are shown."""
ROS_VARIABLES: Final = ("ROS_", "RMW_", "CYCLONEDDS_", "ZENOH_", "AMENT_", "LD_LIBRARY_PATH")
"""Beginnings of variables that a node of ROS needs."""
_PATIENCE: Final = 60.0
"""Longest wait for systemd [s]."""
_NAMES_THAT_CHANGE: Final = ("/dev/ttyUSB", "/dev/ttyACM")


@dataclass(frozen=True, slots=True, kw_only=True)
class ServiceState:
    """The state of the service: whether it `starts` with the computer, its last `lines`."""

    path: Path
    active: str
    starts: bool
    restarts: int
    lines: tuple[str, ...]


def unit_here(
    words: Sequence[str], *, with_root: bool, environment: Mapping[str, str]
) -> SystemdUnit:
    """Return the unit that runs `pioneer3` with `words` on this computer, from this folder.

    Raises:
        ConfigError: Such a command does not go on, or cannot be run a second time.
    """
    if not words or words[0] not in COMMANDS:
        asked = f"{words[0]!r} is none of them" if words else "none is given"
        raise ConfigError(
            f"the command to run, one of {', '.join(COMMANDS)}: {asked};"
            f" such as: {COMMAND} run --port /dev/ttyUSB0"
        )
    if any(word.partition("=")[0] == "--record" for word in words):
        raise ConfigError("--record: a service starts again, and its file would be there already")
    kept = ("PIONEER3_", "PYTHONPATH", *(ROS_VARIABLES if words[0].startswith("ros") else ()))
    variables = sorted(
        f"{name}={text}" for name, text in environment.items() if name.startswith(kept)
    )
    return SystemdUnit(
        command=[sys.executable, "-m", "pioneer3", *words],
        about=f"pioneer3 {words[0]}",
        written_by=COMMAND,
        environment=["PYTHONUNBUFFERED=1", *variables],
        user=environment.get("SUDO_USER") or getuser() if with_root else "",
        folder=str(Path.cwd()),
        pauses=PAUSES[_systemd_version() >= STEPS_SINCE],
    )


def check_ports(words: Sequence[str], *, with_root: bool, runs: bool) -> Iterator[Finding]:
    """Yield what is wrong with the serial ports among the words of a command.

    The service that `runs` may hold them; one `with_root` is in the group that may open them.
    """
    for word in words:
        path = word[word.find("/dev/") :] if "/dev/" in word else ""
        port = find_port(path) if path else None
        if port is None:
            continue
        refused = None if Path(port.device).exists() else PortNotFoundError(path)
        port = replace(
            port, allowed=port.allowed or with_root, holders=() if runs else port.holders
        )
        found = check_port(LinkFacts(url=path, port=port, refused=refused))
        yield from (each for each in found if each.level is not Level.OK)
        if path.startswith(_NAMES_THAT_CHANGE):
            yield warning(
                check="name",
                found=f"{path} may have another number after a start",
                advice=f"Use a name that stays: {port.path}"
                if port.path != path
                else "Give it a name that stays: pioneer3 setup udev",
            )


class LocalService:
    """The service of this computer: the system's if it is `with_root`, else the user's own."""

    def __init__(self, *, with_root: bool) -> None:
        self.with_root = with_root
        self.path = Path(WITH_ROOT) if with_root else Path.home() / USER_UNIT

    @classmethod
    def found(cls) -> Self | None:
        """Return the one that is installed, if there is one."""
        both = (cls(with_root=True), cls(with_root=False))
        return next((each for each in both if each.path.exists()), None)

    def install(self, unit: SystemdUnit) -> ServiceState:
        """Write the unit, let it start with the computer, start it now and watch it.

        Raises:
            ConfigError: Something else runs the robot already, or systemd does not run here.
            FilePermissionError: This user may not do it.
            RemoteError: systemd refuses it.
        """
        if not BOOTED.is_dir():
            raise ConfigError(
                "systemd does not run this system, and nothing else is known here that starts"
                " programs with the computer; --print shows the unit"
            )
        self._require_right()
        there = self.found()
        if there is not None and (there.path != self.path or not there.is_ours):
            raise ConfigError(
                f"{there.path} runs the robot already; remove it first: "
                f"{there.how_to_remove if there.is_ours else there.how_to_disable}"
            )
        self.path.parent.mkdir(parents=True, exist_ok=True)
        write_bytes(self.path, unit.text().encode())
        self.path.chmod(0o644 if self.with_root else 0o600)
        self._ctl("daemon-reload")
        self._ctl("enable", SERVICE)
        self._ctl("restart", SERVICE)
        if not self.with_root:
            self._run("loginctl", "enable-linger")
        end = time.monotonic() + WATCHED
        while (state := self.state()).active == "active" and time.monotonic() < end:
            time.sleep(0.5)
        return state

    def remove(self) -> None:
        """Stop the service and remove its unit.

        Raises:
            ConfigError: Another program wrote the unit.
            FilePermissionError: This user may not do it.
        """
        self._require_right()
        if not self.is_ours:
            raise ConfigError(
                f"{self.path} is not of {COMMAND}; remove it by: {self.how_to_disable}"
            )
        self._ctl("disable", "--now", SERVICE)
        self.path.unlink()
        self._ctl("daemon-reload")

    def state(self) -> ServiceState:
        """Return the state of the service."""
        told = dict(
            line.partition("=")[::2]
            for line in self._ctl(
                "show", "-p", "ActiveState,SubState,NRestarts,UnitFileState", SERVICE
            )
        )
        starts = told.get("UnitFileState") == "enabled"
        if not self.with_root:
            starts &= self._run("loginctl", "show-user", getuser(), "-p", "Linger") == [
                "Linger=yes"
            ]
        journal = ("journalctl", *self._manager, "-u", SERVICE, "-n", str(LOG_LINES), "-o", "cat")
        restarts = told.get("NRestarts", "")
        return ServiceState(
            path=self.path,
            active=AGAIN if told.get("SubState") == "auto-restart" else told.get("ActiveState", ""),
            starts=starts,
            restarts=int(restarts) if restarts.isdecimal() else 0,
            lines=tuple(self._run(*journal, "--no-pager", "-q")),
        )

    @property
    def is_ours(self) -> bool:
        """Whether :data:`COMMAND` wrote the unit."""
        return self.path.read_text("utf-8").startswith(f"{WRITTEN_BY}{COMMAND}\n")

    @property
    def how_to_remove(self) -> str:
        """The command that removes it."""
        return f"{self._sudo}{_program()} setup service --remove"

    @property
    def how_to_start(self) -> str:
        """The command that lets it start with the computer."""
        if self.with_root:
            return f"sudo systemctl enable {SERVICE}"
        return f"systemctl --user enable {SERVICE} && sudo loginctl enable-linger {getuser()}"

    @property
    def how_to_disable(self) -> str:
        """The commands that remove a unit of another program."""
        ctl = " ".join([f"{self._sudo}systemctl", *self._manager])
        return f"{ctl} disable --now {SERVICE} && {self._sudo}rm {self.path}"

    @property
    def _sudo(self) -> str:
        return "sudo " if self.with_root else ""

    @property
    def _manager(self) -> tuple[str, ...]:
        return () if self.with_root else ("--user",)

    def _require_right(self) -> None:
        if self.with_root and os.geteuid() != 0:
            again = shlex.join(sys.argv[1:])
            raise FilePermissionError(f"{self.path} needs root; run: sudo {_program()} {again}")

    def _ctl(self, *words: str) -> list[str]:
        done = self._called("systemctl", *self._manager, *words)
        if done.returncode:
            how = "" if self.with_root else "; log in as this user, over ssh or at the screen"
            raise RemoteError(f"systemctl {' '.join(words)}: {done.stderr.strip()}{how}")
        return done.stdout.splitlines()

    def _run(self, *words: str) -> list[str]:
        """Return what a command prints, nothing where it fails."""
        return self._called(*words).stdout.splitlines()

    @staticmethod
    def _called(*words: str) -> subprocess.CompletedProcess[str]:
        runtime = {"XDG_RUNTIME_DIR": f"/run/user/{getattr(os, 'getuid', int)()}"} | os.environ
        try:
            return subprocess.run(
                words, env=runtime, capture_output=True, text=True, timeout=_PATIENCE, check=False
            )
        except (OSError, subprocess.TimeoutExpired) as error:
            return subprocess.CompletedProcess(words, 1, "", str(error))


def _program() -> str:
    """Return the command that starts this program, also for another user."""
    script = Path(sys.executable).with_name("pioneer3")
    return shlex.quote(str(script)) if script.exists() else f"{sys.executable} -m pioneer3"


def _systemd_version() -> int:
    """Return the version of systemd here; 0 if there is none."""
    told = LocalService._called("systemctl", "--version").stdout.split()
    return int(told[1]) if len(told) > 1 and told[1].isdecimal() else 0
