"""Questions to a ROS 1 graph without ROS: is a node there, and the next message on its topic.

A program of rospy knows one master; robots with a roscore each have several. The master and the
nodes speak XML-RPC (https://wiki.ros.org/ROS/Master_API, https://wiki.ros.org/ROS/Slave_API), a
topic comes over TCP (https://wiki.ros.org/ROS/TCPROS). Nothing is registered or published.
"""

import asyncio
from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass
from struct import pack, unpack
from typing import Final
from urllib.parse import urlsplit
from xml.parsers.expat import ExpatError
from xmlrpc.client import Error, dumps, loads

from pioneer3.errors import LinkError
from pioneer3.fleet.spec import Fleet
from pioneer3.links.hosts import address_towards, bracketed, is_address, is_loopback

MASTER_PORT: Final = 11311
CALLER: Final = "/pioneer3_fleet"
LARGEST_ANSWER: Final = 1 << 20
"""Largest answer of a master or node, and message on a topic [bytes]."""


class RosGraphError(LinkError):
    """A master or node does not answer as one."""


@dataclass(frozen=True, slots=True)
class NodeAddress:
    """Where a master or a node listens."""

    host: str
    port: int

    @classmethod
    def of(cls, uri: str) -> "NodeAddress":
        """Return the place in a URI such as `http://p3at-1:11311/`; RosGraphError for none."""
        try:
            parts = urlsplit(uri)
            host, port = parts.hostname, parts.port or MASTER_PORT
        except ValueError:
            host, port = None, 0
        if not host:
            raise RosGraphError(f"{uri!r} is no address of a ROS node")
        return cls(host, port)


@dataclass(frozen=True, slots=True)
class MasterGraph:
    """A master, and how the hosts that nodes name are reached.

    A node tells its host's name, which this computer need not know: its address is that of the name
    in lower case, or else the fallback.
    """

    master: NodeAddress
    addresses: Mapping[str, str]
    fallback: str

    async def node(self, name: str) -> NodeAddress | None:
        """Return where a node listens; `None` if the master knows none of that name.

        Raises:
            RosGraphError: The master answers nonsense.
            OSError: It cannot be reached.
        """
        code, _, uri = await _call(self.master, "lookupNode", CALLER, name)
        return self._reached(NodeAddress.of(str(uri))) if code == 1 else None

    async def answers(self, node: NodeAddress) -> bool:
        """Whether a node is alive: a master goes on to list those that were killed."""
        try:
            code, *_ = await _call(node, "getPid", CALLER)
        except (OSError, EOFError):
            return False
        return code == 1

    async def message(self, node: NodeAddress, topic: str, kind: str) -> bytes:
        """Return the next message, or the latched one, that a node publishes on `topic`.

        Raises:
            RosGraphError: The node does not publish it.
            OSError: It cannot be reached.
        """
        code, said, place = await _call(node, "requestTopic", CALLER, topic, [["TCPROS"]])
        match place:
            case ["TCPROS", str(host), int(port)] if code == 1:
                source = self._reached(NodeAddress(host, port))
            case _:
                raise RosGraphError(f"{topic}: {said}")
        fields = {"callerid": CALLER, "topic": topic, "type": kind, "md5sum": "*"}
        entries = [f"{key}={value}".encode() for key, value in fields.items()]
        header = b"".join(pack("<I", len(entry)) + entry for entry in entries)
        async with _connected(source) as (reader, writer):
            writer.write(pack("<I", len(header)) + header)
            await writer.drain()
            if b"error=" in (answer := await _block(reader)):
                raise RosGraphError(f"{topic}: {answer.decode(errors='replace')}")
            return await _block(reader)

    def _reached(self, endpoint: NodeAddress) -> NodeAddress:
        """Return the same place with an address of this network."""
        host = endpoint.host.lower()
        if is_loopback(host):
            host = self.master.host
        elif not is_address(host):
            host = self.addresses.get(host, self.fallback)
        return NodeAddress(host, endpoint.port)


async def _call(
    place: NodeAddress, method: str, *arguments: str | list[list[str]]
) -> tuple[int, str, object]:
    """Return code, text and value of a call; RosGraphError if they are none of ROS, or OSError."""
    body = dumps(arguments, method).encode()
    request = (
        f"POST /RPC2 HTTP/1.0\r\nHost: {place.host}:{place.port}\r\n"
        f"Content-Type: text/xml\r\nContent-Length: {len(body)}\r\n\r\n"
    )
    async with _connected(place) as (reader, writer):
        writer.write(request.encode() + body)
        await writer.drain()
        try:
            head = (await reader.readuntil(b"\r\n\r\n")).decode("latin-1").lower()
            length = int(head.partition("content-length:")[2].split()[0])
            text = await reader.readexactly(min(length, LARGEST_ANSWER))
            (answer,), _ = loads(text)
        except (
            ValueError,
            IndexError,
            EOFError,
            ExpatError,
            Error,
            asyncio.LimitOverrunError,
        ) as error:
            raise RosGraphError(f"{place.host}:{place.port} is no ROS master or node") from error
    match answer:
        case [int(code), str(said), value]:
            return code, said, value
    raise RosGraphError(f"{place.host}:{place.port} does not answer {method} as ROS does")


@asynccontextmanager
async def _connected(
    place: NodeAddress,
) -> AsyncIterator[tuple[asyncio.StreamReader, asyncio.StreamWriter]]:
    """Connect for the block; leaving it waits for nobody."""
    reader, writer = await asyncio.open_connection(place.host, place.port)
    try:
        yield reader, writer
    finally:
        writer.transport.abort()


async def _block(reader: asyncio.StreamReader) -> bytes:
    """Return the next length and its bytes; RosGraphError at the end, or for too many."""
    try:
        (length,) = unpack("<I", await reader.readexactly(4))
        if length > LARGEST_ANSWER:
            raise RosGraphError("not a connection of ROS")
        return await reader.readexactly(length)
    except EOFError:
        raise RosGraphError("the node hung up") from None


MASTER: Final = "ROS_MASTER_URI"
OWN_ADDRESS: Final = ("ROS_IP", "ROS_HOSTNAME")


def master_of(fleet: Fleet) -> str:
    """Return the URI of the fleet's master, which runs at the operator's computer."""
    host = fleet.operator.address or "localhost"
    return f"http://{bracketed(host)}:{MASTER_PORT}"


def missing_variables(fleet: Fleet, environment: Mapping[str, str]) -> dict[str, str]:
    """Return the variables that programs on this computer need, and `environment` lacks.

    Robots reach a program at the address that it tells the master. This is the one from which this
    computer reaches the robots; its host name may mean another one, or be unknown to them.
    """
    found: dict[str, str] = {}
    robots = [robot for robot in fleet.robots if robot.ros == "1"]
    if not robots:
        return found
    if not environment.get(MASTER):
        found[MASTER] = master_of(fleet)
    if not any(environment.get(name) for name in OWN_ADDRESS):
        with suppress(OSError):  # no network leads there
            found[OWN_ADDRESS[0]] = address_towards(robots[0].address)
    return found
