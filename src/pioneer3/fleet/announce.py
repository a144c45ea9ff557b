"""Robots that listen beyond this computer announce themselves by DNS-SD (RFC 6763, zeroconf)."""

import socket
from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager
from dataclasses import dataclass
from ipaddress import ip_address
from typing import TYPE_CHECKING, Final

from pioneer3.errors import how_to_get
from pioneer3.links.urls import split_host

if TYPE_CHECKING:
    from zeroconf import ServiceInfo

    from pioneer3.sim.server.running import RunningSimulation

SERVICE: Final = "_pioneer3._tcp.local."
"""Robots' own ports; the record has the keys `kind`, `model` and `robot`."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Announcement:
    """A robot's port that others may find.

    Attributes:
        robot: Its name.
        kind: `simulator` or `robot`.
        model: Name of its type.
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


def _is_address(host: str) -> bool:
    """Whether it is an address; without a network it is this computer's name."""
    try:
        ip_address(host)
    except ValueError:
        return False
    return True


@asynccontextmanager
async def announced(announcements: Sequence[Announcement]) -> AsyncIterator[None]:
    """Announce robots during the block; those on loopback are left out.

    Raises:
        ImportError: The extra `fleet` is missing.
        OSError: There is no network.
    """
    outside = [one for one in announcements if not ip_address(one.address).is_loopback]
    if not outside:
        yield
        return
    try:
        from zeroconf.asyncio import AsyncZeroconf
    except ImportError:
        raise ImportError(how_to_get("fleet")) from None
    zeroconf = AsyncZeroconf(interfaces=sorted({one.address for one in outside}))
    try:
        for one in outside:
            await zeroconf.async_register_service(_record(one), allow_name_change=True)
        yield
    finally:
        await zeroconf.async_close()  # takes them back


def _record(one: Announcement) -> "ServiceInfo":
    from zeroconf import ServiceInfo

    host = socket.gethostname().partition(".")[0]
    label = f"{one.robot} on {host} {one.port}".replace(".", "-")[:63]
    return ServiceInfo(
        SERVICE,
        f"{label}.{SERVICE}",
        parsed_addresses=[one.address],
        port=one.port,
        properties={"robot": one.robot, "kind": one.kind, "model": one.model},
        server=f"{host}.local.",
    )
