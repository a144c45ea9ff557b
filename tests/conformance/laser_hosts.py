"""Hosts of simulated lasers, with the manners of programs that run at real ones."""

import asyncio
import os
import termios
import time
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from functools import partial

import pytest

from pioneer3.lasers.lms2xx.device import LmsDevice
from pioneer3.lasers.lms2xx.telegram import LmsTelegramReader, Sign, Telegram, encode
from pioneer3.models.lasers import LASERS
from pioneer3.sim.equipment import EquipmentOptions
from pioneer3.sim.server import laser_ports
from pioneer3.sim.server.laser import SimulatedLaser
from pioneer3.sim.server.start import simulator
from pioneer3.sim.worldfile import RobotSpec
from pioneer3.sim.worldfile.arguments import WorldOverrides

BOOT = 0.4
"""In place of the 30 s of a real LMS-2xx [s]."""
PATIENCE = 15.0
"""For anything that should come at once, on a busy machine [s]."""


@asynccontextmanager
async def simulated(
    name: str, monkeypatch: pytest.MonkeyPatch | None = None
) -> AsyncIterator[SimulatedLaser]:
    """Run a simulator with one laser; with `monkeypatch` it is an LMS-2xx that starts quickly."""
    if monkeypatch is not None:
        monkeypatch.setattr(laser_ports, "device_of", partial(LmsDevice, boot=BOOT))
    spec = RobotSpec(
        model="p3dx-sh", name="robot", equipment=EquipmentOptions(laser=name, laser_port=None)
    )
    overrides = WorldOverrides(robots=(spec,))
    async with simulator(map_name="office", port=0, overrides=overrides) as running:
        assert LASERS[name] is running.lasers[0].model
        yield running.lasers[0]


class Terminal:
    """A program at a serial port: it sets the port up, and reads without waiting."""

    def __init__(self, path: str, baud: int) -> None:
        self.file = os.open(path, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
        settings = termios.tcgetattr(self.file)
        settings[0] = settings[1] = settings[3] = 0  # neither canonical mode, nor echo, nor signals
        settings[2] = termios.CS8 | termios.CREAD | termios.CLOCAL
        settings[6][termios.VMIN], settings[6][termios.VTIME] = 0, 1
        termios.tcsetattr(self.file, termios.TCSANOW, settings)
        self.set_speed(baud)
        self.heard = b""

    def set_speed(self, baud: int, when: int = termios.TCSANOW) -> None:
        """Change the speed of the port."""
        settings = termios.tcgetattr(self.file)
        settings[4] = settings[5] = getattr(termios, f"B{baud}")
        termios.tcsetattr(self.file, when, settings)

    def flush(self) -> None:
        """Forget all that has not been read or sent."""
        termios.tcflush(self.file, termios.TCIOFLUSH)
        self.heard = b""

    def write(self, data: bytes) -> None:
        """Send `data` in one piece."""
        assert os.write(self.file, data) == len(data)

    async def write_slowly(self, data: bytes, pause: float) -> None:
        """Send byte by byte, with pauses [s]."""

        def write() -> None:
            for byte in data:
                os.write(self.file, bytes((byte,)))
                time.sleep(pause)

        await asyncio.to_thread(write)

    def read(self) -> bytes:
        """Return what has come."""
        try:
            data = os.read(self.file, 65536)
        except BlockingIOError:
            data = b""
        self.heard += data
        return data

    async def listen(self, seconds: float) -> bytes:
        """Return all that comes within so many seconds."""
        end, data = time.monotonic() + seconds, b""
        while time.monotonic() < end:
            await asyncio.sleep(0.005)
            data += self.read()
        return data

    async def until(self, wanted: bytes) -> bytes:
        """Return what has come since the last call, up to and with `wanted`."""
        async with asyncio.timeout(PATIENCE):
            while wanted not in self.heard:
                await asyncio.sleep(0.005)
                self.read()
        found, _, self.heard = self.heard.partition(wanted)
        return found + wanted

    def close(self) -> None:
        """Leave, with the port as it is."""
        os.close(self.file)


class LmsHost(Terminal):
    """A program at an LMS-2xx: it sends telegrams and takes the answers, whatever else comes."""

    def __init__(self, path: str, baud: int = 9600) -> None:
        super().__init__(path, baud)
        self.reader = LmsTelegramReader(range(0x80, 0x85))

    async def answer(self, code: int) -> Telegram:
        """Return the next telegram with this code; others are dropped."""
        async with asyncio.timeout(PATIENCE):
            while True:
                for item in self.reader.feed(self.read(), time.monotonic()):
                    if not isinstance(item, Sign) and item.code == code:
                        return item
                await asyncio.sleep(0.005)

    async def ask(self, code: int, data: bytes = b"") -> bytes:
        """Return the body of the answer to a request."""
        self.write(encode(code, data))
        return (await self.answer(code + 0x80)).body


class NetworkHost:
    """A program at a TCP port."""

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self.reader, self.writer = reader, writer
        self.pieces: list[bytes] = []
        self._rest = b""

    @classmethod
    async def connect(cls, laser: SimulatedLaser, port: int = 0) -> "NetworkHost":
        """Connect to a port of `laser`."""
        return cls(*await asyncio.open_connection(*laser.addresses[port]))

    async def until(self, wanted: bytes) -> bytes:
        """Return what has come since the last call, up to and with `wanted`."""
        async with asyncio.timeout(PATIENCE):
            while wanted not in self._rest:
                data = await self.reader.read(65536)
                assert data, "the laser has closed the connection"
                self.pieces.append(data)
                self._rest += data
        found, _, self._rest = self._rest.partition(wanted)
        return found + wanted

    async def cola(self, request: str) -> str:
        """Return the next telegram after a request of CoLa-A."""
        self.writer.write(f"\x02{request}\x03".encode())
        return await self.telegram()

    async def telegram(self) -> str:
        """Return the next telegram of CoLa-A."""
        found = await self.until(b"\x03")
        assert found[:1] == b"\x02"
        return found[1:-1].decode()

    async def close(self) -> None:
        """Leave."""
        self.writer.close()
