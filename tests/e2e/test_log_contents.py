"""All that happened in a run is in its log: who came, what was asked, where the robot went."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from hashlib import sha256
from itertools import pairwise
from math import hypot, isnan
from pathlib import Path
from typing import Any

import pytest

from pioneer3.analysis.anonymous import USERS
from pioneer3.errors import MotionError
from pioneer3.geometry import Pose2
from pioneer3.links import Link
from pioneer3.links.memory import null_modem
from pioneer3.log.reader import open_log
from pioneer3.log.topics import LogTopic
from pioneer3.maps.write import write_aria_map
from pioneer3.nav.places import Destination
from pioneer3.navigation.connect import connect_async
from pioneer3.navigation.goals import GoalChanged
from pioneer3.navigation.navigator import Navigator
from pioneer3.navigation.recording import KINDS, EstimateMade, MapUsed, kind_of
from pioneer3.runtime.recording import CommandGiven, TruePoseTold
from pioneer3.sim.worldfile import load_map
from pioneer3.tasks import running
from pioneer3.web.app import make_app
from pioneer3.web.hosting import ConnectTarget, hosted
from pioneer3.web.page import Page
from pioneer3.web.scene import RobotScene
from tests.e2e.test_map_build import BEGIN as MAP_BEGIN
from tests.e2e.test_map_build import in_the_rooms
from tests.support import SimulatedRobot, is_at
from tests.unit.web.browser import Browser, simulated
from tests.unit.web.test_navigation import BEGIN, ROOMS, arrived, at_once

pytest.importorskip("numba")
pytest.importorskip("scipy")


@asynccontextmanager
async def recorded_page(path: Path, *names: str) -> AsyncIterator[tuple[Page, Any]]:
    """Show simulated robots in two rooms on a page, and record them."""
    poses = [Pose2(BEGIN.x, BEGIN.y + number, 0.0) for number in range(len(names))]
    here = simulated(*poses, line_map=ROOMS)
    serving: list[asyncio.Task[None]] = []

    def target(number: int, name: str) -> ConnectTarget:
        async def plug_in() -> Link:
            ours, theirs = null_modem()
            serving.append(asyncio.ensure_future(here.robots[number].port.serve(theirs)))
            return ours

        scene = RobotScene.of(here, here.robots[number])
        return ConnectTarget(url=f"memory:{number}", open=plug_in, scene=scene, name=name)

    targets = [target(number, name) for number, name in enumerate(names)]
    page = Page()
    async with (
        running(here._simulation.run(), page.run()),
        hosted(page, targets, lambda line: None, path),
    ):
        for view in page.robots.values():
            view.navigation.in_thread = at_once
        yield page, here
    await asyncio.gather(*serving)


def decoded(path: Path) -> dict[str, list[tuple[int, Any]]]:
    """Return all messages of a log by topic, as objects, each with its time."""
    found: dict[str, list[tuple[int, Any]]] = {}
    for message in open_log(path).messages():
        kind = kind_of(message.topic)
        assert kind is not None, message.topic
        told = message.data if kind is bytes else message.decode(kind)
        found.setdefault(message.topic, []).append((message.time, told))
    return found


async def test_a_drive_on_the_page_is_in_the_log_with_all_that_belongs_to_it(
    tmp_path: Path,
) -> None:
    path = tmp_path / "run.mcap"
    async with recorded_page(path, "") as (page, here), Browser(make_app(page)) as ann:
        await asyncio.sleep(1.0)
        ann.say("goto", x=2.5, y=0.0, name="Kitchen", speed=0.6)
        await ann.stay(1.0)
        await arrived(ann, 30.0)
        there = here.robots[0].body.robot_in_world
        assert hypot(there.x - 2.5, there.y) < 0.05
        async with Browser(make_app(page)) as bob:
            await ann.keep_driving(-0.1, 0.5)
            bob.say("take_over")
            await asyncio.sleep(1.0)
        await asyncio.sleep(1.0)
    found = decoded(path)

    goals = [goal for _, goal in found["goal"]]
    assert [goal.status for goal in goals] == ["accepted", "executing", "succeeded"]
    assert {(goal.number, goal.by, goal.speed) for goal in goals} == {(1, "script", 0.6)}
    assert goals[0].places == (Destination(x=2.5, y=0.0, name="Kitchen"),)
    assert goals[-1].reason == "arrived"

    ways = [way for _, way in found["way"]]
    assert ways[0].points[0] == pytest.approx((BEGIN.x, BEGIN.y), abs=0.1)
    assert ways[0].points[-1] == pytest.approx((2.5, 0.0), abs=0.01)
    assert ways[0].place == goals[0].places[0]
    assert ways[-1].points == ()
    assert len(ways) < 10

    ((_, used),) = found["map"]
    assert used.line_map.name == "rooms"
    assert used.line_map.walls.tolist() == ROOMS.walls.tolist()
    assert [each.name for each in used.line_map.objects] == ["Kitchen"]

    times, truths = zip(*found["truth"], strict=True)
    assert truths[0].robot_in_world == BEGIN
    assert any(is_at(truth.robot_in_world, there) for truth in truths)
    assert min(b - a for a, b in pairwise(times)) >= 0.09e9
    estimates = found["estimate"]
    _, last = estimates[-1]
    assert (last.map, last.sure) == ("rooms", True)
    assert min(b - a for (a, _), (b, _) in pairwise(estimates)) > 0.49e9

    events = [(event.kind, event.text) for _, event in found["event"]]
    told = [text for kind, text in events if kind == "page"]
    assert told[:2] == ["script came, a driver", "script took control of Pioneer 3-DX"]
    assert told[-1].endswith("left")
    assert all(map(USERS.fullmatch, told))
    assert any(kind == "notice" and "took over; you watch now" in text for kind, text in events)
    assert found.keys() >= {*KINDS} - {"scan"}


async def test_of_several_robots_each_has_its_own_topics(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    async with recorded_page(path, "amy", "bob") as (page, here), Browser(make_app(page)) as ann:
        await asyncio.sleep(1.0)
        ann.say("goto", robot=2, x=-1.0, y=0.0)
        await ann.stay(1.0)
        await arrived(ann, 20.0)
        there = [robot.body.robot_in_world for robot in here.robots]
    found = decoded(path)
    for name, place in zip(("amy", "bob"), there, strict=True):
        assert is_at(found[f"{name}/truth"][-1][1].robot_in_world, place)
    assert found.keys() >= {"amy/truth", "bob/truth", "amy/map", "bob/map", "bob/goal", "bob/way"}
    assert "amy/goal" not in found
    assert any(
        "took control of bob" in event.text for _, event in found["event"] if event.kind == "page"
    )


async def test_a_program_that_goes_to_a_place_tells_its_goal_and_the_file_of_its_map(
    tmp_path: Path,
) -> None:
    write_aria_map(ROOMS, tmp_path / "rooms.map")
    line_map, path = load_map(tmp_path / "rooms.map"), tmp_path / "run.mcap"
    async with (
        SimulatedRobot(line_map, home=BEGIN) as sim,
        connect_async(sim.open, record=path) as robot,
    ):
        navigator = await Navigator.on(robot, line_map, start=BEGIN, in_thread=at_once)
        robot.navigator = navigator
        async with running(navigator.run()):
            await robot.goto("kitchen")
            going = asyncio.ensure_future(navigator.goto(Destination(x=-2.5, y=0.0)))
            await asyncio.sleep(3.0)
            robot.stop()
            with pytest.raises(MotionError):
                await going
    log = open_log(path)
    goals = [message.decode(GoalChanged) for message in log.messages("goal".__eq__)]
    assert {goal.by for goal in goals} == {"program"}
    ends = [(goal.number, goal.status, goal.reason) for goal in goals if goal.reason]
    assert ends == [(1, "succeeded", "arrived"), (2, "aborted", "somebody stopped the robot")]
    (used,) = (message.decode(MapUsed) for message in log.messages("map".__eq__))
    assert used.file == str(tmp_path / "rooms.map")
    assert used.sha256 == sha256((tmp_path / "rooms.map").read_bytes()).hexdigest()
    (*_, last) = (message.decode(EstimateMade) for message in log.messages("estimate".__eq__))
    true = sim.body.robot_in_world
    assert last.robot_in_map is not None
    half_a_second = 0.4  # [m] of a robot that brakes: estimates are told so often
    assert hypot(last.robot_in_map.x - true.x, last.robot_in_map.y - true.y) < half_a_second
    assert last.spread < 0.3
    (*_, (_, told)) = log.of(LogTopic("truth", TruePoseTold))
    assert hypot(told.robot_in_world.x - true.x, told.robot_in_world.y - true.y) < 0.3


async def test_of_a_map_that_is_made_the_log_has_where_the_robot_was_on_it(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    async with in_the_rooms(record=path) as (sim, robot, builder):
        exploring = asyncio.ensure_future(builder.explore(0.5))
        await asyncio.sleep(8.0)
        robot.stop()
        with pytest.raises(MotionError):
            await exploring
        await asyncio.sleep(2.0)
        here = MAP_BEGIN.inverse() @ sim.body.robot_in_world
    found = decoded(path)
    told = [estimate for _, estimate in found["estimate"]]
    assert {(each.map, each.sure, isnan(each.spread)) for each in told} == {("map", True, True)}
    assert is_at(told[-1].robot_in_map, here)
    assert {each.place for _, each in found["way"]} == {None}
    assert len(found["way"][0][1].points) > 1
    assert found["way"][-1][1].points == ()
    assert "map" not in found


async def test_what_is_asked_last_is_told_with_its_time(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    async with SimulatedRobot() as sim, connect_async(sim.open, record=path) as robot:
        await robot.motors(True)
        log = robot.arbiter.log
        assert log is not None
        began = log.log.clock()
        robot.drive(0.2)
    *_, (time, last) = open_log(path).of(LogTopic("command", CommandGiven))
    assert (last.command, last.twist.v) == ("drive", 0.2)
    assert time == pytest.approx(log.log._ns(began), abs=1e7)
