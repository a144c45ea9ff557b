"""A simulated camera on a robot: its pictures, and those who look at them by HTTP."""

import asyncio
import logging
import socket
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from math import inf
from typing import Final

from pioneer3 import mjpeg
from pioneer3.links.hosts import url_of
from pioneer3.models.cameras import CAMERAS, CameraModel
from pioneer3.sim.body import Body
from pioneer3.sim.equipment import Equipment
from pioneer3.sim.firmware import Firmware
from pioneer3.sim.physics.dynamics import Instant, MujocoDynamics
from pioneer3.sim.physics.renderer import TakePicture
from pioneer3.sim.server.listeners import StreamServer

log = logging.getLogger(__name__)

MOST_VIEWERS = 8
"""Most viewers of one camera."""
MOST_WAITING = 24
"""Connections that have not yet said what they want, and viewers."""
LONGEST_REQUEST = 8 << 10
"""[bytes]."""
REQUEST_PATIENCE = 5.0
"""A viewer that does not ask for so long is cut off [s, real]."""
WRITE_PATIENCE = 10.0
"""So is one that takes nothing for so long [s, real]."""
FIRST_PATIENCE = 10.0
"""Longest wait for a picture [s, real]."""
SEND_BUFFER = 32 << 10
"""Send buffer of a socket [bytes]; the system's would let a slow viewer see old pictures."""
STREAMS: Final = ("/", "/stream", "/video.mjpg")
SNAPSHOT: Final = "/snapshot.jpg"
SLACK = 1e-6
"""Times are sums of ticks, and rounded [s]."""


@dataclass(frozen=True, slots=True, eq=False)
class Shot:
    """A picture to be rendered: of the world at an instant."""

    instant: Instant
    asked: TakePicture


class SimulatedCamera:
    """One camera: it takes pictures while somebody looks; `taken` is the number that were rendered.

    `wake` is called when there is a `shot` to render. Its `address` is host and number of its port.
    """

    def __init__(
        self,
        dynamics: MujocoDynamics,
        firmware: Firmware,
        equipment: Equipment,
        wake: Callable[[], None] = lambda: None,
    ) -> None:
        assert equipment.camera is not None
        self.model: CameraModel = CAMERAS[equipment.camera]
        self.body: Body = firmware.body
        self.address: tuple[str, int] | None = None
        self.taken = 0
        self._dynamics, self._firmware, self._wake = dynamics, firmware, wake
        self._size = equipment.picture_width, equipment.picture_height
        self._period = 1 / equipment.picture_rate
        self._due = -inf
        self.shot: Shot | None = None
        self._wanted = 0
        self._arrival = asyncio.Event()
        self._jpeg, self._view = b"", self.model.wide
        self._server: StreamServer | None = None

    @property
    def url(self) -> str:
        """URL of its stream."""
        assert self.address is not None
        return f"{url_of(*self.address).replace('tcp://', 'http://', 1)}/"

    @property
    def wanted(self) -> bool:
        """Whether anybody looks."""
        return self._wanted > 0

    def tick(self, now: float) -> None:
        """Take a picture if one is due at `now` [s, simulated]."""
        if self._wanted and now >= self._due - SLACK and self.shot is None:
            self.shoot(now)

    def shoot(self, now: float) -> None:
        """Take a picture of the world as it is; it is rendered later."""
        if self._due == -inf:
            self._due = now
        if now >= self._due - SLACK:
            self._due += self._period * (1 + (now - self._due + SLACK) // self._period)
        camera = self._firmware.accessories.camera
        assert camera is not None
        aim = camera.position(now)
        instant = self._dynamics.instant(self.body)
        width, height = self._size
        asked = TakePicture(
            camera=instant.camera,
            qpos=instant.qpos.tobytes(),
            people=instant.people.tobytes(),
            hidden=instant.hidden,
            pan=aim.pan,
            tilt=aim.tilt,
            view=self.model.view(aim.zoom),
            width=width,
            height=height,
        )
        self.shot = Shot(instant, asked)
        self._wake()

    def publish(self, shot: Shot, jpeg: bytes | None) -> None:
        """Give all viewers the rendered picture; `None` if that failed."""
        if self.shot is shot:
            self.shot = None
        if jpeg is not None:
            self._jpeg, self._view = jpeg, shot.asked.view
            self.taken += 1
            arrival, self._arrival = self._arrival, asyncio.Event()
            arrival.set()

    async def listen(self, listener: socket.socket, now: Callable[[], float]) -> None:
        """Serve viewers at a listening socket; `now` returns the simulated time [s]."""
        serve = partial(self._serve, now)
        self._server = StreamServer(serve, most=MOST_WAITING, limit=LONGEST_REQUEST)
        self.address = await self._server.listen(listener)

    def close(self) -> None:
        """Cut off all viewers and stop listening."""
        if self._server is not None:
            self._server.close()

    async def _serve(
        self,
        now: Callable[[], float],
        reader: asyncio.StreamReader,
        writer: asyncio.StreamWriter,
    ) -> None:
        """Answer one request; no viewer ends the simulator."""
        try:
            with suppress(OSError, TimeoutError, asyncio.IncompleteReadError):
                await self._answer(await _request(reader), writer, now)
        except Exception:
            log.exception("the camera at %s failed", self.url)
        finally:
            writer.transport.abort() if writer.transport.get_write_buffer_size() else writer.close()

    async def _answer(
        self, path: str | None, writer: asyncio.StreamWriter, now: Callable[[], float]
    ) -> None:
        if path is None:
            await _send(writer, _refusal("400 Bad Request", "only GET is understood"))
        elif path not in {*STREAMS, SNAPSHOT}:
            await _send(writer, _refusal("404 Not Found", f"there are / and {SNAPSHOT}"))
        elif self._wanted >= MOST_VIEWERS:
            await _send(writer, _refusal("503 Service Unavailable", "too many viewers"))
        else:
            connection = writer.get_extra_info("socket")
            connection.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, SEND_BUFFER)
            writer.transport.set_write_buffer_limits(high=0)
            self._wanted += 1
            try:
                if self._wanted == 1:
                    self.shoot(now())
                if path == SNAPSHOT:
                    await self._snapshot(writer)
                else:
                    await self._stream(writer)
            finally:
                self._wanted -= 1
                if not self._wanted:
                    self.shot, self._due = None, -inf

    async def _snapshot(self, writer: asyncio.StreamWriter) -> None:
        try:
            async with asyncio.timeout(FIRST_PATIENCE):
                await self._arrival.wait()
        except TimeoutError:
            await _send(writer, _refusal("503 Service Unavailable", "nothing renders pictures"))
            return
        await _send(writer, mjpeg.answer("200 OK", "image/jpeg", self._jpeg))

    async def _stream(self, writer: asyncio.StreamWriter) -> None:
        """Send each picture; the newest when the viewer is slow."""
        await _send(writer, mjpeg.stream_head())
        sent = self.taken
        while True:
            if sent == self.taken:
                async with asyncio.timeout(FIRST_PATIENCE):
                    await self._arrival.wait()
            sent = self.taken
            await _send(writer, mjpeg.part(self._jpeg, self._view))


async def _request(reader: asyncio.StreamReader) -> str | None:
    """Return the path that is asked for, or `None` if it is no request that we know."""
    try:
        async with asyncio.timeout(REQUEST_PATIENCE):
            head = await reader.readuntil(b"\r\n\r\n")
    except asyncio.LimitOverrunError:
        return None
    words = head.split(b"\r\n", 1)[0].decode("latin-1").split()
    if len(words) != 3 or words[0] != "GET" or not words[2].startswith("HTTP/"):
        return None
    return words[1].partition("?")[0]


async def _send(writer: asyncio.StreamWriter, data: bytes) -> None:
    """Send `data`; return when it has left.

    Raises:
        TimeoutError: It does not leave.
        OSError: The viewer has gone.
    """
    writer.write(data)
    async with asyncio.timeout(WRITE_PATIENCE):
        await writer.drain()


def _refusal(status: str, reason: str) -> bytes:
    return mjpeg.answer(status, "text/plain; charset=utf-8", f"{reason}\n".encode())
