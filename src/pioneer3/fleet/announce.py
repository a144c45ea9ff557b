"""Robots and pages that others reach are announced by DNS-SD (RFC 6763, zeroconf)."""

import socket
from collections.abc import AsyncIterator, Callable, Sequence
from contextlib import AsyncExitStack, asynccontextmanager
from dataclasses import dataclass
from ipaddress import ip_address
from typing import TYPE_CHECKING, Final
from urllib.parse import urlsplit

from pioneer3.errors import how_to_get
from pioneer3.links.urls import ANY, machine_address, split_host

if TYPE_CHECKING:
    from zeroconf import ServiceInfo

    from pioneer3.sim.server.running import RunningSimulation

SERVICE: Final = "_pioneer3._tcp.local."
"""Robots' own ports, and pages; the record has the keys `kind`, `model` and `robot`."""
LONGEST_LABEL: Final = 63
"""Longest label of a name in DNS [bytes]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Announcement:
    """A robot's port, or a page, that others may find.

    Attributes:
        robot: Its name; empty for a page.
        kind: `simulator`, `robot`, `http page` or `https page`.
        model: Name of the robot's type.
        address: IP address.
        port: TCP port.
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
            robot=robot.name,
            kind="simulator",
            model=robot.model.name,
            address=host,
            port=port,
        )
        for robot, (host, port) in places
        if _is_address(host)
    )


def of_page(host: str, url: str) -> tuple[Announcement, ...]:
    """Return the announcement of a page of robots.

    Args:
        host: Address that it is served at.
        url: One of its addresses, for the port.
    """
    address = machine_address() if host in ANY else host
    parts = urlsplit(url)
    if not _is_address(address) or parts.port is None:
        return ()
    kind = f"{parts.scheme} page"
    return (Announcement(robot="", kind=kind, model="", address=address, port=parts.port),)


def _is_address(host: str) -> bool:
    """Whether it is an address; without a network it is this computer's name."""
    try:
        ip_address(host)
    except ValueError:
        return False
    return True


@asynccontextmanager
async def announced(
    announcements: Sequence[Announcement], warn: Callable[[str], None]
) -> AsyncIterator[None]:
    """Announce robots and pages during the block; those on loopback are left out.

    Args:
        announcements: Of all of them.
        warn: Called with the reason where it is not possible; the block goes on.
    """
    async with AsyncExitStack() as stack:
        try:
            await _announce(announcements, stack)
        except (ImportError, OSError) as error:
            warn(f"not announced in the network: {error}")
        yield


async def _announce(announcements: Sequence[Announcement], stack: AsyncExitStack) -> None:
    """Announce until the end of `stack`.

    Raises:
        ImportError: The extra `fleet` is missing.
        OSError: The network does not allow it.
    """
    outside = [one for one in announcements if not ip_address(one.address).is_loopback]
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
