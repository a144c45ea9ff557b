"""Cameras for tests: OpenGL or a reason to skip, pictures, and an MJPEG server with faults."""

import asyncio
import os
import subprocess
import sys
from collections.abc import AsyncGenerator, AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass, field
from functools import lru_cache
from io import BytesIO

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from pioneer3 import mjpeg
from pioneer3.errors import DeviceError
from pioneer3.robot.devices.presence import Presence
from pioneer3.robot.supervisor import Feed
from pioneer3.state import Picture

Pixels = NDArray[np.uint8]


@lru_cache(maxsize=1)
def has_opengl() -> bool:
    """Whether MuJoCo can render here, asked without the code that is tested."""
    program = (
        "import mujoco\n"
        "model = mujoco.MjModel.from_xml_string('<mujoco/>')\n"
        "mujoco.Renderer(model).render()\n"
    )
    return any(
        subprocess.run(
            [sys.executable, "-c", program],
            env=os.environ | {"MUJOCO_GL": backend},
            capture_output=True,
            check=False,
        ).returncode
        == 0
        for backend in ("egl", "osmesa")
    )


def require_opengl() -> None:
    """Skip the test where there is no OpenGL."""
    pytest.importorskip("mujoco")
    if not has_opengl():
        pytest.skip("OpenGL is missing: apt-get install libegl1 libgl1-mesa-dri")


def decoded(file: bytes) -> Pixels:
    """Return a JPEG or a PNG as an array, shape (H, W, 3)."""
    return np.asarray(Image.open(BytesIO(file)).convert("RGB"))


def jpeg_of(color: tuple[int, int, int] = (200, 30, 30), size: tuple[int, int] = (32, 24)) -> bytes:
    """Return a JPEG of one colour; `size` is width and height."""
    return encoded(np.full((*size[::-1], 3), color, np.uint8))


def encoded(pixels: Pixels) -> bytes:
    """Return a JPEG of these pixels, shape (H, W, 3)."""
    file = BytesIO()
    Image.fromarray(pixels).save(file, "JPEG", quality=95)
    return file.getvalue()


@asynccontextmanager
async def http_get(url: str, headers: str = "") -> AsyncIterator[asyncio.StreamReader]:
    """Ask for a page with `headers`, whole lines; yield what answers, from its first line on."""
    host, _, path = url.removeprefix("http://").partition("/")
    name, _, port = host.partition(":")
    reader, writer = await asyncio.open_connection(name, int(port))
    writer.write(f"GET /{path} HTTP/1.0\r\n{headers}\r\n".encode())
    try:
        yield reader
    finally:
        writer.close()


async def body_of(url: str) -> tuple[str, bytes]:
    """Return the first line and the body of an answer."""
    async with http_get(url) as reader:
        head, _, body = (await reader.read()).partition(b"\r\n\r\n")
        return head.split(b"\r\n")[0].decode(), body


Script = Callable[[asyncio.StreamReader, asyncio.StreamWriter], Awaitable[None]]


@dataclass
class FakeCamera:
    """A camera on the network that does as its script says, with each connection.

    Attributes:
        url: Of its stream.
        requests: The questions that it got.
        left: Set when a connection has ended.
    """

    url: str
    requests: list[bytes] = field(default_factory=list)
    left: asyncio.Event = field(default_factory=asyncio.Event)


@asynccontextmanager
async def fake_camera(*scripts: Script) -> AsyncIterator[FakeCamera]:
    """Run a camera; its first connections get `scripts`, later ones the last of them."""
    told = FakeCamera("")
    left = list(scripts)

    async def serve(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        script = left.pop(0) if len(left) > 1 else left[0]
        told.left.clear()
        try:
            with suppress(OSError, asyncio.IncompleteReadError):
                told.requests.append(await reader.readuntil(b"\r\n\r\n"))
                await script(reader, writer)
                await writer.drain()
        finally:
            told.left.set()
            writer.transport.abort() if writer.is_closing() else writer.close()

    server = await asyncio.start_server(serve, "127.0.0.1", 0)
    told.url = f"http://127.0.0.1:{server.sockets[0].getsockname()[1]}/stream"
    try:
        yield told
    finally:
        server.close()


def says(data: bytes, *, then_waits: bool = False) -> Script:
    """Return a script that says something, and hangs up or falls silent."""

    async def script(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        writer.write(data)
        if then_waits:
            await reader.read()

    return script


def films(*colors: tuple[int, int, int], pause: float = 0.02, count: int = 10_000) -> Script:
    """Return a script that sends `count` pictures of these colours in turn, each after `pause`."""

    async def script(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        writer.write(mjpeg.stream_head())
        for number in range(count):
            writer.write(mjpeg.part(jpeg_of(colors[number % len(colors)])))
            await writer.drain()
            await asyncio.sleep(pause)

    return script


class TenASecond:
    """A source of ten pictures a second, in the loop's time; one that is `lost` has none.

    Attributes:
        viewers: Number of iterations that go on.
    """

    presence = Presence(True, "The camera is lost: its cable.")

    def __init__(
        self, *, lost: bool = False, jpeg: bytes | None = None, view: float | None = None
    ) -> None:
        self.viewers = 0
        self._jpeg, self._view = jpeg or jpeg_of(), view
        self._lost = lost
        self._feed: Feed[Picture] = Feed()

    async def run(self) -> None:
        for number in range(1, 10_000):
            clock = asyncio.get_running_loop().time
            self._feed.publish(
                Picture(stamp=clock(), sequence=number, jpeg=self._jpeg, view=self._view)
            )
            await asyncio.sleep(0.1)

    async def values(self) -> AsyncGenerator[Picture, None]:
        self.viewers += 1
        try:
            async for picture in self._feed.values():
                yield picture
        finally:
            self.viewers -= 1

    async def picture(self, max_age: float = 1.0, patience: float = 6.0) -> Picture:
        if self._lost:
            await asyncio.sleep(patience)
            raise DeviceError(str(self.presence))
        return await anext(self._feed.values())
