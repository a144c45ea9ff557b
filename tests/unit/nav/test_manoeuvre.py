"""Manoeuvres out of narrow places."""

from itertools import pairwise
from math import cos, hypot, pi, sin

import numpy as np
import pytest
from numpy.typing import NDArray

from pioneer3.geometry import Pose2, arc, wrap
from pioneer3.jit import fast
from pioneer3.limits import Limits
from pioneer3.maps import LineMap
from pioneer3.maps.grid import samples
from pioneer3.nav import manoeuvre
from pioneer3.nav.costs import PASSING_DISTANCE
from pioneer3.nav.kernels import CACHE
from pioneer3.nav.kernels.manoeuvres import manoeuvre as kernel
from pioneer3.nav.manoeuvre import (
    GAP,
    MOVE_LENGTH,
    PROGRESS,
    Manoeuvre,
    Search,
)
from pioneer3.nav.moving import PERSON_RADIUS
from pioneer3.nav.planner import CostToGo
from tests.unit.nav.offices import AT, box, costs, room

Float = NDArray[np.float64]
LIMITS = Limits(max_speed=0.7, max_turn_rate=1.5)
POCKET = room(*box(5.35, 3.4, 5.75, 3.9), *box(4.0, 2.2, 5.2, 2.6), *box(4.0, 3.4, 4.6, 6.0))
"""Out of the upper right a P3-AT has to turn between three boxes."""


def to_go(line_map: LineMap, x: float, y: float) -> CostToGo:
    on = costs(line_map)
    found = CostToGo.of(on.costs(), on.raster, x, y)
    assert found is not None
    return found


def things(points: Float) -> Float:
    """Return points as obstacles."""
    return np.pad(points, ((0, 0), (0, 3)))


def found(search: Search) -> Float | None:
    """Return the poses at the end of a search."""
    while not search.done:
        search.go_on()
    return search.poses


def test_a_search_among_many_things_needs_no_kernel_of_its_own() -> None:
    pytest.importorskip("numba")
    at, way = Pose2(5.0, 4.2, 0.0), to_go(POCKET, 2.0, 3.0)
    walls = things(samples(POCKET.walls, 0.05))
    for count in (1, len(walls)):
        found(Search(at, AT, walls[-count:], way))
    assert len(fast(kernel, CACHE).signatures) == 1  # type: ignore[attr-defined]


def person(x: float, y: float) -> Float:
    """Return somebody who stands, as an obstacle."""
    return np.array([[x, y, 0.0, 0.0, PERSON_RADIUS]])


def gap(pose: Float, points: Float) -> float:
    """Return the distance between a P3-AT and the nearest of some points, by its sides."""
    x, y, theta = pose
    c, s = cos(theta), sin(theta)
    ahead = c * (points[:, 0] - x) + s * (points[:, 1] - y)
    left = c * (points[:, 1] - y) - s * (points[:, 0] - x)
    beyond_x = np.clip(np.maximum(ahead - AT.length_front, -AT.length_rear - ahead), 0, None)
    beyond_y = np.clip(abs(left) - AT.width / 2, 0, None)
    return float(np.hypot(beyond_x, beyond_y).min())


@pytest.mark.parametrize("theta", np.linspace(-pi, pi, 9)[:-1].tolist())
@pytest.mark.parametrize("at", [(5.0, 3.0), (4.98, 3.1)])
def test_a_manoeuvre_keeps_clear_and_leads_on(at: tuple[float, float], theta: float) -> None:
    points, there = samples(POCKET.walls, 0.05), to_go(POCKET, 1.0, 3.0)
    here = Pose2(*at, theta)
    least = min(GAP, gap(np.array([*at, theta]), points) - 1e-6)
    poses = found(Search(here, AT, things(points), there))
    assert poses is not None
    assert poses[0] == pytest.approx([*at, theta])
    for before, after in pairwise(poses):
        dx, dy = after[:2] - before[:2]
        turn = wrap(float(after[2] - before[2]))
        way = hypot(dx, dy)
        assert way == pytest.approx(MOVE_LENGTH, abs=1e-6) or way == pytest.approx(0, abs=1e-6)
        if way > MOVE_LENGTH / 2:  # never sideways
            middle = before[2] + turn / 2
            assert abs(dx * sin(middle) - dy * cos(middle)) < 1e-6
        assert abs(turn) < 0.2
        assert gap(after, points) >= least - 1e-9
    assert there.at(*poses[-1, :2]) < there.at(*at) - PROGRESS + 0.1
    around = np.hypot(*(points - poses[-1, :2]).T).min()
    assert around >= AT.corner


def test_there_is_none_out_of_a_place_without_a_way() -> None:
    closed = room(*box(4.5, 2.5, 5.5, 3.5))
    poses = found(
        Search(Pose2(5.0, 3.0), AT, things(samples(closed.walls, 0.05)), to_go(room(), 1.0, 3.0))
    )
    assert poses is None


def test_a_search_in_parts_finds_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    points, there = samples(POCKET.walls, 0.05), to_go(POCKET, 1.0, 3.0)

    def search() -> Search:
        return Search(Pose2(4.98, 3.0, 1.5), AT, things(points), there)

    monkeypatch.setattr(manoeuvre, "STATES_AT_ONCE", manoeuvre.MOST_STATES)
    at_once = search()
    at_once.go_on()
    assert at_once.done
    monkeypatch.setattr(manoeuvre, "STATES_AT_ONCE", 40)
    in_parts = search()
    in_parts.go_on()
    assert not in_parts.done
    assert in_parts.poses is None
    later = found(in_parts)
    assert later is not None
    assert at_once.poses is not None
    assert np.array_equal(later, at_once.poses)


def test_backwards_is_taken_where_it_is_shorter() -> None:
    alley = room([3.0, 2.65, 7.0, 2.65], [3.0, 3.35, 7.0, 3.35], [5.4, 2.65, 5.4, 3.35])
    points, there = samples(alley.walls, 0.05), to_go(alley, 1.0, 3.0)
    poses = found(Search(Pose2(4.2, 3.0, 0.0), AT, things(points), there))
    assert poses is not None
    assert poses[-1, 0] < 3.0
    assert np.allclose(poses[:, 2] % (2 * pi), 0.0, atol=0.3)


@pytest.mark.parametrize("theta", [0.0, 1.5, -1.6, 3.0])
def test_a_robot_drives_it_without_touching_anything(theta: float) -> None:
    points, there = samples(POCKET.walls, 0.05), to_go(POCKET, 1.0, 3.0)
    at = Pose2(4.98, 3.0, theta)
    poses = found(Search(at, AT, things(points), there))
    assert poses is not None
    drive, v, w, nearest = Manoeuvre(poses, LIMITS), 0.0, 0.0, 1.0
    for _ in range(1500):
        wanted = drive.step(at)
        if wanted is None:
            break
        v += float(np.clip(wanted[0] - v, -0.03, 0.03))
        w += float(np.clip(wanted[1] - w, -0.15, 0.15))
        at = at @ arc(v * 0.1, w * 0.1, 1.0)
        nearest = min(nearest, gap(np.array([at.x, at.y, at.theta]), points))
    assert wanted is None
    assert hypot(at.x - poses[-1, 0], at.y - poses[-1, 1]) < 0.05
    assert nearest > 0.0


CORRIDOR = room([0.0, 2.0, 10.0, 2.0], [0.0, 4.0, 10.0, 4.0])


def line(x: float, y: float, towards: float) -> Float:
    """Return points of the way of somebody who walks along the corridor."""
    return np.array([(x + towards * step, y) for step in np.arange(0.0, 4.0, 0.1)])


@pytest.mark.parametrize("theta", [0.0, 0.4, 2.5, pi])
def test_a_way_aside_ends_beside_the_way_of_who_waits(theta: float) -> None:
    walls = samples(CORRIDOR.walls, 0.05)
    obstacles = np.concatenate([things(walls), person(6.0, 3.1)])
    ways = line(6.0, 3.1, -1.0)
    poses = found(Search(Pose2(5.0, 3.0, theta), AT, obstacles, to_go(CORRIDOR, 9.0, 3.0), ways))
    assert poses is not None
    assert gap(poses[-1], ways) >= PASSING_DISTANCE - 1e-9
    assert all(gap(each, walls) >= GAP - 1e-9 for each in poses[1:])
    assert all(
        gap(each, np.array([[6.0, 3.1]])) >= PERSON_RADIUS + GAP - 1e-9 for each in poses[1:]
    )
    assert all(gap(each, ways) < PASSING_DISTANCE for each in poses[:-1])


def test_between_two_people_it_turns_to_the_wall() -> None:
    """They stand 15 cm before and behind it, as people do who wait."""
    before, behind = 5.0 + AT.length_front + 0.4, 5.0 - AT.length_rear - 0.4
    walls = things(samples(CORRIDOR.walls, 0.05))
    obstacles = np.concatenate([walls, person(before, 3.0), person(behind, 3.0)])
    ways = line(before, 3.0, -1.0)
    poses = found(Search(Pose2(5.0, 3.0, 0.0), AT, obstacles, to_go(CORRIDOR, 9.0, 3.0), ways))
    assert poses is not None
    assert gap(poses[-1], ways) >= PASSING_DISTANCE - 1e-9


def test_who_is_beside_their_way_stays() -> None:
    here, ways = Pose2(5.0, 2.4, 0.0), line(7.0, 3.2, -1.0)
    walls = things(samples(CORRIDOR.walls, 0.05))
    poses = found(Search(here, AT, walls, to_go(CORRIDOR, 9.0, 3.0), ways))
    assert poses is not None
    assert len(poses) == 1
    assert Manoeuvre(poses, LIMITS).step(here) is None


def test_in_a_narrow_corridor_there_is_no_place_aside() -> None:
    narrow = room([0.0, 2.6, 10.0, 2.6], [0.0, 3.4, 10.0, 3.4])
    obstacles = np.concatenate([things(samples(narrow.walls, 0.05)), person(5.8, 3.0)])
    poses = found(
        Search(Pose2(5.0, 3.0), AT, obstacles, to_go(narrow, 9.0, 3.0), line(5.8, 3.0, -1.0))
    )
    assert poses is None
