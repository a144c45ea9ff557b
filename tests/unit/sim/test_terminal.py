"""Simulated devices at a real pseudo terminal whose host pauses."""

import asyncio
import os
from collections.abc import AsyncIterator
from io import FileIO

import pytest

from pioneer3.links.serial import PtyPair, make_pty
from pioneer3.sim.server import clients
from pioneer3.sim.server.clients import HostConnection, PtyClient

pytestmark = pytest.mark.realtime
MESSAGE = 700
"""Length of a message [bytes]; no part of the terminal's buffers is a multiple of it."""


class Robot:
    """The handler of a terminal; it is never asked anything."""

    def received(self, client: HostConnection, data: bytes) -> None:
        pass

    def disconnected(self, client: HostConnection) -> None:
        pass


class Line:
    """A terminal: the device at one end sends numbered messages, the test reads the other."""

    def __init__(self, pair: PtyPair) -> None:
        self.slave = pair.slave
        os.set_blocking(pair.slave, False)
        os.set_blocking(pair.master, False)
        self.client = PtyClient(Robot(), FileIO(pair.master, "r+"), pair.path, pair.slave)
        self.sent = 0
        self.heard = b""

    def send(self, count: int) -> None:
        """Let the device send so many messages."""
        for _ in range(count):
            self.client.send(f"{self.sent:06}".encode().ljust(MESSAGE - 1, b".") + b"\n")
            self.sent += 1

    async def read(self) -> None:
        """Read all that has come."""
        while True:
            await asyncio.sleep(0.02)  # the kernel hands it over in pieces
            try:
                self.heard += os.read(self.slave, 65536)
            except BlockingIOError:
                return

    @property
    def numbers(self) -> list[int]:
        """The messages that the host has got; it is an error if one is not whole."""
        messages = self.heard.splitlines()
        assert {len(message) for message in messages} == {MESSAGE - 1}
        return [int(message.rstrip(b".")) for message in messages]

    def close(self) -> None:
        self.client.remove()
        os.close(self.slave)


@pytest.fixture
async def line() -> AsyncIterator[Line]:
    line = Line(make_pty())
    yield line
    line.close()


async def test_a_host_that_pauses_finds_each_message_whole_or_not_at_all(line: Line) -> None:
    for _ in range(3):
        line.send(100)
        assert line.client.full
        await line.read()
        assert not line.client.full
        await line.read()
    line.send(1)
    await line.read()
    numbers = line.numbers
    assert len(numbers) > 10
    assert numbers == sorted(set(numbers))
    assert numbers[:5] == [0, 1, 2, 3, 4]
    assert numbers[-1] == 300


async def test_a_slow_reader_is_a_host(line: Line, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(clients, "UNREAD", 0.1)
    for _ in range(20):
        line.send(30)
        await asyncio.sleep(0.05)
        line.heard += os.read(line.slave, 2 * MESSAGE)
    line.send(1)
    await line.read()
    assert not line.client.full
    await line.read()
    assert len(line.numbers) > 20


async def test_a_terminal_that_nobody_reads_holds_nothing_back(
    line: Line, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(clients, "UNREAD", 0.05)
    line.send(100)
    for _ in range(5):
        await asyncio.sleep(0.05)
        line.send(1)
    assert not line.client.full
