"""Where modes say that they are going to."""

from dataclasses import replace
from math import inf

import pytest

from pioneer3.behaviors import modes
from pioneer3.behaviors.actions.follow_lab import FollowLab
from pioneer3.behaviors.actions.follow_tracking import FollowTracking
from pioneer3.behaviors.follow import follow
from pioneer3.behaviors.goal import Goal
from pioneer3.behaviors.stack import Stack
from pioneer3.geometry import Pose2
from pioneer3.state import Sonar
from tests.unit.behaviors.actions.test_follow_tracking import decided
from tests.unit.behaviors.support import P3AT, seen
from tests.unit.behaviors.tracking.scene import Scene, ahead


def test_goto_is_going_to_its_place() -> None:
    assert modes.goto(1.0, 2.0, 0.5).goal == Goal(x=1.0, y=2.0, heading=0.5)
    assert modes.goto(1.0, 2.0).goal == Goal(x=1.0, y=2.0)


def test_wander_and_teleop_are_going_nowhere() -> None:
    assert modes.wander().goal is None
    assert modes.teleop().goal is None


def test_follow_is_going_to_somebody_once_it_hears_them() -> None:
    action = FollowTracking()
    assert Stack.alone(action, 20).goal is None
    assert follow().goal is None
    decided(Scene(people=[ahead(0.6)]), action)
    goal = Stack.alone(action, 20).goal
    assert goal is not None
    assert goal.person
    x, y = action.target.estimate.position if action.target else (inf, inf)
    assert (goal.x, goal.y) == (x, y)


def test_the_labs_follow_is_going_to_the_nearest_echo() -> None:
    action, here = FollowLab(), seen(pose=Pose2(1.0, 2.0, 0.0))
    ranges = tuple(0.6 if number == 3 else inf for number in range(16))
    heard = replace(here, snapshot=replace(here.snapshot, sonar=Sonar(ranges=ranges)))
    action.decide(heard)
    mount = P3AT.sonars[3]
    echo = here.pose @ Pose2(mount.x, mount.y, mount.theta) @ Pose2(0.6)
    assert action.goal is not None
    assert (action.goal.x, action.goal.y) == pytest.approx((echo.x, echo.y))
    action.decide(here)
    assert action.goal is None
