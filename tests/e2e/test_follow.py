"""A robot follows somebody through a furnished room: virtual time, errors as of a real robot."""

import asyncio
from math import radians

import pytest

from pioneer3.behaviors.modes.follow import RULES, Rule, follow
from pioneer3.geometry import Pose2
from pioneer3.navigation.connect import connect_async
from pioneer3.sim.kernels.drives import TOUCHED
from pioneer3.sim.realism import Realism
from pioneer3.sim.worldfile import Person
from tests.combinations import pairwise
from tests.e2e.follow_course import make_course
from tests.e2e.follow_obstructions import among_chairs
from tests.e2e.follow_walk import Outcome, Walk, gap_to, within
from tests.support import SimulatedRobot


def walked(seed: int, rule: Rule, model: str, seconds: float = 60.0) -> Outcome:
    walk = Walk(course=make_course(seed), seed=seed, rule=rule, model=model, seconds=seconds)
    return walk.run()


@pytest.mark.parametrize(("model", "seed"), [("p3at-sh", 101), ("p3dx-sh", 102)])
def test_tracking_keeps_the_person(model: str, seed: int) -> None:
    outcome = walked(seed, "tracking", model)
    assert outcome.share() >= 0.95
    assert (outcome.lost, outcome.walls, outcome.contacts, outcome.ended) == (0, 0, 0, None)


@pytest.mark.parametrize(("model", "seed"), [("p3at-sh", 101), ("p3dx-sh", 102)])
def test_by_the_legs_it_keeps_as_far_as_wanted(model: str, seed: int) -> None:
    outcome = walked(seed, "legs", model)
    assert within(outcome) >= 0.99
    assert outcome.held == len(outcome.gaps)
    assert (outcome.lost, outcome.walls, outcome.contacts, outcome.ended) == (0, 0, 0, None)


def test_chairs_are_not_taken_for_people() -> None:
    outcome = Walk(course=among_chairs(104), seed=104, rule="legs").run()
    assert within(outcome) >= 0.99
    assert outcome.held == len(outcome.gaps)
    assert (outcome.lost, outcome.walls, outcome.contacts, outcome.ended) == (0, 0, 0, None)


async def test_it_goes_on_by_sonar_when_the_laser_falls_silent() -> None:
    sim = SimulatedRobot(realism=Realism(), seed=2)
    front = sim.body.model.length_front + 0.25
    path = ((front + 0.5, 0.0), (front + 4.5, 0.0))
    person = sim.world.add_obstacle(Person(path=path, speed=0.3, pause=3.0, loop=False))
    async with sim, connect_async(sim.open) as robot:
        robot.arbiter.start(follow())
        await asyncio.sleep(6.0)
        assert robot.devices.laser.latest is not None
        assert not any("sonar" in words for words in robot.arbiter.told)
        lasers, robot.arbiter.lasers = robot.arbiter.lasers, ()
        await asyncio.sleep(4.0)
        assert any("by sonar, the laser is silent" in words for words in robot.arbiter.told)
        assert gap_to(person.pose, sim.body)[0] < 0.6
        robot.arbiter.lasers = lasers
        await asyncio.sleep(2.0)
        assert not any("sonar" in words for words in robot.arbiter.told)
        assert gap_to(person.pose, sim.body)[0] < 0.6


async def test_the_laser_is_on_only_while_it_follows() -> None:
    sim = SimulatedRobot()
    async with sim, connect_async(sim.open) as robot:
        await asyncio.sleep(1.0)
        assert robot.laser.latest is None
        robot.arbiter.start(follow("tracking"))
        await asyncio.sleep(1.0)
        assert robot.laser.latest is None
        robot.arbiter.start(follow("legs"))
        await asyncio.sleep(1.0)
        assert robot.laser.rate > 5
        robot.arbiter.stop()
        await asyncio.sleep(2.0)
        assert robot.laser.rate == 0


def test_the_labs_rule_stays_farther_behind() -> None:
    """It has no speed of its own: at 0.4 m/s it is 0.48 m farther away than it wants to be."""
    outcome = walked(101, "lab", "p3at-sh", seconds=20.0)
    assert outcome.contacts == 0
    assert outcome.share(0.6, 1.0) > 0.3


def test_the_same_seed_gives_the_same_walk() -> None:
    one, other = (walked(103, "tracking", "p3dx-sh", seconds=10.0) for _ in range(2))
    assert one.gaps == other.gaps


@pytest.mark.parametrize(
    ("model", "rule", "latency"),
    pairwise(["p3at-sh", "p3dx-sh"], RULES.names, [0.0, 0.1, 0.2, 0.3]),
)
async def test_nobody_is_touched_however_slow_the_link(
    model: str, rule: Rule, latency: float
) -> None:
    """Somebody stands 0.9 m ahead; then they step up to 0.15 m before the robot."""
    sim = SimulatedRobot(model=model, realism=Realism(), seed=7)
    sim.latency = latency
    touched = []
    sim.stepped = lambda: touched.append(bool(sim.body.drives.flags[TOUCHED, sim.body.number]))
    front = sim.body.model.length_front + 0.25
    person = sim.world.add_obstacle(Person(path=((front + 0.9, 0.0),)))
    async with sim, connect_async(sim.open) as robot:
        robot.arbiter.start(follow(rule))
        await asyncio.sleep(6.0)
        assert sim.body.robot_in_world.x > 0.3
        sim.world.move_obstacle(person, sim.body.robot_in_world @ Pose2(front + 0.15))
        await asyncio.sleep(3.0)
        assert robot.arbiter.mode is not None
    assert not any(touched)


@pytest.mark.parametrize("aside", [0.0, 0.3])
@pytest.mark.parametrize("model", ["p3at-sh", "p3dx-sh"])
async def test_it_stands_still_before_somebody_who_does(model: str, aside: float) -> None:
    """Neither to and fro nor from side to side, though echoes come one by one."""
    sim = SimulatedRobot(model=model, realism=Realism(), seed=1)
    front = sim.body.model.length_front
    path = ((front + 0.85, aside), (front + 2.85, aside))
    person = sim.world.add_obstacle(Person(path=path, speed=0.4, pause=2.0, loop=False))
    turned = []
    async with sim, connect_async(sim.open) as robot:
        robot.arbiter.start(follow())
        await asyncio.sleep(7.0)  # they wait for 2 s and walk for 5 s
        sim.world.remove_obstacle(person)
        person = sim.world.add_obstacle(Person(path=path[1:]))
        await asyncio.sleep(4.0)
        sim.stepped = lambda: turned.append(abs(sim.body.speeds[1]))
        await asyncio.sleep(6.0)
    gap, _ = gap_to(person.pose, sim.body)
    assert gap == pytest.approx(0.3, abs=0.05)
    assert sum(turned) / len(turned) < radians(2)
