"""A cable with a listener: what a node sends to its simulated robot, and when."""

import asyncio
import time
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass, field
from urllib.parse import urlsplit

from pioneer3.arcos import commands
from pioneer3.arcos.commands import Command
from pioneer3.arcos.packet import PacketReader
from pioneer3.geometry import STILL, Twist2


@dataclass
class Tap:
    """What went over one cable.

    Attributes:
        url: Where a node finds the robot.
        heard: Commands to the robot, and when they came [s, monotonic].
        answered: When something came from the robot [s, monotonic].
    """

    url: str
    heard: list[tuple[float, Command]] = field(default_factory=list)
    answered: list[float] = field(default_factory=list)

    @property
    def now(self) -> Twist2:
        """What the robot is told to do."""
        changes = self.velocities
        return changes[-1][1] if changes else STILL

    @property
    def velocities(self) -> list[tuple[float, Twist2]]:
        """Whenever the velocity changed: when, and what it became."""
        changes: list[tuple[float, Twist2]] = []
        v, last = 0.0, STILL
        for when, command in self.heard:
            match command:
                case commands.Vel():
                    v = command.speed
                    continue
                case commands.RVel():
                    now = Twist2(v, command.rate)
                case commands.Stop():
                    now = STILL
                case _:
                    continue
            if now != last:
                changes.append((when, now))
                last = now
        return changes


@asynccontextmanager
async def tapped(url: str) -> AsyncIterator[Tap]:
    """Pass on all that goes to and from the simulator at `url`, and listen."""
    address = urlsplit(url)
    tap = Tap("")

    async def connected(ours: asyncio.StreamReader, back: asyncio.StreamWriter) -> None:
        try:
            theirs, on = await asyncio.open_connection(address.hostname, address.port)
        except OSError:  # no simulator there at the moment
            back.close()
            return
        reader = PacketReader()

        async def pass_on(source: asyncio.StreamReader, to: asyncio.StreamWriter) -> None:
            with suppress(ConnectionError):
                while data := await source.read(4096):
                    now = time.monotonic()
                    to.write(data)
                    if to is back:
                        tap.answered.append(now)
                        continue
                    payloads = reader.feed(data)
                    tap.heard += ((now, commands.from_payload(payload)) for payload in payloads)
            to.close()

        await asyncio.gather(pass_on(ours, on), pass_on(theirs, back))

    server = await asyncio.start_server(connected, "127.0.0.1", 0)
    tap.url = f"tcp://127.0.0.1:{server.sockets[0].getsockname()[1]}"
    try:
        yield tap
    finally:
        server.close()
