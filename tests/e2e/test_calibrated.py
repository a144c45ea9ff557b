"""A robot whose own file has the errors of its odometry knows where it is, and drives as asked."""

import asyncio
from dataclasses import replace
from math import degrees, hypot, pi, radians
from pathlib import Path

import pytest
from msgspec import structs

from pioneer3.arcos import commands
from pioneer3.errors import ConfigError
from pioneer3.geometry import wrap
from pioneer3.models import OdometryCorrection
from pioneer3.models.odometry import UNCORRECTED
from pioneer3.models.own import own_folder
from pioneer3.navigation.connect import connect_async
from pioneer3.ros.messages.motion import odometry
from pioneer3.runtime.robot import Robot
from pioneer3.sim.realism import OdometryErrors, Realism
from pioneer3.sim.worldfile.spec import Physics
from tests.support import SimulatedRobot, until
from tests.unit.ros.support import Blank, update

WRONG = OdometryErrors(mode="constant", scale=1.02, base_ratio=0.975, wheel_ratio=1.015, slip=0.0)
UNCORRECTED_ERRORS = OdometryErrors(mode="none")
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


OTHERS = (commands.TicksMM(110), commands.RevCount(15000), commands.DriftFactor(-160))
"""Numbers of encoders that another program sets: odometry is wrong by a sixth by them."""
ENCODERS = "\n[encoders]\nticks_mm = 128\nrev_count = 16570\n"


async def tell_as_others_do(sim: SimulatedRobot) -> None:
    """Set other numbers of encoders, as a host does that knows no own file."""
    async with connect_async(sim.open, model="p3dx-sh") as driver:
        for command in OTHERS:
            driver.send(command)
        await asyncio.sleep(0.5)


async def apart_after_corner(sim: SimulatedRobot, driver: Robot) -> float:
    """Return how far from where it thinks to be a robot is after a corner [m]."""
    assert driver.snapshot is not None
    truth, believed = sim.body.robot_in_world, driver.snapshot.odometry.robot_in_odom
    await driver.move(2.0)
    await driver.turn(pi / 2)
    await driver.move(1.0)
    await asyncio.sleep(0.5)
    went = truth.inverse() @ sim.body.robot_in_world
    told = believed.inverse() @ driver.snapshot.odometry.robot_in_odom
    return hypot(went.x - told.x, went.y - told.y)


@pytest.mark.planar("the other dynamics are asked for by name")
@pytest.mark.parametrize("physics", ["planar", "mujoco"])
async def test_numbers_of_another_host_are_set_back_and_nothing_is_corrected_twice(
    physics: Physics,
) -> None:
    own = calibrate(WRONG)
    async with robot_with(WRONG, physics=physics) as sim:
        await tell_as_others_do(sim)
        async with connect_async(sim.open) as driver:
            assert await apart_after_corner(sim, driver) > 0.2
        own.write_text(own.read_text() + ENCODERS)
        async with connect_async(sim.open) as driver:
            config = await driver.devices.configuration()
            told = config.ticks_per_mm, config.rev_count_ticks, config.drift_factor_8192nds
            assert told == (128, 16570, 0)
            assert await apart_after_corner(sim, driver) < 0.01


async def test_a_robot_that_was_restarted_is_told_its_numbers_again() -> None:
    others = ENCODERS.replace("128", "150")
    own = calibrate(WRONG)
    own.write_text(own.read_text() + others)
    async with robot_with(UNCORRECTED_ERRORS) as sim, connect_async(sim.open) as driver:
        assert (await driver.devices.configuration()).ticks_per_mm == 150
        sim.power_cycle()
        assert sim.body.encoders.ticks_mm == 128
        await until(lambda: sim.body.encoders.ticks_mm == 150)


@pytest.mark.parametrize("model", ["p3dx-sh", "p2dx"])
async def test_a_controller_that_tells_no_such_numbers_is_sent_none(model: str) -> None:
    own = calibrate(WRONG, like=model)
    own.write_text(own.read_text() + ENCODERS)
    sim = robot_with(WRONG, model)
    untold = structs.replace(sim.firmware._configuration(), ticks_per_mm=0)
    sim.firmware._configuration = lambda: untold  # type: ignore[method-assign]
    async with sim, connect_async(sim.open) as driver:
        await driver.move(0.3)
        assert not any(isinstance(each, commands.TicksMM) for each in sim.wires[0].commands)


async def test_the_file_of_another_robot_is_refused() -> None:
    own = calibrate(WRONG)
    own.write_text('serial_number = "47"\n' + own.read_text())
    sim = robot_with(WRONG)
    async with sim, connect_async(sim.open):
        pass  # a simulated one may stand for it
    sim = robot_with(WRONG)
    whole = sim.firmware._configuration()
    sim.firmware._configuration = lambda: structs.replace(whole, serial_number="48")  # type: ignore[method-assign]
    async with sim:
        with pytest.raises(ConfigError, match=r"serial number '47', not of this one, '48'"):
            async with connect_async(sim.open):
                pass


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
