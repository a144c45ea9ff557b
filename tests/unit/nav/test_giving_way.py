"""Going aside for people."""

from math import hypot

import numpy as np

from pioneer3.geometry import Pose2
from pioneer3.nav.giving_way import BESIDE, refuge
from pioneer3.nav.mover import Mover
from pioneer3.nav.moving import PERSON_RADIUS
from tests.unit.nav.offices import AT, costs, room, two_rooms

NOTHING = np.empty((0, 2))


def walker(x: float, y: float, heading: tuple[float, float]) -> Mover:
    return Mover(x, y, 0.0, 0.0, 0.0, (x, y), walks=True, heading=heading)


def test_the_robot_goes_beside_the_way_of_who_comes() -> None:
    here, comes = Pose2(5.0, 3.0, 0.0), walker(6.0, 3.0, (-1.0, 0.0))
    aside = refuge(costs(room()), AT.corner, here, [comes], NOTHING)
    assert aside is not None
    assert abs(aside.y - 3.0) > AT.corner + PERSON_RADIUS + BESIDE
    assert hypot(aside.x - here.x, aside.y - here.y) < 2.0
    assert np.isfinite(aside.at(here.x, here.y))


def test_out_of_a_door_it_goes_back_to_its_side() -> None:
    here, comes = Pose2(4.9, 3.0, 0.0), walker(5.8, 3.0, (-1.0, 0.0))
    aside = refuge(costs(two_rooms(0.9)), AT.corner, here, [comes], NOTHING)
    assert aside is not None
    assert aside.x < 4.9
    assert abs(aside.y - 3.0) > AT.corner


def test_things_that_nobody_mapped_are_no_place_to_wait() -> None:
    here, comes = Pose2(5.0, 3.0, 0.0), walker(6.0, 3.0, (-1.0, 0.0))
    free = refuge(costs(room()), AT.corner, here, [comes], NOTHING)
    assert free is not None
    thing = np.array([[free.x, free.y]])
    other = refuge(costs(room()), AT.corner, here, [comes], thing)
    assert other is not None
    assert hypot(other.x - free.x, other.y - free.y) > AT.width / 2
