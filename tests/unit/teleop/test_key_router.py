"""One keyboard for several robots."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import AsyncExitStack, asynccontextmanager
from dataclasses import dataclass
from typing import cast

from pioneer3.navigation.connect import connect_async
from pioneer3.teleop.keyboard import Key, Keyboard
from pioneer3.teleop.keyboard_drive import KeyboardDriver
from pioneer3.teleop.several import KeyRouter, numbers
from tests.support import SimulatedRobot

UP, LEFT = "\x1b[A", "\x1b[D"


def test_the_lab_numbers_its_robots() -> None:
    names = ["RosAria_p3at_1_113", "RosAria_p3dx_5_160"]
    assert numbers(names) == {"RosAria_p3at_1_113": 1, "RosAria_p3dx_5_160": 5}


def test_others_are_numbered_in_their_order() -> None:
    assert numbers(["front", "rear"]) == {"front": 0, "rear": 1}
    assert numbers(["a_p3at_1_1", "b_p3at_1_1"]) == {"a_p3at_1_1": 0, "b_p3at_1_1": 1}


@dataclass
class Seat:
    """Somebody at the keyboard.

    Attributes:
        sims: Their robots, numbers 1 and 3.
        lines: Every live line.
    """

    board: KeyRouter
    sims: list[SimulatedRobot]
    lines: list[str]
    typed: "asyncio.Queue[str]"
    driving: "asyncio.Future[None]"

    async def press(self, *tokens: str, seconds: float = 2.0) -> list[int]:
        """Press keys, wait; return which way each robot drives."""
        for token in tokens:
            self.typed.put_nowait(token)
        await asyncio.sleep(seconds)
        return [round(sim.speed * 10) for sim in self.sims]


@asynccontextmanager
async def seat() -> AsyncIterator[Seat]:
    async with AsyncExitStack() as stack:
        typed: asyncio.Queue[str] = asyncio.Queue()

        async def tokens() -> AsyncIterator[str]:
            while True:
                yield await typed.get()

        lines: list[str] = []
        board, sims = KeyRouter({"one": 1, "three": 3}, lines.append), []
        for name in board.selection.numbers:
            sims.append(sim := await stack.enter_async_context(SimulatedRobot()))
            robot = await stack.enter_async_context(connect_async(sim.open))
            keyboard = Keyboard(speed=0.2, latch=True)
            board.add(name, KeyboardDriver(robot, keyboard, board.shows(name)))
        driving = asyncio.ensure_future(board.run(tokens()))
        yield Seat(board, sims, lines, typed, driving)
        driving.cancel()
        await asyncio.wait([driving])


async def test_keys_go_to_the_robot_chosen_and_the_one_left_stands() -> None:
    async with seat() as the:
        assert await the.press(UP) == [2, 0]
        assert await the.press("q") == [0, 0]
        assert await the.press(UP) == [0, 2]
        assert await the.press("q") == [0, 0]
        assert await the.press("3", UP) == [0, 2]
        assert await the.press("1", UP) == [2, 0]


async def test_all_drive_together_and_space_stops_all() -> None:
    async with seat() as the:
        assert await the.press("a", UP) == [2, 2]
        assert await the.press("1") == [2, 0]  # who stays chosen goes on
        assert await the.press("3", UP) == [0, 2]
        assert await the.press("1", " ") == [0, 0]


async def test_a_number_that_no_robot_has_changes_nothing() -> None:
    async with seat() as the:
        assert await the.press(UP, "7") == [2, 0]
        assert the.board.selection.chosen == ("one",)


async def test_letters_that_drive_elsewhere_do_not_here() -> None:
    async with seat() as the:
        assert await the.press("w", "s", "d", "y") == [0, 0]


async def test_the_live_line_tells_who_drives() -> None:
    async with seat() as the:
        await the.press(UP)
        assert the.lines[-1].startswith("one:  0.20 m/s")
        await the.press("a")
        assert the.lines[-1].startswith("ALL ROBOTS: ")


async def test_the_emergency_stop_is_for_all_and_leaving_stops_all() -> None:
    async with seat() as the:
        await the.press("a", UP)
        assert await the.press("k") == [0, 0]
        assert [sim.powered for sim in the.sims] == [False, False]
        the.typed.put_nowait("\x04")
        await asyncio.wait_for(the.driving, 5.0)


async def test_a_stop_goes_first_to_those_that_move_whoever_is_chosen() -> None:
    told: list[str] = []

    @dataclass
    class Noted:
        name: str
        moves: bool

        def press(self, key: Key) -> None:
            told.append(self.name)

    board = KeyRouter({name: number for number, name in enumerate("abcd")})
    for name in "abcd":
        board.add(name, cast("KeyboardDriver", Noted(name, moves=name in "bd")))
    assert board.press(" ")
    assert told == ["b", "d", "a", "c"]


async def test_escape_ends_choosing_and_then_the_program() -> None:
    async with seat() as the:
        assert await the.press("s", "3", "\x1b", UP) == [2, 0]
        assert await the.press("s", "1", "3", "y", UP) == [2, 2]
        the.typed.put_nowait("\x1b")
        await asyncio.wait_for(the.driving, 5.0)


async def test_the_live_line_asks_which_robots_while_several_are_chosen() -> None:
    async with seat() as the:
        await the.press("s", "3")
        assert the.lines[-1].endswith("marked: three")
