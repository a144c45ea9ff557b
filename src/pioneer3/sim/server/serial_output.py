"""Bytes of a tick on their way to a terminal, spread over the time until the next tick.

A real unit pauses for at most 14 ms between two bytes of a telegram (lms2xx.md 1.3), and programs
give a telegram up after 35 ms. Ticks are 20 ms apart: all bytes of a tick at once would leave a gap
of 20 ms, and a longer one wherever the machine is busy.
"""

import asyncio
from collections import deque

from pioneer3.sim.server.clients import Client
from pioneer3.sim.server.pacer import TICK

STEP = 0.004
"""Between two pieces [s, real]."""
PIECES = round(TICK / STEP)
MOST = 3 * PIECES
"""More pieces than this wait only where time passes faster than in reality: all leave at once."""


class SerialOutput:
    """Sends to one client at a time, in pieces."""

    def __init__(self) -> None:
        self._pieces: deque[bytes] = deque()
        self._client: Client | None = None
        self._timer: asyncio.TimerHandle | None = None

    def send(self, client: Client, data: bytes) -> None:
        """Send the bytes of one tick to `client`; those of another client are forgotten."""
        if client is not self._client:
            self.clear()
            self._client = client
        size = -(-len(data) // PIECES)
        self._pieces.extend(data[at : at + size] for at in range(0, len(data), size))
        if self._timer is None:
            self._next()
        if len(self._pieces) > MOST:
            client.send(b"".join(self._pieces))
            self._pieces.clear()

    def clear(self) -> None:
        """Forget the bytes that wait."""
        self._pieces.clear()
        self._client = None
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None

    def _next(self) -> None:
        """Send a piece, and wake up for the next one."""
        self._timer = None
        if self._client is None or not self._pieces:
            return
        self._client.send(self._pieces.popleft())
        self._timer = asyncio.get_running_loop().call_later(STEP, self._next)
