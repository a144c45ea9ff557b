"""One browser at the page: snapshots out, requests in, and the wheel given back when it goes."""

import asyncio
import logging
from contextlib import suppress
from typing import Any, Literal

from msgspec import MsgspecError
from starlette.websockets import WebSocket, WebSocketDisconnect

from pioneer3.errors import CommandError
from pioneer3.robot.limits import checked
from pioneer3.web import messages
from pioneer3.web.page import Page

log = logging.getLogger(__name__)


class Visitor:
    """Serves one WebSocket of :class:`Page`."""

    def __init__(self, page: Page, socket: WebSocket) -> None:
        self._page = page
        self._socket = socket

    async def serve(self) -> None:
        """Talk until the browser goes; then let go of whatever it held."""
        await self._socket.accept()
        talk = [asyncio.ensure_future(t) for t in (self._states(), self._snapshots(), self._hear())]
        try:
            await asyncio.wait(talk, return_when=asyncio.FIRST_COMPLETED)
        finally:
            self._page.let_go(self)
            for task in talk:
                task.cancel()
            for result in await asyncio.gather(*talk, return_exceptions=True):
                if isinstance(result, Exception) and not isinstance(result, WebSocketDisconnect):
                    log.debug("a page went away: %r", result)

    async def _states(self) -> None:
        await self._say(self._page.hello())
        await self._say(self._page.status())
        async for _ in self._page.robot.supervisor.status.values():
            await self._say(self._page.hello())
            await self._say(self._page.status())

    async def _snapshots(self) -> None:
        async for snapshot in self._page.robot.supervisor.snapshots.values():
            await self._say(self._page.snapshot(snapshot, self._driver()))

    async def _hear(self) -> None:
        with suppress(WebSocketDisconnect):
            while True:
                try:
                    refused = self._obey(messages.decode(await self._socket.receive_text()))
                except (MsgspecError, CommandError) as error:
                    refused = f"not understood: {error}"
                except KeyError:
                    refused = "not understood: bytes, where text is expected"
                if isinstance(refused, dict):
                    await self._say(refused)
                elif refused:
                    await self._say({"type": "refused", "message": refused})

    def _obey(self, request: messages.AnyRequest) -> str | dict[str, Any] | None:
        """Carry out a request; return the answer, or why it was refused, or nothing."""
        page = self._page
        match request:
            case messages.Drive(v, w):
                return page.drive(self, checked(v, w))
            case messages.Stop():
                page.stop(self)
            case messages.EmergencyStop():
                page.robot.emergency_stop()
            case messages.ResetEmergencyStop():
                page.robot.reset_emergency_stop()
            case messages.SwitchMotors(on):
                return page.robot.helm.set_motors(on=on)
            case messages.Ping(t):
                return {"type": "pong", "t": t}
        return None

    def _driver(self) -> Literal["you", "other"] | None:
        driver = self._page.driver()
        if driver is None:
            return None
        return "you" if driver is self else "other"

    async def _say(self, message: dict[str, Any]) -> None:
        await self._socket.send_text(messages.encode(message))
