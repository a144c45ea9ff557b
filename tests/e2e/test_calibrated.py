"""A robot whose own file has the errors of its odometry knows where it is, and drives as asked."""

import asyncio
from dataclasses import replace
from math import degrees, hypot, pi, radians
from pathlib import Path

import pytest

from pioneer3.geometry import wrap
from pioneer3.models import OdometryCorrection
from pioneer3.models.odometry import UNCORRECTED
from pioneer3.models.own import own_folder
from pioneer3.navigation.connect import connect_async
from pioneer3.ros.messages.motion import odometry
from pioneer3.runtime.robot import Robot
from pioneer3.sim.realism import OdometryErrors, Realism
from pioneer3.sim.worldfile.spec import Physics
from tests.support import SimulatedRobot
from tests.unit.ros.support import Blank, update

WRONG = OdometryErrors(mode="constant", scale=1.02, base_ratio=0.975, wheel_ratio=1.015, slip=0.0)
OTHER = replace(WRONG, scale=0.96, base_ratio=1.03, wheel_ratio=0.99)


def calibrate(
    errors: OdometryErrors | OdometryCorrection, file: str = "MobileSim.toml", like: str = "p3dx-sh"
) -> Path:
    """Write the errors into a robot's own file; return its path."""
    own_folder().mkdir(parents=True, exist_ok=True)
    names = ("scale", "base_ratio", "wheel_ratio")
    ratios = "\n".join(f"{name} = {getattr(errors, name)}" for name in names)
    path = own_folder() / file
    path.write_text(f'like = "{like}"\n\n[odometry]\n{ratios}\n')
    return path


def robot_with(
    errors: OdometryErrors, model: str = "p3dx-sh", physics: Physics = "planar", seed: int = 0
) -> SimulatedRobot:
    realism = replace(Realism.ideal(), odometry=errors)
    return SimulatedRobot(model=model, realism=realism, physics=physics, seed=seed)


async def apart_after_square(errors: OdometryErrors, turn: int, **how: object) -> float:
    """Return how far from where it thinks to be a robot is after a square of 4 m [m]."""
    sim = robot_with(errors, **how)  # type: ignore[arg-type]
    async with sim, connect_async(sim.open) as driver:
        for _ in range(4):
            await driver.move(4.0)
            await driver.turn(turn * pi / 2)
        await asyncio.sleep(0.5)
        return apart(sim, driver)


def apart(sim: SimulatedRobot, driver: Robot) -> float:
    assert driver.snapshot is not None
    truth, believed = sim.body.robot_in_world, driver.snapshot.odometry.robot_in_odom
    return hypot(truth.x - believed.x, truth.y - believed.y)


@pytest.mark.planar("the other dynamics are asked for by name")
@pytest.mark.parametrize(
    ("model", "physics"), [("p3dx-sh", "planar"), ("p3at-sh", "planar"), ("p3dx-sh", "mujoco")]
)
@pytest.mark.parametrize("errors", [WRONG, OTHER])
async def test_a_square_ends_where_its_odometry_says(
    errors: OdometryErrors, model: str, physics: Physics
) -> None:
    before = 0.0
    for turn in (1, -1):
        calibrate(UNCORRECTED)
        before += await apart_after_square(errors, turn, model=model, physics=physics)
        calibrate(errors, like=model)
        assert await apart_after_square(errors, turn, model=model, physics=physics) < 0.003
    assert before > 1.0


@pytest.mark.planar("noise is that of the plane")
async def test_with_noise_it_ends_five_times_nearer() -> None:
    before = after = 0.0
    for errors in (WRONG, OTHER):
        model = str(calibrate(errors, "twin.toml"))
        for seed in range(2):
            calibrate(UNCORRECTED)
            before += await apart_after_square(OdometryErrors(), 1, model=model, seed=seed)
            calibrate(errors)
            after += await apart_after_square(OdometryErrors(), 1, model=model, seed=seed)
    assert after * 5 < before


@pytest.mark.parametrize("errors", [WRONG, OTHER])
async def test_it_drives_straight_and_turns_as_much_as_is_asked(errors: OdometryErrors) -> None:
    calibrate(errors)
    async with robot_with(errors) as sim, connect_async(sim.open) as driver:
        await hold(driver, 0.3, 0.0, 2.0)
        there = sim.body.robot_in_world
        await hold(driver, 0.3, 0.0, 10.0)
        here = sim.body.robot_in_world
        assert abs(degrees(here.theta)) < 0.4
        assert here.x - there.x == pytest.approx(3.0, abs=0.015)
        await hold(driver, 0.0, pi / 8, 2.0)
        here, turned = sim.body.robot_in_world, 0.0
        for _ in range(8):
            begin = sim.body.robot_in_world.theta
            await hold(driver, 0.0, pi / 8, 2.0)
            turned += wrap(sim.body.robot_in_world.theta - begin)
        assert turned == pytest.approx(2 * pi, rel=0.01)
        there = sim.body.robot_in_world
        assert hypot(there.x - here.x, there.y - here.y) < 0.03


async def test_the_speed_that_is_measured_is_the_true_one() -> None:
    calibrate(WRONG)
    async with robot_with(WRONG) as sim, connect_async(sim.open) as driver:
        await hold(driver, 0.2, 0.3, 2.0)
        assert driver.snapshot is not None
        measured = driver.snapshot.odometry
        assert measured.twist.v == pytest.approx(0.2, abs=0.003)
        assert measured.twist.w == pytest.approx(0.3, abs=radians(1.1))
        across = measured.twist.w * driver.info.model.true_base
        assert measured.right_speed - measured.left_speed == pytest.approx(across, abs=0.01)


async def hold(driver: Robot, speed: float, turn_rate: float, seconds: float) -> None:
    """Drive without a look at the odometry."""
    for _ in range(round(seconds / 0.1)):
        driver.drive(speed, turn_rate)
        await asyncio.sleep(0.1)


async def test_modes_and_ros_take_the_corrected_pose() -> None:
    calibrate(OTHER)
    async with robot_with(OTHER) as sim, connect_async(sim.open) as driver:
        await driver.goto(3.0, -1.5, 1.0)
        await asyncio.sleep(0.5)
        there = sim.body.robot_in_world
        assert hypot(there.x - 3.0, there.y + 1.5) < 0.1
        assert there.theta == pytest.approx(1.0, abs=0.06)
        message = Blank()
        assert driver.snapshot is not None
        odometry(message, update(driver.snapshot))
        place = message.pose.pose.position
        assert (place.x, place.y) == pytest.approx((there.x, there.y), abs=0.003)
