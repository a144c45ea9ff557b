"""Modes on a simulated robot: what starts, overrides and ends them. Virtual time."""

import asyncio
import logging
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass
from math import inf
from pathlib import Path

import pytest

from pioneer3 import MotionError, Robot, connect_async
from pioneer3.behaviors.action import MODE, Action, Desire, Goal, Ranked, Situation, Stack
from pioneer3.behaviors.actions import Hold, Move
from pioneer3.geometry import Twist2
from pioneer3.links.tap import read_recording
from pioneer3.log.reader import open_log
from pioneer3.log.topics import LogTopic
from pioneer3.runtime.arbiter import KEYBOARD
from pioneer3.runtime.recording import CommandGiven, DecisionMade
from tests.support import SLOW, SimulatedRobot, wall_at


@dataclass
class Go(Action):
    """Drives ahead, and backs off a stalled robot if it is to."""

    name: str = "go"
    speed: float = 0.3
    answers_stalls: bool = False

    def decide(self, situation: Situation) -> Desire | None:
        if self.answers_stalls and situation.snapshot.motors.stalled:
            return Desire(v=-0.1, answers_stall=True)
        return Desire(v=self.speed)


@dataclass
class Keep(Action):
    """Lets the robot no nearer to what its sonar sees than a metre."""

    name: str = "keep away"

    def decide(self, situation: Situation) -> Desire | None:
        ahead = situation.around.nearest(-0.3, 0.3).distance
        return Desire(v_max=0.0, reason=f"{ahead:.1f} m ahead") if ahead < 1.0 else None


@dataclass
class Points(Action):
    """Wants nothing, and has a goal."""

    to: Goal
    name: str = "points"

    @property
    def goal(self) -> Goal:
        return self.to

    def decide(self, situation: Situation) -> Desire | None:
        return None


@dataclass
class Fails(Action):
    """Works for a while."""

    name: str = "shy"
    left: int = 5

    def decide(self, situation: Situation) -> Desire | None:
        self.left -= 1
        return Desire(v=0.3 / max(0, self.left)) if self.left < 2 else Desire(v=0.3)


def mode(*actions: Action) -> Stack:
    return Stack.of("mode", MODE, [Ranked(-n, action) for n, action in enumerate(actions)])


@asynccontextmanager
async def robot_at(wall: float = inf) -> AsyncIterator[tuple[SimulatedRobot, Robot]]:
    line_map = wall_at(wall) if wall < inf else None
    async with SimulatedRobot(line_map) as sim, connect_async(sim.open) as robot:
        yield sim, robot


async def test_a_mode_drives_until_its_time_is_over() -> None:
    async with robot_at() as (sim, robot):
        await robot.run(mode(Go()), 3.0)
        assert sim.body.robot_in_world.x > 0.4
        await asyncio.sleep(1.0)
        assert sim.speed == 0.0
        assert robot.arbiter.mode is None


async def test_a_mode_ends_when_it_has_done_what_it_is_for() -> None:
    async with robot_at() as (sim, robot):
        move = Move(distance=0.5, speed=0.3, deceleration=1.0)
        await robot.run(mode(move, Points(Goal(x=0.5, y=0.0, name="Kitchen"))))
        assert sim.body.robot_in_world.x == pytest.approx(0.5, abs=0.02)
        assert robot.arbiter.ended is not None
        assert robot.arbiter.ended.done
        assert robot.arbiter.ended.place == "Kitchen"


async def test_a_second_mode_replaces_the_first() -> None:
    async with robot_at() as (sim, robot):
        first = asyncio.ensure_future(robot.run(mode(Go())))
        await asyncio.sleep(2.0)
        robot.arbiter.start(mode(Go("back", -0.2)))
        with pytest.raises(MotionError, match="mode: another mode was started"):
            await first
        await asyncio.sleep(2.0)
        assert sim.speed == pytest.approx(-0.2, abs=0.01)


async def test_hands_come_before_a_mode_which_then_goes_on() -> None:
    async with robot_at() as (sim, robot):
        held = Hold("keyboard")
        robot.arbiter.add(held, KEYBOARD)
        robot.arbiter.start(mode(Go()))
        await asyncio.sleep(2.0)
        for _ in range(20):
            robot.arbiter.hold(held, Twist2(-0.2, 0.0), 0.3)
            await asyncio.sleep(0.1)
        assert sim.speed == pytest.approx(-0.2, abs=0.01)
        robot.arbiter.release(held)
        await asyncio.sleep(2.0)
        assert sim.speed == pytest.approx(0.3, abs=0.01)


async def test_limits_of_a_mode_hold_for_hands_too() -> None:
    async with robot_at(2.0) as (sim, robot):
        held = Hold("keyboard")
        robot.arbiter.add(held, KEYBOARD)
        robot.arbiter.start(mode(Keep()))
        for _ in range(150):
            robot.arbiter.hold(held, Twist2(0.3, 0.0), 0.3)
            await asyncio.sleep(0.1)
        assert sim.speed == 0.0
        assert 0.8 < sim.body.robot_in_world.x < 1.2
        why = robot.why_not_moving()
        assert why is not None
        assert why.text.startswith("It stands because of keep away, ")


@pytest.mark.parametrize("stop", ["stop", "emergency_stop"])
async def test_a_stop_ends_a_mode(stop: str) -> None:
    async with robot_at() as (sim, robot):
        running = asyncio.ensure_future(robot.run(mode(Go())))
        await asyncio.sleep(2.0)
        getattr(robot, stop)()
        with pytest.raises(MotionError, match="mode: somebody stopped the robot"):
            await running
        await asyncio.sleep(2.0)
        assert sim.speed == 0.0


async def test_an_action_that_fails_stops_the_robot_and_is_named(
    caplog: pytest.LogCaptureFixture,
) -> None:
    async with robot_at() as (sim, robot):
        with (
            caplog.at_level(logging.CRITICAL, "pioneer3.runtime.arbiter"),
            pytest.raises(MotionError, match="the action 'shy' failed: ZeroDivisionError"),
        ):
            await robot.run(mode(Fails(), Go()))
        await asyncio.sleep(1.0)
        assert sim.speed == 0.0
        assert robot.snapshot is not None
        await robot.run(mode(Go()), 2.0)  # the robot still obeys
        assert sim.body.robot_in_world.x > 0.2


async def test_a_stall_ends_the_motion_of_a_mode() -> None:
    async with robot_at(0.6) as (sim, robot):
        with pytest.raises(MotionError, match="mode: the wheels stalled"):
            await robot.run(mode(Go()))
        assert abs(sim.speed) < SLOW
        await asyncio.sleep(0.5)
        assert str(robot.why_not_moving()).startswith(
            "Waiting for a fresh command: the wheels stalled; drive the other way"
        )


async def test_an_answer_to_a_stall_drives_on() -> None:
    async with robot_at(0.6) as (sim, robot):
        robot.arbiter.start(mode(Go(answers_stalls=True)))
        moved, before = 0.0, sim.body.robot_in_world.x
        for _ in range(100):
            await asyncio.sleep(0.1)
            here = sim.body.robot_in_world.x
            moved, before = moved + max(0.0, before - here), here
        assert moved > 0.004  # it has backed off, again and again
        assert robot.supervisor.pilot.blocked is None


async def test_a_lost_link_ends_a_mode() -> None:
    async with robot_at() as (sim, robot):
        running = asyncio.ensure_future(robot.run(mode(Go())))
        await asyncio.sleep(2.0)
        await sim.unplug()
        sim.plugged = True
        with pytest.raises(MotionError, match="mode: the link was lost"):
            await running
        await asyncio.sleep(3.0)
        assert robot.snapshot is not None
        assert sim.speed == 0.0
        robot.arbiter.start(mode(Go()))
        await asyncio.sleep(2.0)
        assert sim.speed == pytest.approx(0.3, abs=0.01)


async def test_a_mode_that_may_not_drive_ends_at_once_and_says_why() -> None:
    async with robot_at() as (_, robot):
        robot.emergency_stop()
        with pytest.raises(MotionError, match="mode: the emergency stop is latched"):
            await robot.run(mode(Go()))


async def test_a_recording_says_what_decided(tmp_path: Path) -> None:
    path = tmp_path / "drive.mcap"
    async with SimulatedRobot() as sim, connect_async(sim.open, record=path) as robot:
        await robot.run(mode(Go()), 1.0)
    made = [each for _, each in open_log(path).of(LogTopic("decision", DecisionMade))]
    driven = [each for each in made if each.decision.wanted]
    assert {(each.mode, each.told) for each in driven} == {("mode", ("0.30 m/s: go",))}
    assert len(driven) == 1  # not at every report
    assert made[-1].told == ()
    given = [each for _, each in open_log(path).of(LogTopic("command", CommandGiven))]
    assert [(each.by, each.command) for each in given][:2] == [
        ("", "stop: the mode mode was started"),
        ("mode", "start"),
    ]
    assert any(chunk.data for chunk in read_recording(path))
