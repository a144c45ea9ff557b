"""Maps of places that have changed since."""

import numpy as np
import pytest

from pioneer3.geometry import Pose2
from pioneer3.maps import OccupancyGrid
from pioneer3.maps.line_map import OCCUPIED
from pioneer3.nav.changes import changes, days_of, render_days
from pioneer3.nav.mapper import Mapper
from pioneer3.nav.rendering import render
from tests.unit.nav.halls import HALL, ROUND, look

BOX = np.array([[5, 0.6, 5.6, 0.6], [5.6, 0.6, 5.6, 0], [5, 0.6, 5, 0]], dtype=np.float64)
SHELF = np.array([1, -1, 1, -1]) * BOX + np.array([0, 8, 0, 8])
"""Things at two walls of the hall [m], which stood there on one day each."""


def driven(*days: np.ndarray) -> list[Mapper]:
    """Return mappers after laps around the block, each goes on with the one before."""
    mappers = list[Mapper]()
    for number, things in enumerate(days):
        rng = np.random.default_rng(number)
        mapper = Mapper.of(mappers[-1].state, ROUND[0]) if mappers else Mapper(ROUND[0])
        for place in ROUND:
            walls = np.concatenate([HALL, things])
            odometry = ROUND[0].inverse() @ place
            mapper.add(look(walls, place, odometry, noise=0.005, rng=rng, count=361))
        mapper.improve()
        mappers.append(mapper)
    return mappers


def walls_near(grid: OccupancyGrid, x: float, y: float) -> bool:
    """Return whether there is a wall within 5 cm of a place."""
    row, column = (np.array([y - grid.origin.y, x - grid.origin.x]) // grid.resolution).astype(int)
    around = grid.states[row - 2 : row + 3, column - 2 : column + 3]
    return bool((around == OCCUPIED).any())


def test_what_has_gone_since_goes_and_what_has_come_is_drawn() -> None:
    before, after = driven(BOX, SHELF)
    assert len(list(days_of(after.survey))) == 2
    old, new = render_days(before.survey), render_days(after.survey)
    assert (old.states == render(before.survey).states).all()
    for x, y, was, now in (
        (5.3, 0.6, True, False),  # the box
        (5.3, 7.4, False, True),  # the shelf
        (12.0, 3.0, True, True),
        (4.0, 4.0, True, True),
    ):
        assert (walls_near(old, x, y), walls_near(new, x, y)) == (was, now)
    found = changes(old, new)
    (box,) = (each for each in found if each.gone)
    (shelf,) = (each for each in found if not each.gone)
    assert (box.x, box.y) == pytest.approx((5.3, 0.5), abs=0.2)
    assert (shelf.x, shelf.y) == pytest.approx((5.3, 7.5), abs=0.2)
    third = render_days(driven(BOX, SHELF, SHELF)[-1].survey)
    assert not walls_near(third, 5.3, 0.6)
    assert walls_near(third, 5.3, 7.4)


def test_nothing_has_changed_where_a_map_is_only_continued() -> None:
    before, after = driven(BOX, BOX)
    assert changes(render_days(before.survey), render_days(after.survey)) == []


def test_what_was_not_seen_again_stays() -> None:
    (mapper,) = driven(BOX)
    again = Mapper.of(mapper.state, ROUND[60])
    for number in range(60, 66):
        place = ROUND[number]
        again.add(look(HALL, place, Pose2() @ (ROUND[60].inverse() @ place), count=361))
    old, new = render_days(mapper.survey), render_days(again.survey)
    assert walls_near(new, 5.3, 0.6)
    assert changes(old, new) == []
