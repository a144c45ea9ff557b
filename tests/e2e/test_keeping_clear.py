"""Nobody is hit: the whole driver against walls and people, however slow the link. Virtual time."""

import asyncio
from collections.abc import Callable
from math import pi

import numpy as np
import pytest

from pioneer3 import Robot, connect_async
from pioneer3.behaviors.action import Stack
from pioneer3.behaviors.actions import RatioInput
from pioneer3.behaviors.modes import goto, wander
from pioneer3.behaviors.modes.by_hand import teleop
from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap
from pioneer3.sim.kernels.drives import TOUCHED
from pioneer3.sim.realism import Realism
from pioneer3.sim.worldfile import Person
from tests.combinations import pairwise
from tests.support import SimulatedRobot

SPEED = 0.4
ROOM = LineMap(
    name="room",
    walls=np.array(
        [
            [-2.0, -3.0, 4.0, -3.0],
            [4.0, -3.0, 4.0, 3.0],
            [4.0, 3.0, -2.0, 3.0],
            [-2.0, 3.0, -2.0, -3.0],
        ]
    ),
)
SECONDS = 25.0


def pushed(robot: Robot) -> Stack:
    """Return guarded driving with the stick pushed for `SPEED`."""
    ratios = RatioInput()
    ratios.push(min(1.0, SPEED / robot.info.limits.max_speed), 0.0)
    return teleop(ratios)


def backed(robot: Robot) -> Stack:
    """Return the same backwards."""
    ratios = RatioInput(full_backwards=SPEED)
    ratios.push(-1.0, 0.0)
    return teleop(ratios)


MODES: dict[str, Callable[[Robot], Stack]] = {
    "teleop": pushed,
    "backwards": backed,
    "goto": lambda robot: goto(9.0, 0.0, speed=SPEED),
    "wander lab": lambda robot: wander(preset="lab", speed=SPEED),
    "wander aria": lambda robot: wander(preset="aria", speed=SPEED),
}


@pytest.mark.parametrize(
    ("model", "who", "mode", "latency"),
    pairwise(["p3at-sh", "p3dx-sh"], ["wall", "person"], list(MODES), [0.0, 0.1, 0.2, 0.3]),
)
async def test_nothing_is_touched(model: str, who: str, mode: str, latency: float) -> None:
    home = Pose2(0.0, 0.2, pi if mode == "backwards" else 0.1)
    sim = SimulatedRobot(ROOM, model=model, home=home, realism=Realism(), seed=7)
    sim.latency = latency
    touched: list[tuple[float, Pose2]] = []
    if who == "person":
        sim.world.add_obstacle(Person(name="Ada", path=((2.2, 0.3),)))

    def watch() -> None:
        if sim.body.drives.flags[TOUCHED, sim.body.number] and not touched:
            touched.append((sim.world.time, sim.body.robot_in_world))

    sim.stepped = watch
    async with sim, connect_async(sim.open) as robot:
        robot.arbiter.start(MODES[mode](robot))
        await asyncio.sleep(SECONDS)
        ended = robot.arbiter.ended
        if mode == "goto" and ended is not None:  # somebody stands in the way for long
            assert ended.why.startswith("something is in the way")
        else:
            assert robot.arbiter.mode is not None
        way = sim.body.robot_in_world.x - home.x
    assert touched == []
    assert abs(way) > 0.3 or mode.startswith("wander")


@pytest.mark.parametrize("mode", MODES)
async def test_an_emergency_stop_ends_every_mode(mode: str) -> None:
    async with SimulatedRobot() as sim, connect_async(sim.open) as robot:
        robot.arbiter.start(MODES[mode](robot))
        await asyncio.sleep(3.0)
        assert abs(sim.speed) > 0.1
        robot.emergency_stop()
        await asyncio.sleep(0.5)
        assert sim.speed == 0.0
        assert not sim.powered
        assert robot.arbiter.mode is None


@pytest.mark.parametrize("mode", MODES)
async def test_the_stop_button_ends_every_mode(mode: str) -> None:
    async with SimulatedRobot() as sim, connect_async(sim.open) as robot:
        robot.arbiter.start(MODES[mode](robot))
        await asyncio.sleep(3.0)
        sim.body.stop_button = True
        await asyncio.sleep(1.5)
        sim.body.stop_button = False
        await asyncio.sleep(2.0)
        assert sim.speed == 0.0
        assert robot.arbiter.ended is not None
        assert robot.arbiter.ended.why == "the stop button on the robot is pressed"
