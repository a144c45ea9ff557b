"""A page that sends too much is told, then closed; its stops, and others, are heard at once."""

import asyncio
import gc
import json
import re
from contextlib import suppress

import pytest
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosedError

from pioneer3.web.requests import is_stop
from pioneer3.web.websocket import ENOUGH, FLOODS, MOST_UNREAD, TOO_MANY, BoundedWebSocket
from tests.unit.web.test_server import closing_code, served, until_driving, until_standing

pytestmark = pytest.mark.realtime

PING = '{"type":"ping","t":1}'
RESET = '{"type":"reset_emergency_stop"}'
PATIENCE = 20.0


def burst(texts: list[str]) -> bytes:
    """Return messages as they are on the wire, masked with zeros."""
    frames = (b"\x81" + bytes([0x80 | len(t)]) + bytes(4) + t.encode() for t in texts)
    return b"".join(frames)


async def told(page: ClientConnection) -> list[str]:
    """Return what the page is told, until it is closed."""
    heard = []
    with suppress(ConnectionClosedError):
        async for text in page:
            message = json.loads(text)
            if message["type"] == "told":
                heard.append(message["message"])
    return heard


async def test_who_pings_in_a_loop_is_told_once_then_closed() -> None:
    async with served() as (_, where), connect(f"ws://{where}/ws") as page:
        page.transport.write(burst([PING] * (TOO_MANY + 10)))
        async with asyncio.timeout(PATIENCE):
            assert await told(page) == [f"{FLOODS}: only stops are heard"]
        assert page.close_code == 1008
        assert page.close_reason == FLOODS


async def test_a_stop_behind_too_many_pings_is_heard_and_the_page_stays() -> None:
    async with served() as (sim, where), connect(f"ws://{where}/ws") as page:
        await until_driving(sim, page)
        page.transport.write(burst([PING] * (ENOUGH + 20) + ['{"type":"emergency_stop"}']))
        await until_standing(sim)
        pongs = 0
        async with asyncio.timeout(PATIENCE):
            async for text in page:
                pongs += '"pong"' in str(text)
                if '"emergency_stop":true' in str(text):
                    break
        assert pongs < ENOUGH  # the oldest answers are forgotten, and the last pings were not heard
        assert page.close_code is None


@pytest.mark.parametrize("stop", ['{"type":"stop"}', '{ "robot": 1, "type" : "emergency_stop" }'])
def test_a_stop_is_told_by_its_type(stop: str) -> None:
    assert is_stop(stop.encode())


@pytest.mark.parametrize(
    "other",
    [
        RESET,
        '{"type":"stop_button","id":1,"pressed":false}',
        '{"type":"drive","v":0.3,"w":0,"input":"stop"}',
        '{"type":"drive","input":{"type":"stop"}}',
        '"stop"',
        "stop",
        "[" * 10_000,
        "",
    ],
)
def test_another_message_about_stops_is_no_stop(other: str) -> None:
    assert not is_stop(other.encode())


async def test_resets_are_limited_as_other_messages_are_and_stops_still_pass() -> None:
    async with served() as (sim, where), connect(f"ws://{where}/ws") as page:
        await until_driving(sim, page)
        flood = [PING] * (ENOUGH + 20)
        page.transport.write(burst([*flood, '{"type":"emergency_stop"}', *[RESET] * 20]))
        await until_standing(sim)
        latched: list[str] = []
        async with asyncio.timeout(PATIENCE):
            async for text in page:
                latched += re.findall('"emergency_stop":(true|false)', str(text))
                if latched.count("true") and len(latched) >= latched.index("true") + 5:
                    break
        assert latched[-5:] == ["true"] * 5  # no reset behind the stop was heard
        assert page.close_code is None


async def test_who_floods_with_resets_is_told_then_closed() -> None:
    async with served() as (_, where), connect(f"ws://{where}/ws") as page:
        page.transport.write(burst([RESET] * (TOO_MANY + 10)))
        async with asyncio.timeout(PATIENCE):
            assert await told(page) == [f"{FLOODS}: only stops are heard"]
        assert page.close_code == 1008


async def test_who_floods_stops_driving() -> None:
    async with served() as (sim, where), connect(f"ws://{where}/ws") as page:
        await until_driving(sim, page)
        drive = '{"type":"drive","v":0.3,"w":0}'
        page.transport.write(burst([drive] * (TOO_MANY + 10)))
        assert await closing_code(page) == 1008
        await until_standing(sim)


@pytest.mark.parametrize(
    "frame",
    [
        pytest.param(b"\x89\x80" + bytes(4), id="pings of the protocol"),
        pytest.param(b"\x80\x80" + bytes(4), id="empty parts of a message"),
        pytest.param(b"\x82\x80" + bytes(4), id="bytes"),
    ],
)
async def test_frames_of_any_kind_count(frame: bytes) -> None:
    first = b"\x01\x80" + bytes(4) if frame[0] == 0x80 else b""
    async with served() as (_, where), connect(f"ws://{where}/ws") as page:
        frame = frame.replace(b"\x80\x80", b"\x00\x80")
        page.transport.write(first + frame * (TOO_MANY + 10))
        assert await closing_code(page) == 1008


async def test_who_sends_more_than_can_be_read_is_closed_unread() -> None:
    async with served() as (_, where), connect(f"ws://{where}/ws") as page:
        page.transport.write(b"\x81" * 4 * MOST_UNREAD)
        async with asyncio.timeout(PATIENCE):
            await page.wait_closed()
        assert page.close_code in {1006, 1008}  # the system may drop what was not read


async def test_who_drives_and_looks_as_a_page_does_is_never_told() -> None:
    async with served() as (_, where), connect(f"ws://{where}/ws") as page:
        listening = asyncio.ensure_future(told(page))
        for _ in range(2 * ENOUGH):  # three times as often as a page that drives
            await page.send(PING)
            await asyncio.sleep(0.02)
        await page.close()
        assert await listening == []


def masked(opcode: int, data: bytes) -> bytes:
    """Return a frame as it is on the wire, masked with zeros."""
    return bytes([opcode, 0x80 | len(data)]) + bytes(4) + data


@pytest.mark.parametrize(
    "frames",
    [
        pytest.param(masked(0x81, b"\xff\xfe"), id="one frame"),
        pytest.param(masked(0x01, b"\xe2") + masked(0x80, b"\x28\xa1"), id="fragments"),
    ],
)
async def test_text_that_is_not_utf8_closes_the_page_and_stops_what_it_drives(
    frames: bytes, caplog: pytest.LogCaptureFixture
) -> None:
    async with served() as (sim, where), connect(f"ws://{where}/ws") as page:
        await until_driving(sim, page)
        page.transport.write(frames)
        assert await closing_code(page) == 1007
        await until_standing(sim)
    (record,) = caplog.records
    assert record.getMessage() == "A page was closed: it sent text that is not UTF-8"
    assert record.exc_info is None


async def test_text_in_fragments_that_part_a_letter_is_understood() -> None:
    first, rest = '{"type":"ping","t":1,"é":0}'.encode().split(b"\xc3")
    async with served() as (_, where), connect(f"ws://{where}/ws") as page:
        page.transport.write(masked(0x01, first + b"\xc3") + masked(0x80, rest))
        async with asyncio.timeout(PATIENCE):
            async for text in page:
                if '"pong"' in str(text) or '"refused"' in str(text):
                    break


async def test_many_bad_texts_and_requests_are_a_few_lines_with_their_number(
    caplog: pytest.LogCaptureFixture,
) -> None:
    async with served() as (_, where):
        for _ in range(25):
            async with connect(f"ws://{where}/ws") as page:
                page.transport.write(masked(0x81, b"\xff"))
                await closing_code(page)
        for _ in range(12):
            reader, writer = await asyncio.open_connection(*where.split(":"))
            writer.write(b"\xff\xff\r\n\r\n")
            await reader.read()
            writer.close()
    assert [record.getMessage() for record in caplog.records] == [
        "A page was closed: it sent text that is not UTF-8",
        "A page was closed: it sent text that is not UTF-8 (10 times so far)",
        "Invalid HTTP request received.",
        "Invalid HTTP request received. (10 times so far)",
    ]


async def test_a_page_that_left_is_freed_without_a_collection_of_the_whole_heap() -> None:
    def pages() -> int:
        return sum(isinstance(one, BoundedWebSocket) for one in gc.get_objects())

    async with served() as (_, where):
        gc.collect()
        gc.disable()
        try:
            async with connect(f"ws://{where}/ws") as page:
                await page.send(PING)
                await page.recv()
                assert pages() == 1
            async with asyncio.timeout(PATIENCE):
                while pages():  # noqa: ASYNC110  the heap tells nobody
                    await asyncio.sleep(0.02)
        finally:
            gc.enable()
