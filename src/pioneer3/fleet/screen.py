"""Driving a fleet on a full screen of a terminal, for 80 x 24 characters and more."""

import asyncio
from collections import deque
from collections.abc import Callable, Sequence
from typing import ClassVar, Final

from rich.segment import Segment
from rich.style import Style
from rich.text import Text
from textual import events
from textual.app import App, ComposeResult
from textual.binding import Binding, BindingType
from textual.geometry import Region, Size
from textual.scroll_view import ScrollView
from textual.strip import Strip

from pioneer3.fleet.columns import TableCell
from pioneer3.fleet.drive import FleetDrive
from pioneer3.fleet.drive_table import COLUMNS, GAP, Look, cells, headline, why_of, widths
from pioneer3.tasks import running
from pioneer3.teleop.screen import PatientDriver, ScreenPart, log_told_by, obeyed_by_none, run_app
from pioneer3.teleop.several import CHOOSING, KEYS

REFRESH: Final = 0.5
TOKENS: Final = {
    "up": "\x1b[A",
    "down": "\x1b[B",
    "right": "\x1b[C",
    "left": "\x1b[D",
    "space": " ",
    "tab": "\t",
    "enter": "\r",
    "escape": "\x1b",
    "ctrl+c": "\x04",
    "ctrl+d": "\x04",
    "ctrl+q": "\x04",
    "ctrl+r": "\x12",
}
"""The texts that a terminal sends, by textual's names of keys; Ctrl-C and Ctrl-Q quit, too."""
SCROLLS: Final = {"pageup": -10, "pagedown": 10, "home": -10_000, "end": 10_000}
STYLES: Final = {True: Style(color="green"), False: Style(color="red", bold=True), None: Style()}
FRESH: Final = 12.0
"""News stay on the screen for so long [s]."""


def row_strip(row: Sequence[TableCell], across: Sequence[int], style: Style) -> Strip:
    """Return a row, each cell cut or filled to its width."""
    segments = []
    for cell, width in zip(row, across, strict=True):
        text = cell.text if len(cell.text) <= width else f"{cell.text[: width - 1]}…"
        segments.append(Segment(text.ljust(width + GAP), style + STYLES[cell.ok]))
    return obeyed_by_none(Strip(segments))


class RobotTable(ScrollView, can_focus=False):
    """One row for each robot; a click hands its name on."""

    def __init__(self, clicked: Callable[[str], None]) -> None:
        super().__init__(id="table")
        self._clicked = clicked
        self._rows: list[tuple[str, tuple[TableCell, ...]]] = []

    def show(self, looks: Sequence[Look]) -> None:
        """Show the robots as they are now; only rows that have changed are drawn."""
        rows = [(look.member.name, cells(look)) for look in looks]
        before, self._rows = self._rows, rows
        if len(rows) != len(before):
            self.virtual_size = Size(0, len(rows))
            self.refresh()
            return
        for number, (old, new) in enumerate(zip(before, rows, strict=True)):
            if old != new:
                line = number - self.scroll_offset.y
                if 0 <= line < self.size.height:
                    self.refresh(Region(0, line, self.size.width, 1))

    def reveal(self, name: str) -> None:
        """Scroll so far that a robot is seen."""
        number = [each for each, _ in self._rows].index(name)
        top, height = self.scroll_offset.y, self.size.height
        if not top <= number < top + height:
            self.scroll_to(y=max(0, number - height // 2), animate=False, immediate=True)

    def across(self) -> tuple[int, ...]:
        """Return the width of each column."""
        return widths([name for name, _ in self._rows], self.scrollable_content_region.width)

    def render_line(self, y: int) -> Strip:
        """Draw one line."""
        number = y + self.scroll_offset.y
        if number >= len(self._rows):
            return Strip.blank(self.size.width)
        _, row = self._rows[number]
        style = Style(reverse=True) if row[0].text else Style()
        return row_strip(row, self.across(), style).adjust_cell_length(self.size.width)

    def on_click(self, event: events.Click) -> None:
        """Hand the robot on that was clicked at."""
        number = event.y + self.scroll_offset.y
        if number < len(self._rows):
            self._clicked(self._rows[number][0])


class FleetApp(App[None]):
    """Shows a :class:`FleetDrive`, which runs meanwhile, and hands it the keys."""

    ENABLE_COMMAND_PALETTE = False
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding(key, f"hand('{key}')", priority=True, show=False)
        for key in ("ctrl+c", "ctrl+d", "ctrl+q", "ctrl+r", "tab")
    ]
    CSS = """
    Screen { layout: vertical; overflow: hidden; }
    Part { height: auto; }
    #head, #titles { height: 1; text-style: bold; }
    #titles { text-style: underline; }
    #table { height: 1fr; scrollbar-size-vertical: 1; }
    #why { min-height: 2; max-height: 4; }
    #said { max-height: 2; color: $warning; }
    #foot { max-height: 4; background: $boost; }
    """

    def __init__(self, drive: FleetDrive) -> None:
        super().__init__(driver_class=PatientDriver)
        self._drive = drive
        self._head, self._titles = ScreenPart(id="head"), ScreenPart(id="titles")
        self._table = RobotTable(self._click)
        self._why, self._said = ScreenPart(id="why"), ScreenPart(id="said")
        self._foot = ScreenPart(id="foot")
        self._shown: dict[ScreenPart, str] = {}
        self._news: deque[tuple[float, str]] = deque(maxlen=2)

    def compose(self) -> ComposeResult:
        """Lay the screen out."""
        yield from (self._head, self._titles, self._table, self._why, self._said, self._foot)

    def on_mount(self) -> None:
        """Begin to look."""
        self.set_interval(REFRESH, self.look)
        self.call_after_refresh(self.look)

    def on_key(self, event: events.Key) -> None:
        """Hand a key on."""
        event.stop()
        event.prevent_default()
        self.action_hand(event.key if event.key in TOKENS else event.character or event.key)

    def action_hand(self, key: str) -> None:
        """Hand a key on, by its name or its character; scroll where it means nothing."""
        if key in SCROLLS:
            self._table.scroll_relative(y=SCROLLS[key], animate=False, immediate=True)
            return
        before = self._drive.board.selection.chosen
        self._drive.press(TOKENS.get(key, key))
        if self._drive.over.is_set():
            self.exit()
            return
        chosen = self._drive.board.selection.chosen
        if chosen != before:
            self._table.reveal(chosen[0])
        self.look()

    def on_app_blur(self) -> None:
        """Let go: nobody looks at this terminal any more."""
        self._drive.let_go()

    def say(self, text: str) -> None:
        """Show a sentence for a while."""
        self._news.append((asyncio.get_running_loop().time(), text))

    def look(self) -> None:
        """Show the robots as they are now."""
        if isinstance(self._driver, PatientDriver) and self._driver.missed:
            self._driver.missed = False
            self.refresh(layout=True)
        now, board = asyncio.get_running_loop().time(), self._drive.board
        looks = [Look(member, board.selection, now) for member in self._drive.look()]
        self._table.show(looks)
        self._put(self._head, headline(looks, emergency=board.emergency))
        titles = zip(COLUMNS, self._table.across(), strict=True)
        line = " ".join(column.title.ljust(width)[:width] for column, width in titles)
        self._put(self._titles, line)
        self._put(self._why, self._about_chosen(looks))
        fresh = [text for stamp, text in self._news if now - stamp < FRESH]
        self._put(self._said, "\n".join(fresh))
        choosing = board.selection.marked is not None
        typed = f"   number: {board.selection.typed}_" if board.selection.typed else ""
        together = self._drive.group.together
        more = f"   g: {together.mode.start.lower()}" if together else ""
        self._put(self._foot, (CHOOSING if choosing else KEYS + more) + typed)

    def _about_chosen(self, looks: Sequence[Look]) -> str:
        """Return the names of those that drive, and the whole trouble of the first that has any."""
        selection = self._drive.board.selection
        chosen = [look.member for look in looks if look.member.name in selection.chosen]
        who = ", ".join(member.name for member in chosen)
        if len(chosen) == len(looks) > 1:
            who = "ALL ROBOTS"
        elif len(who) > 60:
            who = f"{len(chosen)} robots"
        keyboard = next((k for m in chosen if (k := self._drive.board.keyboard(m.name))), None)
        speeds = f" [{keyboard.speed:.2f} m/s, {keyboard.turn_rate:.2f} rad/s]" if keyboard else ""
        unwell = next((member for member in chosen if member.told is None), chosen[0])
        why = why_of(unwell)
        return f"Keys drive {who}{speeds}" + (f"\n{unwell.name}: {why}" if why else "")

    def _put(self, part: ScreenPart, text: str) -> None:
        """Show a text in a part of the screen; the same one again costs nothing."""
        if self._shown.get(part) != text:
            self._shown[part] = text
            part.update(Text(text, overflow="ellipsis"))

    def _click(self, name: str) -> None:
        self._drive.board.toggle(name)
        self.look()


async def run_screen(drive: FleetDrive) -> int:
    """Drive on the whole terminal until the quit key; return the exit code. Then all stand.

    The end of the terminal is as the quit key.
    """
    app = FleetApp(drive)
    with log_told_by(app.say):
        async with running(drive.run()):
            await run_app(app)
    return app.return_code or 0
