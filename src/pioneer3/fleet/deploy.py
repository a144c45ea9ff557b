"""Installs this package on robots' computers, with a service that drives the robot from the start.

Versions lie side by side below `~/.local/share/pioneer3`; the link `current` points to the one in
use. A version that does not start gives way to the one before it.
"""

import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

from pioneer3.errors import ConfigError, RemoteError
from pioneer3.fleet.bundle import OLDEST_PYTHON, Bundle, Bundler, Platform, version_pair
from pioneer3.fleet.copy import put_file
from pioneer3.fleet.host_facts import BASE
from pioneer3.fleet.run import Done, Outcome, on_each, output_of
from pioneer3.fleet.spec import Fleet, FleetRobot
from pioneer3.fleet.ssh import LOGIN, Login, connect
from pioneer3.fleet.unit import (
    SERVICE,
    USER_UNIT,
    WATCHED,
    WITH_ROOT,
    SystemdUnit,
    check_unit,
    unit_of,
)

if TYPE_CHECKING:
    import asyncssh

KEPT: Final = 2
"""Number of versions that stay: the new one, and the one before it."""

_ASK: Final = """\
for name in python3.14 python3.13 python3.12 python3.11 python3; do
  path=$(command -v $name) && $path -c 'import sys; sys.exit(sys.version_info < (3, 11))' && break
  path=
done
echo "$HOME"
uname -m
getconf GNU_LIBC_VERSION 2>/dev/null | cut -d' ' -f2 | grep . || echo none
echo "${path:-none}"
${path:-python3} -c 'import sys; print("%d.%d" % sys.version_info[:2])' 2>/dev/null || echo none
if [ "$(id -u)" = 0 ] || sudo -n true 2>/dev/null; then echo root; else echo user; fi
command -v systemctl >/dev/null && echo systemd || echo none
readlink @BASE@/current || echo none
"""
_UNPACK: Final = """\
set -e
cd @BASE@
new=releases/@NAME@
if [ ! -e $new/complete ]; then
  rm -rf $new
  @PYTHON@ -m venv --without-pip $new 2>&1 ||
    { echo "its Python makes no venv; on it run: sudo apt-get install python3-venv" >&2; exit 1; }
  tar -xzf @NAME@.tar.gz -C $new/@PACKAGES@ --no-same-owner
  $new/bin/python -m pioneer3 --version
  touch $new/complete
fi
rm -f @NAME@.tar.gz
"""
_SWITCH: Final = """\
set -e
cd @BASE@
ln -sfn releases/@NAME@ current.new
mv -T current.new current
"""
_MANAGER: Final = """\
export XDG_RUNTIME_DIR="${XDG_RUNTIME_DIR:-/run/user/$(id -u)}"
ctl() { @CTL@ "$@"; }
"""
_START: Final = """\
set -e
began=$(date +%s)
@BASE@/current/bin/python -m pioneer3 run --help >/dev/null
watched=$((@WATCHED@ + 4 * ($(date +%s) - began)))
ctl daemon-reload
ctl enable @SERVICE@ 2>&1
ctl restart @SERVICE@
restarts=$(ctl show -p NRestarts --value @SERVICE@)
for second in $(seq $watched); do
  sleep 1
  state=$(ctl is-active @SERVICE@ || true)
  if [ "$state" != active ] || [ "$(ctl show -p NRestarts --value @SERVICE@)" != "$restarts" ]; then
    echo "the service is $state" >&2
    exit 1
  fi
done
"""
_WHY: Final = "@JOURNAL@ -u @SERVICE@ -n 3 -o cat --no-pager 2>/dev/null || true"
_PRUNE: Final = """\
cd @BASE@/releases
for name in $(ls -1t | tail -n +@FROM@); do
  [ "releases/$name" = "$(readlink ../current)" ] || rm -rf "./$name"
done
"""
_SWITCH_OFF: Final = """\
ctl disable --now @SERVICE@ 2>&1 || true
rm -f @BASE@/current
"""
_LINGER: Final = "loginctl enable-linger 2>/dev/null && echo yes || echo no"


@dataclass(frozen=True, slots=True, kw_only=True)
class _Target:
    """A robot's computer, as far as an installation has to know it."""

    home: str
    platform: Platform
    python: str
    with_root: bool
    has_systemd: bool
    current: str

    @property
    def base(self) -> str:
        return f"{self.home}/{BASE}"


async def deploy(
    fleet: Fleet,
    robots: Sequence[FleetRobot],
    *,
    login: Login = LOGIN,
    extras: Sequence[str] = (),
    service: bool = True,
) -> tuple[Outcome, ...]:
    """Install this package on all computers at once.

    A version that is there already stays; one that does not start gives way to the one before it.
    The package comes with `extras` such as `nav`, and with the service that drives the robot; with
    that of ROS 1 if a robot is on it.
    """
    on_ros1 = any(robot.ros == "1" for robot in robots)
    extras = [*extras, *(["ros1"] if on_ros1 and service else [])]
    with tempfile.TemporaryDirectory(prefix="pioneer3-") as folder:
        bundler = Bundler(Path(folder), extras)

        async def work(robot: FleetRobot) -> Done:
            async with connect(robot, login) as connection:
                target = await _ask(connection)
                try:
                    if service:
                        check_unit(robot, fleet)
                    bundle = await bundler.bundle(target.platform)
                except ConfigError as error:
                    raise RemoteError(str(error)) from None
                file = Path(folder) / robot.name
                here = _Installation(connection=connection, target=target, bundle=bundle, file=file)
                said = bundle.name if await here.unpack() else f"{bundle.name} was there"
                if service:
                    python = f"{target.base}/current/bin/python"
                    unit = unit_of(robot, fleet, python, with_root=target.with_root)
                    said += await here.serve(unit, user=robot.user)
                else:
                    await here.run(_SWITCH)
                await here.run(_PRUNE)
            return Done(said=said)

        return await on_each(robots, work)


async def _ask(connection: "asyncssh.SSHClientConnection") -> _Target:
    """Ask a computer for the facts about an installation; RemoteError if none is possible."""
    answer = (await output_of(connection, _ASK.replace("@BASE@", BASE))).splitlines()
    home, machine, glibc, path, python, root, systemd, current = answer[-8:]
    version = version_pair(python)
    if path == "none" or version is None or version < OLDEST_PYTHON:
        found = f"it has Python {python}" if version else "it has no Python"
        raise RemoteError(
            f"{found}; pioneer3 needs 3.11 or newer. Install a system of 2023 or later there "
            "(Debian 12, Ubuntu 24.04); or let this computer drive the robot over the network: "
            "see how-to/fleet-work.md, An old computer on the robot"
        )
    libc = version_pair(glibc)
    if libc is None:
        raise RemoteError("its C library is not glibc: there are no packages for that")
    return _Target(
        home=home,
        platform=Platform(machine, version, libc),
        python=path,
        with_root=root == "root",
        has_systemd=systemd == "systemd",
        current=current,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class _Installation:
    """A version on its way to one computer; `file` holds its unit here."""

    connection: "asyncssh.SSHClientConnection"
    target: _Target
    bundle: Bundle
    file: Path

    async def run(self, script: str) -> str:
        """Return the output of a script, with values in the place of its words."""
        bundle, target = self.bundle, self.target
        words = {
            "@BASE@": BASE,
            "@NAME@": bundle.name,
            "@PYTHON@": target.python,
            "@PACKAGES@": bundle.platform.packages,
            "@CTL@": "sudo -n systemctl" if target.with_root else "systemctl --user",
            "@JOURNAL@": "sudo -n journalctl" if target.with_root else "journalctl --user",
            "@SERVICE@": SERVICE,
            "@WATCHED@": str(WATCHED),
            "@FROM@": str(KEPT + 1),
        }
        for word, value in words.items():
            script = script.replace(word, value)
        return await output_of(self.connection, script)

    async def unpack(self) -> bool:
        """Put the version beside the others, if it is not there; return whether it was not."""
        marker = f"{BASE}/releases/{self.bundle.name}/complete"
        there = await output_of(self.connection, f"test -e {marker} && echo yes || echo no")
        if there == "yes":
            return False
        archive = f"{self.target.base}/{self.bundle.name}.tar.gz"
        await put_file(self.connection, self.bundle.path, archive)
        await self.run(_UNPACK)
        return True

    async def serve(self, unit: SystemdUnit, *, user: str) -> str:
        """Let the service run this version; return a word about that.

        If it does not start, the version before it runs again, and this raises RemoteError.
        """
        target, name = self.target, self.bundle.name
        if not target.has_systemd:
            await self.run(_SWITCH)
            return "; no systemd there: nothing starts it"
        path = WITH_ROOT if target.with_root else f"{target.home}/{USER_UNIT}"
        before = await output_of(self.connection, f"cat {path} 2>/dev/null || true")
        state = await self.run(_MANAGER + "ctl is-active @SERVICE@ 2>/dev/null || true")
        same_unit = before.rstrip("\n") == unit.text().rstrip("\n")
        unchanged = same_unit and target.current == f"releases/{name}"
        if unchanged and state == "active":
            return ", and runs"
        await self._write_unit(unit.text())
        await self.run(_SWITCH)
        try:
            await self.run(_MANAGER + _START)
        except RemoteError as error:
            why = "; ".join((await self.run(_MANAGER + _WHY)).splitlines())
            told = "That version was there before" if unchanged else await self._roll_back(before)
            raise RemoteError(f"{name} does not start: {error}; {why}. {told}") from None
        if target.with_root or await output_of(self.connection, _LINGER) == "yes":
            return ", and drives the robot from the start"
        return (
            ", and runs; to let it run from the start an administrator has to run there: "
            f"sudo loginctl enable-linger {user}"
        )

    async def _write_unit(self, text: str) -> None:
        self.file.write_text(text, encoding="utf-8")
        self.file.chmod(0o644)
        if not self.target.with_root:
            await put_file(self.connection, self.file, f"{self.target.home}/{USER_UNIT}")
            return
        staged = f"{self.target.base}/{SERVICE}.service"
        await put_file(self.connection, self.file, staged)
        install = f"sudo -n install -o root -g root -m 644 {staged} {WITH_ROOT} && rm {staged}"
        await output_of(self.connection, install)

    async def _roll_back(self, unit: str) -> str:
        """Go back to the version before; return a word about that."""
        if self.target.current == "none" or not unit:
            await self.run(_MANAGER + _SWITCH_OFF)
            return "The service is switched off again; nothing ran there before"
        await self._write_unit(unit + "\n")
        name = self.target.current.rpartition("/")[2]
        old = replace(self, bundle=replace(self.bundle, name=name))
        try:
            await old.run(_SWITCH)
            await old.run(_MANAGER + _START)
        except RemoteError as error:
            return f"The version before, {name}, does not start any more either: {error}"
        return f"The version before, {name}, runs again"
