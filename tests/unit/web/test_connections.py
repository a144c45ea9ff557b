"""Who keeps a connection to the page when there are too many, over real sockets."""

import asyncio
import errno
import socket
from collections.abc import AsyncIterator
from contextlib import ExitStack, asynccontextmanager
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from websockets.asyncio.client import connect
from websockets.exceptions import InvalidStatus

from pioneer3 import connect_async
from pioneer3.web import connections
from pioneer3.web.access import certificate
from pioneer3.web.connections import (
    KEPT_BACK,
    Acceptor,
    ConnectionLimits,
    ConnectionPhase,
    ConnectionPool,
    HttpConnection,
)
from pioneer3.web.page import Page
from pioneer3.web.scene import RobotScene
from pioneer3.web.server import serve
from tests.support import SimulatedRobot, until

ROOM = 128
"""Files that the server may open: 32 connections, and 64 WebSockets."""
PATIENCE = 20.0


@asynccontextmanager
async def served(cert: certificate.Certificate | None = None) -> AsyncIterator[tuple[Page, str]]:
    """Serve the page of a robot to few; yield it, and `host:port` of http, or https."""
    page = Page()
    async with (
        SimulatedRobot() as sim,
        connect_async(sim.open) as robot,
        page.hosting(robot, RobotScene()),
        serve(page, port=0, certificate=cert) as at,
    ):
        yield page, urlsplit(at.https if cert and at.https else at.http).netloc


@pytest.fixture
def _few_files(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(connections, "spare_files", lambda: KEPT_BACK + ROOM)


def dial(where: str, words: bytes = b"") -> socket.socket:
    """Return a connection that has said `words`."""
    host, port = where.split(":")
    caller = socket.create_connection((host, int(port)))
    caller.setblocking(False)
    caller.sendall(words)
    return caller


def is_closed(caller: socket.socket) -> bool:
    """Whether the server has closed it."""
    try:
        return caller.recv(65_536, socket.MSG_PEEK) == b""
    except BlockingIOError:
        return False
    except ConnectionResetError:
        return True


async def stop(where: str) -> bytes:
    """Post an emergency stop; return the status line."""
    reader, writer = await asyncio.open_connection(*where.split(":"))
    writer.write(
        f"POST /api/emergency_stop HTTP/1.1\r\nHost: {where}\r\nContent-Length: 0\r\n\r\n".encode()
    )
    async with asyncio.timeout(PATIENCE):
        answer = await reader.readline()
    writer.close()
    return answer


@pytest.mark.realtime
@pytest.mark.usefixtures("_few_files")
@pytest.mark.parametrize("words", [b"", b"GET / HT"])
async def test_idle_connections_make_room_for_a_stop_but_a_page_stays(words: bytes) -> None:
    async with served() as (page, where), connect(f"ws://{where}/ws") as ann:
        with ExitStack() as stack:
            idle = [stack.enter_context(dial(where, words)) for _ in range(4 * ROOM)]
            assert b" 204 " in await stop(where)
            assert page.robots[1].robot.supervisor.pilot.emergency
            await until(lambda: sum(map(is_closed, idle)) >= 3.5 * ROOM)
            await ann.send('{"type":"ping","t":1}')
            async with asyncio.timeout(PATIENCE):
                while '"pong"' not in str(await ann.recv()):
                    pass


@pytest.mark.realtime
@pytest.mark.parametrize(
    ("limit", "words"),
    [("SILENCE", b""), ("REQUEST_TIME", b"POST /api/emergency_stop HTTP/1.1\r\nContent-Le")],
)
async def test_who_does_not_go_on_is_closed(
    limit: str, words: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(connections, limit, 0.3)
    async with served() as (_, where):
        with dial(where, words) as caller:
            await until(lambda: is_closed(caller))


@pytest.mark.realtime
async def test_a_byte_now_and_then_does_not_keep_a_request_alive(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(connections, "REQUEST_TIME", 0.5)
    async with served() as (_, where):
        with dial(where, b"GET / HTTP/1.1\r\nX: ") as caller:
            async with asyncio.timeout(PATIENCE):
                while not is_closed(caller):
                    try:
                        caller.sendall(b"x")
                    except OSError:
                        break
                    await asyncio.sleep(0.05)


@pytest.mark.realtime
async def test_who_does_not_go_on_with_tls_is_closed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(connections, "SILENCE", 0.3)
    async with served(certificate.own(tmp_path, ["localhost", "127.0.0.1"])) as (_, where):
        with dial(where, b"\x16\x03\x01") as caller:
            await until(lambda: is_closed(caller))


@pytest.mark.realtime
async def test_there_is_room_for_so_many_websockets_only(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(connections, "MOST_SOCKETS", 4)
    async with served() as (_, where):
        pages = [await connect(f"ws://{where}/ws") for _ in range(3)]  # all that one address has
        with pytest.raises(InvalidStatus) as refused:
            await connect(f"ws://{where}/ws")
        assert refused.value.response.status_code == 503
        await pages[0].close()
        async with connect(f"ws://{where}/ws") as page:
            assert await page.recv()
        for one in pages:
            await one.close()


class OutOfFiles(socket.socket):
    """A listener that once has no file for who comes."""

    refused = False

    def accept(self) -> tuple[socket.socket, object]:
        if not self.refused:
            self.refused = True
            raise OSError(errno.EMFILE, "Too many open files")
        return super().accept()


@pytest.mark.realtime
async def test_without_a_free_file_somebody_makes_room() -> None:
    closed: list[str] = []
    limits = ConnectionLimits(KEPT_BACK + ROOM)
    limits.pool.add(HttpConnection("10.0.0.1", 1e9, lambda: closed.append("the idle one")))
    with OutOfFiles() as listener:
        listener.bind(("127.0.0.1", 0))
        listener.listen()
        listener.setblocking(False)
        acceptor = Acceptor(listener, limits, lambda _: asyncio.Protocol(), None)
        with dial("{}:{}".format(*listener.getsockname())):
            await until(lambda: len(limits.pool) == 1 and closed)
            limits.pool.close_silent()
        acceptor.close()
    assert closed == ["the idle one"]


def callers(most: int, *who: tuple[str, ConnectionPhase]) -> tuple[ConnectionPool, list[str]]:
    """Return connections, by address and stage, and who of them is closed from now on."""
    them, closed = ConnectionPool(most), list[str]()
    for number, (address, stage) in enumerate(who):
        caller = HttpConnection(address, 10.0, lambda n=number, a=address: closed.append(f"{a}{n}"))  # type: ignore[misc]
        them.add(caller)
        caller.phase = stage
    return them, closed


def test_who_has_the_most_connections_loses_the_oldest_silent_one() -> None:
    crowd = [
        ("a", ConnectionPhase.ACTIVE),
        ("a", ConnectionPhase.ANSWERED),
        ("a", ConnectionPhase.NEW),
        ("a", ConnectionPhase.NEW),
    ]
    them, closed = callers(6, ("b", ConnectionPhase.NEW), *crowd, ("c", ConnectionPhase.NEW))
    for _ in range(4):
        them.add(HttpConnection("d", 10.0, lambda: closed.append("d")))
    assert closed == ["a3", "a4", "a2", "d"]
    assert len(them) == 6


def test_who_is_overdue_is_closed() -> None:
    them, closed = callers(9, ("a", ConnectionPhase.NEW), ("b", ConnectionPhase.ACTIVE))
    them.close_overdue(9.9)
    assert closed == []
    them.close_overdue(10.0)
    assert (closed, len(them)) == (["a0", "b1"], 0)


def test_files_are_kept_back_for_the_robot() -> None:
    for files in (256, 1024, 100_000):
        limits = ConnectionLimits(files)
        room = 2 * limits.pool._most + limits.most_sockets  # a request may read a file
        assert room <= files - KEPT_BACK
