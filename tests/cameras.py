"""Cameras for tests: OpenGL or a reason to skip, pictures, and an MJPEG server with faults."""

import asyncio
import os
import subprocess
import sys
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from functools import lru_cache
from io import BytesIO

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

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


def decoded(jpeg: bytes) -> Pixels:
    """Return a JPEG as an array, shape (H, W, 3)."""
    return np.asarray(Image.open(BytesIO(jpeg)).convert("RGB"))


def jpeg_of(color: tuple[int, int, int] = (200, 30, 30), size: tuple[int, int] = (32, 24)) -> bytes:
    """Return a JPEG of one colour; `size` is width and height."""
    file = BytesIO()
    Image.new("RGB", size, color).save(file, "JPEG")
    return file.getvalue()


@asynccontextmanager
async def http_get(url: str) -> AsyncIterator[asyncio.StreamReader]:
    """Ask for a page; yield what answers, from its first line on."""
    host, _, path = url.removeprefix("http://").partition("/")
    name, _, port = host.partition(":")
    reader, writer = await asyncio.open_connection(name, int(port))
    writer.write(f"GET /{path} HTTP/1.0\r\n\r\n".encode())
    try:
        yield reader
    finally:
        writer.close()


async def body_of(url: str) -> tuple[str, bytes]:
    """Return the first line and the body of an answer."""
    async with http_get(url) as reader:
        head, _, body = (await reader.read()).partition(b"\r\n\r\n")
        return head.split(b"\r\n")[0].decode(), body
