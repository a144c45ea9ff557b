"""Starts and goals are where robots can be and can go; copies are alike."""

import numpy as np
import pytest

from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.gym.maps import BASE, SPARE, Distance, FreeSpace, TiledMap
from pioneer3.maps import LineMap, empty_map, shipped_map
from pioneer3.maps.line_map import distances
from pioneer3.models import load_model
from pioneer3.sim.collision import turning_circle
from pioneer3.sim.free_space import Obstructions
from tests.unit.gym.rooms import ROOM, rooms

MODEL = load_model("p3at-sh")
RADIUS = turning_circle(MODEL)
APART = rooms((0.0, 0.0, 4.0, 3.0), (10.0, 0.0, 18.0, 3.0))
CRATE = rooms((0.0, 0.0, 6.0, 6.0), (1.0, 1.0, 5.0, 5.0))


def places(line_map: LineMap, radius: float = RADIUS) -> FreeSpace:
    return FreeSpace(line_map, TiledMap(line_map, 1).walls, radius)


def test_there_is_room_to_turn_at_every_place() -> None:
    office = shipped_map("office")
    found = places(office).points
    assert len(found) > 1000
    ground = Obstructions.of(office)
    for x, y in found[::50]:
        assert distances(np.array([x, y]), office.walls).min() >= RADIUS + SPARE
        assert not any(ground.blocks(MODEL, Pose2(x, y, theta)) for theta in np.arange(0, 6, 0.5))


def test_places_are_spread_over_all_the_room_there_is() -> None:
    points = places(ROOM).points
    room = RADIUS + SPARE
    np.testing.assert_allclose(points.min(axis=0), [-3.2 + room, -2.7 + room], atol=0.11)
    np.testing.assert_allclose(points.max(axis=0), [3.3 - room, 2.9 - room], atol=0.11)


def test_no_goal_lies_behind_a_wall_without_a_door() -> None:
    points = places(APART).points
    assert points[:, 0].min() > 10


def test_a_narrow_robot_has_more_places() -> None:
    office = shipped_map("office")
    assert len(places(office, 0.2).points) > len(places(office).points)


@pytest.mark.parametrize("line_map", [rooms((0.0, 0.0, 0.5, 0.5)), rooms((0.0, 0.0, 9.0, 0.6))])
def test_a_map_without_room_is_refused(line_map: LineMap) -> None:
    with pytest.raises(ConfigError, match="nowhere"):
        places(line_map)


def test_draws_keep_their_distances_and_reach_everywhere() -> None:
    some, rng = places(ROOM), np.random.default_rng(1)
    limit = Distance([(0.0, 0.0)], 1.0, 2.0)
    drawn = np.array([some.sample(rng, limit) for _ in range(300)])
    away = np.hypot(*drawn.T)
    assert 1.0 <= away.min() < 1.1
    assert 1.9 < away.max() <= 2.0
    assert len({(x > 0, y > 0) for x, y in drawn.tolist()}) == 4
    with pytest.raises(ConfigError, match="tries"):
        some.sample(rng, Distance([(0.0, 0.0)], 20.0))


@pytest.mark.parametrize("line_map", [ROOM, shipped_map("office"), CRATE], ids=lambda m: m.name)
def test_copies_are_alike_to_the_last_bit_and_apart(line_map: LineMap) -> None:
    copies = TiledMap(line_map, 70)
    walls = copies.line_map.walls.reshape(70, -1, 4)
    assert (copies.offsets == np.rint(copies.offsets)).all()
    steps = np.tile(copies.offsets - copies.offsets[0], 2)
    np.testing.assert_array_equal(walls - steps[:, None], walls[[0]].repeat(70, axis=0))
    assert BASE <= walls.min() <= walls.max() < 2 * BASE
    ends = walls.reshape(70, -1, 2)
    low, high = ends.min(axis=1), ends.max(axis=1)
    beside = (low[:, None] >= high[None] + 0.9) | (high[:, None] + 0.9 <= low[None])
    assert (beside.any(axis=2) | np.eye(70, dtype=np.bool_)).all()


def test_a_fence_closes_what_is_open() -> None:
    open_map = LineMap(name="open", walls=np.array([[0.0, 0.0, 5.0, 0.0], [0.0, 0.0, 0.0, 4.0]]))
    copies = TiledMap(open_map, 1)
    assert copies.bounds == (-1.0, -1.0, 6.0, 5.0)
    assert len(copies.walls) == 2 + 4


def test_an_empty_map_is_a_small_pen() -> None:
    assert TiledMap(empty_map(), 1).bounds == (-1.0, -1.0, 1.0, 1.0)
