"""Finds robots, simulators, serial bridges, and computers that may be on robots.

Four ways are gone at once: announcements (zeroconf), the query of the serial bridges, TCP ports of
robots at given addresses, and the greeting of ssh there. Nothing moves; a robot's port that answers
is asked for its name by a short session.
"""

import asyncio
import re
import socket
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from enum import StrEnum
from ipaddress import IPv4Interface, ip_address, ip_network
from typing import TYPE_CHECKING, Final

from pioneer3.doctor.probe import ProbeVerdict, probe
from pioneer3.errors import ConfigError
from pioneer3.fleet.announce import SERVICE
from pioneer3.fleet.spec import Fleet
from pioneer3.fleet.ssh_settings import SSH_PORT
from pioneer3.links.hosts import bracketed
from pioneer3.models import find_model
from pioneer3.names import printable

if TYPE_CHECKING:
    from zeroconf import Zeroconf

SSH: Final = "_ssh._tcp.local."
ROBOT_PORTS: Final = range(8101, 8121)
BRIDGE_PORT: Final = 30718
"""Port of the serial bridges on Pioneer robots, by Lantronix (protocol.md 1.1)."""
BRIDGE_QUERY: Final = b"\x00\x00\x00\xf6"
"""Query for Firmware Version (Lantronix UDS-10 User Guide, 8.1)."""
BRIDGE_ANSWER: Final = 0xF7
"""Fourth byte of the answer, Firmware Information."""
ROBOT_MARK: Final = b"\xfa\xfb"
"""Bytes 8 and 9 of the answer of a simulator in the place of a robot (protocol.md 1.1)."""
MOST_ADDRESSES: Final = 1024
AT_ONCE: Final = 128
"""Connections that are tried side by side."""


class FindingKind(StrEnum):
    """Kinds of findings."""

    ROBOT = "robot"
    SIMULATOR = "simulator"
    BRIDGE = "serial bridge"
    COMPUTER = "computer"
    PAGE = "page"


@dataclass(frozen=True, slots=True, kw_only=True)
class Found:
    """Something on the network; its name and model are empty if it told none.

    It has the TCP port of a robot, `None` for a computer, or a bridge whose port is unknown.
    """

    kind: FindingKind
    address: str
    port: int | None = None
    name: str = ""
    detail: str = ""
    model: str = ""


def addresses_in(words: Iterable[str]) -> tuple[str, ...]:
    """Return the addresses in words as `192.168.1.0/24`; ConfigError for others, or too many."""
    found: dict[str, None] = {}
    for word in words:
        try:
            network = ip_network(word, strict=False)
        except ValueError:
            raise ConfigError(
                f"{word!r}: expected an address or a network, as 192.168.1.113 or 192.168.1.0/24"
            ) from None
        if network.num_addresses > MOST_ADDRESSES:
            raise ConfigError(f"{word}: {network.num_addresses} addresses; ask for a part of it")
        found.update((str(host), None) for host in network.hosts())
    return tuple(found)


async def discover(
    addresses: Sequence[str] = (), *, seconds: float = 2.0, broadcast: bool = True
) -> tuple[Found, ...]:
    """Return all that is found, by address and port.

    Ports are tried at the addresses, and with `broadcast` all of the network are asked, by zeroconf
    and the bridges' query. Answers, and each connection, are waited for so long [s].
    """
    broadcasts = await asyncio.to_thread(broadcast_addresses) if broadcast else ()
    ways = [
        _bridges((*broadcasts, *addresses), seconds),
        *([_announcements(seconds)] if broadcast else []),  # they know the robots' names
        _ports(addresses, seconds),
    ]
    found: dict[tuple[str, int | FindingKind], Found] = {}
    for way in await asyncio.gather(*ways):
        for one in way:
            key = (one.address, one.port or one.kind)
            if (old := found.get(key)) is None or (one.detail and not old.detail):
                found[key] = one
    known = {one.address for one in found.values() if one.port is not None}
    # a bridge without a port is the computer of the port that was found there
    kept = [
        one
        for one in found.values()
        if not (one.kind is FindingKind.BRIDGE and one.address in known)
    ]
    return tuple(sorted(kept, key=lambda one: (ip_address(one.address).packed, one.port or 0)))


def broadcast_addresses() -> tuple[str, ...]:
    """Return the broadcast address of each network that this computer is in."""
    try:
        import ifaddr
    except ImportError:  # it comes with zeroconf
        return ()
    return tuple(
        str(interface.network.broadcast_address)
        for adapter in ifaddr.get_adapters()
        for ip in adapter.ips
        if isinstance(ip.ip, str)
        for interface in [IPv4Interface(f"{ip.ip}/{ip.network_prefix}")]
        if not interface.is_loopback and interface.network.prefixlen < 31
    )


class _BridgeAnswers(asyncio.DatagramProtocol):
    """Collects the answers of bridges, by their addresses."""

    def __init__(self) -> None:
        self.found: dict[str, Found] = {}

    def datagram_received(self, data: bytes, addr: tuple[str, int]) -> None:
        """Keep an answer; our own query, which a broadcast brings back, is none."""
        if (found := bridge_answer(data, addr[0])) is not None:
            self.found[addr[0]] = found


def bridge_answer(data: bytes, address: str) -> Found | None:
    """Return the bridge that an answer is of; `None` for other bytes."""
    if len(data) < 4 or data[:3] != b"\0\0\0" or data[3] != BRIDGE_ANSWER:
        return None
    is_robot = data[8:10] == ROBOT_MARK
    detail = "says that a robot is behind it" if is_robot else "its device is not told"
    return Found(kind=FindingKind.BRIDGE, address=address, detail=detail)


async def _bridges(targets: Sequence[str], seconds: float) -> list[Found]:
    loop = asyncio.get_running_loop()
    try:
        transport, answers = await loop.create_datagram_endpoint(
            _BridgeAnswers, family=socket.AF_INET, allow_broadcast=True, local_addr=("0.0.0.0", 0)
        )
    except OSError:
        return []
    try:
        for _ in range(2):  # a datagram may be lost
            for target in targets:
                if ip_address(target).version == 4:
                    transport.sendto(BRIDGE_QUERY, (target, BRIDGE_PORT))
            await asyncio.sleep(seconds / 2)
    finally:
        transport.close()
    return list(answers.found.values())


async def _ports(addresses: Sequence[str], seconds: float) -> list[Found]:
    """Try the ports of robots and ssh at all addresses, some at a time."""
    gate = asyncio.Semaphore(AT_ONCE)

    async def tried(address: str, port: int) -> Found | None:
        async with gate:
            if port == SSH_PORT:
                return await _computer(address, seconds)
            return await _robot(address, port, seconds)

    tries = [tried(address, port) for address in addresses for port in (SSH_PORT, *ROBOT_PORTS)]
    return [one for one in await asyncio.gather(*tries) if one is not None]


async def _computer(address: str, seconds: float) -> Found | None:
    writer = None
    try:
        async with asyncio.timeout(seconds):
            reader, writer = await asyncio.open_connection(address, SSH_PORT)
            line = await reader.readline()
    except (OSError, TimeoutError, ValueError):
        return None
    finally:
        if writer is not None:
            writer.transport.abort()
    banner = line.decode("ascii", "replace").strip()
    if not banner.startswith("SSH-") or not banner.isprintable():
        return None
    return Found(kind=FindingKind.COMPUTER, address=address, detail=banner.split("-", 2)[-1][:60])


async def _robot(address: str, port: int, seconds: float) -> Found | None:
    """Ask a port that is open for the robot behind it."""
    try:
        async with asyncio.timeout(seconds):
            _, writer = await asyncio.open_connection(address, port)
    except (OSError, TimeoutError):
        return None
    writer.transport.abort()
    result = await probe(f"tcp://{bracketed(address)}:{port}")
    match result.verdict:
        case ProbeVerdict.ROBOT | ProbeVerdict.SIMULATOR if result.info is not None:
            is_robot, info = result.verdict is ProbeVerdict.ROBOT, result.info
            return Found(
                kind=FindingKind.ROBOT if is_robot else FindingKind.SIMULATOR,
                address=address,
                port=port,
                name=info.identity.name,
                detail=info.model.title,
                model=info.model.name,
            )
        case ProbeVerdict.BUSY:
            detail = "its port is busy: another program may have it"
            return Found(kind=FindingKind.ROBOT, address=address, port=port, detail=detail)
    return None


async def _announcements(seconds: float) -> list[Found]:
    """Collect announcements; nothing where zeroconf is missing, or there is no network."""
    try:
        from zeroconf import ServiceStateChange
        from zeroconf.asyncio import AsyncServiceBrowser, AsyncServiceInfo, AsyncZeroconf
    except ImportError:
        return []
    names: dict[str, str] = {}

    def note(zeroconf: "Zeroconf", service_type: str, name: str, state_change: object) -> None:
        if state_change is ServiceStateChange.Added:
            names[name] = service_type

    try:
        zeroconf = AsyncZeroconf()
    except OSError:
        return []
    found: list[Found] = []
    try:
        browser = AsyncServiceBrowser(zeroconf.zeroconf, [SERVICE, SSH], handlers=[note])
        await asyncio.sleep(seconds)
        await browser.async_cancel()
        for name, kind in names.items():
            info = AsyncServiceInfo(kind, name)
            if await info.async_request(zeroconf.zeroconf, 1000 * seconds):
                told = {
                    key.decode(errors="replace"): (value or b"").decode(errors="replace")
                    for key, value in info.properties.items()
                }
                host = (info.server or "").partition(".")[0]
                for address in info.parsed_addresses():
                    found += _announced(kind, address, info.port, told, host)
    finally:
        with suppress(OSError):
            await zeroconf.async_close()
    return found


def _announced(
    service: str, address: str, port: int | None, told: dict[str, str], host: str
) -> Iterator[Found]:
    texts = [text for text in (*told.values(), host) if not text.isprintable()]
    if texts:  # it came over the network
        return
    if service == SSH:
        yield Found(kind=FindingKind.COMPUTER, address=address, name=host, detail="announces ssh")
        return
    if told.get("kind", "").endswith("page"):
        where = f"its robots at {told['kind'].partition(' ')[0]}://{bracketed(address)}:{port}"
        yield Found(kind=FindingKind.PAGE, address=address, name=host, detail=where)
        return
    kind = FindingKind.SIMULATOR if told.get("kind") == FindingKind.SIMULATOR else FindingKind.ROBOT
    yield Found(
        kind=kind,
        address=address,
        port=port,
        name=told.get("robot", ""),
        detail=f"announced by {host}",
        model=told.get("model", ""),
    )


_NOT_IN_NAMES = re.compile(r"[^A-Za-z0-9]+")


def offers(found: Sequence[Found], fleet: Fleet | None) -> Iterator[str]:
    """Yield lines of a fleet file: a robot for each address that the fleet does not have yet.

    A row is one on-board computer, so of several robots at one address the first gets the row.
    """
    known = set(fleet.addresses.values()) if fleet else set()
    known |= {robot.address for robot in fleet.robots} if fleet else set()
    names = {robot.name.lower() for robot in fleet.robots} if fleet else set()
    for address in dict.fromkeys(one.address for one in found if one.address not in known):
        here = [one for one in found if one.address == address]
        ports = [one for one in here if one.port is not None]
        best = (ports or here)[0]
        name = _name(here, address, names)
        names.add(name.lower())
        yield ""
        for one in here:
            where = f" at port {one.port}" if one.port else ""
            told = printable(one.detail or one.name)
            yield f"# {one.kind}{where}: {told}"
        yield "[[robot]]"
        yield f'name = "{name}"'
        yield f'address = "{address}"'
        if best.port is not None:
            yield f'port = "tcp://{bracketed(address)}:{best.port}"'
        if best.model and find_model(best.model) is not None:
            yield f'model = "{best.model.strip()}"'


def _name(here: Sequence[Found], address: str, taken: set[str]) -> str:
    """Return a name that no other robot has: that of its computer, else one by its address."""
    told = next((one.name for one in here if one.name and one.kind is not FindingKind.ROBOT), "")
    usual = f"robot-{re.split(r'[.:]', address)[-1]}"
    made = _host_name(told) or _host_name(usual)
    name, number = made, 1
    while name.lower() in taken | {"all", "localhost"}:
        number += 1
        name = f"{made}-{number}"
    return name


def _host_name(text: str) -> str:
    """Return the part of a text that may be a host name."""
    return _NOT_IN_NAMES.sub("-", text).strip("-")[:40].strip("-")
