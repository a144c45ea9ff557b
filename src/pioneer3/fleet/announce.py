"""Robots and pages that others reach are announced by DNS-SD (RFC 6763, zeroconf)."""

import socket
from collections.abc import AsyncIterator, Callable, Sequence
from contextlib import AsyncExitStack, asynccontextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final
from urllib.parse import urlsplit

from pioneer3.distribution import how_to_get
from pioneer3.links.hosts import ANY, is_address, is_loopback, machine_address
from pioneer3.links.urls import split_host

if TYPE_CHECKING:
    from zeroconf import ServiceInfo

    from pioneer3.sim.server.running import RunningSimulation

SERVICE: Final = "_pioneer3._tcp.local."
"""Robots' own ports, and pages; the record has the keys `kind`, `model` and `robot`."""
LONGEST_LABEL: Final = 63
"""Longest label of a name in DNS [bytes]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Announcement:
    """A robot's port, or a page without a robot, that others may find at an IP address.

    Its kind is `simulator`, `robot`, `http page` or `https page`.
    """

    robot: str
    kind: str
    model: str
    address: str
    port: int


def of_simulation(running: "RunningSimulation") -> tuple[Announcement, ...]:
    """Return the announcements of simulated robots, by the addresses that others see."""
    places = [(robot, split_host(robot.url)) for robot in running.robots]
    return tuple(
        Announcement(
            robot=robot.name, kind="simulator", model=robot.model.name, address=host, port=port
        )
        for robot, (host, port) in places
        if is_address(host)  # without a network it is this computer's name
    )


def of_page(host: str, url: str) -> tuple[Announcement, ...]:
    """Return the announcement of a page that is served at `host`, on the port of `url`."""
    address = machine_address() if host in ANY else host
    parts = urlsplit(url)
    if not is_address(address) or parts.port is None:
        return ()
    kind = f"{parts.scheme} page"
    return (Announcement(robot="", kind=kind, model="", address=address, port=parts.port),)


@asynccontextmanager
async def announced(
    announcements: Sequence[Announcement], warn: Callable[[str], None]
) -> AsyncIterator[None]:
    """Announce robots and pages during the block; those on loopback are left out.

    Where that is not possible, `warn` is called with the reason, and the block goes on.
    """
    async with AsyncExitStack() as stack:
        try:
            await _announce(announcements, stack)
        except (ImportError, OSError) as error:
            warn(f"not announced in the network: {error}")
        yield


async def _announce(announcements: Sequence[Announcement], stack: AsyncExitStack) -> None:
    """Announce until the end of `stack`; ImportError without the extra, OSError of the network."""
    outside = [one for one in announcements if not is_loopback(one.address)]
    if not outside:
        return
    try:
        from zeroconf import Error
        from zeroconf.asyncio import AsyncZeroconf
    except ImportError:
        raise ImportError(how_to_get("fleet")) from None
    zeroconf = AsyncZeroconf(interfaces=sorted({one.address for one in outside}))
    stack.push_async_callback(zeroconf.async_close)  # takes them back
    try:
        for one in outside:
            await zeroconf.async_register_service(_record(one), allow_name_change=True)
    except Error as error:
        raise OSError(str(error) or type(error).__name__) from error


def _record(one: Announcement) -> "ServiceInfo":
    from zeroconf import ServiceInfo

    host = socket.gethostname().partition(".")[0]
    label = f"{one.robot or one.kind} on {host} {one.port}".replace(".", "-")
    while len(label.encode()) > LONGEST_LABEL:
        label = label[1:]  # the number at the end tells them apart
    return ServiceInfo(
        SERVICE,
        f"{label}.{SERVICE}",
        parsed_addresses=[one.address],
        port=one.port,
        properties={"robot": one.robot, "kind": one.kind, "model": one.model},
        server=f"{host}.local.",
    )
