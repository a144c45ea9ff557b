"""What a mode of the demo is: functions that know the robot, and no screen."""

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass

from pioneer3.demo.modes.row import Row
from pioneer3.robot.devices import Presence

ALWAYS = Presence(True, "Every robot can do this.")


@dataclass(frozen=True, slots=True, kw_only=True)
class Gauge:
    """A value to be drawn as a bar.

    Attributes:
        share: 0 to 1 of what is full, or -1 to 1 if `signed`.
        text: The value in words.
        alarm: Whether somebody should look at it.
        big: Whether it is what the mode is about.
    """

    name: str
    share: float
    text: str
    alarm: bool = False
    big: bool = False
    signed: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Mode:
    """One of the demo's modes (facts.md 8).

    Attributes:
        key: Activates it, in lower or upper case.
        name: ARIA's.
        label: A shorter one for lists; the name if empty.
        help: What its own keys do, a line each.
        by_hand: Whether what its keys set goes on until another key, so that hands must stay near.
        presence: Whether the robot has what it needs, and how one knows.
        enter: The block that is held while it is active.
        on_key: Takes a key; returns whether that means anything.
        again: What choosing it does while it is active.
        row: ARIA's columns at this moment; `None` while there is nothing to show.
        gauges: Bars for a screen.
        details: Longer texts, a line each.
    """

    key: str
    name: str
    label: str = ""
    help: Sequence[str] = ()
    by_hand: bool = False
    presence: Callable[[], Presence] = lambda: ALWAYS
    enter: Callable[[], AbstractContextManager[object]] = nullcontext
    on_key: Callable[[str], bool] = lambda key: False
    again: Callable[[], object] = lambda: None
    row: Callable[[], Row | None] = lambda: None
    gauges: Callable[[], Sequence[Gauge]] = lambda: ()
    details: Callable[[], Sequence[str]] = lambda: ()
