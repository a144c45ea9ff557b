"""Maps that robots make: driven by hand, by themselves, from logs; and what is saved of them."""

import asyncio
import re
import signal
import subprocess
import sys
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass
from io import StringIO
from math import cos, hypot, inf, radians, sin
from pathlib import Path
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from pioneer3.cli.main import execute
from pioneer3.cli.map_build import _Begin, _Keeper
from pioneer3.errors import ConfigError, MotionError
from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.maps import LineMap, MapObject, read_map
from pioneer3.maps.grid import samples
from pioneer3.maps.line_map import distances
from pioneer3.nav.changes import drawn
from pioneer3.nav.mapper import Mapper
from pioneer3.navigation.connect import connect_async
from pioneer3.navigation.log_files import chosen_log, is_recording
from pioneer3.navigation.map_builder import MapBuilder, whereabouts
from pioneer3.navigation.map_files import files_of, load_survey, save_map, save_survey
from pioneer3.navigation.map_logs import map_log, map_recording
from pioneer3.robot.devices.laser import Laser
from pioneer3.runtime.robot import Robot
from pioneer3.sim.raycast import ranges_reference
from pioneer3.sim.realism import Realism
from pioneer3.sim.server.start import simulator
from pioneer3.sim.worldfile import load_map
from pioneer3.tasks import FastTimeLoop, running
from tests.e2e.processes import p3
from tests.e2e.processes import running as started
from tests.support import SimulatedRobot, is_at
from tests.unit.nav.halls import HALL
from tests.unit.nav.test_changes import BOX, SHELF
from tests.unit.nav.test_changes import driven as driven_on
from tests.unit.nav.test_contradictions import THERE_AND_BACK, unsigned
from tests.unit.web.test_navigation import at_once

pytest.importorskip("numba")
pytest.importorskip("scipy")
SIDES = [[-4, -3, 4, -3], [4, -3, 4, 3], [4, 3, -4, 3], [-4, 3, -4, -3]]
BETWEEN = [[0, -3, 0, 0.6], [0, 1.6, 0, 3], [-2, -3, -2, -2], [2.2, 3, 2.2, 1.8]]
ROOMS = LineMap(name="rooms", walls=np.array([*SIDES, *BETWEEN], dtype=np.float64))
"""Two rooms with a door of 1 m between them."""
BEGIN = Pose2(-2.5, 0.0, 0.5)


@asynccontextmanager
async def in_the_rooms(
    begin: Pose2 = BEGIN, mapper: Mapper | None = None, record: Path | None = None
) -> AsyncIterator[tuple[SimulatedRobot, Robot, MapBuilder]]:
    sim = SimulatedRobot(ROOMS, home=begin, seed=1, realism=Realism(), model="p3dx-sh")
    async with sim, connect_async(sim.open, record=record) as robot:
        builder = MapBuilder(robot, mapper, in_thread=at_once)
        async with running(builder.run()):
            yield sim, robot, builder


def off(line_map: LineMap, begin: Pose2) -> list[float]:
    """Return how far points of a map that began at a pose are from the walls of the rooms [m]."""
    points = samples(line_map.walls, 0.05)
    c, s = np.cos(begin.theta), np.sin(begin.theta)
    placed = points @ np.array([[c, s], [-s, c]]) + (begin.x, begin.y)
    return [float(distances(point, ROOMS.walls).min()) for point in placed]


def found(line_map: LineMap, begin: Pose2) -> float:
    """Return the share of the rooms' walls that a map shows within 5 cm."""
    points, here = samples(ROOMS.walls, 0.1), begin.inverse()
    c, s = np.cos(here.theta), np.sin(here.theta)
    placed = points @ np.array([[c, s], [-s, c]]) + (here.x, here.y)
    return float(np.mean([distances(p, line_map.walls).min() < 0.05 for p in placed]))


async def test_a_robot_explores_all_rooms_and_its_map_shows_their_walls() -> None:
    async with in_the_rooms() as (sim, robot, builder):
        unreachable = await builder.explore(0.6)
        assert unreachable == ()
        assert robot.arbiter.mode is None
        await asyncio.sleep(1.0)
        assert sim.body.speeds[0] == 0.0
        state = builder.state.latest
    assert state is not None
    assert not state.exploring
    assert state.area == pytest.approx(46.0, rel=0.04)
    line_map = builder.finished()
    assert np.mean(np.array(off(line_map, BEGIN)) < 0.05) > 0.98
    assert found(line_map, BEGIN) > 0.9


async def test_the_state_tells_where_the_robot_is_and_what_is_left() -> None:
    async with in_the_rooms() as (sim, _, builder):
        exploring = asyncio.ensure_future(builder.explore(0.5))
        await asyncio.sleep(8.0)
        state = builder.state.latest
        assert state is not None
        assert state.exploring
        assert state.edges
        assert state.way is not None
        here, true = BEGIN @ state.robot_in_map, sim.body.robot_in_world
        assert hypot(here.x - true.x, here.y - true.y) < 0.15
        exploring.cancel()
        await asyncio.gather(exploring, return_exceptions=True)


async def test_a_stop_ends_the_exploration_also_while_it_looks_for_the_next_edge() -> None:
    for seconds in (0.5, 6.0):
        async with in_the_rooms() as (sim, robot, builder):
            exploring = asyncio.ensure_future(builder.explore())
            await asyncio.sleep(seconds)
            robot.stop()
            with pytest.raises(MotionError):
                await exploring
            here = sim.body.robot_in_world
            await asyncio.sleep(4.0)
            now = sim.body.robot_in_world
            assert hypot(now.x - here.x, now.y - here.y) < 0.3
            assert sim.body.speeds[0] == 0.0


@pytest.mark.parametrize("drives", [True, False])
async def test_without_its_laser_it_stands_and_ends(
    drives: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    if not drives:  # it looks for the next edge all the time
        monkeypatch.setattr(MapBuilder, "_head_for", lambda *_: None)
    async with in_the_rooms() as (sim, _, builder):
        exploring = asyncio.ensure_future(builder.explore())
        await asyncio.sleep(6.0)
        monkeypatch.setattr(Laser, "lost", "the laser is lost")
        with pytest.raises(MotionError, match="the laser is lost; start it again"):
            await exploring
        monkeypatch.undo()
        here = sim.body.robot_in_world
        await asyncio.sleep(4.0)
        assert is_at(sim.body.robot_in_world, here)


async def test_hands_on_the_stick_come_first_and_then_it_goes_on() -> None:
    async with in_the_rooms() as (sim, robot, builder):
        exploring = asyncio.ensure_future(builder.explore(0.6))
        await asyncio.sleep(4.0)
        for _ in range(20):
            robot.drive(0.0, 0.4)
            await asyncio.sleep(0.1)
        assert sim.body.speeds[0] == pytest.approx(0.0, abs=0.01)
        await exploring


async def test_a_map_grows_while_a_program_drives() -> None:
    async with in_the_rooms() as (_, robot, builder):
        await asyncio.sleep(3.0)
        before = builder.state.latest
        await robot.turn(3.0)
        await asyncio.sleep(3.0)
        after = builder.state.latest
    assert before is not None
    assert after is not None
    assert after.area > 1.3 * before.area > 0.0
    assert after.edges is None


@pytest.mark.parametrize("name", ["rooms.map", "rooms.yaml", "rooms.toml"])
async def test_what_is_saved_is_read_again_as_it_was(tmp_path: Path, name: str) -> None:
    async with in_the_rooms() as (_, robot, builder):
        await robot.turn(3.0)
        await asyncio.sleep(2.0)
    line_map, path = builder.finished(), tmp_path / name
    save_survey(builder.mapper, path)
    save_map(line_map, path)
    assert all(file.exists() for file in files_of(path))
    again = load_map(path)
    ends = samples(again.walls, 0.1)
    assert max(distances(end, line_map.walls).min() for end in ends) < 0.002
    assert len(again.walls) == pytest.approx(len(line_map.walls), rel=0.02)
    mapper = Mapper.of(load_survey(path))
    assert mapper.survey.poses == builder.mapper.survey.poses


async def test_a_map_is_continued_from_another_place(tmp_path: Path) -> None:
    async with in_the_rooms() as (_, robot, builder):
        await robot.turn(3.0)
        await robot.turn(3.0)
        await asyncio.sleep(2.0)
    old, path = builder.finished(), tmp_path / "rooms.map"
    save_survey(builder.mapper, path)
    begin = Pose2(-1.5, 1.0, 0.0)
    told = BEGIN.inverse() @ begin
    mapper = Mapper.of(load_survey(path), told @ Pose2(0.3, -0.2, 0.1))
    async with in_the_rooms(begin, mapper) as (_, robot, builder):
        await asyncio.sleep(1.0)
        await builder.explore(0.6)
    line_map = builder.finished()
    assert found(old, BEGIN) < 0.8
    assert found(line_map, BEGIN) > 0.9
    assert np.mean(np.array(off(line_map, BEGIN)) < 0.05) > 0.97


async def test_a_robot_that_is_not_at_home_is_not_taken_to_be_there() -> None:
    sim = SimulatedRobot(ROOMS, home=Pose2(2.0, -1.0, 2.0), seed=1, model="p3dx-sh")
    async with sim, connect_async(sim.open) as robot:
        with pytest.raises(MotionError, match="not at the map's home"):
            await whereabouts(robot, ROOMS, 0.0, at_once)


def test_a_recording_becomes_a_map(tmp_path: Path) -> None:
    path = tmp_path / "drive.txt"

    async def drive() -> None:
        async with in_the_rooms(record=path) as (_, robot, _builder):
            await asyncio.sleep(1.0)
            await robot.turn(3.0)
            await robot.turn(3.0)

    async def play() -> Mapper:
        return (await map_recording(path, told.append)).mapper

    told: list[float] = []
    with asyncio.Runner(loop_factory=FastTimeLoop) as runner:
        runner.run(drive())
    assert is_recording(path)
    with asyncio.Runner(loop_factory=FastTimeLoop) as runner:
        mapper = runner.run(play())
    assert len(mapper.survey.frames) > 15
    assert told == sorted(told)
    assert told[-1] > 0.8


def test_a_log_becomes_a_map_and_damaged_files_are_refused(tmp_path: Path) -> None:
    ranges = " ".join(["2.0"] * 181)
    log, told = tmp_path / "a.log", list[float]()
    scans = (f"FLASER 181 {ranges} {x} 0 0 {x} 0 0 {x} host {x}" for x in (0.0, 0.3, 0.6))
    log.write_text("PARAM x y\n" + "\n".join(scans))
    assert not is_recording(log)
    with chosen_log(log) as opened:
        made = map_log(opened, told.append)
    assert made.mapper.survey.frames[0].beams.points.shape == (181, 2)
    log.write_text("nothing\n")
    with pytest.raises(ConfigError, match="is a text that is no log"), chosen_log(log):
        pass
    survey = tmp_path / "a.survey.npz"
    with pytest.raises(ConfigError, match=r"a.survey.npz has to lie beside it"):
        load_survey(tmp_path / "a.map")
    survey.write_bytes(b"no")
    with pytest.raises(ConfigError, match="is no survey"):
        load_survey(tmp_path / "a.map")


def room(robot: Pose2) -> str:
    """Return what a laser at a pose ahead sees of walls around a room, in mm."""
    ranges = []
    for degrees in range(-90, 91):
        x, y = cos(radians(degrees) + robot.theta), sin(radians(degrees) + robot.theta)
        ways = [(5.0 - robot.x) / x if x > 1e-9 else inf, (2.0 - robot.y) / y if y > 1e-9 else inf]
        ways += [(-2.0 - robot.y) / y if y < -1e-9 else inf]
        ranges.append(f"{1000 * min(ways):.0f}")
    return " ".join(ranges)


def test_a_scan_log_of_aria_becomes_a_map_with_its_goals(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log, new = tmp_path / "lab.2d", tmp_path / "lab.map"
    lines = ["LaserOdometryLog", "version: 2", "sick1pose: 0 0 0", "sick1conf: -90 90 181"]
    poses = [Pose2(0.3 * number, 0.0, 0.0) for number in range(8)]
    for pose in poses:
        odometry = pose.x if pose.x < 1.0 else pose.x + 500.0
        lines += [f"robot: {1000 * odometry:.0f} 0 0.00", f"sick1: {room(pose)}"]
    lines += ["robot: 9e7 0 0", "robot: 502100 0 0"]
    lines += ['cairn: GoalWithHeading "" ICON_GOALWITHHEADING "goal1"']
    log.write_text("\n".join(lines))
    assert execute(["map", "build", "--from", str(log), "-o", str(new)]) == 0
    assert "lab.2d is a scan log of ARIA: scans of scan1, odometry of robot" in (
        capsys.readouterr().out
    )
    line_map = read_map(new)
    (goal,) = (each for each in line_map.objects if each.name == "goal1")
    # the way of 300 mm within which odometry began anew is not known from odometry
    assert goal.pose.x == pytest.approx(2.1, abs=0.35)
    assert line_map.bounds.x_max == pytest.approx(5.0, abs=0.1)
    assert execute(["map", "build", "--from", str(log), "--scans", "scan2"]) == 2
    assert "--scans scan2: lab.2d has scan1" in capsys.readouterr().err
    assert execute(["map", "build", "--scans", "scan2"]) == 2
    assert "only with --from" in capsys.readouterr().err
    log.write_text("# pioneer3 recording\n")
    assert execute(["map", "build", "--from", str(log), "--odometry", "tf"]) == 2
    assert "not of a recording" in capsys.readouterr().err


def test_odometry_that_contradicts_the_scans_is_told_of_and_repaired(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log, new, angles = tmp_path / "lab.log", tmp_path / "lab.map", np.radians(np.arange(-90, 91))
    odometry, lines, before = ORIGIN, list[str](), THERE_AND_BACK[0]
    for number, place in enumerate(THERE_AND_BACK):
        odometry, before = odometry @ unsigned(before.inverse() @ place), place
        here = np.array([place.x, place.y])
        ranges = ranges_reference(here, place.theta + angles, HALL, 30.0).min(axis=1)
        pose = f"{odometry.x:.4f} {odometry.y:.4f} {odometry.theta:.4f}"
        read = " ".join(f"{metres:.2f}" for metres in ranges)
        lines.append(f"FLASER 181 {read} {pose} {pose} {number} host {number}")
    log.write_text("\n".join(lines))
    begin = THERE_AND_BACK[0]
    reach = max(hypot(place.x - begin.x, place.y - begin.y) for place in THERE_AND_BACK)
    for options, cure in (
        ([], "; --repair-odometry trusts the scans instead"),
        (["--repair-odometry", "--force"], "; the scans were trusted"),
    ):
        assert execute(["map", "build", "--from", str(log), "-o", str(new), *options]) == 0
        told = capsys.readouterr().err
        assert "odometry contradicts the scans at 0:" in told
        assert cure in told
        farthest = np.hypot(*np.load(new.with_suffix(".survey.npz"))["poses"][:, :2].T).max()
        assert farthest == pytest.approx(reach, abs=0.3)


@dataclass(frozen=True)
class Continued:
    """A map of the hall that was continued on a day when the box was gone and the shelf there."""

    keeper: _Keeper
    path: Path
    old: LineMap
    before: Mapper
    after: Mapper

    def end(self) -> None:
        with self.keeper.saved_at_the_end():
            pass

    def is_old(self, path: Path) -> bool:
        """Return whether the map there and its survey are those of before."""
        same = len(load_survey(path)["poses"]) == len(self.before.survey.poses)
        return same and np.array_equal(load_map(path).walls, self.old.walls)


def continued(path: Path, *, asks: bool) -> Continued:
    before, after = driven_on(BOX, SHELF)
    home = (MapObject(kind="RobotHome", name="Home", pose=ORIGIN),)
    save_map(drawn(before.survey, 0.3, objects=home), path)
    save_survey(before, path)
    keeper = _Keeper(path, _Begin.of(path, None).update, asks=asks)
    finished = drawn(after.survey, 0.3, objects=home)
    builder = SimpleNamespace(mapper=after, finished=lambda: finished)
    keeper.builder = cast("MapBuilder", builder)
    return Continued(keeper, path, load_map(path), before, after)


@pytest.mark.parametrize("name", ["hall.map", "hall.yaml"])
def test_what_has_changed_is_told_and_the_old_map_is_kept(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str
) -> None:
    the = continued(tmp_path / name, asks=False)
    the.end()
    told, kept = capsys.readouterr().out, the.path.with_stem("hall-before")
    assert re.search(r"^gone: 0\.\d\d m² of walls near \(5\.\d, 0\.\d\)$", told, re.MULTILINE)
    assert re.search(r"^new: 0\.\d\d m² of walls near \(5\.\d, 7\.\d\)$", told, re.MULTILINE)
    assert f"the map as it was before is {kept}" in told
    assert the.is_old(kept)
    assert len(load_survey(the.path)["poses"]) == len(the.after.survey.poses)
    assert not np.array_equal(load_map(the.path).walls, the.old.walls)


@pytest.mark.parametrize(
    ("answer", "replaced", "left"),
    [("yes\n", True, False), ("n\n", False, False), ("\n", False, True), ("", False, True)],
)
def test_somebody_is_asked_before_a_map_is_replaced(
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    answer: str,
    *,
    replaced: bool,
    left: bool,
) -> None:
    the = continued(tmp_path / "hall.map", asks=True)
    monkeypatch.setattr(sys, "stdin", StringIO(answer))
    the.end()
    told = capsys.readouterr()
    new, before = tmp_path / "hall-new.map", tmp_path / "hall-before.map"
    assert told.err == f"Replace {the.path}? yes or no: " + "\n" * (not answer)
    assert told.out.index("gone: 0.") < told.out.index("hall.map", told.out.index("gone: 0."))
    assert (f"{the.path} stays as it is" in told.out) == (not replaced)
    assert (f"the new map is {new}" in told.out) == left
    assert the.is_old(before if replaced else the.path)
    assert [path.exists() for path in files_of(new)] == [left] * len(files_of(new))
    if left:
        assert len(load_survey(new)["poses"]) == len(the.after.survey.poses)


def test_nothing_is_written_over_unless_asked_for(tmp_path: Path) -> None:
    old = tmp_path / "lab.map"
    old.write_text("2D-Map\n")
    ended = p3("map", "build", "-o", str(old))
    assert ended.returncode == 2
    assert "is there already; --continue goes on with it" in ended.stderr
    ended = p3("map", "build", "-o", str(tmp_path / "lab.bmp"))
    assert (ended.returncode, "the ending tells the format" in ended.stderr) == (2, True)
    assert [path.name for path in tmp_path.iterdir()] == ["lab.map"]


def test_a_map_without_walls_is_not_saved(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log, new = tmp_path / "a.log", tmp_path / "a.map"
    log.write_text(f"FLASER 181 {' '.join(['2.0'] * 181)} 0 0 0 0 0 0 0 host 0\n")
    assert execute(["map", "build", "--from", str(log), "-o", str(new)]) == 1
    assert "a.map is not written: it would be empty" in capsys.readouterr().err
    assert [*tmp_path.iterdir()] == [log]


def test_without_the_extra_nav_a_sentence_names_it() -> None:
    code = "import sys; sys.modules['scipy'] = None; from pioneer3.cli.main import main; main()"
    ended = subprocess.run(
        [sys.executable, "-c", code, "map", "build"], capture_output=True, text=True, check=False
    )
    assert ended.returncode == 2
    assert ended.stderr.count("\n") == 1
    assert "the extra `nav` is missing; run: " in ended.stderr


@pytest.mark.realtime
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
async def test_a_map_is_saved_whatever_ends_it(tmp_path: Path, number: signal.Signals) -> None:
    path = tmp_path / "lab.map"
    async with simulator(port=0) as simulated:
        asked = ("map", "build", "--explore", "-o", str(path), "--port", simulated.url)
        async with started(*asked) as building:
            while "loops" not in await building.line():
                pass
            await asyncio.sleep(2.0)
            code, _ = await building.end(number)
        assert code == 128 + number
    assert len(read_map(path).walls) > 50
    assert len(Mapper.of(load_survey(path)).survey.frames) >= 1
    assert [home.theta for home in read_map(path).homes] == [ORIGIN.theta]
