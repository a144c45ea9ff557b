"""Which clusters of a scan are legs."""

from math import hypot, inf, nan, pi, radians

import pytest

from pioneer3.behaviors.legs import Leg, find_legs, range_towards
from pioneer3.geometry import Pose2
from tests.unit.behaviors.legs.scans import LEG, Room, spoiled


def free(legs: list[Leg]) -> list[Leg]:
    return [leg for leg in legs if leg.free]


@pytest.mark.parametrize(("beams", "view"), [(181, pi), (361, pi), (1081, 1.5 * pi)])
@pytest.mark.parametrize("distance", [0.5, 1.0, 2.0])
def test_both_legs_are_found_where_they_are(beams: int, view: float, distance: float) -> None:
    room = Room(people=[Pose2(distance)], beams=beams, view=view)
    right, left = free(find_legs(room.scan()))
    for leg, side in ((right, -0.125), (left, 0.125)):
        # the middle of a leg is known to a quarter of its width
        assert hypot(leg.x - distance, leg.y - side) < LEG / 2
        assert leg.width == pytest.approx(2 * LEG, abs=2 * distance * view / (beams - 1))
        assert not leg.both


def test_places_are_in_the_frame_of_odometry() -> None:
    pose = Pose2(3.0, -2.0, radians(130))
    (leg, _) = free(find_legs(Room(people=[pose @ Pose2(1.0)], pose=pose).scan()))
    there = pose @ Pose2(1.0, -0.125)
    assert (leg.x, leg.y) == pytest.approx((there.x, there.y), abs=0.03)


def test_a_wall_is_no_leg() -> None:
    assert find_legs(Room(walls=[(1.0, -3.0, 1.0, 3.0)]).scan()) == []


@pytest.mark.parametrize("width", [0.02, 0.8])
def test_things_of_another_width_are_no_legs(width: float) -> None:
    scan = Room(walls=[(1.0, -width / 2, 1.0, width / 2)], beams=1081).scan()
    assert find_legs(scan) == []


def test_a_flat_thing_as_wide_as_a_leg_is_none() -> None:
    # turned so that its beams get longer from one edge to the other, as of no round thing
    assert find_legs(Room(walls=[(1.0, -0.06, 1.02, 0.06)], beams=1081).scan()) == []


def test_a_corner_that_points_away_is_no_leg() -> None:
    walls = [(1.0, -0.07, 1.06, 0.0), (1.06, 0.0, 1.0, 0.07)]
    assert find_legs(Room(walls=walls, beams=1081).scan()) == []


def test_a_skirt_is_both_legs() -> None:
    (leg,) = find_legs(Room(posts=[(1.0, 0.0, 0.2)]).scan())
    assert leg.both
    assert leg.free


def test_a_leg_that_something_hides_in_part_is_not_free() -> None:
    scan = Room(posts=[(1.5, 0.0, LEG), (1.0, 0.08, LEG)], beams=1081).scan()
    behind, before = sorted(find_legs(scan), key=lambda leg: -leg.x)
    assert not behind.free
    assert before.free


def test_a_leg_at_the_end_of_the_field_of_view_is_not_free() -> None:
    legs = find_legs(Room(posts=[(0.0, 1.0, LEG)]).scan())
    assert free(legs) == []


def test_readings_that_are_not_valid_do_not_end_a_leg() -> None:
    scan = Room(people=[Pose2(1.0)]).scan()
    before = find_legs(scan)
    legs = [k for k, metres in enumerate(scan.ranges) if metres < 2.0]
    ranges = [nan if k in legs[3:5] else metres for k, metres in enumerate(scan.ranges)]
    after = find_legs(spoiled(scan, ranges))
    assert len(after) == len(before) == 2
    for one, other in zip(before, after, strict=True):
        assert hypot(one.x - other.x, one.y - other.y) < 0.02


@pytest.mark.parametrize("nothing", [inf, -inf, nan])
def test_without_readings_there_are_no_legs(nothing: float) -> None:
    scan = Room().scan()
    assert find_legs(spoiled(scan, [nothing] * len(scan.ranges))) == []


def test_the_range_towards_a_bearing_is_that_of_the_nearest_beam() -> None:
    scan = Room(walls=[(1.0, -3.0, 1.0, 3.0)]).scan()
    assert range_towards(scan, 0.0) == pytest.approx(1.0)
    assert range_towards(scan, radians(60.1)) == pytest.approx(2.0, abs=0.02)
    assert range_towards(scan, radians(120)) == 0.0
    assert range_towards(Room().scan(), 0.0) == inf
