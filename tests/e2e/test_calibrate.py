"""`pioneer3 calibrate` from the connection to the robot's own file, in virtual time."""

import asyncio
from collections.abc import AsyncIterator, Iterator
from contextlib import AsyncExitStack, asynccontextmanager
from dataclasses import replace
from math import degrees, radians
from pathlib import Path

import numpy as np
import pytest

from benchmarks.calibration import answers_of, room
from pioneer3 import connect_async
from pioneer3.calibration.calibration import Calibration
from pioneer3.calibration.course import CourseLeg, drive
from pioneer3.calibration.steps import CalibrationStep, plan
from pioneer3.cli import calibrate
from pioneer3.cli.calibrate import _calibrate, _EndError, _Options
from pioneer3.errors import MotionError
from pioneer3.geometry import ORIGIN, Extent, Pose2
from pioneer3.maps import LineMap
from pioneer3.models import load_model
from pioneer3.models.own import own_path, read_own
from pioneer3.navigation.navigator import Navigator
from pioneer3.robot.lasers.mounting import Mounting
from pioneer3.runtime.robot import Robot
from pioneer3.sim.equipment import Equipment
from pioneer3.sim.realism import OdometryErrors, Realism
from pioneer3.tasks import running
from tests.lasers import LaserUnit
from tests.support import SimulatedRobot, is_at, until
from tests.unit.web.test_navigation import at_once

ERRORS = OdometryErrors(mode="constant", wheel_ratio=1.02, base_ratio=0.98, scale=1.015)
WHOLE = _Options(side=None, length=None, rounds=1, by_tape=True, yes=False)
AROUND = Extent(-0.4, -0.4, 0.4, 0.4)
OLD_FILE = '# mine\nlike = "p3dx-sh"\nmax_speed = 0.6\n'


async def ready() -> None:
    """Compile nothing: that would be in a thread."""


@pytest.fixture(autouse=True)
def _without_threads(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let time stand still while a step is measured."""
    monkeypatch.setattr(asyncio, "to_thread", at_once)
    monkeypatch.setattr("pioneer3.navigation.connect.prepare_navigation", ready)


@asynccontextmanager
async def in_a_room(line_map: LineMap | None = None) -> AsyncIterator[tuple[SimulatedRobot, Robot]]:
    realism = Realism(odometry=ERRORS)
    sim = SimulatedRobot(line_map or room(), model="p3dx-sh", realism=realism, seed=2)
    async with sim, connect_async(sim.open) as robot:
        yield sim, robot


class Person:
    """Answers all questions: measures where the robot is, and puts it back on its mark.

    Attributes:
        ends_before: Part of a question that gets no answer any more.
    """

    def __init__(self, sim: SimulatedRobot, ends_before: str = "nothing") -> None:
        self.sim, self.ends_before = sim, ends_before
        self.rng = np.random.default_rng(5)
        self.asked: list[str] = []
        self.gone = self.misreads = False
        self.keys: Iterator[str] = iter(())

    async def answer(self, question: str) -> str:
        self.asked.append(question)
        if self.gone or self.ends_before in question:
            raise _EndError
        if question == calibrate.KEYS:
            key = next(self.keys, "")
            if not key:
                self.sim.body.robot_in_world = ORIGIN
            return key
        return "yes" if question.startswith("Write") else ""

    async def measured(self, step: CalibrationStep) -> dict[str, float]:
        if self.ends_before == "an end" and step.asks:
            self.gone = True
            raise _EndError
        self.misreads, misread = False, self.misreads
        if misread:
            return dict.fromkeys(step.asks, 3.0)
        return dict(answers_of(step, self.sim.body.robot_in_world, self.rng))


@pytest.fixture
def person(monkeypatch: pytest.MonkeyPatch) -> Person:
    somebody = Person.__new__(Person)
    monkeypatch.setattr(calibrate, "_asked", somebody.answer)
    monkeypatch.setattr(calibrate, "_answers", somebody.measured)
    return somebody


def save() -> None:
    path = own_path("MobileSim")
    assert path is not None
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(OLD_FILE)


async def test_a_tape_and_sonars_tell_the_errors_and_they_are_written(
    person: Person, capsys: pytest.CaptureFixture[str]
) -> None:
    save()
    async with in_a_room() as (sim, robot):
        person.__init__(sim)  # type: ignore[misc]
        assert await _calibrate(robot, WHOLE) == 0
        assert not sim.body.speeds[0]
    path = own_path("MobileSim")
    assert path is not None
    found = read_own(path).model.odometry
    assert found.scale == pytest.approx(1.015, abs=0.006)
    assert found.base_ratio / found.scale == pytest.approx(0.98 / 1.015, abs=0.003)
    assert found.wheel_ratio == pytest.approx(1.02, abs=0.002)
    assert read_own(path).model.encoders == sim.body.encoders
    assert not read_own(path).serial_number, "it is simulated"
    assert path.read_text().startswith("# mine")
    assert path.with_name("MobileSim.toml.old").read_text() == OLD_FILE
    said = capsys.readouterr().out
    assert "UMBmark before: E = " in said
    assert "a square of 4 m would end off by" in said


async def test_a_laser_and_a_map_tell_the_errors_and_nobody_is_asked(
    person: Person, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("numba")
    by_map = replace(WHOLE, by_tape=False, yes=True)
    async with in_a_room() as (sim, robot):
        person.__init__(sim)  # type: ignore[misc]
        rng = np.random.default_rng(1)
        robot.navigator = await Navigator.on(
            robot, room(), start=ORIGIN, rng=rng, in_thread=at_once
        )
        async with running(robot.navigator.run()):
            await until(lambda: robot.navigator and robot.navigator.estimate.sure)
            assert await _calibrate(robot, by_map) == 0
        assert not sim.body.speeds[0]
    assert person.asked == []
    path = own_path("MobileSim")
    assert path is not None
    own = read_own(path).model
    assert own.encoders == sim.body.encoders
    for name in ("scale", "base_ratio", "wheel_ratio"):
        assert getattr(own.odometry, name) == pytest.approx(getattr(ERRORS, name), abs=0.0015)
    assert "calibrated by laser" in capsys.readouterr().out


async def test_a_step_can_be_skipped_undone_and_repeated(person: Person) -> None:
    async with in_a_room() as (sim, robot):
        person.__init__(sim)  # type: ignore[misc]
        person.keys = iter(("s", "s", "", "u", "s", "q"))
        assert await _calibrate(robot, WHOLE) == 1
    assert person.asked.count(calibrate.AFTER) == 1


async def test_a_slip_of_the_tape_is_measured_once_more(person: Person) -> None:
    async with in_a_room() as (sim, robot):
        person.__init__(sim)  # type: ignore[misc]
        person.keys, person.misreads = iter(("s", "s", "", "q")), True
        assert await _calibrate(robot, WHOLE) == 1
    answered = [calibrate.KEYS] * 3 + [calibrate.AGAIN, calibrate.AFTER, calibrate.KEYS]
    assert person.asked == answered


@pytest.mark.parametrize("ends", [calibrate.KEYS, "an end", "Write"])
async def test_the_end_of_input_leaves_the_file_whole_and_the_robot_standing(
    person: Person, ends: str
) -> None:
    save()
    async with in_a_room() as (sim, robot):
        person.__init__(sim, ends)  # type: ignore[misc]
        assert await _calibrate(robot, WHOLE) == (0 if ends == "Write" else 1)
        assert not sim.body.speeds[0]
        assert not sim.body.speeds[1]
    assert not sim.powered
    path = own_path("MobileSim")
    assert path is not None
    assert path.read_text() == OLD_FILE


@pytest.mark.parametrize("way_out", ["stop", "emergency stop", "cable", "cancel"])
async def test_every_way_out_of_a_step_stops_the_robot(way_out: str) -> None:
    async with in_a_room() as (sim, robot):
        turning = asyncio.ensure_future(drive(robot, [CourseLeg(turn=20.0)], AROUND))
        await asyncio.sleep(4)
        assert abs(sim.body.speeds[1]) > 0.2
        match way_out:
            case "stop":
                robot.stop()
            case "emergency stop":
                robot.emergency_stop()
            case "cable":
                await sim.unplug()
            case _:
                turning.cancel()
        with pytest.raises((MotionError, asyncio.CancelledError)):
            await turning
        await asyncio.sleep(3)
        here = sim.body.robot_in_world
        await asyncio.sleep(2)
        assert is_at(sim.body.robot_in_world, here)


async def test_a_stop_while_it_stands_between_two_legs_ends_the_step() -> None:
    async with in_a_room() as (sim, robot):
        turning = asyncio.ensure_future(drive(robot, [CourseLeg(turn=0.5)] * 2, AROUND))
        await until(lambda: sim.body.robot_in_world.theta > 0.3 and robot.arbiter.mode is None)
        robot.stop()
        with pytest.raises(MotionError, match="repeat this step"):
            await turning
        here = sim.body.robot_in_world
        await asyncio.sleep(3)
        assert is_at(sim.body.robot_in_world, here)


async def test_nothing_is_driven_where_something_is_near() -> None:
    box = np.array([[0.9, -0.5, 0.9, 0.5]])
    async with in_a_room(LineMap(name="box", walls=box)) as (sim, robot):
        await asyncio.sleep(1)
        with pytest.raises(MotionError, match=r"something is 0\.[789]\d m away"):
            await drive(robot, [CourseLeg(way=1.0)], Extent(0, -0.4, 1.4, 0.4))
        assert is_at(sim.body.robot_in_world, ORIGIN)


async def test_what_comes_in_the_way_ends_a_step() -> None:
    async with in_a_room() as (sim, robot):
        await asyncio.sleep(1)
        with pytest.raises(MotionError, match="holds the robot up"):
            await drive(robot, [CourseLeg(way=4.0)], Extent(0, -0.4, 1.0, 0.4))
        there = sim.body.robot_in_world
        assert 2.2 < there.x + robot.info.model.length_front < 3.4


async def test_turns_tell_the_scale_of_a_gyro(tmp_path: Path) -> None:
    own = tmp_path / "rosie.toml"
    own.write_text('like = "p3dx-sh"\ngyro_scaler = 1.72\n')
    fitted = Equipment(gyro_type=1, gyro_bias=radians(2), gyro_noise=radians(0.5))
    sim = SimulatedRobot(
        room(), model=str(own), realism=Realism(odometry=ERRORS), equipment=fitted, seed=2
    )
    async with sim, connect_async(sim.open) as robot:
        told = Calibration(robot.info.model)
        for step in plan(robot.info.model, 1.2, 1.2, 1, by_laser=False, by_sonar=True)[:2]:
            told.take(step, await drive(robot, step.legs, step.room))
    found = told.gyro_scaler()
    assert found is not None
    assert found[0] == pytest.approx(1.72, abs=0.01)
    assert found[1] < 0.01


async def test_a_laser_tells_the_errors_and_its_own_place_and_delay(tmp_path: Path) -> None:
    pytest.importorskip("numba")
    true = load_model("p3dx-sh").laser
    assert true is not None
    wrong = Mounting(sensor_in_robot=Pose2(true.x + 0.04, true.y - 0.03, radians(3)))
    realism = Realism(odometry=ERRORS)
    async with AsyncExitStack() as stack:
        own = tmp_path / "rosie.toml"
        place = f"x = {true.x}\ny = {true.y}\ntheta_deg = {degrees(true.theta)}\ndelay = 0.05\n"
        own.write_text(f'like = "p3dx-sh"\n[[lasers]]\nport = "a"\nkind = "urg-04lx"\n{place}')
        sim = SimulatedRobot(room(), model=str(own), realism=realism, seed=2)
        await stack.enter_async_context(sim)
        unit = await stack.enter_async_context(LaserUnit(sim, "urg-04lx"))
        connection = connect_async(sim.open, model="p3dx-sh", lasers=[unit.spec(wrong)])
        robot = await stack.enter_async_context(connection)
        await robot.laser.reading()
        told = Calibration(robot.info.model, wrong.sensor_in_robot)
        for step in plan(robot.info.model, 1.2, 1.2, 1, by_laser=True, by_sonar=True):
            told.take(step, await drive(robot, step.legs, step.room, by_laser=True))
    found = told.estimate()
    late = told.delay()
    assert found is not None
    assert found.laser is not None
    assert late is not None
    assert (found.laser.x, found.laser.y) == pytest.approx((true.x, true.y), abs=0.005)
    assert degrees(found.laser.theta) == pytest.approx(degrees(true.theta), abs=0.3)
    assert late[0] == pytest.approx(0.05, abs=0.008)
    assert found.correction.wheel_ratio == pytest.approx(1.02, abs=0.002)
