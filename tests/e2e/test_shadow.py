"""A robot beside its simulated twin: where they part, and the reason that is found."""

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager, suppress
from dataclasses import replace
from random import Random

import pytest

from benchmarks.shadow import WITHIN, Fault, drags, holds, named, slips
from pioneer3 import connect_async
from pioneer3.cli.diagnosis import _driven
from pioneer3.doctor.facts import Level
from pioneer3.errors import MotionError
from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap
from pioneer3.runtime.parting import Cause
from pioneer3.runtime.robot import Robot
from pioneer3.runtime.shadow import Shadow
from pioneer3.sim.kernels.drives import BOTH_STALLED, STALLED, TARGET, VELOCITY
from pioneer3.sim.realism import OdometryErrors, Realism
from pioneer3.sim.worldfile import load_map
from tests.support import SLOW, SimulatedRobot, wall_at

SPEEDS = (-0.2, 0.0, 0.1, 0.2, 0.3, 0.5, 0.7)
TURN_RATES = (0.0, 0.0, 0.3, -0.5, 0.8, -1.0)
RAMP = 0.02
"""More than a wheel's speed changes in a tick [m/s]."""
SLIPPERY = OdometryErrors(mode="constant", scale=0.95, base_ratio=1.0, wheel_ratio=1.0)


@asynccontextmanager
async def shadowed(simulated: SimulatedRobot) -> AsyncIterator[tuple[Robot, Shadow]]:
    """Connect to a robot that has a shadow, whose place is always known."""
    async with simulated, connect_async(simulated.open, record=False, shadow=True) as robot:
        assert robot.shadow is not None
        body = simulated.body
        robot.shadow.odom_in_map = lambda: body.robot_in_world @ odometry_of(robot).inverse()
        yield robot, robot.shadow


def odometry_of(robot: Robot) -> Pose2:
    assert robot.snapshot is not None
    return robot.snapshot.odometry.robot_in_odom


async def drive(robot: Robot, speed: float, turn_rate: float, seconds: float) -> list[Cause]:
    """Hold a stick; return the causes that were told meanwhile."""
    told = []
    assert robot.shadow is not None
    for _ in range(round(10 * seconds)):
        with suppress(MotionError):
            robot.drive(speed, turn_rate)
        await asyncio.sleep(0.1)
        if robot.shadow.parting is not None:
            told.append(robot.shadow.parting.cause)
    return told


def weakened(simulated: SimulatedRobot, left: float, right: float) -> Callable[[], None]:
    """Return a step after which wheels have no more than a share of the speed wanted of them."""
    axes, half = simulated.body.drives.axes, simulated.body.track / 2

    def wheels(row: int) -> tuple[float, float]:
        v, w = axes[row, :, 0]
        return v - w * half, v + w * half

    def step() -> None:
        wanted = zip(wheels(VELOCITY), wheels(TARGET), (left, right), strict=True)
        slow_left, slow_right = (
            share * top if abs(now) > abs(share * top) - RAMP else now for now, top, share in wanted
        )
        axes[VELOCITY, :, 0] = (slow_left + slow_right) / 2, (slow_right - slow_left) / (2 * half)

    return step


@pytest.mark.parametrize(
    ("model", "latency"),
    [
        ("p3dx-sh", 0.2),
        ("p3at-sh", 0.0),
        pytest.param("p3dx-sh", 0.0, marks=pytest.mark.thorough),
        pytest.param("p3at-sh", 0.2, marks=pytest.mark.thorough),
    ],
)
async def test_a_sound_robot_does_what_its_twin_does(model: str, latency: float) -> None:
    random = Random(7)
    simulated = SimulatedRobot(model=model, realism=Realism())
    simulated.latency = latency
    async with shadowed(simulated) as (robot, shadow):
        if latency:
            shadow.odom_in_map = lambda: None  # the truth of now is not that of the report
        for _ in range(30):
            speed, turn_rate = random.choice(SPEEDS), random.choice(TURN_RATES)
            assert await drive(robot, speed, turn_rate, random.uniform(0.5, 4.0)) == []


@pytest.mark.parametrize("speed", [0.25, 0.5])
async def test_slip_is_named(speed: float) -> None:
    simulated = SimulatedRobot(model="p3dx-sh", realism=replace(Realism(), odometry=SLIPPERY))
    async with shadowed(simulated) as (robot, _):
        assert await drive(robot, speed, 0.0, WITHIN + 0.5) != []
        assert set(await drive(robot, speed, 0.0, 5.0)) == {Cause.SLIPS}


@pytest.mark.parametrize(
    ("left", "right", "cause"),
    [
        (0.8, 1.0, Cause.LEFT_DRAGS),
        (1.0, 0.8, Cause.RIGHT_DRAGS),
        (0.8, 0.8, Cause.SLOW),
        (0.0, 0.0, Cause.HELD),
    ],
)
async def test_slow_wheels_are_named(left: float, right: float, cause: Cause) -> None:
    simulated = SimulatedRobot(model="p3dx-sh")
    async with shadowed(simulated) as (robot, _):
        assert await drive(robot, 0.3, 0.0, 6.0) == []
        simulated.stepped = weakened(simulated, left, right)
        await drive(robot, 0.3, 0.0, WITHIN)
        assert set(await drive(robot, 0.3, 0.0, 1.0)) == {cause}


@pytest.mark.parametrize(
    ("line_map", "drag", "level", "found"),
    [
        (None, 0.1, Level.OK, "does what its simulated twin does"),
        (None, 1.0, Level.FAIL, "not as its simulated twin: its left side drags"),
        (wall_at(0.8), 0.0, Level.WARN, "could not be tried: something is 0"),
    ],
)
async def test_the_doctor_drives_beside_a_twin(
    line_map: LineMap | None, drag: float, level: Level, found: str
) -> None:
    pytest.importorskip("mujoco")
    simulated = SimulatedRobot(line_map, model="p3dx-sh", physics="mujoco")
    drags(drag, 0)(simulated)
    async with simulated:
        told = await _driven(simulated.open, None, None, json=True)
        assert abs(simulated.body.speeds[0]) < SLOW
    assert (told.check, told.level) == ("drive", level)
    assert told.found.startswith(found)


async def test_an_empty_battery_is_the_reason_for_slow_wheels() -> None:
    simulated = SimulatedRobot(model="p3dx-sh")
    simulated.body.battery.fixed = 11.2
    simulated.stepped = weakened(simulated, 0.8, 0.8)
    async with shadowed(simulated) as (robot, _):
        await drive(robot, 0.3, 0.0, WITHIN)
        assert set(await drive(robot, 0.3, 0.0, 1.0)) == {Cause.BATTERY}


async def test_wheels_that_stall_in_the_open_are_held() -> None:
    simulated = SimulatedRobot(model="p3dx-sh")

    def held() -> None:
        simulated.body.drives.axes[VELOCITY, :, 0] = 0.0
        simulated.body.drives.flags[STALLED] = BOTH_STALLED

    async with shadowed(simulated) as (robot, _):
        assert await drive(robot, 0.3, 0.0, 6.0) == []
        simulated.stepped = held
        assert set(await drive(robot, 0.3, 0.0, 1.0)) == {Cause.HELD}


@pytest.mark.parametrize(
    ("model", "seed", "fault", "cause"),
    [
        ("p3dx-sh", 3, holds, Cause.HELD),
        ("p3dx-sh", 3, drags(1.0, 0), Cause.LEFT_DRAGS),
        pytest.param("p3dx-sh", 3, drags(1.0, 1), Cause.RIGHT_DRAGS, marks=pytest.mark.thorough),
        ("p3dx-sh", 7, slips, Cause.SLIPS),
        pytest.param("p3at-sh", 4, holds, Cause.HELD, marks=pytest.mark.thorough),
        ("p3at-sh", 1, drags(1.25, 1), Cause.RIGHT_DRAGS),
        *(
            pytest.param(
                "p3at-sh", seed, drags(1.0, 1), Cause.RIGHT_DRAGS, marks=pytest.mark.thorough
            )
            for seed in (3, 5)
        ),
    ],
)
async def test_faults_of_robots_with_mass_are_named(
    model: str, seed: int, fault: Fault, cause: Cause
) -> None:
    pytest.importorskip("mujoco")
    told = await named(model, seed, fault)
    assert told[-1][1] is cause
    assert all(0 < at <= WITHIN for at, _ in told)


async def test_a_side_that_brakes_hard_into_a_turn_does_not_drag() -> None:
    pytest.importorskip("mujoco")
    simulated = SimulatedRobot(model="p3at-sh", realism=Realism(), seed=1, physics="mujoco")
    stalled = []
    simulated.stepped = lambda: stalled.append(simulated.body.drives.flags[STALLED, 0])
    async with shadowed(simulated) as (robot, _):
        assert await drive(robot, 0.69, -0.08, 4.0) + await drive(robot, -0.15, 0.5, 3.0) == []
    assert any(stalled)


async def test_wheels_that_stall_at_a_wall_met_something() -> None:
    simulated = SimulatedRobot(load_map("office"), home=Pose2(3.0, 3.1, -1.57))
    async with shadowed(simulated) as (robot, _):
        assert set(await drive(robot, 0.3, 0.0, 12.0)) == {Cause.IN_THE_WAY}


async def test_wheels_that_spin_are_named() -> None:
    simulated = SimulatedRobot(model="p3dx-sh")
    async with shadowed(simulated) as (robot, _):
        assert await drive(robot, 0.3, 0.0, 6.0) == []
        here = simulated.body.robot_in_world

        def stuck() -> None:
            simulated.body.robot_in_world = here

        simulated.stepped = stuck
        await drive(robot, 0.3, 0.0, 6.0)
        assert set(await drive(robot, 0.3, 0.0, 1.0)) == {Cause.SPINS}


async def test_a_new_session_begins_with_a_new_twin() -> None:
    simulated = SimulatedRobot(model="p3dx-sh")
    async with shadowed(simulated) as (robot, _):
        await drive(robot, 0.3, 0.2, 3.0)
        await simulated.unplug()
        simulated.power_cycle()
        await asyncio.sleep(4.0)
        simulated.plugged = True
        await asyncio.sleep(8.0)
        assert robot.snapshot is not None
        assert await drive(robot, 0.3, -0.2, 6.0) == []


async def test_the_twin_begins_beside_the_robot_and_goes_on_alone() -> None:
    simulated = SimulatedRobot(model="p3dx-sh")
    simulated.stepped = weakened(simulated, 0.0, 0.0)
    async with shadowed(simulated) as (robot, shadow):
        await drive(robot, 0.2, 0.0, 10.0)
        assert shadow.parting is not None
        assert shadow.parting.twin_in_odom.x == pytest.approx(1.0, abs=0.05)
        assert "wheels do not turn" in shadow.parting.text
