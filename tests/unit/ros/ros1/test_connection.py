"""A connection to a subscriber never waits; one to a publisher is read in the event loop."""

import asyncio
import socket
from collections.abc import Iterator
from io import BytesIO
from threading import Event
from types import SimpleNamespace
from typing import Any

import pytest

from pioneer3.ros.ros1.connection import DirectConnection, DirectReading

pytestmark = pytest.mark.realtime

PATIENCE = 5.0
LARGE = 1 << 22
"""More than a socket takes at once [bytes]."""


class Transport:
    """The part of a transport of rospy that counts."""

    name = "/pose"

    def __init__(self, connection: socket.socket) -> None:
        self.socket: socket.socket | None = connection
        self.stat_bytes = self.stat_num_msg = 0
        self.closed = Event()

    def close(self) -> None:
        self.closed.set()


@pytest.fixture
def ends() -> Iterator[tuple[socket.socket, socket.socket]]:
    ours, theirs = socket.socketpair()
    with ours, theirs:
        theirs.settimeout(PATIENCE)
        yield ours, theirs


def read(theirs: socket.socket, size: int) -> bytes:
    found = b""
    while len(found) < size:
        found += theirs.recv(1 << 20)
    return found


def test_a_message_is_sent_at_once(ends: tuple[socket.socket, socket.socket]) -> None:
    ours, theirs = ends
    connection = DirectConnection(Transport(ours), 1)
    connection.write_data(b"one")
    connection.write_data(b"two")
    assert theirs.recv(6, socket.MSG_DONTWAIT) == b"onetwo"
    assert (connection.stat_bytes, connection.stat_num_msg) == (6, 2)


def test_of_messages_to_a_slow_subscriber_the_newest_come_whole(
    ends: tuple[socket.socket, socket.socket],
) -> None:
    ours, theirs = ends
    connection = DirectConnection(Transport(ours), 2)
    for number in range(5):
        connection.write_data(bytes([number]) * LARGE)
    came = read(theirs, 3 * LARGE)
    assert came == b"".join(bytes([number]) * LARGE for number in (0, 3, 4))
    connection.write_data(b"next")
    assert read(theirs, 4) == b"next"


def test_a_slow_subscriber_that_leaves_is_closed(
    ends: tuple[socket.socket, socket.socket],
) -> None:
    ours, theirs = ends
    transport = Transport(ours)
    connection = DirectConnection(transport, 1)
    connection.write_data(bytes(LARGE))
    theirs.close()
    assert transport.closed.wait(PATIENCE)
    with pytest.raises(BrokenPipeError):  # so that rospy removes it
        connection.write_data(b"more")


def test_a_lost_connection_raises(ends: tuple[socket.socket, socket.socket]) -> None:
    ours, theirs = ends
    transport = Transport(ours)
    connection = DirectConnection(transport, 1)
    theirs.close()
    with pytest.raises(OSError, match="pipe"):
        connection.write_data(b"one")
    transport.socket = None
    with pytest.raises(OSError, match="closed"):
        connection.write_data(b"one")


class Publisher(Transport):
    """The part of a transport to a publisher that counts; a message is a line."""

    def __init__(self, connection: socket.socket) -> None:
        super().__init__(connection)
        self.header = {"callerid": "/keys"}
        self.read_buff, self.protocol = BytesIO(), self
        self.read_by_rospy = 0

    def read_messages(self, buffer: BytesIO, messages: list[Any], _: socket.socket) -> None:
        *lines, rest = buffer.getvalue().split(b"\n")
        if b"malformed" in lines:
            raise ValueError("malformed")
        messages += [SimpleNamespace(data=line) for line in lines]
        buffer.seek(0)
        buffer.truncate()
        buffer.write(rest)

    def receive_once(self) -> list[Any]:
        self.read_by_rospy += 1
        return []


class Reading:
    """A connection that the loop reads while a thread of rospy's waits."""

    def __init__(self, ours: socket.socket) -> None:
        self.came: asyncio.Queue[bytes] = asyncio.Queue()
        self.transport = Publisher(ours)
        self.reading = DirectReading(self.transport, self.take, asyncio.get_running_loop())
        self.waiting = asyncio.ensure_future(asyncio.to_thread(self.transport.receive_once))

    def take(self, messages: list[Any], transport: Publisher) -> None:
        assert all(message._connection_header is transport.header for message in messages)
        for message in messages:
            self.came.put_nowait(message.data)

    async def next(self) -> bytes:
        async with asyncio.timeout(PATIENCE):
            return await self.came.get()


async def test_messages_come_in_the_loop_until_the_publisher_closes(
    ends: tuple[socket.socket, socket.socket],
) -> None:
    ours, theirs = ends
    the = Reading(ours)
    theirs.send(b"one\ntw")
    assert await the.next() == b"one"
    theirs.send(b"o\nthree\n")
    assert [await the.next(), await the.next()] == [b"two", b"three"]
    assert (the.transport.stat_bytes, the.transport.stat_num_msg) == (14, 3)
    assert not the.waiting.done()
    theirs.close()
    async with asyncio.timeout(PATIENCE):
        await the.waiting
    assert the.transport.read_by_rospy == 1, "rospy finds the end by itself"


async def test_rospy_goes_on_where_it_closes_a_connection(
    ends: tuple[socket.socket, socket.socket],
) -> None:
    the = Reading(ends[0])
    await asyncio.sleep(0.05)
    ends[0].shutdown(socket.SHUT_RDWR)
    ends[0].close()
    the.reading.end()
    async with asyncio.timeout(PATIENCE):
        await the.waiting
    the.transport.receive_once()
    assert the.transport.read_by_rospy == 2


async def test_a_malformed_message_is_left_to_rospy(
    ends: tuple[socket.socket, socket.socket], caplog: pytest.LogCaptureFixture
) -> None:
    the = Reading(ends[0])
    ends[1].send(b"malformed\n")
    async with asyncio.timeout(PATIENCE):
        await the.waiting
    assert the.transport.read_by_rospy == 1
    assert the.transport.read_buff.getvalue() == b"malformed\n"
    assert "malformed" in caplog.text
