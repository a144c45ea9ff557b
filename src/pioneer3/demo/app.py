"""The demo as a full screen of a terminal, for 80 x 24 characters and more."""

import asyncio
from collections import deque
from collections.abc import Callable
from typing import ClassVar

from rich.console import RenderableType
from rich.text import Text
from textual import events
from textual.app import App, ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Horizontal, VerticalScroll

from pioneer3.demo import view
from pioneer3.demo.drawing import ring
from pioneer3.demo.program import Program
from pioneer3.demo.view import panel
from pioneer3.navigation.picture import Trail, reach_for
from pioneer3.teleop.screen import PatientDriver, ScreenPart

REFRESH = 0.1
BELOW = ("row", "flags", "why", "said", "foot")
PARTS = ("head", "modes", "mode", "ring", *BELOW)
REMEMBERED = 2
"""Sentences that stay on the screen."""
FRESH = 12.0
"""For so long [s]."""
SCROLLS = {"up": -1, "down": 1, "pageup": -10, "pagedown": 10}
LONG = 6
"""From so many lines on, details take the room of the ring."""


class DemoApp(App[None]):
    """Shows a :class:`Program`, made once the screen is there, and hands it the keys."""

    ENABLE_COMMAND_PALETTE = False
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding(f"ctrl+{letter}", f"hand('ctrl+{letter}')", priority=True, show=False)
        for letter in "cdqr"
    ]
    CSS = """
    Screen { layout: vertical; overflow: hidden; }
    Part { height: auto; }
    #head, #flags, #foot { height: 1; }
    #why { min-height: 2; max-height: 3; }
    #said { height: 2; color: $warning; }
    #body { height: 1fr; }
    #modes { width: 16; height: 100%; }
    #panel { width: 1fr; height: 100%; padding: 0 1; scrollbar-size-vertical: 1; }
    #ring { height: 100%; }
    #row { max-height: 8; background: $boost; }
    """

    def __init__(self, make: Callable[["DemoApp"], Program]) -> None:
        super().__init__(driver_class=PatientDriver)
        self._make = make
        self._program: Program | None = None
        self._serving: asyncio.Task[None] | None = None
        self._said: deque[tuple[float, str]] = deque(maxlen=REMEMBERED)
        self._trail = Trail()
        self._reach = 3.0
        self._help = False
        self._parts = {name: ScreenPart(id=name) for name in PARTS}
        self._body = Horizontal(id="body")
        self._panel = VerticalScroll(id="panel", can_focus=False)

    def compose(self) -> ComposeResult:
        """Lay the screen out."""
        yield self._parts["head"]
        with self._body:
            yield self._parts["modes"]
            with self._panel:
                yield self._parts["mode"]
            yield self._parts["ring"]
        for name in BELOW:
            yield self._parts[name]

    def on_mount(self) -> None:
        """Begin to serve, and to look."""
        self._program = self._make(self)
        self._serving = asyncio.ensure_future(self._program.run())
        self._serving.add_done_callback(lambda _: self.exit())
        self._put("foot", Text.assemble(*view.FOOT, no_wrap=True, overflow="crop"))
        self._looking = self.set_interval(REFRESH, self.look)

    async def on_unmount(self) -> None:
        """End serving, whatever ended the screen."""
        self._looking.stop()
        if self._program is not None and self._serving is not None:
            self._program.over.set()
            await self._serving

    def on_key(self, event: events.Key) -> None:
        """Hand a key on."""
        event.stop()
        event.prevent_default()
        printable = event.is_printable and event.character not in {None, " "}
        self.action_hand((event.character or "") if printable else event.key)

    def action_hand(self, key: str) -> None:
        """Hand a key, by its name, to the program; scroll where the mode leaves the keys free."""
        if self._program is None:
            return
        self._help = False
        if self._details_are_long and key in SCROLLS:
            self._panel.scroll_relative(y=SCROLLS[key], animate=False, immediate=True)
        self._program.press(key)

    def on_app_blur(self) -> None:
        """Let go: nobody looks at this terminal any more."""
        if self._program is not None:
            self._program.let_go("the terminal lost the focus")

    def raise_failure(self) -> None:
        """Raise the error that ended the program, if there was one."""
        if self._serving is not None and self._serving.done() and not self._serving.cancelled():
            self._serving.result()

    def say(self, text: str) -> None:
        """Show a sentence."""
        self._said.append((asyncio.get_running_loop().time(), text))

    def show_help(self) -> None:
        """Show the keys until another one is pressed."""
        self._help = True

    def show_mode(self) -> None:
        """Show another mode from its beginning."""
        self._panel.scroll_home(animate=False)

    def look(self) -> None:
        """Show the robot as it is now."""
        program = self._program
        if program is None:
            return
        if isinstance(self._driver, PatientDriver) and self._driver.missed:
            self._driver.missed = False
            self.refresh(layout=True)
        robot = program.robot
        self._put("head", view.headline(robot))
        self._put("flags", view.flags(robot))
        self._put("why", view.reasons(robot))
        self._show_said()
        self._show_row(program)
        rows = self._body.size.height
        self._put("modes", view.mode_list(program.modes.values(), program.active, rows))
        self._show_panel(program)
        self._show_ring(program)

    @property
    def _details_are_long(self) -> bool:
        if self._program is None:
            return False
        return self._help or len(self._program.details()) > LONG

    def _show_said(self) -> None:
        """Show the latest sentences; old news would mislead."""
        now = asyncio.get_running_loop().time()
        fresh = [text for stamp, text in self._said if now - stamp < FRESH]
        self._put("said", Text("\n".join(fresh), overflow="ellipsis", no_wrap=len(fresh) > 1))

    def _show_row(self, program: Program) -> None:
        row = program.row()
        width = self.size.width
        self._put("row", Text("\n".join(row.folded(width)) if row else "", no_wrap=True))

    def _show_panel(self, program: Program) -> None:
        mode = program.active
        if self._help:
            self._put("mode", Text("\n".join(program.help())))
            return
        width = max(20, self._panel.size.width - 2)
        self._put(
            "mode",
            panel(mode, program.gauges(), program.details(), width, cropped=self._details_are_long),
        )

    def _show_ring(self, program: Program) -> None:
        picture = self._parts["ring"]
        picture.display = not self._details_are_long
        rows = self._body.size.height
        columns = min(2 * rows + 2, (self.size.width - 16) * 55 // 100)
        picture.styles.width = columns
        snapshot = program.robot.snapshot
        if snapshot is None or not picture.display or rows < 1 or columns < 1:
            picture.update("")
            return
        pose, ranges = snapshot.odometry.robot_in_odom, snapshot.sonar.ranges
        self._trail.add(pose)
        self._reach = reach_for(ranges, self._reach)
        drawn = ring(
            program.robot.info.model,
            ranges,
            columns,
            rows,
            reach=self._reach,
            laser=program.active.points(),
            trail=self._trail.seen_from(pose),
        )
        picture.update(drawn.text())

    def _put(self, name: str, content: RenderableType) -> None:
        self._parts[name].update(content)
