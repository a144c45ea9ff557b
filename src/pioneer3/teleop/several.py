"""One keyboard for several robots: who is chosen, and which keys reach whom."""

import re
from collections.abc import AsyncIterator, Callable, Iterator, Sequence
from contextlib import AsyncExitStack, contextmanager
from dataclasses import dataclass, field
from enum import Enum, auto
from string import digits
from typing import Final

from pioneer3.teleop.keyboard import Key, Keyboard
from pioneer3.teleop.keyboard_drive import KeyboardDriver
from pioneer3.teleop.terminal import ARROWS, ESCAPE


class RobotChooser(Enum):
    """Keys that choose robots."""

    NEXT = auto()
    NUMBER = auto()
    ALL = auto()
    SEVERAL = auto()
    CONFIRM = auto()


@dataclass(frozen=True, slots=True)
class KeyRow:
    """Keys that do one thing, by the text that a terminal sends.

    `name` is for people, empty for a second name, which the help leaves out.
    """

    name: str
    words: str
    acts: dict[str, Key | RobotChooser]


TABLE: Final = (
    KeyRow("arrows", "drive", {**ARROWS}),
    KeyRow("space", "stop all", {" ": Key.STOP}),
    KeyRow("k", "emergency stop of all", {"k": Key.EMERGENCY}),
    KeyRow("Ctrl-R", "release it", {"\x12": Key.RESET}),
    KeyRow("q", "next robot", {"q": RobotChooser.NEXT, "\t": RobotChooser.NEXT}),
    KeyRow("0-9", "this robot", dict.fromkeys(digits, RobotChooser.NUMBER)),
    KeyRow("a", "all", {"a": RobotChooser.ALL}),
    KeyRow("s", "several", {"s": RobotChooser.SEVERAL}),
    KeyRow("+ -", "speed", {"+": Key.FASTER, "=": Key.FASTER, "-": Key.SLOWER}),
    KeyRow("m", "motors", {"m": Key.MOTORS}),
    KeyRow("Ctrl-D", "quit", {"\x04": Key.QUIT}),
    KeyRow("", "choose those marked", dict.fromkeys("y\r\n", RobotChooser.CONFIRM)),
    KeyRow("", "keep those chosen, else quit", {"\x1b": Key.QUIT}),
)
"""All keys; where there is one robot, letters drive, and here they choose."""
KEYS: Final = "   ".join(f"{row.name}: {row.words}" for row in TABLE if row.name)
CHOOSING: Final = (
    "Which ones? 0-9, q and the mouse mark, a marks all   y: drive those   Esc: as before"
)
ACTS: Final = {token: act for row in TABLE for token, act in row.acts.items()}
FOR_ALL: Final = {Key.STOP, Key.EMERGENCY, Key.RESET}
"""Keys that every robot obeys, chosen or not."""
LAB_NUMBER: Final = re.compile(r".*p3[a-z]+[_-](\d+)(?:_|$)")
"""The lab numbers its robots, as in p3at_1_113 and p3at-1."""


def act_of(token: str) -> Key | RobotChooser | None:
    """Return the meaning of a key; capitals, as with Caps Lock, mean the same."""
    return ACTS.get(token if len(token) > 1 else token.lower())


def numbers(names: Sequence[str]) -> dict[str, int]:
    """Return a number for each robot: the lab's, or else in their order from 0."""
    found = [int(match[1]) for name in names if (match := LAB_NUMBER.match(name))]
    if len(set(found)) == len(names):
        return dict(zip(names, found, strict=True))
    return {name: number for number, name in enumerate(names)}


@dataclass(slots=True)
class Selection:
    """Robots that obey the keys, and those marked to be next. Pure.

    Numbers are typed with as many digits as the highest has, and `typed` are those of one that is
    not complete. `chosen` are the robots that drive, in the order of their numbers, never none;
    `marked` are the next ones while somebody chooses several, else `None`.
    """

    numbers: dict[str, int]
    chosen: tuple[str, ...] = field(init=False)
    marked: frozenset[str] | None = field(default=None, init=False)
    typed: str = field(default="", init=False)
    _last: str = field(init=False)

    def __post_init__(self) -> None:
        self._last = self.order[0]
        self.chosen = (self._last,)

    @property
    def order(self) -> list[str]:
        """The robots by their numbers."""
        return sorted(self.numbers, key=lambda name: self.numbers[name])

    @property
    def width(self) -> int:
        """How many digits choose a robot."""
        return len(str(max(self.numbers.values())))

    def label(self, name: str) -> str:
        """Return the number of a robot as it is typed."""
        return f"{self.numbers[name]:0{self.width}}"

    def press(self, choice: RobotChooser, token: str = "") -> None:
        """Obey a key that chooses; `token` is the digit of a number."""
        if choice is RobotChooser.NUMBER:
            self._type(token)
            return
        self.typed = ""
        match choice:
            case RobotChooser.NEXT:
                order = self.order
                self._point_at(order[(order.index(self._last) + 1) % len(order)])
            case RobotChooser.ALL if self.marked is None:
                self._choose(frozenset(self.numbers))
            case RobotChooser.ALL:
                self.marked = frozenset(self.numbers)
            case RobotChooser.SEVERAL:
                self.marked = frozenset()
            case RobotChooser.CONFIRM:
                self._choose(self.marked or frozenset())
                self.marked = None

    def cancel(self) -> bool:
        """Keep those chosen; return whether somebody was choosing several."""
        was, self.marked, self.typed = self.marked is not None, None, ""
        return was

    def choose(self, name: str) -> None:
        """Let one robot drive."""
        self._last = name
        self._choose(frozenset({name}))

    def toggle(self, name: str) -> None:
        """Mark a robot or not; while nobody chooses several, let it drive or not."""
        self._last = name
        if self.marked is not None:
            self.marked ^= {name}
        else:
            self._choose(frozenset(self.chosen) ^ {name})

    def _type(self, digit: str) -> None:
        self.typed += digit
        if len(self.typed) < self.width:
            return
        wanted, self.typed = int(self.typed), ""
        for name, number in self.numbers.items():
            if number == wanted:
                self._point_at(name)

    def _point_at(self, name: str) -> None:
        self._last = name
        if self.marked is not None:
            self.marked ^= {name}
        else:
            self._choose(frozenset({name}))

    def _choose(self, names: frozenset[str]) -> None:
        if names:
            self.chosen = tuple(name for name in self.order if name in names)


class KeyRouter:
    """Routes keys to the drivers of robots; `show` is given the live line of the robot chosen.

    The robots of `selection` drive, the others stand. A latched `emergency` stop counts for robots
    that join later, too.
    """

    def __init__(
        self, numbers: dict[str, int], show: Callable[[str], None] = lambda line: None
    ) -> None:
        self.selection = Selection(numbers)
        self.emergency = False
        self._show = show
        self._drivers: dict[str, KeyboardDriver] = {}

    def shows(self, name: str) -> Callable[[str], None]:
        """Return the function that shows the live lines of a robot."""

        def show(line: str) -> None:
            chosen = self.selection.chosen
            if self.selection.marked is not None:
                marked = ", ".join(sorted(self.selection.marked, key=self.selection.order.index))
                self._show(f"{CHOOSING}   marked: {marked or 'none'}")
            elif name == chosen[0]:
                who = {1: name, len(self.selection.numbers): "ALL ROBOTS"}
                self._show(f"{who.get(len(chosen), ', '.join(chosen))}: {line}")

        return show

    @contextmanager
    def joined(self, name: str, driver: KeyboardDriver) -> Iterator[None]:
        """Let `driver` have the keys of this robot during the block."""
        self.add(name, driver)
        try:
            yield
        finally:
            self._drivers.pop(name, None)

    def add(self, name: str, driver: KeyboardDriver) -> None:
        """Let `driver` have the keys of this robot; an emergency stop counts for it, too."""
        self._drivers[name] = driver
        if self.emergency:
            driver.press(Key.EMERGENCY)

    def keyboard(self, name: str) -> Keyboard | None:
        """Return the speeds of a robot's keys, or `None` while it has no driver."""
        driver = self._drivers.get(name)
        return driver.keyboard if driver else None

    async def run(self, tokens: AsyncIterator[str]) -> None:
        """Drive until the quit key or the end of `tokens`; then all robots stand."""
        async with AsyncExitStack() as stack:
            for driver in self._drivers.values():
                await stack.enter_async_context(driver.driving())
            async for token in tokens:
                if not self.press(token):
                    return

    def press(self, token: str) -> bool:
        """Obey a key; return whether to go on."""
        act, before = act_of(token), self.selection.chosen
        if act is Key.QUIT:
            return token == ESCAPE and self.selection.cancel()
        if isinstance(act, RobotChooser):
            self.selection.press(act, token)
            self._stop_left(before)
        elif act in FOR_ALL:
            self.emergency = act is Key.EMERGENCY or (self.emergency and act is not Key.RESET)
            self._hand(act, self.selection.order)
        elif act is not None:
            self._hand(act, self.selection.chosen)
        return True

    def toggle(self, name: str) -> None:
        """Mark a robot, or let it drive, or not."""
        before = self.selection.chosen
        self.selection.toggle(name)
        self._stop_left(before)

    def let_go(self) -> None:
        """Let the chosen robots stand: nobody is at the keys."""
        self._hand(Key.STOP, self.selection.chosen)

    def _stop_left(self, before: Sequence[str]) -> None:
        """Let the robots stand that were chosen before and are not now."""
        self._hand(Key.STOP, [name for name in before if name not in self.selection.chosen])

    def _hand(self, key: Key, names: Sequence[str]) -> None:
        """Hand a key to the drivers of robots, to those first that move."""
        drivers = [self._drivers[name] for name in names if name in self._drivers]
        for driver in sorted(drivers, key=lambda driver: not driver.moves):
            driver.press(key)
