"""One keyboard for several robots: keys go to those chosen."""

import asyncio
import re
from collections.abc import AsyncIterator, Callable, Sequence
from typing import Final

from pioneer3.tasks import running
from pioneer3.teleop.drive import KeyboardDriver
from pioneer3.teleop.keyboard import Key
from pioneer3.teleop.terminal import SEQUENCES

KEYS: Final = (
    "arrows: drive   q: next robot   0-9: this robot   a: all   space: stop all   + -: speed   "
    "m: motors   k: emergency stop   Ctrl-R: release it   Ctrl-D: quit"
)
NEXT, ALL, QUIT = {"q", "\t"}, {"a"}, {"\x04", "\x1b"}
FOR_ALL: Final = {Key.STOP, Key.EMERGENCY, Key.RESET}
"""Keys that every robot obeys, chosen or not."""
LETTERS: Final = {"w", "a", "s", "d", "q"}
"""They drive where there is one robot; here arrows do."""
LAB_NUMBER: Final = re.compile(r".*p3[a-z]+_(\d)_")
"""The lab numbers its robots, as in p3at_1_113."""


def numbers(names: Sequence[str]) -> dict[str, int]:
    """Return a digit for each robot: the lab's, or else in their order from 0."""
    found = [match[1] for name in names if (match := LAB_NUMBER.match(name))]
    if len(set(found)) == len(names):
        return {name: int(digit) for name, digit in zip(names, found, strict=True)}
    return {name: number for number, name in enumerate(names)}


class Switchboard:
    """Passes keys on to the drivers of robots.

    Args:
        numbers: The digit of each robot.
        show: Given the live line of the robot chosen.

    Attributes:
        chosen: The robots that drive; the others stand.
    """

    def __init__(self, numbers: dict[str, int], show: Callable[[str], None]) -> None:
        self.numbers = numbers
        self.chosen = [min(numbers, key=lambda name: numbers[name])]
        self._show = show
        self._drivers: dict[str, KeyboardDriver] = {}
        self._keys: dict[str, asyncio.Queue[Key]] = {name: asyncio.Queue() for name in numbers}

    def shows(self, name: str) -> Callable[[str], None]:
        """Return what to give the live lines of a robot to."""

        def show(line: str) -> None:
            if name == self.chosen[0]:
                who = name if len(self.chosen) == 1 else "ALL ROBOTS"
                self._show(f"{who}: {line}")

        return show

    def add(self, name: str, driver: KeyboardDriver) -> None:
        """Let `driver` have the keys of this robot."""
        self._drivers[name] = driver

    async def run(self, tokens: AsyncIterator[str]) -> None:
        """Drive until the quit key or the end of `tokens`; then all robots stand."""
        driving = [driver.run(_pressed(self._keys[name])) for name, driver in self._drivers.items()]
        async with running(*driving):
            async for token in tokens:
                if token in QUIT:
                    return
                self.press(token)

    def press(self, token: str) -> None:
        """Obey a key."""
        order = sorted(self.numbers, key=lambda name: self.numbers[name])
        if token in NEXT:
            self._choose([order[(order.index(self.chosen[0]) + 1) % len(order)]])
        elif token in ALL:
            self._choose(order)
        elif token.isdecimal():
            self._choose([name for name in order if self.numbers[name] == int(token)])
        elif token not in LETTERS and (key := SEQUENCES.get(token)):
            for name in order if key in FOR_ALL else self.chosen:
                self._keys[name].put_nowait(key)

    def _choose(self, names: Sequence[str]) -> None:
        """Let these robots have the keys; who had them and is left stands."""
        for name in self.chosen:
            if names and name not in names:
                self._keys[name].put_nowait(Key.STOP)
        self.chosen = list(names) or self.chosen


async def _pressed(keys: "asyncio.Queue[Key]") -> AsyncIterator[Key]:
    while True:
        yield await keys.get()
