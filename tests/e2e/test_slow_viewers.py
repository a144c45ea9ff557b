"""Viewers that read nothing, over real sockets: they delay nobody, and little is kept for them."""

import asyncio
import json
import re
import socket
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from urllib.parse import urlsplit

import numpy as np
import pytest
from websockets.asyncio.client import ClientConnection, connect

from pioneer3 import connect_async
from pioneer3.maps import LineMap
from pioneer3.web import client
from pioneer3.web.page import Page
from pioneer3.web.scene import RobotScene
from pioneer3.web.server import serve
from pioneer3.web.websocket import BoundedWebSocket
from tests.support import SimulatedRobot, until

pytestmark = pytest.mark.realtime

PATIENCE = 20.0
STALLED = 6
MAP = LineMap(name="large", walls=np.arange(16_000.0).reshape(-1, 4))
"""So large that who reads nothing is stuck in the first message."""
SEQUENCE = re.compile(rb'"sequence":(\d+)')
UPGRADE = (
    "GET /ws HTTP/1.1\r\nHost: {}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
    "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n"
)


@asynccontextmanager
async def served() -> AsyncIterator[tuple[SimulatedRobot, Page, str]]:
    """Serve a robot in a large map; yield it, its page, and `host:port`."""
    page = Page()
    async with (
        SimulatedRobot() as sim,
        connect_async(sim.open) as robot,
        page.hosting(robot, RobotScene(MAP)),
        serve(page, port=0) as at,
    ):
        yield sim, page, urlsplit(at.http).netloc


async def stall(where: str) -> socket.socket:
    """Open a viewer that never reads, not even the answer to its first request."""
    host, port = where.split(":")
    viewer = socket.socket()
    viewer.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    viewer.setblocking(False)
    loop = asyncio.get_running_loop()
    await loop.sock_connect(viewer, (host, int(port)))
    await loop.sock_sendall(viewer, UPGRADE.format(where).encode())
    return viewer


async def snapshots(page: ClientConnection) -> AsyncIterator[int]:
    """Yield the sequence number of every snapshot."""
    async for text in page:
        message = json.loads(text)
        if message["type"] == "robots":
            for snapshot in message["snapshots"]:
                yield snapshot["sequence"]


@pytest.fixture
def sockets(monkeypatch: pytest.MonkeyPatch) -> list[BoundedWebSocket]:
    """Collect the server's sides of all WebSockets, and lose patience soon."""
    seen: list[BoundedWebSocket] = []
    made = BoundedWebSocket.connection_made

    def note(self: BoundedWebSocket, transport: asyncio.BaseTransport) -> None:
        seen.append(self)
        made(self, transport)

    monkeypatch.setattr(BoundedWebSocket, "connection_made", note)
    monkeypatch.setattr(client, "PATIENCE", 3.0)
    return seen


async def test_viewers_that_read_nothing_delay_nobody_and_cost_no_more_than_a_message(
    sockets: list[BoundedWebSocket],
) -> None:
    async with served() as (sim, page, where), connect(f"ws://{where}/ws") as ann:
        stalled = [await stall(where) for _ in range(STALLED)]
        seen: list[int] = []
        piled_up = 0
        async with asyncio.timeout(PATIENCE):
            async for sequence in snapshots(ann):
                seen.append(sequence)
                await ann.send('{"type":"drive","v":0.3,"w":0}')
                piled_up = max(piled_up, *(_waiting(one) for one in sockets))
                if len(seen) == 20:
                    break
        assert len(page.clients.connected) == 1 + STALLED
        assert seen == list(range(seen[0], seen[0] + 20))
        assert page.robots[1].robot.snapshot is not None
        assert page.robots[1].robot.snapshot.sequence - seen[-1] <= 1
        assert sim.speed > 0.25
        longest = max(len(text) for text in page.audiences.first.retained.since(0))
        assert 50_000 < piled_up <= longest + 100
        for one in stalled:
            one.close()


async def test_a_viewer_that_reads_nothing_is_sent_away_and_its_buffer_is_freed(
    sockets: list[BoundedWebSocket],
) -> None:
    async with served() as (_, page, where):
        with await stall(where) as viewer:
            await until(lambda: sockets and _waiting(sockets[0]))
            await until(lambda: not page.clients.connected and not _waiting(sockets[0]))
            async with asyncio.timeout(PATIENCE):
                loop, gone = asyncio.get_running_loop(), False
                while not gone:
                    try:
                        gone = await loop.sock_recv(viewer, 65_536) == b""
                    except ConnectionResetError:
                        gone = True


async def test_a_viewer_that_wakes_up_in_time_goes_on_with_the_newest(
    sockets: list[BoundedWebSocket],
) -> None:
    async with served() as (_, page, where):
        robot = page.robots[1].robot
        with await stall(where) as viewer:
            await until(lambda: sockets and _waiting(sockets[0]))
            assert robot.snapshot is not None
            asleep = robot.snapshot.sequence
            await until(lambda: robot.snapshot and robot.snapshot.sequence >= asleep + 10)
            read = b""
            async with asyncio.timeout(PATIENCE):
                while len(seen := [int(n) for n in SEQUENCE.findall(read)]) < 5:
                    read += await asyncio.get_running_loop().sock_recv(viewer, 65_536)
        assert seen[0] >= asleep + 10
        assert seen == list(range(seen[0], seen[0] + len(seen)))
        assert len(page.clients.connected) == 1


def _waiting(one: BoundedWebSocket) -> int:
    return one.transport.get_write_buffer_size()
