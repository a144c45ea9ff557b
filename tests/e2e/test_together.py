"""Robots that drive as a group in one simulated world, over cables of their own. Virtual time."""

import asyncio
import logging
from collections.abc import AsyncIterator, Callable, Iterable, Sequence
from contextlib import AsyncExitStack, asynccontextmanager
from dataclasses import dataclass, field
from math import hypot, pi
from random import Random
from statistics import median, quantiles

import pytest

from pioneer3.behaviors.modes.group import FollowLeader, Form, GroupMode, Spread
from pioneer3.errors import MotionError
from pioneer3.geometry import Pose2
from pioneer3.links.memory import Fault
from pioneer3.navigation.group import stacks_of
from pioneer3.navigation.traffic import Participant, SharedPlace, Traffic
from pioneer3.state import Snapshot
from tests.robots_together import Together, together

COURSE = ((0.3, 0.0, 10.0), (0.3, 0.1, 16.0), (0.3, 0.0, 6.0), (0.3, -0.1, 16.0), (0.3, 0.0, 6.0))
"""Speed [m/s], turn rate [rad/s] and time [s] of each part: 16 m, bends of 92°, 3 m in radius."""
TIGHT = ((0.3, 0.0, 8.0), (0.2, 0.4, 8.0), (0.3, 0.0, 4.0), (0.2, -0.5, 7.0), (-0.15, 0.0, 6.0))
"""Bends of 0.5 m, in which the places of outer robots go backwards; and back at the end."""
LEADER = "robot-1"
log = logging.getLogger(__name__)


@dataclass
class Group:
    """Robots that know each other's places.

    Attributes:
        here: The robots.
        traffic: Theirs.
        names: Of all.
        off: How far followers were off their places while the leader drove [m].
    """

    here: Together
    traffic: Traffic
    names: list[str]
    off: list[float] = field(default_factory=list)

    def start(self, mode: GroupMode, leader: str | None = LEADER) -> None:
        robots = dict(zip(self.names, self.here.robots, strict=True))
        for name, stack in stacks_of(mode, robots, leader, self.traffic).items():
            assert robots[name].arbiter.start(stack) is None

    def running(self) -> list[str | None]:
        """Return the mode of each robot."""
        modes = [robot.arbiter.mode for robot in self.here.robots]
        return [mode.name if mode else None for mode in modes]

    async def lead(self, v: float, w: float, seconds: float) -> None:
        """Drive the leader as a key that is held does."""
        for _ in range(round(seconds / 0.1)):
            self.here.robots[0].drive(v, w)
            await asyncio.sleep(0.1)

    def note(self, places: Sequence[tuple[float, float]]) -> None:
        """Note how far each follower is off the nearest place, at each look."""
        leader = self.here.pose(0)
        there = [leader @ Pose2(*place) for place in places]
        for number in range(1, len(self.names)):
            pose = self.here.pose(number)
            self.off.append(min(hypot(p.x - pose.x, p.y - pose.y) for p in there))


@dataclass
class Lossy:
    """A cable that loses three reports of ten, each whole."""

    random: Random

    def __call__(self, data: bytes) -> Iterable[bytes]:
        return () if self.random.random() < 0.3 else (data,)


@asynccontextmanager
async def group(*poses: Pose2, faults: Sequence[Fault] = ()) -> AsyncIterator[Group]:
    async with together(*poses, faults=faults) as here, AsyncExitStack() as stack:
        traffic, names = Traffic(), [one.name for one in here.simulation.robots]
        for number, (name, robot) in enumerate(zip(names, here.robots, strict=True)):

            def place(snapshot: Snapshot, number: int = number) -> SharedPlace | str:
                odom = snapshot.odometry.robot_in_odom
                return SharedPlace("hall", here.pose(number) @ odom.inverse())

            stack.enter_context(traffic.joined(Participant(name, robot, place)))
        yield Group(here, traffic, names)


def lined_up(count: int, apart: float = 1.2) -> list[Pose2]:
    """Return poses side by side, the leader in the middle, the others from right to left."""
    ys = [apart * n for n in range(-(count // 2), count - count // 2)]
    ys.remove(0.0)
    return [Pose2(0.0, 0.0), *(Pose2(0.0, y) for y in ys)]


def told(name: str, off: Sequence[float]) -> tuple[float, float]:
    """Return the median and the 95 % bound; log them for the docs."""
    worst = quantiles(off, n=20)[-1]
    log.info("%s: median %.2f, 95 %% %.2f, worst %.2f m", name, median(off), worst, max(off))
    return median(off), worst


@pytest.mark.parametrize("count", [3, 5])
@pytest.mark.parametrize("formation", ["line", "wedge"])
async def test_a_formation_keeps_its_shape_around_a_leader_that_turns(
    formation: str, count: int
) -> None:
    async with group(*lined_up(count)) as the:
        mode = Form(formation=formation, spacing=1.3)  # type: ignore[arg-type]
        the.start(mode)
        await asyncio.sleep(25.0)
        places = mode.places(count - 1)
        the.here.looked = lambda: the.note(places)
        for part in COURSE:
            await the.lead(*part)
        the.here.looked = lambda: None
        middle, worst = told(f"{formation} of {count}", the.off)
        await asyncio.sleep(15.0)
        assert max(the.here.speeds) < 0.05
        assert middle < 0.25
        assert worst < 0.8
        assert the.here.gap > 0.1


@pytest.mark.parametrize("formation", ["line", "wedge", "column"])
async def test_in_bends_that_are_too_tight_for_their_places_they_do_not_touch(
    formation: str,
) -> None:
    async with group(*lined_up(5)) as the:
        the.start(Form(formation=formation, spacing=1.1))  # type: ignore[arg-type]
        await asyncio.sleep(20.0)
        for part in TIGHT:
            await the.lead(*part)
        await asyncio.sleep(15.0)
        log.info("%s in tight bends: %.2f m at the nearest", formation, the.here.gap)
        assert the.here.gap > 0.01  # 2 to 14 cm, by the phases of their reports


@pytest.mark.parametrize("count", [3, 5])
async def test_a_column_follows_the_track_of_its_leader(count: int) -> None:
    async with group(*(Pose2(-1.4 * n, 0.0) for n in range(count))) as the:
        the.start(FollowLeader(distance=1.3))
        await asyncio.sleep(5.0)
        track: list[Pose2] = []

        def note() -> None:
            track.append(the.here.pose(0))
            for number in range(1, count):
                pose = the.here.pose(number)
                if pose.x > 0.0:  # the track begins there
                    the.off.append(min(hypot(p.x - pose.x, p.y - pose.y) for p in track))

        the.here.looked = note
        for part in COURSE:
            await the.lead(*part)
        middle, worst = told(f"column of {count}, off the track", the.off)
        assert middle < 0.1
        assert worst < 0.3
        assert the.here.gap > 0.2


async def test_a_third_of_all_news_lost_costs_accuracy_and_no_contact() -> None:
    async with group(*lined_up(3), faults=[Lossy(Random(number)) for number in range(3)]) as the:
        mode = Form(formation="wedge", spacing=1.3)
        the.start(mode)
        await asyncio.sleep(25.0)
        the.here.looked = lambda: the.note(mode.places(2))
        for part in COURSE:
            await the.lead(*part)
        _, worst = told("wedge of 3, 30 % of the news lost", the.off)
        assert worst < 1.0
        assert the.here.gap > 0.1


async def test_a_leader_that_stops_suddenly_is_not_run_into() -> None:
    for mode, poses in (
        (FollowLeader(distance=1.1), [Pose2(-1.1 * n, 0.0) for n in range(5)]),
        (Form(formation="wedge", spacing=1.1), lined_up(5)),
    ):
        async with group(*poses) as the:
            the.start(mode)
            await asyncio.sleep(10.0)
            await the.lead(0.5, 0.0, 10.0)
            the.here.robots[0].emergency_stop()
            await asyncio.sleep(6.0)
            assert the.here.gap > 0.1
            assert max(the.here.speeds) < 0.05


async def test_a_robot_that_dies_on_the_way_stops_nobody_else_and_is_not_touched() -> None:
    async with group(*lined_up(5)) as the:
        the.start(Form(formation="wedge", spacing=1.3))
        await asyncio.sleep(20.0)
        await the.lead(0.3, 0.0, 5.0)
        await the.here.kill(1)
        await the.lead(0.3, 0.15, 10.0)
        assert abs(the.here.speeds[1]) < 0.01  # it stands by itself
        assert max(the.here.speeds[2:]) > 0.15
        assert the.here.gap > 0.1


async def test_followers_of_a_leader_that_is_lost_stand_and_end() -> None:
    async with group(*lined_up(3)) as the:
        the.start(Form(formation="line", spacing=1.3))
        await asyncio.sleep(15.0)
        await the.lead(0.3, 0.0, 5.0)
        await the.here.kill(0)
        await asyncio.sleep(2.5)
        assert max(the.here.speeds) < 0.01
        assert str(the.here.robots[1].why_not_moving()) == (
            "It stands because of keep formation, it is not known where robot-1 is."
        )
        await asyncio.sleep(2.0)
        assert the.running() == [None, None, None]
        ended = the.here.robots[1].arbiter.ended
        assert ended is not None
        assert "it is not known where robot-1 is" in ended.why


async def test_robots_in_a_heap_spread_out_and_are_done() -> None:
    starts = [(0.0, 0.0), (1.0, 0.1), (0.1, 1.1), (-1.0, 0.2), (0.2, -1.0)]
    async with group(*(Pose2(x, y, n * 1.1) for n, (x, y) in enumerate(starts))) as the:
        the.start(Spread(apart=2.0), None)
        await asyncio.sleep(45.0)
        poses = [the.here.pose(n) for n in range(5)]
        nearest = min(hypot(a.x - b.x, a.y - b.y) for n, a in enumerate(poses) for b in poses[:n])
        assert nearest > 1.85
        assert the.running() == [None] * 5
        assert the.here.gap > 0.1


@pytest.mark.parametrize(
    ("change", "why"),
    [
        (lambda the: the.start(Form(spacing=0.9)), "0.9 m from robot to robot is too near"),
        (lambda the: the.start(Form(), None), "no leader is named"),
        (lambda the: the.traffic.forget("robot-2") or the.start(Form()), "it is not connected"),
    ],
)
async def test_a_group_that_cannot_drive_is_told_why(
    change: Callable[[Group], None], why: str
) -> None:
    async with group(*lined_up(2)) as the:
        with pytest.raises(MotionError, match=why):
            change(the)


async def test_two_on_crossing_ways_do_not_meet_at_the_crossing() -> None:
    async with group(Pose2(-3.0, 0.0), Pose2(0.0, -3.0, pi / 2)) as the:
        for _ in range(120):
            for robot in the.here.robots:
                robot.drive(0.7)
            await asyncio.sleep(0.1)
        assert the.here.gap > 0.05
