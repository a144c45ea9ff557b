"""One browser at the page: news out, requests in, and the wheels given back when it goes."""

import asyncio
import logging
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from msgspec import MsgspecError
from starlette.websockets import WebSocket, WebSocketDisconnect

from pioneer3.errors import CommandError
from pioneer3.robot.limits import checked
from pioneer3.web import requests
from pioneer3.web.access.role import Role
from pioneer3.web.access.sessions import Session
from pioneer3.web.editor import refusal
from pioneer3.web.outbox import Outbox
from pioneer3.web.page import Page
from pioneer3.web.station import Station

log = logging.getLogger(__name__)

PATIENCE = 10.0
"""A page that takes nothing for this long [s] is sent away."""
REVOKED = 4401
"""Closes the WebSocket of somebody who was shown out."""
TRY_AGAIN_LATER = 1013
"""Closes the WebSocket of a page that takes nothing."""
ONLY_DRIVERS = "you are a viewer: you may look, and stop the robot"


class Visitor:
    """Serves one WebSocket of :class:`Page` to whom `session` belongs.

    What is sent waits for the network, what is heard never does: a page that cannot be told
    anything may still stop a robot.
    """

    def __init__(self, page: Page, socket: WebSocket, session: Session) -> None:
        self._page = page
        self._socket = socket
        self._session = session
        self.name = page.name_for(session, socket.headers.get("user-agent", ""))
        self._outbox: Outbox | None = None
        self._number = 0

    @property
    def role(self) -> Role:
        """What they may do."""
        return self._session.role

    def tell(self, news: str) -> None:
        """Show `news`; who does not read misses what is too much."""
        self._answer({"type": "told", "message": news})

    def wake(self) -> None:
        """Look for what is new."""
        if self._outbox is not None:
            self._outbox.wake()

    async def serve(self) -> None:
        """Talk until the browser goes; then let go of whatever it held."""
        await self._socket.accept()
        self._number = number = self._page.enter(self)
        self._outbox = outbox = Outbox(self._page, number)
        parts = (self._write(outbox), self._hear(), self._obey_end(), self._page.closed.wait())
        talk = [asyncio.ensure_future(part) for part in parts]
        try:
            await asyncio.wait(talk, return_when=asyncio.FIRST_COMPLETED)
        finally:
            self._page.leave(number)
            for task in talk:
                task.cancel()
            for result in await asyncio.gather(*talk, return_exceptions=True):
                if isinstance(result, Exception) and not isinstance(result, WebSocketDisconnect):
                    log.debug("a page went away: %r", result)

    async def _write(self, outbox: Outbox) -> None:
        try:
            while True:
                for text in await outbox.news():
                    async with asyncio.timeout(PATIENCE):
                        await self._socket.send_text(text)
        except TimeoutError:
            why = f"it took nothing for {PATIENCE:.0f} s"
            log.info("%s: its page is closed: %s", self.name, why)
            self._hang_up(TRY_AGAIN_LATER, why)

    async def _obey_end(self) -> None:
        """Close when the session is revoked."""
        await self._session.ended.wait()
        self._page.let_go(self)
        why = "this session was revoked"
        try:
            async with asyncio.timeout(1.0):
                await self._socket.close(REVOKED, why)
        except TimeoutError:
            self._hang_up(REVOKED, why)

    def _hang_up(self, code: int, why: str) -> None:
        """Close the connection of a page that takes nothing, so that nothing is kept for it."""
        hang_up: Callable[[int, str], None] | None = self._socket.scope["state"].get("hang_up")
        if hang_up is not None:
            hang_up(code, why)

    async def _hear(self) -> None:
        with suppress(WebSocketDisconnect):
            while True:
                answer = await self._reply()
                if isinstance(answer, dict):
                    self._answer(answer)
                elif answer:
                    self._answer({"type": "refused", "message": answer})

    async def _reply(self) -> str | dict[str, Any] | None:
        """Hear one request and carry it out; return the answer as :meth:`_obey` does."""
        try:
            text = await self._socket.receive_text()
        except KeyError:
            return "not understood: bytes, where text is expected"
        try:
            request = requests.decode(text)
            self._note_life()
            return self._refuse(request) or await self._obey(request)
        except (MsgspecError, CommandError) as error:
            return f"not understood: {error}"

    def _answer(self, message: dict[str, Any]) -> None:
        if self._outbox is not None:
            self._outbox.answer(message)

    def _note_life(self) -> None:
        self._session.seen = asyncio.get_running_loop().time()
        self._page.heard_of(self)

    def _refuse(self, request: requests.AnyRequest) -> str | dict[str, Any] | None:
        """Return the answer to what this role may not ask, or `None`."""
        if self.role is Role.DRIVER or isinstance(request, requests.FOR_ALL):
            return None
        return refusal(ONLY_DRIVERS) if isinstance(request, requests.Edit) else ONLY_DRIVERS

    async def _obey(self, request: requests.AnyRequest) -> str | dict[str, Any] | None:
        """Carry out a request; return the answer, or why it was refused, or nothing."""
        match request:
            case requests.Ping(t):
                return {"type": "pong", "t": t}
            case requests.EmergencyStop(robot=None):
                self._page.emergency_stop()
                return None
            case requests.StartMode() | requests.Goto() | requests.EndMode():
                return self._drive_itself(self._page.station(request.robot), request)
            case requests.WatchDetails() | requests.AskConfig() | requests.WatchLasers():
                self._look(request)
                return None
            case requests.RobotRequest():
                return self._obey_for(self._page.station(request.robot), request)
        answer = await self._page.edit(self, request)
        self._page.look()  # pages hear of it before the answer speaks of it
        return answer

    def _obey_for(
        self, station: Station, request: requests.Wish | requests.WheelRequest
    ) -> str | None:
        """Carry out what concerns one robot; return why not, or `None`."""
        match request:
            case requests.Drive(v, w, source):
                return station.drive(self, checked(v, w), source)
            case requests.Stop():
                station.wheel.stop(self)
            case requests.EmergencyStop():
                station.robot.emergency_stop()
            case requests.ResetEmergencyStop():
                station.robot.reset_emergency_stop()
            case requests.SwitchMotors(on):
                return station.robot.arbiter.set_motors(on=on)
            case requests.TakeWheel():
                return station.wheel.take(self, keep=True)
            case requests.TakeOver():
                station.wheel.take_over(self)
            case requests.HandOver(to):
                guest = self._page.people.guests.get(to)
                if guest is None or guest.role is not Role.DRIVER:
                    return "nobody of that number is here who may drive"
                return station.wheel.hand_over(self, guest)
            case requests.GiveUpWheel():
                station.wheel.let_go(self)
        return None

    def _drive_itself(self, station: Station, request: requests.ModeRequest) -> str | None:
        """Start or end a mode; return why not, or `None`."""
        match request:
            case requests.StartMode(mode):
                return station.start_mode(self, mode)
            case requests.EndMode():
                return station.wheel.end_mode(self)
        said = station.goto(self, request)
        if said.warning:
            self.tell(said.warning)
        return said.refusal or None

    def _look(self, request: requests.Look) -> None:
        """Show more or less on this page alone."""
        match request:
            case requests.WatchLasers(on):
                self._page.scans.want(self._number, wanted=on)
            case requests.WatchDetails(on):
                station = self._page.station(request.robot)
                for each in self._page.stations.values():
                    each.details.unwatch(self)
                if self._outbox is not None:
                    self._outbox.watched = station.details.notices if on else None
                if on:
                    station.details.watch(self)
            case requests.AskConfig():
                self._page.station(request.robot).details.want_config()
