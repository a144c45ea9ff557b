"""Somebody walks a course, and a robot follows them: what came of it."""

import asyncio
from collections.abc import Callable
from contextlib import closing
from dataclasses import dataclass, field
from math import atan2, hypot, radians

from pioneer3.behaviors.modes.follow import Rule, follow
from pioneer3.geometry import Pose2
from pioneer3.navigation.connect import connect_async
from pioneer3.runtime.robot import Robot
from pioneer3.sim.body import Body
from pioneer3.sim.kernels.drives import TOUCHED
from pioneer3.sim.obstacles import Obstacle
from pioneer3.sim.realism import Realism
from pioneer3.sim.world import World
from pioneer3.sim.worldfile import Person
from tests.conftest import VirtualTimeLoop
from tests.e2e.follow_course import Course, Passer
from tests.support import TICK, SimulatedRobot

SPEED = 0.4
"""Of the person [m/s]."""
START = 0.6
"""Between robot and person in the beginning [m], unless the robot is to keep more."""
WAIT = 4.0
"""The person stands still for this long; then they walk, and are watched from then on [s]."""
KEEP = 0.3
"""Distance to keep, unless said otherwise [m]."""
NEAR, FAR = 0.15, 0.6
"""Between the outlines [m]; in between, the person is kept."""
LOST, LOST_FOR = 1.5, 2.0
"""Farther away [m] for so long [s], the person is lost."""
HELD = 0.5
"""The person is not farther from where the rule takes them to be [m]."""
ASIDE, MISTAKEN_FOR = radians(65), 1.0
"""Farther aside than this [rad], or lost, the person cannot be heard. A rule that says for so long
[s] that it follows them then takes something else for them."""


@dataclass(slots=True)
class Outcome:
    """Of one walk; shares are of the time that the person was watched.

    Attributes:
        gaps: Between the outlines, every 20 ms [m].
        held: At how many of these times the rule knew where the person was.
        lost: How often the person was lost.
        walls: How often something else was taken for them.
        contacts: How often the robot touched something, or somebody.
        ended: Why the mode ended before the walk, or `None`.
    """

    gaps: list[float] = field(default_factory=list)
    held: int = 0
    lost: int = 0
    walls: int = 0
    contacts: int = 0
    ended: str | None = None

    def share(self, low: float = NEAR, high: float = FAR) -> float:
        """Return the share of the time with the outlines so far apart [m]."""
        return sum(low <= gap <= high for gap in self.gaps) / len(self.gaps)


class Judge:
    """Watches robot and person; the robot is to keep `keep` [m] from them."""

    def __init__(self, robot: Robot, body: Body, person: Obstacle, keep: float = KEEP) -> None:
        self._lost = LOST + keep - KEEP
        self.outcome = Outcome()
        self._robot, self._body, self._person = robot, body, person
        self._far = self._mistaken = 0.0
        self._touching = False

    def look(self) -> None:
        """Look, every `TICK`."""
        outcome, (gap, bearing) = self.outcome, gap_to(self._person.pose, self._body)
        outcome.gaps.append(gap)
        outcome.held += self._knows_place()
        before, self._far = self._far, self._far + TICK if gap > self._lost else 0.0
        outcome.lost += before < LOST_FOR <= self._far
        wrong = (gap > self._lost or abs(bearing) > ASIDE) and self._says_it_follows()
        before, self._mistaken = self._mistaken, self._mistaken + TICK if wrong else 0.0
        outcome.walls += before < MISTAKEN_FOR <= self._mistaken
        touches = bool(self._body.drives.flags.item(TOUCHED, self._body.number))
        outcome.contacts += touches and not self._touching
        self._touching = touches
        ended = self._robot.arbiter.ended
        outcome.ended = ended.why if ended else None

    def _knows_place(self) -> bool:
        """Return whether the robot takes a place near the person for theirs."""
        mode, snapshot = self._robot.arbiter.mode, self._robot.snapshot
        if mode is None or mode.goal is None or snapshot is None:
            return False
        taken = snapshot.odometry.robot_in_odom.inverse() @ Pose2(mode.goal.x, mode.goal.y)
        there = self._body.robot_in_world.inverse() @ self._person.pose
        return hypot(taken.x - there.x, taken.y - there.y) <= HELD

    def _says_it_follows(self) -> bool:
        shares = self._robot.arbiter.decision.contributions
        return any(s.action == "follow" and s.reason.startswith("follows") for s in shares)


def within(outcome: Outcome, keep: float = KEEP) -> float:
    """Return the share of the time in which the gap was as wide as wanted, within 0.5 m."""
    return outcome.share(keep - 0.5, keep + 0.5)


def gap_to(person: Pose2, body: Body, radius: float = 0.25) -> tuple[float, float]:
    """Return the distance between the outlines [m], and where the person is [rad]."""
    there, model = body.robot_in_world.inverse() @ person, body.model
    ahead = max(there.x - model.length_front, -model.length_rear - there.x, 0.0)
    aside = max(abs(there.y) - model.width / 2, 0.0)
    return hypot(ahead, aside) - radius, atan2(there.y, there.x)


@dataclass(frozen=True, slots=True, kw_only=True)
class Walk:
    """Somebody walks a course.

    Attributes:
        course: Where.
        seed: Of all chances.
        rule: That the robot follows.
        model: The robot's.
        seconds: How long.
        speed: Of the person [m/s].
        realism: Of the simulation.
        keep: Distance to keep [m].
        wide: Whether the laser has 1081 readings in 270 degrees, not 181 in 180.
        watch: Called every `TICK`.
    """

    course: Course
    seed: int
    rule: Rule
    model: str = "p3at-sh"
    seconds: float = 60.0
    speed: float = SPEED
    realism: Realism = field(default_factory=Realism)
    keep: float = KEEP
    wide: bool = False
    watch: Callable[[Robot, Body, Obstacle], None] = lambda *_: None

    def run(self) -> Outcome:
        """Return what came of it; takes about a second."""
        with closing(VirtualTimeLoop()) as loop:
            return loop.run_until_complete(self.walk())

    async def walk(self) -> Outcome:
        """Return what came of it."""
        path = self.course.path
        standing = Person(path=path[:1])
        robot = SimulatedRobot(
            self.course.room, model=self.model, realism=self.realism, seed=self.seed
        )
        reach = robot.body.model.length_front + max(START, self.keep) + standing.radius
        robot.body.robot_in_world = Pose2(*path[0], self.course.heading) @ Pose2(-reach)
        waiting = robot.world.add_obstacle(standing)
        async with robot, connect_async(robot.open) as driver:
            if self.wide:
                driver.devices.laser.set_up(radians(-135), radians(135), radians(0.25))
            driver.arbiter.start(follow(self.rule, keep=self.keep))
            await asyncio.sleep(WAIT)
            robot.world.remove_obstacle(waiting)
            person = robot.world.add_obstacle(Person(path=path, speed=self.speed, loop=False))
            judge = Judge(driver, robot.body, person, self.keep)
            passing: dict[Passer, Obstacle] = {}
            for tick in range(round(self.seconds / TICK)):
                self._let_pass(robot.world, passing, tick * TICK)
                await asyncio.sleep(TICK)
                judge.look()
                self.watch(driver, robot.body, person)
        return judge.outcome

    def _let_pass(self, world: World, passing: dict[Passer, Obstacle], now: float) -> None:
        """Let others come and go."""
        for passer in self.course.passers:
            here = passer.comes <= now < passer.goes
            if here and passer not in passing:
                passing[passer] = world.add_obstacle(passer.person)
            elif not here and passer in passing:
                world.remove_obstacle(passing.pop(passer))
