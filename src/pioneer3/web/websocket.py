"""uvicorn's WebSocket with bounded buffers and a rate limit for its messages."""

import asyncio
import socket
from asyncio import BaseTransport
from typing import Any

from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol
from websockets.frames import Frame

from pioneer3.web.access.middleware import POLICY_VIOLATION
from pioneer3.web.messages import Told, encode
from pioneer3.web.requests import is_stop

UNSENT = 16_384
"""Unsent bytes that the system keeps for a page; one more frame is kept here."""
CLOSE_TIME = 1.0
"""Time for the close frame of a page that took nothing [s]."""
RATE = 60.0
"""Frames that a page may send [1/s]; one that drives sends 15, and some more for its display."""
ENOUGH = 120
"""Frames beyond that rate above which only stops are accepted."""
TOO_MANY = 240
"""Frames beyond that rate above which none is accepted."""
SLICE = 1024
"""Bytes of a page that are read at once; then the others have their turn."""
MOST_UNREAD = 65_536
"""A page that has sent so much more than could be read is closed [bytes]."""
NOT_TEXT = 1007
"""Close code for text that is not UTF-8 (RFC 6455, 8.1)."""
FLOODS = "this page sends too much"


class BoundedWebSocket(WebSocketsSansIOProtocol):
    """A WebSocket that takes the next message when the last has been handed to the network.

    `state["hang_up"](code, reason)` of the ASGI scope closes one that takes nothing any more. One
    that sends too much is told, and closed if it goes on: the robot that it drives stops.
    """

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self._unread = bytearray()
        self._reading = self._told = self._closing = False
        self._frames, self._counted_at = 0.0, self.loop.time()

    def connection_made(self, transport: BaseTransport) -> None:
        """Keep the buffers of the connection small."""
        assert isinstance(transport, asyncio.Transport)
        transport.set_write_buffer_limits(high=0)
        line = transport.get_extra_info("socket")
        if line is not None and hasattr(socket, "TCP_NOTSENT_LOWAT"):
            line.setsockopt(socket.IPPROTO_TCP, socket.TCP_NOTSENT_LOWAT, UNSENT)
        self.app_state = {**self.app_state, "hang_up": self._hang_up}
        super().connection_made(transport)

    def data_received(self, data: bytes) -> None:
        """Read the data, a little at a time."""
        if self._closing:
            return
        self._unread += data
        if len(self._unread) > MOST_UNREAD:
            self._disconnect()
        elif not self._reading:
            self._read_on()

    def connection_lost(self, exc: Exception | None) -> None:
        """Let go of what refers back to this: cycles wait for a collection of the whole heap."""
        self._closing = True
        super().connection_lost(exc)
        self.app_state = {}
        if self.handshake_initiated:
            self.scope = {**self.scope, "state": {}}
        self.conn.parser.close()

    def handle_text(self, event: Frame) -> None:
        """Accept a message unless there were too many; a stop is always accepted."""
        if self._closing:
            return
        if self._count() <= ENOUGH or not event.fin or is_stop(bytes(event.data)):
            super().handle_text(event)

    def handle_bytes(self, event: Frame) -> None:
        """Count it with the messages."""
        self._count()
        super().handle_bytes(event)

    def handle_cont(self, event: Frame) -> None:
        """Count it with the messages."""
        self._count()
        super().handle_cont(event)

    def send_receive_event_to_app(self) -> None:
        """Pass a whole message on, unless it is closed; text that is not UTF-8 closes it."""
        if self._closing:
            return
        if self.curr_msg_data_type == "text" and not _is_utf8(b"".join(self.frames)):
            self.logger.warning("A page was closed: it sent text that is not UTF-8")
            self._disconnect(NOT_TEXT, "this is not UTF-8")
        else:
            super().send_receive_event_to_app()

    def handle_ping(self) -> None:
        """Count it with the messages; browsers send none."""
        self._count()
        super().handle_ping()

    def _read_on(self) -> None:
        if self._closing:
            return
        part = bytes(self._unread[:SLICE])
        del self._unread[:SLICE]
        super().data_received(part)
        self._reading = bool(self._unread) and not self._closing
        if self._reading:
            self.loop.call_soon(self._read_on)

    def _count(self) -> float:
        """Count a frame; return how many there were beyond the rate."""
        now = self.loop.time()
        self._frames = max(0.0, self._frames - (now - self._counted_at) * RATE) + 1
        self._counted_at = now
        if self._frames <= ENOUGH:
            self._told = False
        elif self._frames > TOO_MANY:
            self._disconnect()
        elif not self._told:
            self._told = True
            self._tell(f"{FLOODS}: only stops are heard")
        return self._frames

    def _tell(self, message: str) -> None:
        if self.handshake_complete and not self.close_sent and not self.transport.is_closing():
            self.conn.send_text(encode(Told(message)).encode())
            self.transport.write(b"".join(self.conn.data_to_send()))

    def _disconnect(self, code: int = POLICY_VIOLATION, why: str = FLOODS) -> None:
        """Accept no more, and tell the application that this page is gone."""
        if self._closing:
            return
        self._closing = True
        self._unread.clear()
        self.queue.put_nowait({"type": "websocket.disconnect", "code": code, "reason": why})
        self._hang_up(code, why)

    def _hang_up(self, code: int, reason: str) -> None:
        """Send the reason, if that is possible; then drop the connection and its unsent data."""
        self.conn.fail(code, reason)
        self.transport.write(b"".join(self.conn.data_to_send()))
        self.loop.call_later(CLOSE_TIME, self.transport.abort)


def _is_utf8(data: bytes) -> bool:
    try:
        data.decode()
    except UnicodeDecodeError:
        return False
    return True
