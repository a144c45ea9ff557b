"""Signals that end a program stop its robots first: SIGINT, SIGTERM, SIGHUP and SIGQUIT.

=================================  ===============================================================
action of the program              effect of a signal
=================================  ===============================================================
ignores it (SIG_IGN, nohup)        nothing: the robot goes on
nothing: it would end the program  the session ends with STOP, ENABLE 0, SONAR 0 and CLOSE. Then
                                   `SystemExit`, 128 + its number, passes the program's blocks;
                                   SIGQUIT ends the program as it does without this package
has had a handler since before it  the robot stops, and moves again for a fresh command only; then
connected                          that handler runs. Of SIGINT it is Python's: `KeyboardInterrupt`
has set a handler since            that handler runs alone; the robot stops when the program ends,
                                   or if it calls the handler that `signal.signal` returned
=================================  ===============================================================

Only the main thread can have handlers. A robot that another thread has connected to is stopped by
the end of its block or of the program; where a signal kills the program, by its own watchdog.
"""

import atexit
import os
import signal
import threading
from collections.abc import Callable
from contextlib import suppress
from types import FrameType
from typing import TYPE_CHECKING, Any, NoReturn

if TYPE_CHECKING:  # the command line's help loads this module, and does without an event loop
    from asyncio import AbstractEventLoop

LEAVE = tuple(
    signal.Signals[name]
    for name in ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT")
    if name in signal.Signals.__members__  # Windows has two of them
)


class StopOnSignals:
    """Stops one robot when a signal comes, for the length of a block; see this module.

    Args:
        stop: Lets the robot stand; called in `loop`.
        close: Ends the session and returns; `None` where the end of `loop` does that.
    """

    def __init__(
        self,
        loop: "AbstractEventLoop",
        stop: Callable[[], None],
        close: Callable[[], None] | None = None,
    ) -> None:
        self._loop, self._stop, self._close = loop, stop, close
        self._process = os.getpid()
        self._open = False
        self._before: dict[int, Any] = {}

    def __enter__(self) -> None:
        self._open = True
        if threading.current_thread() is threading.main_thread():
            for number in LEAVE:
                handler = _still_open(signal.getsignal(number), number)
                if handler is signal.SIG_DFL or callable(handler):
                    self._before[number] = handler
                    signal.signal(number, self)

    def __exit__(self, *_: object) -> None:
        self._open = False
        if threading.current_thread() is threading.main_thread():
            for number, handler in self._before.items():
                later = signal.getsignal(number)
                if later is self:
                    signal.signal(number, _still_open(handler, number))
                while isinstance(later, StopOnSignals):  # robots that come and go would pile up
                    if later._before[number] is self:
                        later._before[number] = handler
                    later = later._before[number]

    def __call__(self, number: int, frame: FrameType | None) -> None:
        """Stop this robot and those that were connected before; then let the signal do its work."""
        robots, handler = [self], self._before[number]
        while isinstance(handler, StopOnSignals):
            robots.append(handler)
            handler = handler._before[number]
        robots = [robot for robot in robots if robot._reachable]
        for robot in robots:
            robot._loop.call_soon_threadsafe(robot._stop)
        if callable(handler):
            handler(number, frame)
        elif robots:
            _end_program(number, robots)
        else:
            die_of(number)

    @property
    def _reachable(self) -> bool:
        """Whether the robot is still connected, and by this process: not by the one it forked."""
        return self._open and self._process == os.getpid() and not self._loop.is_closed()


def _still_open(handler: Any, number: int) -> Any:
    """Return `handler`, or the one before it if its robot has been left, and so on."""
    while isinstance(handler, StopOnSignals) and not handler._open:
        handler = handler._before[number]
    return handler


def die_of(number: int) -> NoReturn:
    """End this process as the signal does where nobody handles it: the shell is told which."""
    signal.signal(number, signal.SIG_DFL)
    signal.raise_signal(number)
    raise SystemExit(128 + number)  # it is blocked


def _end_program(number: int, robots: list[StopOnSignals]) -> None:
    """End the sessions of `robots`, then the program."""
    for robot in robots:
        if robot._close is not None:
            with suppress(Exception):  # the others, and the end, come all the same
                robot._close()
    loops = [robot._loop for robot in robots if robot._close is None and robot._loop.is_running()]
    if loops:
        loops[0].call_soon_threadsafe(_leave_loop, number)
    elif number == getattr(signal, "SIGQUIT", None):
        die_of(number)
    else:
        raise SystemExit(128 + number)


def _leave_loop(number: int) -> NoReturn:
    """Leave the event loop: `asyncio.run` cancels every task, and each tells its robot to stop."""
    if number == getattr(signal, "SIGQUIT", None):
        atexit.register(die_of, number)
    raise SystemExit(128 + number)
