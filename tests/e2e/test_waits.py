"""Whoever waits for a robot is told that the link is lost. Virtual time."""

import asyncio
import io
import json
import sys
from collections.abc import Awaitable, Callable
from math import inf
from typing import Any

import pytest

from pioneer3.behaviors.modes import wander
from pioneer3.cli import live, monitor, sonar
from pioneer3.errors import LinkError, MotionError
from pioneer3.navigation.connect import connect_async
from pioneer3.runtime.robot import Robot
from tests.support import SimulatedRobot

AT = 3.0
"""When the link fails [s]."""
TOLD = 2.5 + 0.05
"""Within this time everybody knows [s]."""


def now() -> float:
    return asyncio.get_running_loop().time()


async def lose(robot: SimulatedRobot, how: str, seconds: float = inf) -> None:
    """Let the link fail, for a while or for ever."""
    await asyncio.sleep(AT - now())
    if how == "unplugged":
        await robot.unplug()
    robot.silent = True
    if seconds < inf:
        await asyncio.sleep(seconds)
        robot.plugged, robot.silent = True, False


async def look(driver: Robot, seconds: float = inf, patience: float = 2.5) -> int:
    count = 0
    async for _ in driver.snapshots(seconds, patience):
        count += 1
    return count


Wait = Callable[[Robot], Awaitable[Any]]
MOTIONS: dict[str, Wait] = {
    "move": lambda driver: driver.move(50),
    "turn": lambda driver: driver.turn(50, 0.1),
    "goto": lambda driver: driver.goto(50, 0),
    "run": lambda driver: driver.run(wander()),
    "run for a time": lambda driver: driver.run(wander(), seconds=6),
}
READINGS: dict[str, Wait] = {
    "snapshots": look,
    "snapshots for a time": lambda driver: look(driver, 6),
}


@pytest.mark.parametrize("how", ["unplugged", "silent"])
@pytest.mark.parametrize("what", MOTIONS)
async def test_a_motion_fails_when_the_link_is_lost(what: str, how: str) -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        losing = asyncio.ensure_future(lose(robot, how))
        with pytest.raises(MotionError, match="No robot is connected: the link was lost") as told:
            await MOTIONS[what](driver)
        assert AT < now() < AT + TOLD
        assert isinstance(told.value.__cause__, LinkError)
        await losing


@pytest.mark.parametrize("how", ["unplugged", "silent"])
@pytest.mark.parametrize("what", READINGS)
async def test_who_waits_for_readings_is_told_that_the_link_is_lost(what: str, how: str) -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        losing = asyncio.ensure_future(lose(robot, how))
        with pytest.raises(LinkError, match="No robot is connected: the link was lost"):
            await READINGS[what](driver)
        assert AT < now() < AT + TOLD
        await losing


@pytest.mark.parametrize("end", [AT + 0.3, AT + 2.3])
async def test_an_end_that_comes_while_the_link_is_lost_is_an_error(end: float) -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        losing = asyncio.ensure_future(lose(robot, "unplugged"))
        with pytest.raises(LinkError):
            await look(driver, end - now())
        assert now() == pytest.approx(end)
        await losing


async def test_a_mode_whose_time_is_over_while_the_link_is_lost_has_failed() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        losing = asyncio.ensure_future(lose(robot, "unplugged"))
        with pytest.raises(MotionError, match="the link was lost"):
            await driver.run(wander(), AT + 1 - now())
        await losing


async def test_waiting_for_the_motors_fails_as_a_motion_does() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        robot.edit, began = lambda data: b"", now()
        with pytest.raises(MotionError, match="motors: No robot is connected"):
            await driver.motors(on=True)
        assert now() - began < TOLD


@pytest.mark.parametrize("gap", [1.0, 1.7])
async def test_a_short_silence_is_only_a_gap(gap: float) -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        losing = asyncio.ensure_future(lose(robot, "silent", gap))
        assert await look(driver, 10) == pytest.approx(10 * (10 - gap), abs=5)
        await losing


async def test_a_loss_that_is_mended_at_once_is_only_a_gap() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        losing = asyncio.ensure_future(lose(robot, "unplugged", 1.5))
        assert await look(driver, 10) == pytest.approx(80, abs=10)
        assert driver.snapshot is not None
        assert driver.snapshot.link.sessions == 2
        await losing


async def test_who_has_all_patience_is_told_at_the_end_only() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        losing = asyncio.ensure_future(lose(robot, "unplugged", 20))
        assert await look(driver, 60, inf) > 300
        robot.silent = True
        with pytest.raises(LinkError):
            await look(driver, 60, inf)
        await losing


async def test_after_the_error_a_new_iteration_waits_for_the_robot_to_be_back() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        losing = asyncio.ensure_future(lose(robot, "unplugged", 10))
        errors, seen = 0, 0
        while now() < 30:
            try:
                seen += await look(driver, 30 - now())
            except LinkError:
                errors += 1
        assert 1 < errors <= 5
        assert driver.snapshot is not None
        await losing


class Terminal(io.StringIO):
    """Standard output that keeps what was written when; a terminal or a pipe."""

    def __init__(self, *, isatty: bool) -> None:
        super().__init__()
        self.texts: list[tuple[float, str]] = []
        self._isatty = isatty

    def isatty(self) -> bool:
        return self._isatty

    def write(self, text: str) -> int:
        self.texts.append((now(), text))
        return len(text)

    def first(self, words: str) -> float:
        """Return when `words` were first written [s]."""
        return next(when for when, text in self.texts if words in text)


LOST = ("LOST: No robot is connected", '"snapshot":null', '"sonar":null')
COMMANDS: dict[str, Callable[[Robot, float], Awaitable[int]]] = {
    "monitor": monitor._print_lines,
    "monitor --json": monitor._print_json,
    "sonar": lambda driver, seconds: sonar.show_sonar(driver, seconds, json=False),
    "sonar --json": lambda driver, seconds: sonar.show_sonar(driver, seconds, json=True),
}


@pytest.mark.parametrize("back", [False, True])
@pytest.mark.parametrize("command", COMMANDS)
async def test_a_pipe_is_told_once_of_each_loss_and_the_shell_if_it_lasts(
    command: str, back: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    pipe = Terminal(isatty=False)
    monkeypatch.setattr(sys, "stdout", pipe)
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        losing = asyncio.ensure_future(lose(robot, "silent", 10 if back else inf))
        assert await COMMANDS[command](driver, 25.0) == (0 if back else 1)
        told = [text for _, text in pipe.texts if any(each in text for each in LOST)]
        assert len(told) == 1
        assert pipe.first(told[0]) < AT + TOLD
        if "json" in command:
            assert None in json.loads(told[0]).values()
        losing.cancel()


@pytest.mark.parametrize("isatty", [False, True])
async def test_the_live_line_of_a_motion_says_that_the_link_is_lost(
    isatty: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = Terminal(isatty=isatty)
    monkeypatch.setattr(sys, "stdout", out)
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        losing = asyncio.ensure_future(lose(robot, "silent"))
        await live.show_while(driver, asyncio.sleep(10))
        assert out.first("LOST") < AT + TOLD
        losing.cancel()


async def test_wander_for_a_time_fails_when_the_link_is_lost(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(sys, "stdout", Terminal(isatty=False))
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        losing = asyncio.ensure_future(lose(robot, "unplugged"))
        with pytest.raises(MotionError, match="the link was lost"):
            await live.show_while(driver, driver.run(wander(), 5))
        await losing
