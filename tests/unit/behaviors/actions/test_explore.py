"""Seeking room and new ground. A P3-AT needs 2 * (0.2525 + 0.08) = 0.665 m to pass."""

from math import inf, pi, radians

import pytest

from pioneer3.behaviors.action import Combined, Desire
from pioneer3.behaviors.actions import Explore, Unstick
from pioneer3.behaviors.actions.explore import room
from pioneer3.behaviors.engine import Proposal, combine
from pioneer3.behaviors.surroundings import NOTHING_SENSED, Surroundings
from pioneer3.geometry import ORIGIN, Pose2
from tests.unit.behaviors.support import around, seen, value


def walls(*points: tuple[float, float], pose: Pose2 = ORIGIN) -> Surroundings:
    """Return points of odometry's frame."""
    return Surroundings(pose, points, points)


def row(x: float, start: float, end: float) -> list[tuple[float, float]]:
    """Return a wall across the x axis, from y = `start` to `end`."""
    return [(x, start + 0.1 * n) for n in range(round((end - start) / 0.1) + 1)]


@pytest.mark.parametrize(
    ("bearing", "half", "free"),
    [(0.0, 0.3, 1.0), (pi, 0.3, 2.0), (pi / 2, 0.3, inf), (pi / 2, 1.1, 0.5), (0.0, 0.6, 1.0)],
)
def test_room_is_counted_in_a_strip(bearing: float, half: float, free: float) -> None:
    points = walls((1.0, 0.2), (-2.0, 0.0), (1.05, 0.5)).points()
    assert room(points, bearing, half) == pytest.approx(free if half < 1 else 0.2)


def test_with_nothing_around_it_goes_straight_on() -> None:
    desire = Explore().decide(seen())
    assert (desire.v, desire.heading) == (0.3, 0.0)


def test_it_goes_through_a_door_that_is_wide_enough() -> None:
    # posts at +-0.4 m leave 0.8 m; all else around is closed at 1 m
    closed = [(-1.0, 0.2 * n - 1) for n in range(11)]
    closed += [(0.2 * n - 1, y) for n in range(11) for y in (-1.0, 1.0)]
    door = [*row(1.0, -1.0, -0.4), *row(1.0, 0.4, 1.0)]
    desire = Explore().decide(seen(around=walls(*closed, *door)))
    assert value(desire, "heading") == pytest.approx(0.0)
    narrow = [*row(1.0, -1.0, -0.3), *row(1.0, 0.3, 1.0)]
    shut = Explore().decide(seen(around=walls(*closed, *narrow)))
    free = room(walls(*closed, *narrow).points(), value(shut, "heading") or 0.0, 0.3325)
    assert free < 1.5


def test_it_turns_where_it_stands_before_it_goes() -> None:
    # closed ahead and to the right: the way is to the left, and it is far off the present heading
    ahead = [*row(0.6, -1.0, 1.0), *((0.1 * n - 1.0, -0.6) for n in range(17))]
    ahead += [(-0.6, 0.1 * n - 0.6) for n in range(13)]
    desire = Explore().decide(seen(around=walls(*ahead)))
    assert value(desire, "heading") == pytest.approx(pi / 2, abs=radians(31))
    assert desire.v == 0.0


def test_it_prefers_where_it_has_not_been() -> None:
    action = Explore()
    for n in range(12):  # up and down the x axis, ahead
        action.decide(seen(0.1 * n, pose=Pose2(0.25 * n, 0.25)))
    for n in range(12, -1, -1):
        action.decide(seen(5.0 + 0.1 * n, pose=Pose2(0.25 * n, 0.25, pi)))
    back_home = action.decide(seen(60.0, pose=Pose2(0.0, 0.25)))
    heading = value(back_home, "heading")
    assert heading is not None
    assert abs(heading) > radians(15)


def beside_a_wall(*points: tuple[float, float], rate: float = 0.1) -> Desire:
    """Return what a robot wants that has to turn left, with a wall to its right.

    It sees new ground to the left only; something above lets it turn left at `rate` [rad/s].
    """
    right = [(0.1 * n - 3.0, -0.34) for n in range(60)]
    far = [*row(1.5, -0.3, 3.0), *row(-1.5, -0.3, 3.0), *points]
    limiter = Proposal("limiter sweep", Desire(left_max=rate, right_max=rate))
    higher = combine(Combined(), [limiter], 0.0)
    return Explore().decide(seen(around=walls(*right, *far), higher=higher))


def test_with_room_to_turn_it_turns_where_it_stands() -> None:
    desire = beside_a_wall(rate=0.3)
    assert value(desire, "heading") == pytest.approx(pi / 2, abs=radians(31))
    assert desire.v == 0.0


@pytest.mark.parametrize(("rate", "speed"), [(0.1, 0.1), (0.29, 0.29), (0.0, 0.0)])
def test_beside_a_wall_it_turns_on_an_arc_of_a_metre(rate: float, speed: float) -> None:
    desire = beside_a_wall(rate=rate)
    assert value(desire, "heading") == pytest.approx(pi / 2, abs=radians(31))
    assert desire.v == pytest.approx(speed)


@pytest.mark.parametrize(("x", "speed"), [(0.67, 0.1), (0.65, 0.0)])
def test_there_is_no_arc_without_a_way_on(x: float, speed: float) -> None:
    # its front end is at 0.313 m, and 0.35 m are kept
    assert beside_a_wall((x, 0.0)).v == pytest.approx(speed)


def test_without_range_sensors_it_stands() -> None:
    desire = Explore().decide(seen(around=NOTHING_SENSED))
    assert desire == Desire(v=0.0, turn=0.0, lacks=True, reason="no range sensor works")


def test_who_moves_is_not_stuck() -> None:
    action = Unstick()
    for n in range(400):  # 0.04 m/s: 0.3 m in 7.5 s
        assert action.decide(seen(0.1 * n, pose=Pose2(0.004 * n))) is None


def test_who_hardly_moves_for_a_while_takes_the_way_with_most_room() -> None:
    action, ring = Unstick(), around(*((0.9, radians(b)) for b in range(-140, 141, 10)))
    times = [0.1 * n for n in range(300)]
    wanted = [action.decide(seen(now, around=ring)) for now in times]
    begins = next(now for now, desire in zip(times, wanted, strict=True) if desire is not None)
    assert begins == pytest.approx(12.1, abs=0.15)
    first = next(desire for desire in wanted if desire is not None)
    # the only gap is behind
    assert abs(value(first, "heading") or 0.0) == pytest.approx(pi, abs=radians(25))
    ends = max(now for now, desire in zip(times, wanted, strict=True) if desire is not None)
    assert ends == pytest.approx(begins + 15.0, abs=0.25)


def test_a_way_out_ends_when_it_has_led_far_enough() -> None:
    action = Unstick()
    for n in range(125):
        action.decide(seen(0.1 * n))
    assert action.decide(seen(12.5, pose=Pose2(1.1))) is not None
    assert action.decide(seen(12.6, pose=Pose2(1.25))) is None
