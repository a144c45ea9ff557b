"""A connection to a subscriber never waits, and keeps the newest messages of a slow one."""

import socket
from collections.abc import Iterator
from threading import Event

import pytest

from pioneer3.ros.ros1.connection import DirectConnection

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
