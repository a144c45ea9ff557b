"""What is asked of the operating system for a connection."""

import socket

import pytest

from pioneer3.links.stream import KEEPALIVE, tune


@pytest.fixture
def connection() -> socket.socket:
    return socket.socket()


def test_small_packets_go_at_once_and_a_dead_far_end_is_noticed(connection: socket.socket) -> None:
    with connection:
        tune(connection)
        assert connection.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY)
        assert connection.getsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE)
        for name, value in KEEPALIVE.items():
            assert connection.getsockopt(socket.IPPROTO_TCP, getattr(socket, name)) == value


def test_what_a_system_does_not_know_is_left_out(
    connection: socket.socket, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in KEEPALIVE:
        monkeypatch.delattr(socket, name)
    with connection:
        tune(connection)
        assert connection.getsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE)
