"""Several robots on one map."""

from math import hypot, inf, pi

import numpy as np
import pytest
from numpy.typing import NDArray

from pioneer3.geometry import Pose2
from pioneer3.nav.beams import Beams
from pioneer3.nav.traffic import PASSING_ROOM, Traveller, meeting, passing_place, without_robots
from tests.unit.nav.offices import AT, costs, room, two_rooms

APART = 2 * AT.corner + PASSING_ROOM


def line(x0: float, y0: float, x1: float, y1: float) -> NDArray[np.float64]:
    count = max(2, round(hypot(x1 - x0, y1 - y0) / 0.025))
    return np.linspace((x0, y0), (x1, y1), count)


def traveller(
    x: float, y: float, to: tuple[float, float] | None = None, since: float = 0.0
) -> Traveller:
    way = line(x, y, *to) if to else np.empty((0, 2))
    return Traveller(name="robot", robot_in_map=Pose2(x, y), corner=AT.corner, way=way, since=since)


def test_ways_that_cross_meet_before_the_crossing() -> None:
    mine, other = traveller(2.0, 3.0, (8.0, 3.0)), traveller(4.0, 1.0, (4.0, 5.0))
    met = meeting(mine, other)
    assert met == pytest.approx(2.0 - APART, abs=0.1)


def test_a_robot_that_is_in_the_way_meets_at_once() -> None:
    mine, other = traveller(4.0, 3.0), traveller(1.0, 3.0, (8.0, 3.0))
    assert meeting(mine, other) == 0.0


def test_ways_that_part_do_not_meet() -> None:
    mine, other = traveller(2.0, 3.0, (0.5, 3.0)), traveller(4.0, 3.0, (8.0, 3.0))
    assert meeting(mine, other) is None


def test_ways_far_ahead_do_not_count_yet() -> None:
    mine, other = traveller(1.0, 3.0, (30.0, 3.0)), traveller(30.0, 3.0, (1.0, 3.0))
    assert meeting(mine, other) is None


def test_a_passing_place_is_beside_the_whole_way_of_the_other() -> None:
    mine, other = traveller(5.0, 3.0), traveller(1.0, 3.0, (9.0, 3.0))
    place = passing_place(costs(room()), mine, [other])
    assert place is not None
    assert abs(place.y - 3.0) >= APART
    assert hypot(place.x - 5.0, place.y - 3.0) < APART + 0.6
    assert np.isfinite(place.at(5.0, 3.0))


def test_it_is_on_the_own_side_of_a_door_where_the_other_comes_through() -> None:
    mine, other = traveller(5.6, 3.0), traveller(3.0, 3.0, (9.0, 3.0))
    place = passing_place(costs(two_rooms(1.0)), mine, [other])
    assert place is not None
    assert place.x > 5.0
    assert abs(place.y - 3.0) >= APART


def test_where_nobody_can_go_aside_there_is_no_place() -> None:
    mine = traveller(5.0, 3.0)
    others = [traveller(1.0, y, (9.0, y)) for y in (1.0, 2.0, 3.0, 4.0, 5.0)]
    assert passing_place(costs(room()), mine, others) is None


def test_echoes_of_other_robots_are_left_out() -> None:
    here = Pose2(1.0, 1.0, pi / 2)
    seen = Beams(
        stamp=1.0,
        robot_in_odom=Pose2(),
        points=np.array([[2.0, 0.1], [2.0, 1.5], [4.0, 0.0]]),
        clear=np.empty((0, 2)),
        origin=np.zeros(2),
        far=30.0,
    )
    other = traveller(1.0, 3.0, since=inf)  # 2 m ahead
    left = without_robots(seen, here, [other])
    assert left.points.tolist() == [[2.0, 1.5], [4.0, 0.0]]
    assert without_robots(seen, here, []) is seen
