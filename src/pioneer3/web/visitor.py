"""One browser at the page: snapshots out, requests in, and the wheel given back when it goes."""

import asyncio
import logging
from contextlib import suppress
from typing import Any, Literal

from msgspec import MsgspecError
from starlette.websockets import WebSocket, WebSocketDisconnect

from pioneer3.errors import CommandError
from pioneer3.robot.limits import checked
from pioneer3.web import messages, requests
from pioneer3.web.page import Page
from pioneer3.web.world import News, WorldView

log = logging.getLogger(__name__)

LOOK = 0.1
"""Time between two looks at the simulated world [s]."""


class Visitor:
    """Serves one WebSocket of :class:`Page`."""

    def __init__(self, page: Page, socket: WebSocket) -> None:
        self._page = page
        self._socket = socket
        self._news = News(page.world) if page.world else None

    async def serve(self) -> None:
        """Talk until the browser goes; then let go of whatever it held."""
        await self._socket.accept()
        talk = [asyncio.ensure_future(t) for t in (self._states(), self._snapshots(), self._hear())]
        if self._page.world is not None:
            talk.append(asyncio.ensure_future(self._watch(self._page.world)))
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

    async def _watch(self, view: WorldView) -> None:
        known = view.simulation.world.map
        while True:
            if view.simulation.world.map is not known:
                known = view.simulation.world.map
                await self._say(self._page.hello())
            await self._say_news()
            await asyncio.sleep(LOOK)

    async def _say_news(self) -> None:
        """Tell what has changed in the simulated world."""
        if self._news is not None and (message := self._news.next()):
            await self._say(message)

    async def _hear(self) -> None:
        with suppress(WebSocketDisconnect):
            while True:
                answer = await self._answer()
                if isinstance(answer, dict):
                    await self._say(answer)
                elif answer:
                    await self._say({"type": "refused", "message": answer})

    async def _answer(self) -> str | dict[str, Any] | None:
        """Hear one request and carry it out; return the answer as :meth:`_obey` does."""
        try:
            text = await self._socket.receive_text()
        except KeyError:
            return "not understood: bytes, where text is expected"
        try:
            return await self._obey(requests.decode(text))
        except (MsgspecError, CommandError) as error:
            return f"not understood: {error}"

    async def _obey(self, request: requests.AnyRequest) -> str | dict[str, Any] | None:
        """Carry out a request; return the answer, or why it was refused, or nothing."""
        if isinstance(request, requests.Edit):
            answer = await self._page.edit(self, request)
            await self._say_news()  # before the answer speaks of it
            return answer
        page = self._page
        match request:
            case requests.Drive(v, w):
                return page.drive(self, checked(v, w))
            case requests.Stop():
                page.stop(self)
            case requests.EmergencyStop():
                page.robot.emergency_stop()
            case requests.ResetEmergencyStop():
                page.robot.reset_emergency_stop()
            case requests.SwitchMotors(on):
                return page.robot.helm.set_motors(on=on)
            case requests.Ping(t):
                return {"type": "pong", "t": t}
        return None

    def _driver(self) -> Literal["you", "other"] | None:
        driver = self._page.driver()
        if driver is None:
            return None
        return "you" if driver is self else "other"

    async def _say(self, message: dict[str, Any]) -> None:
        await self._socket.send_text(messages.encode(message))
