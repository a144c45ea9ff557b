"""Connections to subscribers that read at once, late, or not at all."""

import socket
import time
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import pytest

from pioneer3.ros.ros1.outlet import QUEUE, PromptConnection

pytestmark = pytest.mark.realtime
SIZE = 4096
MANY = 2000  # far more than the network keeps
PATIENCE = 20.0


@dataclass
class Transport:
    """What rospy has of a connection."""

    socket: socket.socket | None
    stat_bytes: int = 0
    stat_num_msg: int = 0
    closed: bool = False

    def close(self) -> None:
        self.closed = True


@pytest.fixture
def ends() -> Iterator[tuple[Transport, socket.socket]]:
    """Return a connection and the subscriber's end of it."""
    with (
        socket.create_server(("127.0.0.1", 0)) as server,
        socket.create_connection(server.getsockname()) as theirs,
        server.accept()[0] as ours,
    ):
        ours.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 16384)
        yield Transport(ours), theirs


def message(number: int) -> bytes:
    return number.to_bytes(4, "little") * (SIZE // 4)


def flood(connection: PromptConnection) -> None:
    """Publish more than the network keeps."""
    for number in range(MANY):
        connection.write_data(message(number))


def read(theirs: socket.socket) -> int:
    """Read a whole message; return its number."""
    data = bytearray()
    while len(data) < SIZE:
        piece = theirs.recv(SIZE - len(data))
        assert piece
        data += piece
    number = int.from_bytes(data[:4], "little")
    assert data == message(number)  # none is mixed with another
    return number


def test_who_reads_at_once_gets_everything(ends: tuple[Transport, socket.socket]) -> None:
    transport, theirs = ends
    connection = PromptConnection(transport)
    for number in range(MANY):
        connection.write_data(message(number))
        assert read(theirs) == number
    assert (transport.stat_num_msg, transport.stat_bytes) == (MANY, MANY * SIZE)


def test_who_reads_late_gets_whole_messages_in_order_and_the_newest(
    ends: tuple[Transport, socket.socket],
) -> None:
    transport, theirs = ends
    connection = PromptConnection(transport)
    flood(connection)  # returns although nobody reads
    theirs.settimeout(PATIENCE)
    came = [read(theirs)]
    while came[-1] != MANY - 1:
        came.append(read(theirs))
    assert all(before < after for before, after in pairwise(came))
    assert came[-QUEUE:] == list(range(MANY - QUEUE, MANY))
    assert len(came) < MANY
    began = time.monotonic()
    while connection._relaying:
        assert time.monotonic() - began < PATIENCE
        time.sleep(0.001)
    connection.write_data(message(MANY))
    assert read(theirs) == MANY


def test_a_subscriber_that_goes_is_told_of(ends: tuple[Transport, socket.socket]) -> None:
    transport, theirs = ends
    connection = PromptConnection(transport)
    theirs.close()
    with pytest.raises(OSError, match=r"pipe|reset"):
        flood(connection)


def test_one_that_goes_while_messages_wait_is_closed(
    ends: tuple[Transport, socket.socket],
) -> None:
    transport, theirs = ends
    connection = PromptConnection(transport)
    flood(connection)
    theirs.close()
    began = time.monotonic()
    while not transport.closed:
        assert time.monotonic() - began < PATIENCE
        time.sleep(0.001)


def test_a_closed_connection_is_an_error(ends: tuple[Transport, socket.socket]) -> None:
    transport, _ = ends
    transport.socket = None
    with pytest.raises(OSError, match="closed"):
        PromptConnection(transport).write_data(b"late")
