"""One client of the page, a WebSocket: its requests are carried out, its texts are sent.

Sending waits for the network, receiving never does: a page that takes no texts can still stop a
robot.
"""

import asyncio
import logging
import re
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress

from msgspec import MsgspecError
from starlette.websockets import WebSocket, WebSocketDisconnect

from pioneer3.errors import CommandError, MotionError, Refusal
from pioneer3.geometry import Twist2
from pioneer3.robot.limits import checked
from pioneer3.web import group, requests
from pioneer3.web.access.access import device
from pioneer3.web.access.sessions import LoginSession, Role
from pioneer3.web.audience import Audience
from pioneer3.web.broadcast import Channel
from pioneer3.web.messages import EditRefused, Message, Pong, Refused, Told, encode
from pioneer3.web.page import Page
from pioneer3.web.robot_view import RobotView

log = logging.getLogger(__name__)

PATIENCE = 10.0
"""The connection of a page that takes nothing for this long is closed [s]."""
REVOKED = 4401
"""Close code for a session that was revoked."""
TRY_AGAIN_LATER = 1013
"""Close code for a page that takes nothing."""
CLASS_VIEW = "class"
"""In the address of the WebSocket of a class's page."""
MOST_ANSWERS = 32
"""A client that takes no answers misses the oldest."""


class SendQueue:
    """Unsent texts of one client. Each is made just before it is sent, from the newest data.

    It stays small however slow the client is. Snapshots begin with the first one that comes: an old
    one would look like a fresh one. To `details` this client alone has subscribed.
    """

    def __init__(self, page: Page, audience: Audience, number: int) -> None:
        self._page = page
        self._audience = audience
        self._number = number
        self._clients = 0
        self._people = ""
        self._seen: dict[Channel, int] = {
            # small ones are sent when they change: of a robot that stands the last one holds
            audience.snapshots: 0 if audience.small else audience.snapshots.version,
            audience.scans: audience.scans.version,
        }
        self.details: Channel | None = None
        self._answers: deque[str] = deque(maxlen=MOST_ANSWERS)
        self._news = asyncio.Event()
        self._news.set()

    def wake(self) -> None:
        """Look for new texts."""
        self._news.set()

    def answer(self, message: Message) -> None:
        """Add a message for this client alone."""
        self._answers.append(encode(message))
        self.wake()

    async def news(self) -> Iterator[str]:
        """Wait for something new; return all of it, to be sent one by one."""
        await self._news.wait()
        self._news.clear()
        return self._due()

    def _due(self) -> Iterator[str]:
        page, audience = self._page, self._audience
        yield from self._newer(audience.retained)
        if page.clients.version != self._clients:
            self._clients = page.clients.version
            before, self._people = self._people, page.clients.message_for(self._number)
            if self._people != before:
                yield self._people
        if audience.world is not None:
            yield from self._newer(audience.world)
        yield from self._newer(audience.snapshots)
        if self.details is not None:
            yield from self._newer(self.details)
        if audience.scans.has(self._number):
            yield from self._newer(audience.scans)
        while self._answers:
            yield self._answers.popleft()

    def _newer(self, channel: Channel) -> list[str]:
        seen = self._seen.get(channel, 0)
        self._seen[channel] = channel.version
        return channel.since(seen) if channel.version > seen else []


class Client:
    """Serves one WebSocket of `page` that belongs to `session`."""

    def __init__(self, page: Page, socket: WebSocket, session: LoginSession) -> None:
        self._page = page
        self._socket = socket
        self.session = session
        asked = socket.query_params
        self._audience = page.audiences.find(
            session, robot=_number(asked.get("robot")), small=asked.get("view") == CLASS_VIEW
        )
        kind = device(socket.headers.get("user-agent", ""), asked.get("device", ""))
        self._name = page.access.name_for(session, kind, page.clients.names)
        self._queue: SendQueue | None = None
        self._number = 0

    @property
    def name(self) -> str:
        """Shown to all; a student may change it."""
        return self.session.name if self.role is Role.STUDENT else self._name

    @property
    def role(self) -> Role:
        """The permissions of the client."""
        return self.session.role

    def tell(self, news: str) -> None:
        """Show `news`; a client that reads too slowly misses the oldest."""
        self.show(Told(news))

    def show(self, message: Message) -> None:
        """Send `message` to this client alone; the log has what it tells people."""
        if isinstance(message, Told):
            self._page.clients.note("notice", f"to {self.name}: {message.message}")
        if self._queue is not None:
            self._queue.answer(message)

    def wake(self) -> None:
        """Look for new texts."""
        if self._queue is not None:
            self._queue.wake()

    async def serve(self) -> None:
        """Talk until the browser goes; then end its control."""
        await self._socket.accept()
        self._number = number = self._page.join(self, self._audience)
        self._queue = queue = SendQueue(self._page, self._audience, number)
        parts = (self._send(queue), self._receive(), self._await_revocation())
        talk = [asyncio.ensure_future(part) for part in (*parts, self._page.closed.wait())]
        try:
            await asyncio.wait(talk, return_when=asyncio.FIRST_COMPLETED)
        finally:
            self._page.leave(number, self._audience)
            for task in talk:
                task.cancel()
            for result in await asyncio.gather(*talk, return_exceptions=True):
                if isinstance(result, Exception) and not isinstance(result, WebSocketDisconnect):
                    log.debug("a page went away: %r", result)

    async def _send(self, queue: SendQueue) -> None:
        try:
            while True:
                for text in await queue.news():
                    async with asyncio.timeout(PATIENCE):
                        await self._socket.send_text(text)
        except TimeoutError:
            why = f"it took nothing for {PATIENCE:.0f} s"
            log.info("%s: its page is closed: %s", self.name, why)
            self._hang_up(TRY_AGAIN_LATER, why)

    async def _await_revocation(self) -> None:
        """Close when the session is revoked."""
        await self.session.ended.wait()
        self._page.clients.release_control(self)
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

    async def _receive(self) -> None:
        with suppress(WebSocketDisconnect):
            while True:
                answer = await self._answer_next()
                if answer is not None:
                    self.show(answer)

    async def _answer_next(self) -> Message | None:
        """Receive one request and carry it out; return the answer, if there is one."""
        try:
            text = await self._socket.receive_text()
        except KeyError:
            return Refused("not understood: bytes, where text is expected")
        try:
            request = requests.decode(text)
            self.session.seen = asyncio.get_running_loop().time()
            self._page.clients.keep_alive(self)
            self._fill_in_robot(request)
            return self._check_permission(request) or await self._carry_out(request)
        except (MsgspecError, CommandError) as error:
            return Refused(f"not understood: {error}")
        except MotionError as error:
            return Refused(str(error))

    def _fill_in_robot(self, request: requests.AnyRequest) -> None:
        """Let a request without a number be about the only robot that this client sees."""
        own = self._audience.robot
        if isinstance(request, requests.EmergencyStop) and self.role is not Role.STUDENT:
            return  # it means all robots
        if isinstance(request, requests.RobotRequest | requests.RecordRun):
            request.robot = own if request.robot is None else request.robot

    def _check_permission(self, request: requests.AnyRequest) -> Message | None:
        """Return the refusal of a request that this role may not make, or `None`."""
        refused = None
        if self._page.replay is not None and not isinstance(request, requests.FOR_REPLAYS):
            refused = Refusal(requests.REPLAYED)
        elif self.role is Role.STUDENT:
            refused = requests.refusal_for_student(request, self.session.robot)
        elif self.role is not Role.DRIVER and not isinstance(request, requests.FOR_ALL):
            refused = Refusal(requests.ONLY_DRIVERS)
        if refused is None:
            return None
        message = EditRefused if isinstance(request, requests.Edit | requests.MapEdit) else Refused
        return message(refused.text)

    async def _carry_out(self, request: requests.AnyRequest) -> Message | None:
        """Carry out a request; return the answer, if there is one."""
        page = self._page
        if isinstance(request, requests.PingRequest):
            return Pong(request.t)
        if isinstance(request, requests.EmergencyStop) and request.robot is None:
            page.emergency_stop()
            return None
        if isinstance(request, requests.ViewRequest):
            self._look(request)
            return None
        if isinstance(request, requests.PlayRequest):
            return page.play(request)
        if isinstance(request, requests.Edit | requests.MapEdit):
            return await page.edit(self, request)
        if isinstance(request, requests.ModeRequest):
            refused = self._change_mode(page.robot(request.robot), request)
        elif isinstance(request, requests.StartGroupMode):
            refused = group.start(page, self, request.mode, request.robots, request.leader)
        elif isinstance(request, requests.MapRequest):
            refused = self._navigate(page.robot(request.robot), request)
        elif isinstance(request, requests.ClassRequest):
            refused = self._ask_class(request)
        else:
            refused = self._drive(page.robot(request.robot), request)
        return Refused(refused.text) if refused else None

    def _drive(
        self, view: RobotView, request: requests.DriveRequest | requests.ControlRequest
    ) -> Refusal | None:
        """Carry out a request to drive or to control a robot."""
        control, refused = view.control, None
        match request:
            case requests.VelocityRequest(v, w, source, also):
                views = [view, *self._page.known(also)]
                refused = self._drive_all(views, checked(v, w), source)
            case requests.StopRequest():
                control.stop(self)
            case requests.EmergencyStop():
                view.robot.emergency_stop()
            case requests.ResetEmergencyStop():
                view.robot.reset_emergency_stop()
            case requests.SwitchMotors(on):
                refused = control.switch_motors(self, on=on)
            case requests.TakeControl():
                refused = control.take(self, keep=True)
            case requests.TakeOver():
                refused = control.take_over(self)
            case requests.HandOver(to):
                client = self._page.clients.connected.get(to)
                if client is None or client.role is not Role.DRIVER:
                    return Refusal("nobody of that number is here who may drive")
                refused = control.hand_over(self, client)
            case requests.ReleaseControl():
                view.release(self)
        return refused

    def _ask_class(self, request: requests.ClassRequest) -> Refusal | None:
        """Pass a request on to the class."""
        if self._page.classroom is None:
            return Refusal("there is no class here: start one with pioneer3 class")
        return self._page.classroom.carry_out(request)

    def _drive_all(
        self, views: Sequence[RobotView], twist: Twist2, source: requests.Input
    ) -> Refusal | None:
        """Drive robots, each by its own control; return the first refusal, or `None`."""
        refusals = [(one.name, one.control.drive_from_page(self, twist, source)) for one in views]
        name, refused = next((each for each in refusals if each[1]), ("", None))
        return Refusal(f"{name}: {refused}") if refused and len(views) > 1 else refused

    def _change_mode(self, view: RobotView, request: requests.ModeRequest) -> Refusal | None:
        """Start or end a mode."""
        match request:
            case requests.StartMode(mode):
                return view.control.start_mode(self, mode)
            case requests.EndMode():
                return view.end_mode(self)
            case requests.MakeMap():
                return view.mapping.ask(self, request)
            case requests.Calibrate():
                return view.calibration.ask(self, request)
        if view.navigation.possible:
            return self._navigate(view, request)
        forbidden = view.navigation.forbids
        return Refusal(forbidden) if forbidden else view.control.goto(self, request)

    def _navigate(
        self, view: RobotView, request: requests.GotoPlace | requests.MapRequest
    ) -> Refusal | None:
        """Pass a request on to navigation."""
        if not view.navigation.possible:
            return Refusal(view.navigation.impossible)
        if refused := view.control.take(self):
            return refused
        view.navigation.ask(self, request)
        return None

    def _look(self, request: requests.ViewRequest) -> None:
        """Change what this client is sent, or ask for it once."""
        match request:
            case requests.WatchLasers(on):
                self._audience.scans.subscribe(self._number, on=on)
            case requests.WatchDetails(on):
                details = self._page.details(request.robot)
                for each in self._page.all_details():
                    each.unsubscribe(self)
                if self._queue is not None:
                    self._queue.details = details.channel if on else None
                if on:
                    details.subscribe(self)
            case requests.AskConfig():
                self._page.details(request.robot).request_config()
            case requests.PlanWay():
                self._page.robot(request.robot).navigation.ask(self, request)


def _number(text: str | None) -> int | None:
    """Return the number of a robot in an address, `None` without one."""
    return int(text) if text is not None and re.fullmatch("[0-9]{1,6}", text) else None
