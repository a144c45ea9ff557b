"""Notebooks: live views of a robot, and the stops that their cells need.

A notebook is Jupyter's, or of an editor that does as Jupyter. IPython is not imported unless it
runs this program already.
"""

import asyncio
import sys
from collections.abc import Callable
from concurrent.futures import Future
from contextlib import ExitStack, suppress
from typing import TYPE_CHECKING, Any, Final, Self
from uuid import uuid4

from pioneer3.errors import ConfigError
from pioneer3.runtime.blocking import BlockingConnection
from pioneer3.runtime.facade import LoopThread
from pioneer3.runtime.robot import Robot

if TYPE_CHECKING:
    from IPython.core.interactiveshell import ExecutionResult, InteractiveShell

PERIOD: Final = 0.25
"""Between two pictures of a live view [s]."""
MOST_BYTES: Final = 1e6
"""Bytes of pictures in a second: those of large maps come less often [1/s]."""
_NO_NOTEBOOK: Final = "view: this is no notebook; in a terminal: pioneer3 monitor, pioneer3 sonar"


def shell() -> "InteractiveShell | None":
    """Return the shell of IPython that runs this program, if one does."""
    module = sys.modules.get("IPython")
    return module.get_ipython() if module is not None else None


def leave(url: str) -> None:
    """Close the connections of this notebook to the robot at `url`: its cell runs again."""
    ours = shell()
    for value in list(ours.user_ns.values()) if ours is not None and url else []:
        if isinstance(value, BlockingConnection) and getattr(value, "url", "") == url:
            value.close()


def after_failed_cells(stop: Callable[[], None]) -> Callable[[], None]:
    """Call `stop` after each cell that fails or is interrupted; return how to end that.

    Jupyter takes the handler of SIGINT away after each cell, so signals do not tell of it.
    """
    ours = shell()
    if ours is None:
        return lambda: None

    def ended(result: "ExecutionResult") -> None:
        if not result.success:
            stop()

    ours.events.register("post_run_cell", ended)

    def forget() -> None:
        with suppress(ValueError):  # it is closed twice
            ours.events.unregister("post_run_cell", ended)

    return forget


class LiveView:
    """Shows a robot below a cell, again and again, until it is closed."""

    def __init__(self, robot: Robot, thread: LoopThread) -> None:
        ours = shell()
        if ours is None or not hasattr(ours, "kernel"):
            raise ConfigError(_NO_NOTEBOOK)
        from pioneer3.navigation.picture import card  # loads numpy, here and not in the loop

        self._shell, self._robot, self._name = ours, robot, uuid4().hex
        self._publish(thread.call(lambda: card(robot)), update=False)
        self._work: Future[Any] = asyncio.run_coroutine_threadsafe(self._show(), thread.loop)

    def close(self) -> None:
        """Let the last picture stand; safe to call twice."""
        self._work.cancel()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _ipython_display_(self) -> None:
        """Show nothing more: the picture is there already."""

    async def _show(self) -> None:
        from pioneer3.navigation.picture import Trail, card

        trail, robot, html = Trail(), self._robot, ""
        with ExitStack() as stack:
            for laser in robot.lasers:
                if laser.presence.there:
                    stack.enter_context(laser.wanted())
            try:
                while True:
                    places: list[tuple[float, float]] = []
                    if robot.snapshot is not None:
                        pose = robot.snapshot.odometry.robot_in_odom
                        trail.add(pose)
                        places = trail.seen_from(pose)
                    html = card(robot, places)
                    self._publish(html, update=True)
                    await asyncio.sleep(max(PERIOD, len(html) / MOST_BYTES))
            finally:
                self._publish(f"{html}<i>The view was closed.</i>", update=True)

    def _publish(self, html: str, *, update: bool) -> None:
        self._shell.display_pub.publish(
            {"text/html": html, "text/plain": "a robot"},
            transient={"display_id": self._name},
            update=update,
        )
