"""A log tells the errors of a robot's odometry, and its twin ends drives where the robot did."""

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from dataclasses import astuple, replace
from pathlib import Path

import numpy as np
import pytest

from pioneer3.analysis.open_log import OpenLog, open_log
from pioneer3.analysis.twin import likeness, read_drive, twin_of
from pioneer3.cli.sim_like import AGREES, robot_like
from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.models import load_model
from pioneer3.models.odometry import UNCORRECTED, OdometryCorrection
from pioneer3.models.own import own_folder
from pioneer3.navigation.connect import connect_async
from pioneer3.navigation.navigator import Navigator
from pioneer3.runtime.robot import Robot
from pioneer3.sim.body import Body
from pioneer3.sim.realism import OdometryErrors, Realism, SonarErrors
from pioneer3.sim.world import World
from pioneer3.tasks import running
from tests.e2e.test_navigation import HOME, OFFICE
from tests.support import SimulatedRobot
from tests.unit.web.test_navigation import at_once

pytest.importorskip("scipy")
HIDDEN = OdometryCorrection(scale=1.02, base_ratio=0.98, wheel_ratio=1.01)
NOISY = Realism(sonar=SonarErrors(noise=0.01), laser_noise=0.01)
"""Twice the usual noise of ranges."""
OWN = """like = "p3dx-sh"

[odometry]
scale = 1.02
base_ratio = 0.98
wheel_ratio = 1.01

[[lasers]]
port = "/dev/ttyACM0"
kind = "urg-04lx"
x = 0.1
y = 0
theta_deg = 0
delay = 0.04
"""


def rosie() -> Path:
    """Write the own file of a robot with hidden errors."""
    own_folder().mkdir(parents=True, exist_ok=True)
    path = own_folder() / "rosie.toml"
    path.write_text(OWN)
    return path


@asynccontextmanager
async def recorded(path: Path, seed: int) -> AsyncIterator[tuple[SimulatedRobot, Robot]]:
    """Drive a robot with hidden errors, whose host knows nothing of them."""
    sim = SimulatedRobot(OFFICE, home=HOME or Pose2(), seed=seed, realism=NOISY, model=str(rosie()))
    sim.latency = 0.03
    async with sim, connect_async(sim.open, record=path) as robot:
        yield sim, robot


async def drive_with_map(path: Path, seed: int) -> OpenLog:
    async with recorded(path, seed) as (_, robot):
        rng = np.random.default_rng(seed)
        navigator = await Navigator.on(robot, OFFICE, start=HOME, rng=rng, in_thread=at_once)
        robot.navigator = navigator
        async with running(navigator.run()):
            await robot.goto("kitchen", speed=0.6)
            await robot.goto("home", speed=0.6)
            await asyncio.sleep(5)  # sonars hear the same again and again
    return open_log(path)


@pytest.mark.timeout(300)
@pytest.mark.planar("noise is that of the plane")
async def test_a_log_with_a_map_tells_the_errors_and_its_twin_ends_where_the_robot_did(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    drive = read_drive(await drive_with_map(tmp_path / "drive.mcap", seed=5))
    twin = twin_of(drive)
    for found, true, unsure in zip(
        astuple(twin.model.odometry), astuple(HIDDEN), twin.unsure, strict=True
    ):
        assert abs(found - true) < 4 * unsure < 0.04
    assert 0.4 < twin.noise < 3.0
    assert twin.delay == pytest.approx(2 * 0.03, abs=0.02)
    assert likeness(drive, twin).agrees
    right = replace(twin, model=drive.model, covariance=twin.covariance * 1e-6)
    assert not likeness(drive, right).agrees, "a robot without errors would end elsewhere"

    await drive_with_map(tmp_path / "other.mcap", seed=6)
    other = likeness(read_drive(open_log(tmp_path / "other.mcap")), twin)
    assert other.agrees, "it was not fitted to this drive"
    assert not np.array_equal(other.runs, likeness(drive, twin).runs)

    log, against = (str(tmp_path / f"{name}.mcap") for name in ("drive", "other"))
    with robot_like(log, Realism(), against) as like:
        assert load_model(like.robot.model).odometry == twin.model.odometry
        assert like.realism.odometry.turn_noise == pytest.approx(0.01 * twin.noise)
        assert like.delay == twin.delay
        assert like.realism.sonar.noise == pytest.approx(NOISY.sonar.noise, rel=0.3)
        assert like.realism.laser_noise == pytest.approx(NOISY.laser_noise, rel=0.2)
    told = capsys.readouterr().out
    assert f"{1000 * (twin.delay or 0):.0f} ms" in told
    assert f"from {twin.pieces} pieces" in told
    assert AGREES in told


def test_a_twin_by_an_own_file_has_no_other_log() -> None:
    rosie()
    with pytest.raises(ConfigError, match="--against other: of a twin by a log"):
        robot_like("rosie", Realism(), "other").__enter__()


async def test_a_log_without_a_place_on_a_map_says_that_it_tells_nothing(tmp_path: Path) -> None:
    async with recorded(tmp_path / "drive.mcap", seed=1) as (_, robot):
        await robot.move(0.3)
    drive = read_drive(open_log(tmp_path / "drive.mcap"))
    with pytest.raises(ConfigError, match=r"it has 0 pieces of 1\.5 m or radians"):
        twin_of(drive)


@pytest.mark.parametrize("name", [lambda path: "rosie", str])
def test_a_robot_is_simulated_by_its_own_file(name: Callable[[Path], str]) -> None:
    with robot_like(name(rosie()), Realism()) as like:
        assert (like.robot.name, like.robot.equipment.laser) == ("rosie", "urg-04lx")
        body = Body(load_model(like.robot.model))
        assert body.model.laser
        assert body.model.laser.delay == 0.04
        world = World(None, [body], realism=like.realism)
        column = world.drives.errors[:4, 0].tolist()
        assert column == [*(HIDDEN.matrix(body.model.wheel_base) or ())]
        assert Realism().odometry == OdometryErrors() == world.realism.odometry
        assert load_model("p3dx").odometry == UNCORRECTED
