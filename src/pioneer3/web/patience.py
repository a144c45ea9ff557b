"""uvicorn's WebSocket, kept short: what a page does not take is not piled up for it."""

import asyncio
import socket
from asyncio import BaseTransport

from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol

UNSENT = 16_384
"""What the system keeps for a page beyond what is on its way [bytes]; a frame more is kept here."""
LAST_WORDS = 1.0
"""How long a page that took nothing is given to hear why it is sent away [s]."""


class ShortSocket(WebSocketsSansIOProtocol):
    """A WebSocket that takes the next message when the last has been handed to the network.

    `state["hang_up"](code, reason)` of the ASGI scope closes one that takes nothing any more.
    """

    def connection_made(self, transport: BaseTransport) -> None:
        """Keep the buffers of the connection small."""
        assert isinstance(transport, asyncio.Transport)
        transport.set_write_buffer_limits(high=0)
        line = transport.get_extra_info("socket")
        if line is not None and hasattr(socket, "TCP_NOTSENT_LOWAT"):
            line.setsockopt(socket.IPPROTO_TCP, socket.TCP_NOTSENT_LOWAT, UNSENT)
        self.app_state = {**self.app_state, "hang_up": self._hang_up}
        super().connection_made(transport)

    def _hang_up(self, code: int, reason: str) -> None:
        """Say why, if that still gets through; then drop the connection and all that waits."""
        self.conn.fail(code, reason)
        self.transport.write(b"".join(self.conn.data_to_send()))
        self.loop.call_later(LAST_WORDS, self.transport.abort)
