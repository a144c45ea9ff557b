"""Robots that find themselves on a map and go to its places: the whole stack, in virtual time."""

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass
from math import hypot
from typing import Any

import numpy as np
import pytest

from pioneer3.behaviors.action import MODE, Action, Desire, Situation, Stack
from pioneer3.errors import CommandError, ConfigError, MotionError
from pioneer3.geometry import Pose2, Twist2
from pioneer3.maps import LineMap, shipped_map
from pioneer3.models.lasers import LASERS
from pioneer3.nav.costs import CostMap
from pioneer3.nav.places import Destination, find_place, home
from pioneer3.navigation.connect import connect_async
from pioneer3.navigation.navigator import Navigator
from pioneer3.robot.devices.laser import Laser
from pioneer3.robot.devices.presence import Presence
from pioneer3.runtime.robot import Robot
from pioneer3.sim.realism import Realism
from pioneer3.state import Charging
from pioneer3.tasks import running
from tests.lasers import LaserUnit
from tests.support import SLOW, SimulatedRobot, is_at
from tests.unit.web.test_navigation import at_once
from tests.wandering import Watch

pytest.importorskip("numba")
pytest.importorskip("scipy")
OFFICE = shipped_map("office")
HOME = home(OFFICE)
assert HOME is not None
HOME_PLACE = find_place(OFFICE, "home")


@asynccontextmanager
async def in_the_office(
    start: Pose2 | None = HOME, *, seed: int = 1, model: str = "p3at-sh"
) -> AsyncIterator[tuple[SimulatedRobot, Robot, Navigator]]:
    sim = SimulatedRobot(OFFICE, home=HOME or Pose2(), seed=seed, realism=Realism(), model=model)
    async with sim, connect_async(sim.open) as robot:
        rng = np.random.default_rng(seed)
        navigator = await Navigator.on(robot, OFFICE, start=start, rng=rng, in_thread=at_once)
        robot.navigator = navigator
        async with running(navigator.run()):
            yield sim, robot, navigator


@pytest.mark.parametrize("model", [pytest.param("p3at-sh", marks=pytest.mark.thorough), "p3dx-sh"])
async def test_it_drives_to_the_kitchen_by_name(model: str) -> None:
    async with in_the_office(model=model) as (sim, robot, _):
        await robot.goto("kitchen", speed=0.7)
        goal, there = find_place(OFFICE, "Kitchen"), sim.body.robot_in_world
        assert hypot(there.x - goal.x, there.y - goal.y) < 0.05
        assert sim.body.speeds[0] == pytest.approx(0.0, abs=SLOW)


async def test_it_ends_at_the_heading() -> None:
    async with in_the_office() as (sim, _, navigator):
        await navigator.goto(Destination(x=5.0, y=4.0, heading=1.0))
        there = sim.body.robot_in_world
        assert hypot(there.x - 5.0, there.y - 4.0) < 0.05
        assert there.theta == pytest.approx(1.0, abs=0.05)


async def test_a_robot_that_is_not_sure_where_it_is_does_not_go() -> None:
    async with in_the_office(Pose2(12.0, 9.0, 0.0)) as (sim, robot, _):
        with pytest.raises(MotionError, match="not sure where the robot is"):
            await robot.goto("kitchen")
        assert is_at(sim.body.robot_in_world, sim.body.home)


async def test_a_robot_that_was_carried_away_stops() -> None:
    async with in_the_office() as (sim, robot, navigator):
        going = asyncio.ensure_future(robot.goto("Lobby", speed=0.5))
        await asyncio.sleep(6.0)
        assert navigator.estimate.sure
        carried = sim.body.robot_in_world = Pose2(13.0, 2.0, 2.0)
        with pytest.raises(MotionError):
            await going
        now = sim.body.robot_in_world
        assert hypot(now.x - carried.x, now.y - carried.y) < 1.0


async def test_a_stop_ends_the_drive() -> None:
    async with in_the_office() as (sim, robot, _):
        going = asyncio.ensure_future(robot.goto("kitchen"))
        await asyncio.sleep(5.0)
        robot.stop()
        with pytest.raises(MotionError):
            await going
        await asyncio.sleep(2.0)
        assert sim.body.speeds[0] == pytest.approx(0.0, abs=SLOW)


async def test_a_stop_while_the_way_is_planned_ends_the_goal() -> None:
    async with in_the_office() as (sim, robot, navigator):
        assert await navigator.find()
        planned = asyncio.Event()

        async def slowly(function: Callable[..., Any], *arguments: Any) -> Any:
            await planned.wait()
            return function(*arguments)

        navigator._drives.ways._in_thread = slowly
        going = asyncio.ensure_future(robot.goto("kitchen"))
        await asyncio.sleep(1.0)
        robot.stop()
        planned.set()
        with pytest.raises(MotionError, match="goto Kitchen: somebody stopped the robot"):
            await going
        await asyncio.sleep(2.0)
        assert is_at(sim.body.robot_in_world, sim.body.home)


async def test_after_the_connection_is_closed_no_goal_is_waited_for() -> None:
    async with in_the_office() as (_, _robot, navigator):
        pass
    with pytest.raises(MotionError, match="the robot has gone"):
        await navigator.goto(HOME_PLACE)


async def test_hands_on_the_stick_come_first() -> None:
    async with in_the_office() as (sim, robot, _):
        going = asyncio.ensure_future(robot.goto("kitchen"))
        await asyncio.sleep(5.0)
        for _ in range(20):
            robot.drive(0.0, 0.4)
            await asyncio.sleep(0.1)
        assert sim.body.speeds[0] == pytest.approx(0.0, abs=0.01)
        await going  # it goes on where the hands left it


async def test_a_robot_that_may_be_anywhere_looks_around_and_finds_itself() -> None:
    async with in_the_office(start=None) as (sim, _, navigator):
        assert not navigator.estimate.sure
        await navigator.look_around()
        found, there = navigator.estimate.robot_in_map, sim.body.robot_in_world
        assert found is not None
        assert hypot(found.x - there.x, found.y - there.y) < 0.1
        await asyncio.sleep(1.0)
        assert sim.body.speeds[0] == pytest.approx(0.0, abs=SLOW)


async def test_a_robot_without_a_laser_goes_by_its_sonars(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Laser, "presence", property(lambda _: Presence(False, "none")))
    async with in_the_office() as (sim, _, navigator):
        await asyncio.sleep(1.0)
        assert navigator.estimate.reason == "has to drive a little"
        await navigator.look_around()
        await navigator.goto(find_place(OFFICE, "Kitchen"), speed=0.5)
        goal, there = find_place(OFFICE, "Kitchen"), sim.body.robot_in_world
        assert hypot(there.x - goal.x, there.y - goal.y) < 0.2


async def test_sonars_alone_ask_for_the_place(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Laser, "presence", property(lambda _: Presence(False, "none")))
    async with in_the_office(start=None) as (_, _robot, navigator):
        with pytest.raises(MotionError, match="tell its place"):
            await navigator.goto(find_place(OFFICE, "Kitchen"))


async def test_a_laser_that_falls_silent_leaves_the_robot_standing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    async with in_the_office() as (sim, robot, navigator):
        going = asyncio.ensure_future(robot.goto("Lobby", speed=0.5))
        await asyncio.sleep(6.0)
        silent = property(lambda _: None, lambda _, _scan: None)
        monkeypatch.setattr(Laser, "latest", silent, raising=False)
        await asyncio.sleep(3.5)
        assert not navigator.estimate.sure
        assert sim.body.speeds[0] == pytest.approx(0.0, abs=SLOW)
        with pytest.raises(MotionError, match="the laser is silent for 4 s; start it again"):
            await going
        stood = sim.body.robot_in_world
        monkeypatch.undo()  # somebody plugs it in again, and stands beside the robot
        await asyncio.sleep(5.0)
        assert navigator.estimate.sure
        assert is_at(sim.body.robot_in_world, stood)


async def test_a_patrol_goes_from_place_to_place_and_begins_anew() -> None:
    async with in_the_office() as (sim, _, navigator):
        visited: list[str] = []
        goals = [find_place(OFFICE, name) for name in ("Corridor", "home")]

        async def watch() -> None:
            async for state in navigator.state.values():
                name = state.goal.name if state.goal else ""
                if name and name != (visited or [""])[-1]:
                    visited.append(name)

        async with running(watch()):
            await navigator.patrol(goals, 0.7, rounds=2)
        assert visited == ["Corridor", "Home"] * 2
        goal, there = goals[-1], sim.body.robot_in_world
        assert hypot(there.x - goal.x, there.y - goal.y) < 0.05


async def test_a_patrol_leaves_out_places_without_a_way() -> None:
    async with in_the_office() as (sim, _, navigator):
        goals = [find_place(OFFICE, "Corridor"), Destination(x=50.0, y=50.0), HOME_PLACE]
        await navigator.patrol(goals, 0.7, rounds=1)
        there = sim.body.robot_in_world
        assert hypot(there.x - HOME_PLACE.x, there.y - HOME_PLACE.y) < 0.05


async def test_a_robot_that_goes_to_a_dock_waits_for_its_charger(
    caplog: pytest.LogCaptureFixture,
) -> None:
    caplog.set_level("INFO")
    async with in_the_office() as (_, robot, _nav):
        await robot.goto("Dock", speed=0.7)
        snapshot = robot.snapshot
        assert snapshot is not None
        assert snapshot.battery.charging in (Charging.BULK, Charging.FLOAT, Charging.OVERCHARGE)
    assert "stands in Dock" in caplog.text


def with_laser(name: str, start: Pose2) -> tuple[SimulatedRobot, LaserUnit]:
    """Return a robot in the office whose laser talks to the program itself."""
    sim = SimulatedRobot(OFFICE, home=start, seed=1, realism=Realism())
    return sim, LaserUnit(sim, name, serial=not LASERS[name].tcp_ports)


PLACES = [each for each in OFFICE.objects if each.role in {"goal", "dock", "home"}]


@pytest.mark.parametrize("name", LASERS)
async def test_every_laser_is_sure_of_its_place_in_time(name: str) -> None:
    """A URG-04LX tells that it reaches 5.6 m, and hears dark walls as far as a third of that."""
    for start in (PLACES[0].pose, PLACES[-1].pose):
        sim, unit = with_laser(name, start)
        async with sim, unit, connect_async(sim.open, lasers=[unit.spec()]) as robot:
            rng = np.random.default_rng(1)
            navigator = await Navigator.on(robot, OFFICE, start=start, rng=rng, in_thread=at_once)
            async with running(navigator.run()):
                assert await navigator.find(5.0), navigator.estimate.reason


@pytest.mark.parametrize("name", ["urg-04lx", "urg-04lx-ug01"])
async def test_a_laser_that_sees_four_metres_reaches_all_places(name: str) -> None:
    assert HOME is not None
    sim, unit = with_laser(name, HOME)
    async with sim, unit, connect_async(sim.open, lasers=[unit.spec()]) as robot:
        rng = np.random.default_rng(1)
        navigator = await Navigator.on(robot, OFFICE, start=HOME, rng=rng, in_thread=at_once)
        async with running(navigator.run()):
            for place in PLACES:
                await navigator.goto(find_place(OFFICE, place.name or "home"), speed=0.7)
                there = sim.body.robot_in_world
                assert hypot(there.x - place.pose.x, there.y - place.pose.y) < 0.15, place.name


async def test_a_map_that_is_too_large_is_refused_before_the_work() -> None:
    hall, called = LineMap(name="hall", walls=np.array([[0.0, 0.0, 500.0, 500.0]])), list[Any]()

    async def noted(function: Callable[..., Any], *args: Any) -> Any:
        called.append(function)
        return await at_once(function, *args)

    sim = SimulatedRobot(OFFICE, home=HOME or Pose2())
    async with sim, connect_async(sim.open) as robot:
        with pytest.raises(ConfigError, match=r"500 x 500 m.* 160000 square metres"):
            await Navigator.on(robot, hall, in_thread=noted)
    assert called
    assert CostMap.of not in called


async def test_names_are_checked() -> None:
    async with in_the_office() as (_, robot, _nav):
        with pytest.raises(ConfigError, match="has Corridor, Dock"):
            await robot.goto("canteen")
        robot.navigator = None
        with pytest.raises(CommandError, match="there is no map"):
            await robot.goto("kitchen")
        with pytest.raises(CommandError, match="give x and y"):
            await robot.goto(1.0)


def pose_of(name: str) -> Pose2:
    """Return the pose of a place of the office."""
    place = find_place(OFFICE, name)
    return Pose2(place.x, place.y, place.heading or 0.0)


@asynccontextmanager
async def again_in(sim: SimulatedRobot, line_map: LineMap = OFFICE) -> AsyncIterator[Robot]:
    """Connect to a robot that nobody tells the place of, as each command does."""
    async with connect_async(sim.open) as robot:
        rng = np.random.default_rng(1)
        navigator = await Navigator.on(robot, line_map, rng=rng, in_thread=at_once)
        navigator.place_as_remembered(HOME)
        robot.navigator = navigator
        async with running(navigator.run()):
            yield robot


async def test_the_place_where_a_program_left_the_robot_is_remembered_on_this_map_only() -> None:
    sim = SimulatedRobot(OFFICE, home=HOME or Pose2(), seed=1, realism=Realism())
    async with sim:
        async with again_in(sim) as robot:
            await robot.goto("Lab", speed=0.7)
        async with again_in(sim) as robot:
            assert robot.navigator is not None
            assert not robot.navigator.estimate.sure  # a guess, until a scan agrees
            await robot.goto("home", speed=0.7)
        there = sim.body.robot_in_world
        assert HOME is not None
        assert hypot(there.x - HOME.x, there.y - HOME.y) < 0.06
        other = LineMap(name="office", walls=OFFICE.walls[1:], objects=OFFICE.objects)
        sim.body.robot_in_world = pose_of("Lab")
        async with again_in(sim, other) as robot:
            assert robot.navigator is not None
            assert not await robot.navigator.find(5.0)


@pytest.mark.parametrize("place", ["Home", "Kitchen"])
async def test_a_robot_that_was_carried_home_is_found_and_elsewhere_it_is_not_sure(
    place: str,
) -> None:
    sim = SimulatedRobot(OFFICE, home=HOME or Pose2(), seed=1, realism=Realism())
    async with sim:
        async with again_in(sim) as robot:
            await robot.goto("Lab", speed=0.7)
        sim.body.robot_in_world = pose_of(place)
        async with again_in(sim) as robot:
            assert robot.navigator is not None
            assert await robot.navigator.find(5.0) == (place == "Home")
            estimate, there = robot.navigator.estimate, sim.body.robot_in_world
        if place == "Home":
            assert estimate.robot_in_map is not None
            assert hypot(estimate.robot_in_map.x - there.x, estimate.robot_in_map.y - there.y) < 0.1


@dataclass(slots=True)
class Reckless(Action):
    """Drives on, whatever is there."""

    twist: Twist2
    name: str = "reckless"

    def decide(self, situation: Situation) -> Desire:
        return Desire(v=self.twist.v, w=self.twist.w)


@pytest.mark.parametrize("twist", [Twist2(0.7, 0.0), Twist2(-0.4, 0.0), Twist2(0.5, 0.8)])
async def test_no_mode_touches_a_wall_of_the_map(twist: Twist2) -> None:
    async with in_the_office() as (sim, robot, navigator):
        assert await navigator.find()
        watch = sim.stepped = Watch(sim)
        robot.arbiter.start(Stack.alone(Reckless(twist), MODE))
        await asyncio.sleep(20.0)
        assert robot.arbiter.mode is not None
        assert watch.log.impacts == []
        assert sim.body.speeds[0] == pytest.approx(0.0, abs=SLOW) or twist.w
