"""Ways over a map."""

from dataclasses import replace
from heapq import heappop, heappush
from math import hypot, inf, pi, sqrt

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.maps import Extent, LineMap, MapObject, OccupancyGrid
from pioneer3.maps.grid import outline
from pioneer3.maps.line_map import FREE, OCCUPIED, UNKNOWN
from pioneer3.nav.costs import PASSING_DISTANCE, CostMap
from pioneer3.nav.planner import CostToGo, NoWay, Way, plan
from pioneer3.nav.raster import Raster
from tests.combinations import examples
from tests.unit.nav.offices import AT, area, box, costs, room, two_rooms

Float32 = NDArray[np.float32]
place = st.tuples(st.floats(0.6, 9.4), st.floats(0.6, 5.4))


def way(on: CostMap, start: tuple[float, float], goal: tuple[float, float]) -> Way:
    found = plan(on, start, goal)
    assert isinstance(found, Way), found
    return found


def why_not(on: CostMap, start: tuple[float, float], goal: tuple[float, float]) -> NoWay:
    found = plan(on, start, goal)
    assert isinstance(found, NoWay)
    return found


def over_graph(costs: Float32, goal: int) -> Float32:
    """The oracle: ways from cell to cell, also across corners, each half of either cell's cost."""
    height, width = costs.shape
    cells = np.arange(height * width).reshape(height, width)
    parts = []
    for dr, dc, length in ((0, 1, 1.0), (1, 0, 1.0), (1, 1, 2**0.5), (1, -1, 2**0.5)):
        here = cells[: height - dr, max(0, -dc) : width - max(0, dc)]
        there = cells[dr:, max(0, dc) : width + min(0, dc)]
        mean = (costs.ravel()[here] + costs.ravel()[there]) / 2 * length
        keep = np.isfinite(mean)
        parts.append((here[keep], there[keep], mean[keep]))
    rows, columns, values = (np.concatenate(part) for part in zip(*parts, strict=True))
    graph = coo_array((values, (rows, columns)), shape=(cells.size, cells.size)).tocsr()
    found: Float32 = dijkstra(graph, directed=False, indices=goal).reshape(costs.shape)
    return found


@settings(deadline=None, max_examples=20)
@given(st.lists(place, max_size=4), place)
def test_costs_to_go_agree_with_a_graph_of_cells(
    boxes: list[tuple[float, float]], goal: tuple[float, float]
) -> None:
    walls = [side for x, y in boxes for side in box(x - 0.3, y - 0.3, x + 0.3, y + 0.3)]
    on = CostMap.of(room(*walls), AT, cell=0.1)
    cell = on.raster.cell_of(*goal)
    assert cell is not None
    assume(on.can_turn(*goal))
    each = on.costs()
    each[on.clearance < on.needed] = np.inf  # the graph halves what a step out of there costs
    found = CostToGo.of(each, on.raster, *goal)
    assert found is not None
    oracle = over_graph(each, cell[0] * on.raster.width + cell[1])
    far = np.isfinite(found.values) & (oracle > 1.0)
    assert (np.isfinite(found.values) <= np.isfinite(oracle)).all()
    ratio = found.values[far] / oracle[far]  # a graph's ways have eight directions
    assert 0.9 < np.median(ratio) < 1.06
    assert np.quantile(ratio, 0.9) < 1.2


def marched(costs: Float32, goal: tuple[int, int]) -> NDArray[np.float64]:
    """The oracle: fast marching with a heap that keeps all cells in order."""
    values, done = np.full(costs.shape, inf), np.zeros(costs.shape, dtype=np.bool_)
    values[goal], waiting = 0.0, [(0.0, goal)]

    def reached(row: int, column: int) -> float:
        inside = 0 <= row < costs.shape[0] and 0 <= column < costs.shape[1]
        return float(values[row, column]) if inside and done[row, column] else inf

    while waiting:
        _, (row, column) = heappop(waiting)
        if done[row, column]:
            continue
        done[row, column] = True
        for r, c in ((row, column - 1), (row, column + 1), (row - 1, column), (row + 1, column)):
            if not (0 <= r < costs.shape[0] and 0 <= c < costs.shape[1]) or done[r, c]:
                continue
            step = float(costs[r, c])
            low, high = sorted(
                (
                    min(reached(r, c - 1), reached(r, c + 1)),
                    min(reached(r - 1, c), reached(r + 1, c)),
                )
            )
            value = low + step
            if high < low + step < inf:
                value = (low + high + sqrt(2 * step**2 - (high - low) ** 2)) / 2
            if value < values[r, c]:
                values[r, c] = value
                heappush(waiting, (value, (r, c)))
    return values


@settings(deadline=None, max_examples=examples(40))
@given(
    arrays(
        np.float32,
        (14, 11),
        elements=st.sampled_from([0.05, 0.05, 0.05, 0.0713, 0.2, 3.0, 40.0, inf]).map(np.float32),
    ),
    st.integers(1, 12),
    st.integers(1, 9),
)
def test_costs_to_go_are_those_of_a_heap_of_cells(each: Float32, row: int, column: int) -> None:
    raster = Raster(x=0.0, y=0.0, cell=0.05, height=14, width=11)
    found = CostToGo.of(each, raster, *raster.middle_of(row, column))
    assert found is not None
    wanted = marched(each, (row, column))
    assert (np.isfinite(found.values) == np.isfinite(wanted)).all()
    reached = np.isfinite(wanted)
    # single precision; where two ways meet at the bound of the root's range, its error is a root
    assert np.allclose(found.values[reached], wanted[reached], rtol=1e-4, atol=1e-4)


@given(place, place)
def test_in_the_open_the_way_is_straight(
    start: tuple[float, float], goal: tuple[float, float]
) -> None:
    found = way(OPEN, start, goal)
    straight = hypot(goal[0] - start[0], goal[1] - start[1])
    assert found.length == pytest.approx(straight, rel=0.02, abs=0.06)
    assert found.points[0].tolist() == pytest.approx(start)
    assert found.points[-1].tolist() == pytest.approx(goal)
    assert found.to_go[-1] == 0.0


OPEN = costs(LineMap(name="", walls=np.array(box(-5.0, -5.0, 15.0, 11.0))))


def test_it_leads_through_the_door() -> None:
    found = way(costs(two_rooms(1.0)), (2.0, 1.0), (8.0, 1.0))
    through = found.points[np.abs(found.points[:, 0] - 5.0).argmin()]
    assert through[1] == pytest.approx(3.0, abs=0.2)
    assert found.length == pytest.approx(2 * hypot(3.0, 1.85), rel=0.08)


def test_no_way_leads_through_a_door_that_is_too_narrow() -> None:
    assert "narrow" in why_not(costs(two_rooms(0.5)), (2.0, 1.0), (8.0, 1.0)).why
    assert why_not(costs(two_rooms(0.0)), (2.0, 1.0), (8.0, 1.0)).why == "no way leads to the goal"


def test_a_robot_beside_a_wall_gets_out() -> None:
    found = way(costs(room()), (0.15, 3.0), (5.0, 3.0))
    assert found.length == pytest.approx(4.85, rel=0.05)


@pytest.mark.parametrize(
    ("goal", "words"),
    [
        ((20.0, 3.0), "outside of the map"),
        ((0.3, 3.0), "m from something"),
        ((3.0, 3.0), "forbidden"),
    ],
)
def test_goals_that_cannot_be_reached_have_a_reason(goal: tuple[float, float], words: str) -> None:
    forbidden = area("ForbiddenArea", (2, 2), (4, 2), (4, 4), (2, 4))
    assert words in why_not(costs(room(objects=(forbidden,))), (7.0, 3.0), goal).why


def test_it_goes_around_forbidden_areas_and_lines() -> None:
    forbidden = area("ForbiddenArea", (4, 2), (6, 2), (6, 6), (4, 6))
    found = way(costs(room(objects=(forbidden,))), (2.0, 4.0), (8.0, 4.0))
    inside = (found.points[:, 0] > 4) & (found.points[:, 0] < 6) & (found.points[:, 1] > 2)
    assert not inside.any()
    line = area("ForbiddenLine", (5, 1.5), (5, 6))
    found = way(costs(room(objects=(line,))), (2.0, 4.0), (8.0, 4.0))
    across = found.points[np.abs(found.points[:, 0] - 5.0).argmin()]
    assert across[1] < 1.5 - AT.width / 2


def test_it_goes_around_things_that_are_seen() -> None:
    door = costs(two_rooms(2.0))
    thing = np.array([[5.0, y] for y in np.arange(2.0, 3.0, 0.05)])
    found = way(door.with_obstacles(thing), (2.0, 3.0), (8.0, 3.0))
    through = found.points[np.abs(found.points[:, 0] - 5.0).argmin()]
    assert through[1] > 3.2
    closed = np.array([[5.0, y] for y in np.arange(2.0, 4.0, 0.05)])
    assert plan(door.with_obstacles(closed), (2.0, 3.0), (8.0, 3.0)) == NoWay(
        "no way leads to the goal"
    )


def test_it_prefers_areas_where_it_may_go_faster() -> None:
    slow = replace(area("SpeedArea", (4, 2.9), (6, 2.9), (6, 6), (4, 6)), name="0.2 m/s")
    on = costs(room())
    assert way(on, (2.0, 3.5), (8.0, 3.5)).points[:, 1].min() > 3.0
    limited = costs(room(objects=(slow,)))
    assert limited.speed_at(5.0, 4.0) == pytest.approx(0.2)
    assert limited.speed_at(5.0, 2.0) == inf
    found = way(limited, (2.0, 3.5), (8.0, 3.5))
    across = found.points[np.abs(found.points[:, 0] - 5.0).argmin()]
    assert across[1] < 2.9


def test_nothing_is_planned_where_nothing_is_known() -> None:
    states = np.full((60, 100), FREE, dtype=np.uint8)
    states[0], states[-1], states[:, 0], states[:, -1] = OCCUPIED, OCCUPIED, OCCUPIED, OCCUPIED
    states[20:, 40:60] = UNKNOWN
    grid = OccupancyGrid(states=states, resolution=0.1, origin=Pose2())
    rows, columns = np.nonzero(states == OCCUPIED)
    walls = outline(
        np.asarray((np.stack([columns, rows], axis=1) + 0.5) * 0.1, dtype=np.float64), 0.1
    )
    on = costs(LineMap(name="scanned", walls=walls, grids=(grid,)))
    found = way(on, (2.0, 4.0), (8.0, 4.0))
    within = (found.points[:, 0] > 4) & (found.points[:, 0] < 6)
    assert found.points[within, 1].max() < 2.0
    assert "nothing is known" in why_not(on, (2.0, 4.0), (5.0, 4.0)).why


def test_the_rest_of_a_way_begins_where_the_robot_is() -> None:
    found = way(OPEN, (1.0, 1.0), (5.0, 1.0))
    rest = found.rest_from(3.0, 1.1)
    assert rest.length == pytest.approx(2.0, abs=0.05)
    assert found.rest_from(9.0, 1.0).length < 0.1


def test_outside_of_the_raster_no_way_leads_anywhere() -> None:
    raster = Raster.around(Extent(0.0, 0.0, 1.0, 1.0), 0.05)
    each = np.full(raster.shape, 0.05, dtype=np.float32)
    assert CostToGo.of(each, raster, 5.0, 5.0) is None
    found = CostToGo.of(each, raster, 0.5, 0.5)
    assert found is not None
    assert found.at(9.0, 9.0) == inf


def test_a_map_of_kilometres_is_refused() -> None:
    far = LineMap(name="far", walls=np.array([[0.0, 0.0, 9e3, 9e3]]))
    with pytest.raises(ConfigError, match="the map is 9000 x 9000 m"):
        costs(far)


def test_a_way_may_be_a_kilometre_long() -> None:
    corridor = LineMap(name="corridor", walls=np.array(box(0.0, 0.0, 1000.0, 2.4)))
    assert way(costs(corridor), (1.0, 1.2), (999.0, 1.2)).length == pytest.approx(998.0, abs=0.1)


def test_a_robot_passes_a_door_of_a_large_map_whose_cells_are_larger() -> None:
    low, high = [60.0, 0.0, 60.0, 80.0], [60.0, 80.85, 60.0, 120.0]
    on = costs(LineMap(name="large", walls=np.array([*box(0.0, 0.0, 120.0, 120.0), low, high])))
    assert on.raster.cell == 2 * costs(room()).raster.cell
    assert way(on, (50.0, 20.0), (70.0, 20.0)).length == pytest.approx(2 * hypot(10, 60.4), abs=1.5)


@pytest.mark.parametrize("width", [2.0, 6.0])
def test_a_way_keeps_beside_the_line_on_which_somebody_comes(width: float) -> None:
    low, high = 3.0 - width / 2, 3.0 + width / 2
    on, line = costs(room([0, low, 10, low], [0, high, 10, high])), np.array([[8.0, 3.0, 4.0, 3.0]])
    straight = way(on, (1.0, 3.0), (9.0, 3.0))
    beside = way(on.with_lines(line), (1.0, 3.0), (9.0, 3.0))
    middle = [y for x, y in beside.points.tolist() if 5.0 < x < 7.0]
    assert all(abs(y - 3.0) > PASSING_DISTANCE + AT.width / 2 for y in middle)
    assert beside.length < straight.length + 1.0


def test_a_way_leads_through_people_where_there_is_no_other_one() -> None:
    on = costs(two_rooms(0.9))
    there = way(on, (1.0, 3.0), (9.0, 3.0))
    lines = np.array([[*there.points[-1], *there.points[0]]])
    assert way(on.with_lines(lines), (1.0, 3.0), (9.0, 3.0)).length < there.length + 2.5


WEST, EAST = (1.0, 4.8), (9.0, 4.8)
UPPER = ((4.0, 3.6), (6.0, 3.6), (6.0, 6.0), (4.0, 6.0))
"""A sector across the upper of the two passages of `around`."""


def around(*objects: MapObject) -> CostMap:
    """Return the costs of a room with a block in its middle, and sectors."""
    return costs(room(*box(2, 2.4, 8, 3.6), objects=objects))


def sector(kind: str, heading: float, corners: tuple[tuple[float, float], ...]) -> MapObject:
    return replace(area(kind, *corners, name="ramp"), pose=Pose2(0.0, 0.0, heading))


def lowest(found: Way) -> float:
    return float(found.points[:, 1].min())


def test_a_one_way_sector_is_crossed_towards_its_heading_alone() -> None:
    to_east = around(sector("OneWaySector", 0.0, UPPER))
    assert lowest(way(to_east, WEST, EAST)) > 3.6
    assert lowest(way(to_east, EAST, WEST)) < 2.4


def test_a_goal_in_a_one_way_sector_is_reached_from_its_entry() -> None:
    to_west = around(sector("OneWaySector", pi, UPPER))
    found = way(to_west, WEST, (5.0, 4.8))
    assert lowest(found) < 2.4
    assert lowest(way(to_west, EAST, (5.0, 4.8))) > 3.6


def test_a_robot_in_a_one_way_sector_leaves_it_at_its_end() -> None:
    to_west = around(sector("OneWaySector", pi, UPPER))
    assert lowest(way(to_west, (5.0, 4.8), EAST)) < 2.4


def test_a_restrictive_sector_is_entered_for_a_goal_in_it_alone() -> None:
    on = around(sector("RestrictiveSector", 0.0, UPPER))
    assert lowest(way(on, WEST, EAST)) < 2.4
    assert lowest(way(on, WEST, (5.0, 4.8))) > 3.6
    assert lowest(way(on, (5.0, 4.8), EAST)) > 3.6


def test_a_way_that_only_a_sector_closes_names_it() -> None:
    lower = ((4.0, 0.0), (6.0, 0.0), (6.0, 2.4), (4.0, 2.4))
    on = around(sector("OneWaySector", pi, UPPER), sector("RestrictiveSector", 0.0, lower))
    assert (
        why_not(on, WEST, EAST).why
        == "no way leads to the goal but through a restrictive sector, ramp"
    )
    alone = around(sector("OneWaySector", pi, UPPER), area("ForbiddenArea", *lower))
    assert (
        why_not(alone, WEST, EAST).why
        == "no way leads to the goal but against a one-way sector, ramp"
    )


@pytest.mark.parametrize("turned", [0.3, -2.0, pi / 2])
def test_sectors_may_be_turned_overlap_and_be_smaller_than_a_cell(turned: float) -> None:
    speck = ((4.99, 4.79), (5.01, 4.79), (5.01, 4.81), (4.99, 4.81))
    on = around(
        sector("OneWaySector", turned, UPPER),
        sector("RestrictiveSector", turned, UPPER),
        sector("OneWaySector", pi, speck),
    )
    assert lowest(way(on, WEST, EAST)) < 2.4
    assert lowest(way(on, EAST, WEST)) < 2.4
