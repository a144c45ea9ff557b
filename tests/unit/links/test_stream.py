"""Links over real sockets: the same contract as in memory."""

import asyncio
import socket
import struct
from collections.abc import AsyncIterator

import pytest

from pioneer3.errors import LinkError
from pioneer3.links.base import WRITTEN
from pioneer3.links.stream import KEEPALIVE, StreamLink, accepted, open_tcp, tune

pytestmark = pytest.mark.realtime


@pytest.fixture
async def ends() -> AsyncIterator[tuple[StreamLink, StreamLink]]:
    arrived: asyncio.Queue[StreamLink] = asyncio.Queue()

    async def on_client(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        await arrived.put(accepted("tcp://client", reader, writer))

    server = await asyncio.start_server(on_client, "127.0.0.1", 0)
    async with server:
        ours = await open_tcp("127.0.0.1", server.sockets[0].getsockname()[1])
        theirs = await arrived.get()
        yield ours, theirs
        await ours.close()
        await theirs.close()


Ends = tuple[StreamLink, StreamLink]


async def test_bytes_pass_both_ways(ends: Ends) -> None:
    for near, far in (ends, ends[::-1]):
        await near.write(b"hello")
        assert await far.read() == b"hello"


async def test_bytes_are_handed_over_and_their_end_is_read(ends: Ends) -> None:
    ours, theirs = ends
    came: list[bytes] = []
    with ours.handing(came.append):
        end = asyncio.ensure_future(ours.read())
        await theirs.write(b"one")
        await asyncio.sleep(0.05)
        assert came == [b"one"]
        assert not end.done()
    await theirs.write(b"two")
    assert await end == b"two"
    assert came == [b"one"]
    with ours.handing(came.append):
        await theirs.close()
        assert await ours.read() == b""


async def test_there_is_nothing_to_wait_for_until_the_far_end_takes_no_more(ends: Ends) -> None:
    ours, theirs = ends
    assert ours.write(b"a little") is WRITTEN
    more = ours.write(bytes(1 << 24))
    assert more is not WRITTEN
    writing = asyncio.ensure_future(more)
    while not writing.done():
        await theirs.read()


async def test_a_far_end_that_closes_is_read_as_the_end(ends: Ends) -> None:
    ours, theirs = ends
    await theirs.close()
    assert await ours.read() == b""
    assert await ours.read() == b""


async def test_a_closed_link_takes_nothing(ends: Ends) -> None:
    ours, _ = ends
    await ours.close()
    await ours.close()
    with pytest.raises(LinkError, match="the link is closed"):
        await ours.write(b"x")


async def test_a_reset_connection_is_a_link_error(ends: Ends) -> None:
    ours, theirs = ends
    await ours.write(b"unread")
    await asyncio.sleep(0.05)
    reset = struct.pack("ii", 1, 0)  # linger for no time: RST in place of FIN
    theirs._writer.get_extra_info("socket").setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, reset)
    theirs._writer.transport.abort()
    with pytest.raises(LinkError, match="tcp://127"):
        await ours.read()
    with pytest.raises(LinkError, match="tcp://127"):
        await ours.write(b"x")


async def test_a_link_without_a_speed_ignores_one(ends: Ends) -> None:
    assert ends[0].speeds == ()
    await ends[0].set_speed(38400)


async def test_closing_does_not_wait_for_a_far_end_that_takes_nothing(ends: Ends) -> None:
    ours, _ = ends
    with pytest.raises(TimeoutError):  # noqa: PT012  nothing else ends it
        async with asyncio.timeout(0.1):
            while True:
                await ours.write(bytes(1 << 20))
    began = asyncio.get_running_loop().time()
    await ours.close()
    assert asyncio.get_running_loop().time() - began < 5.0


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
