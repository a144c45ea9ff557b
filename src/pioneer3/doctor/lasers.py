"""Asks ports for a laser range finder, as a driver would, and changes nothing there."""

import asyncio
import os
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Final

from pioneer3.doctor.ports import SerialPort, is_serial, list_ports
from pioneer3.doctor.recognition import UNNAMED
from pioneer3.errors import ConfigError, LinkError, PortNotFoundError
from pioneer3.lasers.client import LineSpeedWanted, Patience, ScanSettings, ScansLost
from pioneer3.lasers.recognition import QUESTION, name_in
from pioneer3.links import Link, open_link
from pioneer3.links.urls import split_url
from pioneer3.models.lasers import LaserProtocol
from pioneer3.robot.lasers.search import ProtocolSearch

PATIENCE: Final = Patience(give_up=3.5)
"""Once over all serial speeds."""
REST: Final = 0.4
"""For the rest of an answer [s]."""
SCANS: Final = 5
"""So many times that long is waited for an answer that comes between scans: at 19200 baud a scan
takes 1.1 s."""


@dataclass(frozen=True, slots=True)
class FoundLaser:
    """A port with a laser: the `url` for `--laser`, and its own name as far as it gave one."""

    url: str
    protocol: LaserProtocol
    name: str


async def find_laser(taken: Sequence[str] = ()) -> str:
    """Return the port of the only laser at this computer's serial ports that are not `taken`.

    Raises:
        LinkError: there is none.
        ConfigError: there are several.
    """
    found = await find_lasers(taken)
    if not found:
        raise PortNotFoundError(
            "--laser auto: no laser answers at a serial port of this computer; a laser in the "
            "network is given by its address, such as --laser tcp://192.168.0.10:10940"
        )
    if len(found) > 1:
        several = ", ".join(f"{laser.url} ({laser.name})" for laser in found)
        raise ConfigError(f"--laser auto: there are several: {several}; choose one")
    return found[0].url


async def find_lasers(taken: Sequence[str] = ()) -> tuple[FoundLaser, ...]:
    """Return the lasers at this computer's serial ports that are not `taken` and nobody uses."""
    in_use = {_device(url) for url in taken if is_serial(url)}
    free = [
        port
        for port in list_ports()
        if port.device not in in_use and not port.holders and not port.console and port.allowed
    ]
    asked = await asyncio.gather(*(_ask_port(port) for port in free))
    return tuple(laser for laser in asked if laser is not None)


async def _ask_port(port: SerialPort) -> FoundLaser | None:
    found = await laser_at(port.path)
    if found is None and port.is_hokuyo:
        return FoundLaser(port.path, LaserProtocol.SCIP, port.product or "Hokuyo")
    return found


async def laser_at(url: str) -> FoundLaser | None:
    """Return the laser at `url`, or `None` if none answers."""
    try:
        link = await open_link(url)
    except LinkError:
        return None
    try:
        return await laser_on(link)
    finally:
        await link.close()


async def laser_on(link: Link, patience: Patience = PATIENCE) -> FoundLaser | None:
    """Return the laser at an open link, or `None` if none answers."""
    heard = bytearray()
    protocol = await _search(link, patience, heard)
    if protocol is None:
        return None
    with suppress(LinkError):
        await _hear_more(link, heard)
        if not name_in(bytes(heard)):  # it was scanning, and has not been asked
            await link.write(QUESTION)
        for _ in range(SCANS):
            if not name_in(bytes(heard)):
                await _hear_more(link, heard)
    return FoundLaser(link.url, protocol, name_in(bytes(heard)) or UNNAMED[protocol])


async def _search(link: Link, patience: Patience, heard: bytearray) -> LaserProtocol | None:
    """Return the protocol of the laser; put what it said at its speed into `heard`."""
    clock = asyncio.get_running_loop().time
    found: list[LaserProtocol] = []
    search = ProtocolSearch(
        clock(),
        link.speeds,
        ScanSettings(),
        patience,
        round_trip=link.round_trip,
        found=found.append,
    )
    with suppress(LinkError):
        while not found:
            for event in search.tick(clock()):
                match event:
                    case LineSpeedWanted(baud):
                        await link.set_speed(baud)
                        heard.clear()
                    case ScansLost():
                        return None
            if question := search.outgoing():
                await link.write(question)
            with suppress(TimeoutError):
                async with asyncio.timeout_at(search.deadline):
                    data = await link.read()
                    heard += data
                    if not data or any(
                        isinstance(event, ScansLost) for event in search.receive(data, clock())
                    ):
                        break
    return found[0] if found else None


async def _hear_more(link: Link, heard: bytearray) -> None:
    """Add to `heard` all that comes for a short while."""
    with suppress(TimeoutError):
        async with asyncio.timeout(REST):
            while data := await link.read():
                heard += data


def _device(url: str) -> str:
    return os.path.realpath(split_url(url)[1])
