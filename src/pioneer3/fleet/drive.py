"""Drives the robots of a fleet with one keyboard; it knows no screen."""

import asyncio
from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager

from pioneer3.errors import ConfigError
from pioneer3.fleet.group import GroupKey, RobotGroup
from pioneer3.fleet.members import Connect, Member, Members
from pioneer3.fleet.places import StartPlaces
from pioneer3.fleet.spec import FleetRobot
from pioneer3.runtime.driven import Driven
from pioneer3.teleop.keyboard import Manner
from pioneer3.teleop.keyboard_drive import KeyboardDriver
from pioneer3.teleop.several import KeyRouter, numbers


class FleetDrive:
    """Robots, those of them that are chosen, and the keys that drive them.

    The key `g` starts what they do `together`. Robots that are `lined_up` stand so far apart [m],
    from left to right by their numbers. The quit key sets the event `over`.
    """

    def __init__(
        self,
        robots: Sequence[FleetRobot],
        connect: Connect,
        manner: Manner,
        *,
        together: GroupKey | None = None,
        lined_up: float | None = None,
    ) -> None:
        if not robots:
            raise ConfigError("no robot is named: there is nobody to drive")
        self.board = KeyRouter(numbers([robot.name for robot in robots]))
        order = self.board.selection.order
        self.group = RobotGroup(order, together)
        self._places = StartPlaces(order, lined_up)
        if together is not None and together.leader is not None:
            self.board.selection.choose(together.leader)
        self.over = asyncio.Event()
        self._manner = manner
        self._members = Members(robots, self.board.selection.numbers, connect, self._join)

    async def run(self) -> None:
        """Keep the robots connected until cancelled; then all stand."""
        await self._members.run()

    def press(self, token: str) -> None:
        """Obey a key, by the text that a terminal sends for it."""
        if token in {"g", "G"}:
            self.group.start()
        elif not self.board.press(token):
            self.over.set()

    def let_go(self) -> None:
        """Let all stand that the keys or the mode of the group drive: nobody is at the keys."""
        self.group.end("the terminal lost the focus")
        self.board.let_go()

    def look(self) -> list[Member]:
        """Return the state of all robots now, by their numbers."""
        return self._members.look()

    @asynccontextmanager
    async def _join(self, robot: FleetRobot, driven: Driven) -> AsyncIterator[None]:
        """Let a robot that is connected have the keys for the length of the block."""
        driven.arbiter.remembers = False
        driver = KeyboardDriver(driven, self._manner.keyboard(driven.info.limits))
        name = robot.name
        async with driver.driving(), self._places.of(name, driven) as place:
            with self.group.joined(name, driven, place), self.board.joined(name, driver):
                yield
