"""The facts that a robot's computer tells: one question over ssh, and its answer as data."""

import asyncio
import shlex
import time
from collections.abc import Awaitable, Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from pioneer3.errors import HostError, RemoteError
from pioneer3.fleet.run import output_of
from pioneer3.fleet.spec import Fleet, FleetRobot
from pioneer3.fleet.ssh import asyncssh_module, connect
from pioneer3.fleet.unit import SERVICE, WITH_ROOT
from pioneer3.names import printable

if TYPE_CHECKING:
    import asyncssh

BASE: Final = ".local/share/pioneer3"
"""Below the user's home; `fleet deploy` puts the package there, and `current` points to the version
in use."""
RUNTIME: Final = "XDG_RUNTIME_DIR=${XDG_RUNTIME_DIR:-/run/user/$(id -u)}"
"""The user's service manager is found by this; not every sshd sets it."""
CLOCK_QUESTIONS: Final = 3
REACHABLE: Final = 3.0
"""Longest wait for a connection to a free port there [s]."""
LOGS: Final = (
    f"if [ -e {WITH_ROOT} ]; then journalctl -u {SERVICE} {{options}}; "
    f"else journalctl --user -u {SERVICE} {{options}}; fi"
)
"""Shows the output of our service there."""


def logs_command(lines: int, *, follow: bool) -> str:
    """Return the command that shows the last lines of our service, and new ones as they come."""
    options = f"-n {lines} -o short-iso --no-pager --no-hostname"
    return LOGS.format(options=f"{options} -f" if follow else options)


@dataclass(frozen=True, slots=True, kw_only=True)
class HostFacts:
    """The facts about a robot's computer; facts that it did not tell are empty, or `None`.

    It has been `up` for so long [s], runs `load` programs on average of the last minute, and has so
    much space `free` on the disk of the user's home [bytes]. `device` says whether the robot's
    serial port is there, and is `None` for a port in the network. `names` are the addresses there
    of the fleet's host names, and `addresses` the names of its addresses. `environment` has
    :data:`ROS_VARIABLES` of a terminal there. `open_ports` says whether we reach a port that a
    program opens there, and `passwords` whether they let people in; `None` if not tried. `version`
    is that of the deployed pioneer3, and `service` the state of our service, such as `active`. Its
    clock is ahead of ours by `clock_offset`, with an error of `clock_error` at most [s].
    """

    hostname: str = ""
    machine: str = ""
    system: str = ""
    glibc: str = ""
    python: str = ""
    up: float | None = None
    load: float | None = None
    free: int | None = None
    groups: tuple[str, ...] = ()
    device: bool | None = None
    device_allowed: bool = False
    ros: tuple[str, ...] = ()
    environment: Mapping[str, str] = field(default_factory=dict)
    names: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    addresses: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    own_addresses: tuple[str, ...] = ()
    firewall: bool = False
    open_ports: bool | None = None
    version: str = ""
    service: str = ""
    clock_offset: float | None = None
    clock_error: float = 0.0
    passwords: bool | None = None


ROS_VARIABLES: Final = ("ROS_MASTER_URI", "ROS_IP", "ROS_HOSTNAME")
_QUESTIONS: Final = {
    "hostname": "hostname",
    "machine": "uname -m",
    "system": '. /etc/os-release; echo "$PRETTY_NAME"',
    "glibc": "getconf GNU_LIBC_VERSION | cut -d' ' -f2",
    "python": "python3 -c 'import platform; print(platform.python_version())'",
    "up": "cut -d' ' -f1 /proc/uptime",
    "load": "cut -d' ' -f1 /proc/loadavg",
    "free": "df -Pk ~ | awk 'NR == 2 {print $4}'",
    "groups": "id -Gn",
    "ros": "ls /opt/ros",
    "own_addresses": 'getent ahostsv4 "$(hostname)" | cut -d" " -f1 | sort -u',
    "firewall": "grep -i '^ENABLED=yes' /etc/ufw/ufw.conf",
    "version": f"basename $(readlink ~/{BASE}/current)",
    "service": f"if [ -e {WITH_ROOT} ]; then systemctl is-active {SERVICE}; "
    f"else {RUNTIME} systemctl --user is-active {SERVICE}; fi",
}
"""A line of the shell for each fact."""
_LISTEN: Final = (
    "import socket; s = socket.create_server(('', 0)); print(s.getsockname()[1], flush=True); "
    f"s.settimeout({REACHABLE + 2:g}); s.accept()"
)


def question(robot: FleetRobot, fleet: Fleet) -> str:
    """Return the script that answers with a line for each fact, `key=value`."""
    asked = dict(_QUESTIONS)
    if robot.is_device:
        device = shlex.quote(robot.port)
        asked["device"] = f"test -e {device} && echo yes"
        asked["device_allowed"] = f"test -r {device} && test -w {device} && echo yes"
    for name, address in _hosts(fleet):
        asked[f"name {name}"] = f"getent ahostsv4 {shlex.quote(name)} | cut -d' ' -f1 | sort -u"
        asked[f"address {address}"] = f"getent hosts {shlex.quote(address)} | cut -d' ' -f2-"
    for variable in ROS_VARIABLES:  # as a terminal there has them: the shell of ssh reads no files
        asked[f"environment {variable}"] = f"bash -ic 'printf %s \"${variable}\"' </dev/null"
    lines = [
        f"printf '%s=' {shlex.quote(key)}; ({command}) 2>/dev/null | tr '\\n' ' '; echo"
        for key, command in asked.items()
    ]
    return "\n".join(lines)


def _hosts(fleet: Fleet) -> Iterator[tuple[str, str]]:
    if fleet.operator.name and fleet.operator.address:
        yield fleet.operator.name, fleet.operator.address
    for robot in fleet.robots:
        yield robot.host, robot.address


def parsed(robot: FleetRobot, answer: str) -> HostFacts:
    """Return the facts in the answer to :func:`question`."""
    lines = (printable(line).partition("=") for line in answer.split("\n"))
    said = {key: value.strip() for key, _, value in lines}

    def group(kind: str) -> dict[str, str]:
        return {
            key.removeprefix(f"{kind} "): value
            for key, value in said.items()
            if key.startswith(f"{kind} ")
        }

    def words(kind: str) -> Mapping[str, tuple[str, ...]]:
        return {key: tuple(value.split()) for key, value in group(kind).items()}

    free = _number(said.get("free", ""))
    return HostFacts(
        hostname=said.get("hostname", ""),
        machine=said.get("machine", ""),
        system=said.get("system", ""),
        glibc=said.get("glibc", ""),
        python=said.get("python", ""),
        up=_number(said.get("up", "")),
        load=_number(said.get("load", "")),
        free=None if free is None else int(free * 1024),
        groups=tuple(said.get("groups", "").split()),
        device=said.get("device") == "yes" if robot.is_device else None,
        device_allowed=said.get("device_allowed") == "yes",
        ros=tuple(said.get("ros", "").split()),
        environment=group("environment"),
        names=words("name"),
        addresses=words("address"),
        own_addresses=tuple(said.get("own_addresses", "").split()),
        firewall=bool(said.get("firewall")),
        version=said.get("version", ""),
        service=said.get("service", ""),
    )


def _number(text: str) -> float | None:
    try:
        return float(text)
    except ValueError:
        return None


async def clock_of(connection: "asyncssh.SSHClientConnection") -> tuple[float, float]:
    """Return the offset of a computer's clock against ours, and the error of that at most [s].

    Raises:
        RemoteError: It does not tell the time.
    """
    best = (0.0, float("inf"))
    for _ in range(CLOCK_QUESTIONS):
        before = time.time()
        text = await output_of(connection, "date +%s.%N")
        after = time.time()
        try:
            there = float(text)
        except ValueError:
            raise RemoteError(f"date says {text!r}, which is no time") from None
        found = (there - (before + after) / 2, (after - before) / 2)
        best = min(best, found, key=lambda each: each[1])
    return best


async def reaches_ports(connection: "asyncssh.SSHClientConnection", address: str) -> bool | None:
    """Return whether we reach a port that a program opens there; `None` if it opens none."""
    import asyncssh

    try:
        process = await connection.create_process(f"python3 -c {shlex.quote(_LISTEN)}")
        port = int(await process.stdout.readline())
    except (asyncssh.Error, ValueError):
        return None
    try:
        async with asyncio.timeout(REACHABLE):
            _, writer = await asyncio.open_connection(address, port)
    except (OSError, TimeoutError):
        return False
    finally:
        process.close()
    writer.close()
    with suppress(OSError):
        await writer.wait_closed()
    return True


async def clock_ahead(robot: FleetRobot) -> float:
    """Return how far the clock of a robot's computer is ahead of ours [s].

    Raises:
        HostError: It cannot be logged in to.
        RemoteError: It does not tell the time.
    """
    async with connect(robot) as connection:
        ahead, _ = await clock_of(connection)
    return ahead


def clocks() -> Callable[[FleetRobot], Awaitable[float]] | None:
    """Return :func:`clock_ahead`, or `None` where asyncssh is missing.

    Loads asyncssh, which takes so long that it must not happen while robots are asked.
    """
    try:
        asyncssh_module()
    except HostError:
        return None
    return clock_ahead
