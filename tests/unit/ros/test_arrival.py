"""When data arrived at this computer."""

import socket
import time
from collections.abc import Iterator
from types import SimpleNamespace

import pytest

from pioneer3.ros.ros1.arrivals import LONGEST, Arrivals, NotingSocket

pytestmark = pytest.mark.realtime


@pytest.fixture
def pair() -> Iterator[tuple[socket.socket, socket.socket]]:
    """Return both ends of a connection."""
    with (
        socket.create_server(("127.0.0.1", 0)) as server,
        socket.create_connection(server.getsockname()) as theirs,
        server.accept()[0] as ours,
    ):
        yield ours, theirs


def test_data_that_waited_is_as_old_as_that(pair: tuple[socket.socket, socket.socket]) -> None:
    ours, theirs = pair
    noting = NotingSocket(ours)
    assert noting.age() == 0.0
    ages = []
    for _ in range(20):  # the kernel begins to note times a moment after the first to ask for them
        theirs.send(b"abc")
        time.sleep(0.01)
        assert noting.recv(100) == b"abc"
        ages.append(noting.age())
    assert 0.01 <= max(ages) <= LONGEST


def test_the_end_of_a_connection_has_no_age(pair: tuple[socket.socket, socket.socket]) -> None:
    ours, theirs = pair
    noting = NotingSocket(ours)
    theirs.close()
    assert noting.recv(100) == b""
    assert noting.age() == 0.0
    assert noting.fileno() == ours.fileno()


def test_the_connection_of_a_message_is_found(pair: tuple[socket.socket, socket.socket]) -> None:
    ours, theirs = pair
    header = {"callerid": "/rob_key"}
    connection = SimpleNamespace(header=header, socket=ours)
    other = SimpleNamespace(header=dict(header), socket=theirs)
    topic = SimpleNamespace(connections=[other, connection])
    arrivals = Arrivals(SimpleNamespace(impl=topic))
    message = SimpleNamespace(_connection_header=header)
    assert arrivals.age(message) == 0.0
    assert isinstance(connection.socket, NotingSocket)
    assert other.socket is theirs
    ages = []
    for _ in range(20):  # the kernel begins to note times a moment after the first to ask for them
        theirs.send(b"abc")
        time.sleep(0.01)
        connection.socket.recv(100)
        ages.append(arrivals.age(message))
    assert max(ages) >= 0.01
    assert arrivals.age(SimpleNamespace(_connection_header={})) == 0.0
