"""Pictures of a camera over the API. Virtual time, save for the stream, which has a real server."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import numpy as np
import pytest

from pioneer3.mjpeg import END, Frame, Parser, part, stream_head
from pioneer3.navigation.connect import connect_async
from pioneer3.tasks import running
from pioneer3.web import connections
from pioneer3.web.access.sessions import Role, SessionKind
from pioneer3.web.page import Page
from pioneer3.web.scene import RobotScene
from pioneer3.web.server import serve
from tests.cameras import (
    FakeCamera,
    TenASecond,
    decoded,
    encoded,
    fake_camera,
    films,
    http_get,
    jpeg_of,
)
from tests.cameras import (
    Script as CameraScript,
)
from tests.support import SimulatedRobot
from tests.unit.web.asking import Script, stranger
from tests.unit.web.browser import Browser, Product, product

IMAGE, STREAM = "/api/robots/1/camera/image", "/api/robots/1/camera/stream"
JPEG = jpeg_of()


@asynccontextmanager
async def looking(*, lost: bool = False) -> AsyncIterator[tuple[Product, TenASecond]]:
    camera = TenASecond(lost=lost)
    async with product() as the, running(camera.run()):
        the.robot.devices.camera._source = camera
        yield the, camera


async def test_an_image_is_the_next_picture() -> None:
    async with looking() as (the, _):
        answer = await Script(the.app).ask("GET", IMAGE)
        assert answer.status == 200
        assert answer.headers["content-type"] == "image/jpeg"
        assert answer.body == JPEG


@pytest.mark.parametrize("path", [IMAGE, STREAM])
async def test_a_lost_camera_and_none_are_told_in_words(path: str) -> None:
    async with looking(lost=True) as (the, _):
        assert "its cable" in (await Script(the.app).ask("GET", path)).detail
    async with product() as the:
        answer = await Script(the.app).ask("GET", path)
        assert (answer.status, "--camera" in answer.detail) == (409, True)
        assert (await Script(the.app).ask("GET", path.replace("/1/", "/2/"))).status == 404


@pytest.mark.parametrize("path", [IMAGE, STREAM])
async def test_a_stranger_sees_nothing(path: str) -> None:
    async with looking() as (the, _):
        assert (await stranger(the.app).ask("GET", path)).status == 401


async def test_a_stream_ends_with_its_session() -> None:
    async with looking() as (the, camera):
        session, secret = the.page.access.sessions.open("Vera", Role.VIEWER, SessionKind.SCRIPT)
        script = stranger(the.app).with_headers(authorization=f"Bearer {secret}")
        asked = asyncio.ensure_future(script.ask("GET", STREAM))
        await asyncio.sleep(1.05)
        assert camera.viewers == 1
        session.ended.set()
        answer = await asked
        parser = Parser()
        head = f"HTTP/1.1 200 OK\r\ncontent-type: {answer.headers['content-type']}\r\n\r\n"
        assert parser.receive(head.encode() + answer.body) == [Frame(JPEG, None)] * parser.pictures
        assert 8 <= parser.pictures <= 10
        await asyncio.sleep(0.1)
        assert camera.viewers == 0


async def test_the_page_is_told_which_robot_has_a_camera() -> None:
    async with looking() as (the, _), Browser(the.app) as ann:
        await asyncio.sleep(0.5)
        the.page._publish_robots()
        await asyncio.sleep(0.5)
        assert ann.latest("hello")["robots"][0]["camera"]
    async with product() as the, Browser(the.app) as ann:
        await asyncio.sleep(0.5)
        assert not ann.latest("hello")["robots"][0]["camera"]


@asynccontextmanager
async def served(*scripts: CameraScript) -> AsyncIterator[tuple[FakeCamera, str, str]]:
    """Serve the page of a robot with a camera; yield the camera, an address and a header."""
    page = Page()
    async with (
        fake_camera(*scripts) as camera,
        SimulatedRobot() as sim,
        connect_async(sim.open, camera=camera.url) as robot,
        serve(page, host="127.0.0.1", port=0) as at,
        page.hosting(robot, RobotScene()),
    ):
        yield camera, f"{at.http}{STREAM}", f"Host: {at.http.removeprefix('http://')}\r\n"


@pytest.mark.realtime
async def test_a_slow_viewer_gets_fewer_pictures_and_none_that_has_waited_for_long() -> None:
    noise = np.random.default_rng(1).integers(0, 256, (480, 640, 3), dtype=np.uint8)
    large = encoded(noise)
    assert len(large) > 300_000

    async def script(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        writer.write(stream_head())
        for number in range(1000):
            writer.write(part(large[:-2] + number.to_bytes(4, "big") + END))
            await writer.drain()
            await asyncio.sleep(0.05)

    async with (
        served(script) as (_, stream, host),
        http_get(stream, host) as quick,
        http_get(stream, host) as slow,
    ):
        parser, newest = Parser(), b""
        while parser.pictures < 20:
            for jpeg, _ in parser.receive(await quick.read(1 << 16)):
                newest = jpeg
        late = Parser()
        sent = int.from_bytes(newest[-6:-2], "big")
        seen = list[int]()
        while not seen or seen[-1] < sent:
            seen += [
                int.from_bytes(jpeg[-6:-2], "big")
                for jpeg, _ in late.receive(await slow.read(1 << 16))
            ]
        assert len(seen) < 10
        assert seen == sorted(set(seen))


@pytest.mark.realtime
async def test_viewers_share_one_connection_and_a_stream_outlasts_other_answers(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(connections, "ANSWER_TIME", 0.5)
    film = films((200, 30, 30), (30, 30, 200), pause=0.05)
    async with served(film) as (camera, stream, host):
        async with http_get(stream, host) as one, http_get(stream, host) as two:
            clock = asyncio.get_running_loop().time
            end, parsers = clock() + 1.5, (Parser(), Parser())
            while clock() < end:
                for reader, parser in zip((one, two), parsers, strict=True):
                    for jpeg, _ in parser.receive(await reader.read(1 << 16)):
                        assert decoded(jpeg).shape == (24, 32, 3)
        assert min(parser.pictures for parser in parsers) > 10
        assert len(camera.requests) == 1
