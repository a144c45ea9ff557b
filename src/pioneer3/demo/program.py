"""The demo without a screen: modes, keys, and everything that must stop the robot."""

import asyncio
import logging
from collections.abc import Callable, Coroutine, Iterable, Mapping, Sequence
from contextlib import ExitStack, suppress
from dataclasses import replace
from typing import Any, Protocol, TypeVar

from pioneer3.demo.columns import ColumnRow
from pioneer3.demo.mode import Context, DemoMode, Description, Gauge
from pioneer3.demo.modes import MODES
from pioneer3.errors import PioneerError
from pioneer3.robot.devices import Acts, Presence
from pioneer3.robot.pilot import STOPPED
from pioneer3.robot.supervisor import Connection
from pioneer3.runtime.robot import Robot
from pioneer3.teleop.keyboard import PATIENCE, Key, patient
from pioneer3.teleop.terminal import ARROWS, ESCAPE

HELP_KEYS = frozenset("hH?/")
EMERGENCY_KEYS = frozenset("kK")
"""ARIA uses neither."""
STOP_KEY = "space"
RESET_KEY = "ctrl+r"
QUIT_KEYS = frozenset({"escape", "ctrl+c", "ctrl+d", "ctrl+q"})

ARROW_NAMES = {Key.FORWARD: "up", Key.BACK: "down", Key.RIGHT: "right", Key.LEFT: "left"}
NAMES: Mapping[str, str] = {
    **{text: ARROW_NAMES[key] for text, key in ARROWS.items()},
    f"{ESCAPE}[5~": "pageup",
    f"{ESCAPE}[6~": "pagedown",
    ESCAPE: "escape",
    " ": "space",
    "\r": "enter",
    "\n": "enter",
    "\x7f": "backspace",
    "\x08": "backspace",
    "\x03": "ctrl+c",
    "\x04": "ctrl+d",
    "\x12": RESET_KEY,
}
"""By the text that a terminal sends."""


def named(token: str) -> str:
    """Return the name of the key that sent `token`, or the character that it is."""
    return NAMES.get(token, token)


log = logging.getLogger(__name__)

TICK = 0.1
T = TypeVar("T")


class Display(Protocol):
    """Shows the demo to people."""

    def show_help(self) -> None:
        """Show which keys there are."""

    def show_mode(self) -> None:
        """Another mode is active."""

    def say(self, text: str) -> None:
        """Tell a sentence."""


class Program:
    """Holds the modes; one of them is active. Every way out of :meth:`run` stops the robot.

    `face` shows it to people; `first` is the key of the mode to begin with. A speed set by hand
    lasts for `patience` without a key [s]; see :func:`patient`. `over` is set when the demo shall
    end.
    """

    def __init__(
        self,
        robot: Robot,
        face: Display,
        *,
        first: str = "t",
        patience: float = PATIENCE,
        acts: Acts | None = None,
        modes: Iterable[Description] = MODES,
    ) -> None:
        self.robot = robot
        self.over = asyncio.Event()
        self.context = Context(robot, face.say, self._work, acts or Acts())
        made = (_careful(mode.make(self.context, mode)) for mode in modes)
        self.modes = {mode.about.key: mode for mode in made}
        self.active = self.modes[first]
        self._face = face
        self._patience = patient(patience)
        self._held = ExitStack()
        self._tasks: set[asyncio.Task[object]] = set()
        self._clock = asyncio.get_running_loop().time
        self._broken: set[str] = set()
        self._last_key = self._clock()
        self._status = robot.supervisor.status.latest
        self._ended = robot.arbiter.ended

    async def run(self) -> None:
        """Serve until :attr:`over`."""
        try:
            self._guard("motors", lambda: self.robot.arbiter.set_motors(on=True))
            self._enter(self.active)
            while not self.over.is_set():
                self._look()
                with suppress(TimeoutError):
                    async with asyncio.timeout(TICK):
                        await self.over.wait()
        finally:
            try:
                self.robot.arbiter.stop()
            finally:
                tasks = list(self._tasks)
                self._leave()
                await asyncio.gather(*tasks, return_exceptions=True)

    def press(self, key: str) -> None:
        """Take a key: a character, or a name such as `up`, `space`, `pageup`, `ctrl+r`."""
        self._last_key = self._clock()
        if key in EMERGENCY_KEYS:
            self.robot.emergency_stop()
            self._face.say("EMERGENCY STOP. Ctrl-R releases it; the motors stay off.")
        elif key in QUIT_KEYS:
            self.robot.arbiter.stop()
            self.over.set()
        elif key == RESET_KEY:
            self.robot.reset_emergency_stop()
            self._face.say("The emergency stop is released; e in teleop, or driving, brings power.")
        elif key in HELP_KEYS:
            self._face.show_help()
        elif key.lower() in self.modes:
            self.choose(self.modes[key.lower()])
        else:
            if key == STOP_KEY and self._moves():
                self.robot.arbiter.stop()  # in every mode, whatever else the key means there
            self._guard(self.active.about.name, lambda: self.active.on_key(key))

    def choose(self, mode: DemoMode) -> None:
        """Make `mode` the active one; the robot stops. Choosing the active one is up to it."""
        if mode is self.active:
            self._guard(mode.about.name, mode.again)
            return
        self._leave()
        self.robot.arbiter.stop()
        self.active = mode
        self._enter(mode)

    def let_go(self, why: str) -> None:
        """End a motion that was set by hand: no person is near any more."""
        if self.active.about.by_hand and self._moves():
            self.robot.arbiter.stop()
            self._face.say(f"Stopped: {why}.")

    def help(self) -> list[str]:
        """Return which keys there are, a line each (facts.md 8.1)."""
        listed = [mode.about for mode in self.modes.values()]
        return [
            "quit: escape",
            "help: 'h', 'H', '?' or '/'",
            "emergency stop: 'k' or 'K'; release it: Ctrl-R",
            "stop: space",
            *(f"{one.name} mode: '{one.key}' or '{one.key.upper()}'" for one in listed),
            f"current mode: {self.active.about.name}",
            *self.active.about.help,
        ]

    def row(self) -> ColumnRow | None:
        """Return the columns of the active mode, if there is anything to show."""
        if self.active.presence().there is False:
            return None
        return self._shown(self.active.row, None)

    def gauges(self) -> Sequence[Gauge]:
        """Return the bars of the active mode."""
        return self._shown(self.active.gauges, ())

    def details(self) -> Sequence[str]:
        """Return the longer texts of the active mode."""
        return self._shown(self.active.details, ())

    def _enter(self, mode: DemoMode) -> None:
        self._broken.discard(mode.about.key)
        self._face.show_mode()
        if mode.presence().there is False:
            self._face.say(f"{mode.about.name}: {mode.presence()}")
        else:
            self._guard(mode.about.name, mode.begin)
            self._guard(mode.about.name, lambda: self._held.enter_context(mode.enter()))

    def _leave(self) -> None:
        for task in self._tasks:
            task.cancel()
        self._guard(self.active.about.name, self._held.close)

    def _guard(self, what: str, act: Callable[[], object]) -> None:
        """Do it; a failure stops the robot and is told, and the demo goes on."""
        try:
            act()
        except Exception as error:
            self._failed(what, error)

    def _failed(self, what: str, error: Exception) -> None:
        self.robot.arbiter.stop()
        if isinstance(error, PioneerError):
            self._face.say(str(error))
        else:
            log.error("%s failed: %s: %s", what, type(error).__name__, error, exc_info=error)
            self._face.say(f"{what} failed, the robot is stopped: {type(error).__name__}: {error}")

    def _shown(self, part: Callable[[], T], otherwise: T) -> T:
        """Return a part of the active mode to show, or `otherwise` if that fails."""
        mode = self.active
        if mode.about.key in self._broken:
            return otherwise
        try:
            return part()
        except Exception as error:
            self._broken.add(mode.about.key)  # it would be told ten times a second
            self._failed(mode.about.name, error)
            return otherwise

    def _work(self, coroutine: Coroutine[Any, Any, object]) -> Callable[[], None]:
        """Run it until the mode is left; return a function that ends it before."""
        name = self.active.about.name
        task = asyncio.ensure_future(coroutine)
        self._tasks.add(task)

        def ended(task: asyncio.Task[object]) -> None:
            self._tasks.discard(task)
            error = None if task.cancelled() else task.exception()
            if isinstance(error, Exception):
                self._failed(name, error)

        task.add_done_callback(ended)

        def end() -> None:
            task.cancel()

        return end

    def _look(self) -> None:
        """Tell the news since the last look; end a motion that nobody holds."""
        status, ended = self.robot.supervisor.status.latest, self.robot.arbiter.ended
        if status is not None and status is not self._status:
            lost = status.connection is Connection.LOST
            more = ". What drove it must be started anew" if lost else ""
            self._face.say(f"{status.connection.value.upper()}: {status.message}{more}")
        new = ended is not None and ended is not self._ended
        if ended is not None and new and not ended.done and ended.why != STOPPED:
            self._face.say(f"{ended.mode.name} ended: {ended.why}")
        self._status, self._ended = status, ended
        if self._clock() - self._last_key >= self._patience:
            self.let_go(f"no key for {self._patience:g} s. The next key starts anew")

    def _moves(self) -> bool:
        snapshot, pilot = self.robot.snapshot, self.robot.supervisor.pilot
        if snapshot is None:
            return False
        return snapshot.motors.moving or not pilot.asked(self._clock()).is_zero


def _careful(mode: DemoMode) -> DemoMode:
    """Return `mode` with a presence that cannot fail: all of them are asked all the time."""

    def presence() -> Presence:
        try:
            return mode.presence()
        except Exception as error:
            return Presence(None, f"{mode.about.name} cannot tell: {type(error).__name__}: {error}")

    return replace(mode, presence=presence)
