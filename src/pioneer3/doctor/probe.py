"""Probes ports, side by side, for the devices at the other ends."""

import asyncio
from collections.abc import Awaitable, Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Final

from pioneer3.arcos.host_events import Timing
from pioneer3.doctor.facts import UNREACHABLE
from pioneer3.doctor.lasers import laser_at
from pioneer3.doctor.ports import SerialPort
from pioneer3.doctor.probe_session import QUICK, ProbeSession
from pioneer3.doctor.recognition import DeviceKind, OtherDevice
from pioneer3.errors import LinkError, PortBusyError, PortNotFoundError, PortPermissionError
from pioneer3.links import open_link
from pioneer3.robot.supervisor import RobotInfo, is_simulator

SIMULATOR_URL: Final = "tcp://localhost:8101"


class ProbeVerdict(StrEnum):
    """Result of a probe."""

    ROBOT = "robot"
    SIMULATOR = "simulator"
    LASER = "laser"
    OTHER = "something else"
    SILENT = "silent"
    BUSY = "busy"
    NO_PERMISSION = "no permission"
    CONSOLE = "console"
    NOBODY = "nobody"
    FAILED = "failed"
    NOT_PROBED = "not probed"


_REFUSALS: Final = {
    PortPermissionError: ProbeVerdict.NO_PERMISSION,
    PortBusyError: ProbeVerdict.BUSY,
    PortNotFoundError: ProbeVerdict.NOBODY,
}
"""Verdicts about links that do not open; other errors are failures."""


@dataclass(frozen=True, slots=True)
class Probed:
    """One port, and the result of probing it.

    `url` is the argument for `--port`; `detail` is the name of the device, or the obstacle, for
    people.
    """

    url: str
    verdict: ProbeVerdict
    detail: str = ""
    port: SerialPort | None = None
    info: RobotInfo | None = None


def skipped(port: SerialPort) -> Probed | None:
    """Return the result for a port that must not, or need not, be probed; else `None`."""
    if port.holders:
        who = ", ".join(f"{holder.name} (process {holder.pid})" for holder in port.holders)
        return Probed(port.path, ProbeVerdict.BUSY, f"open in {who}", port)
    if port.console:
        return Probed(
            port.path, ProbeVerdict.CONSOLE, "this computer's own console, left alone", port
        )
    if port.is_hokuyo:
        return Probed(port.path, ProbeVerdict.LASER, port.product or "Hokuyo", port)
    return None


async def probe_port(port: SerialPort) -> Probed:
    """Return the result for the serial `port`."""
    known = skipped(port)
    if known is not None and known.verdict is ProbeVerdict.LASER:
        laser = await laser_at(port.path)  # by its USB number it is one; it is asked for its name
        return replace(known, detail=laser.name) if laser else known
    return known or await probe(port.path, port)


async def probe(url: str, port: SerialPort | None = None, timing: Timing = QUICK) -> Probed:
    """Return the result for `url`; sends bytes to it, and raises ConfigError alone, for no port."""
    try:
        session = ProbeSession(await open_link(url), timing)
    except LinkError as error:
        verdicts = (verdict for kind, verdict in _REFUSALS.items() if isinstance(error, kind))
        return Probed(url, next(verdicts, ProbeVerdict.FAILED), str(error), port)
    try:
        if await session.handshake() and session.info is not None:
            return _robot(url, port, session.info)
        other_device = await session.other_device()
        if other_device is None and session.closed:
            return Probed(
                url, ProbeVerdict.BUSY, "hangs up at once: busy with somebody else?", port
            )
        return _other(url, port, other_device)
    finally:
        await session.close()


async def probe_all(
    ports: Sequence[SerialPort],
    urls: Sequence[str] = (),
    progress: Callable[[Sequence[str]], None] = lambda waiting: None,
) -> list[Probed]:
    """Return the results for all serial `ports`, then all `urls`, in their order.

    They are probed side by side, so that it takes as long as the slowest of them; `progress` is
    given the ports that have not been judged yet, at first and after each.
    """
    waiting = [*(port.path for port in ports), *urls]

    async def judged(url: str, probing: Awaitable[Probed]) -> Probed:
        result = await probing
        waiting.remove(url)
        progress(tuple(waiting))
        return result

    progress(tuple(waiting))
    return await asyncio.gather(
        *(judged(port.path, probe_port(port)) for port in ports),
        *(judged(url, probe(url)) for url in urls),
    )


def _robot(url: str, port: SerialPort | None, info: RobotInfo) -> Probed:
    verdict = ProbeVerdict.SIMULATOR if is_simulator(info) else ProbeVerdict.ROBOT
    speed = f" at {info.speed} baud" if info.speed else ""
    return Probed(url, verdict, f"{info.identity.name}, {info.model.title}{speed}", port, info)


def _other(url: str, port: SerialPort | None, other_device: OtherDevice | None) -> Probed:
    if other_device is None:
        return Probed(
            url, ProbeVerdict.SILENT, "nothing answers: robot off, or nothing there", port
        )
    verdict = ProbeVerdict.LASER if other_device.kind is DeviceKind.LASER else ProbeVerdict.OTHER
    return Probed(url, verdict, other_device.name, port)


def choose(found: Iterable[Probed]) -> Probed | None:
    """Return the one to use: a robot before a simulator, which may have been left running."""
    by_verdict = {each.verdict: each for each in reversed(list(found))}
    return by_verdict.get(ProbeVerdict.ROBOT) or by_verdict.get(ProbeVerdict.SIMULATOR)


def came_back(
    before: Iterable[SerialPort], without: Iterable[SerialPort], after: Iterable[SerialPort]
) -> tuple[SerialPort, ...]:
    """Return the ports that were plugged in again; a device may have another number then.

    `without` are those that are there after the cable was pulled.
    """
    stayed = {port.device for port in without}
    appeared = [port for port in after if port.device not in stayed]
    vanished = {port.path for port in before if port.device not in stayed}
    return tuple(sorted(appeared, key=lambda port: port.path not in vanished))


async def wait_for_plug(
    before: tuple[SerialPort, ...],
    without: tuple[SerialPort, ...],
    list_ports: Callable[[], tuple[SerialPort, ...]],
    *,
    patience: float = 30.0,
) -> tuple[SerialPort, ...]:
    """Return the ports that appear within `patience` [s]; udev gets a second to name them."""
    loop = asyncio.get_running_loop()
    end = loop.time() + patience
    while loop.time() < end:
        if came_back(before, without, list_ports()):
            await asyncio.sleep(1.0)
            return came_back(before, without, list_ports())
        await asyncio.sleep(0.3)
    return ()


def not_probed(ports: Iterable[SerialPort], urls: Iterable[str]) -> list[Probed]:
    """Return the list of ports without probing any."""
    listed = [
        skipped(port) or Probed(port.path, ProbeVerdict.NOT_PROBED, "", port) for port in ports
    ]
    return listed + [Probed(url, ProbeVerdict.NOT_PROBED) for url in urls]


def found_code(found: Sequence[Probed]) -> int:
    """Return the exit code: 0 when a robot was found or ports were only listed, else 3."""
    only_listed = any(each.verdict is ProbeVerdict.NOT_PROBED for each in found)
    return 0 if only_listed or choose(found) else UNREACHABLE
