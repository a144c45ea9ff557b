"""Places beside the ways of others, where a robot can wait until they have passed."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from math import hypot, isfinite

import numpy as np
from numpy.typing import NDArray

from pioneer3.geometry import Pose2
from pioneer3.nav.costs import CostMap
from pioneer3.nav.mover import Mover
from pioneer3.nav.moving import PERSON_RADIUS
from pioneer3.nav.planner import CostToGo
from pioneer3.nav.raster import Raster

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]

WINDOW = 5.0
"""Places so far from the robot in x or y are looked at [m]."""
AHEAD = 4.0
"""So far ahead of somebody who walks the robot is in the way [m]."""
APART = 0.1
"""From one point to the next one on the ways of people [m]."""
BESIDE = 0.25
"""Room that is left between the robot and somebody who passes [m]."""
TURN = 0.7
"""A turn to a place is worth so much of a way [m/rad]."""
SPARE = 0.03
"""More than is needed to turn, where the robot waits [m]."""


def ways_of(walkers: Sequence[Mover], here: Pose2, *, to_robot: bool = True) -> Float:
    """Return points on the lines ahead of people [m], shape (K, 2).

    Args:
        walkers: These.
        here: Where the robot is [m].
        to_robot: Whether their ways may lead to the robot as well as where they walked last.
    """
    steps, points = np.arange(0.0, AHEAD, APART)[:, None], [np.empty((0, 2))]
    for walker in walkers:
        place = np.array((walker.x, walker.y))
        towards = np.array((here.x, here.y)) - place
        directions = [np.array(walker.heading)] if any(walker.heading) else []
        if to_robot or not directions:
            directions.append(towards / max(hypot(*towards.tolist()), 1e-9))
        points += [place + steps * direction for direction in directions]
    return np.concatenate(points)


def refuge(
    costs: CostMap, corner: float, robot_in_map: Pose2, walkers: Sequence[Mover], seen: Float
) -> CostToGo | None:
    """Return the way to the nearest place where a robot is in nobody's way, if there is one.

    Args:
        costs: Of the map alone.
        corner: From the middle of the robot to its farthest corner [m].
        robot_in_map: Where it is [m, rad].
        walkers: Who come, or stand because of the robot.
        seen: Other things that are not on the map [m], shape (N, 2).
    """
    here = robot_in_map.x, robot_in_map.y
    around = _window(costs, *here).with_obstacles(_with_bodies(seen, walkers))
    apart = corner + PERSON_RADIUS + BESIDE

    def free(places: Float) -> Bool:
        beside = np.ones(len(places), dtype=np.bool_)
        for walker in walkers:
            to_robot = np.array(here) - (walker.x, walker.y)
            to_robot /= max(hypot(*to_robot.tolist()), 1e-9)
            for ahead in (np.array(walker.heading), to_robot):
                beside &= _from_way(walker, ahead, places) > apart
        return beside

    return nearest_place(around, robot_in_map, free)


def nearest_place(
    costs: CostMap, robot_in_map: Pose2, free: Callable[[Float], Bool]
) -> CostToGo | None:
    """Return the way to the nearest place where a robot can turn and wait, if there is one.

    Args:
        costs: Of the map, with all that is seen.
        robot_in_map: Where the robot is [m, rad].
        free: Returns which of some places are in nobody's way, (N, 2) [m] to (N,).
    """
    raster, prices = costs.raster, costs.costs()
    from_robot = CostToGo.of(prices, raster, robot_in_map.x, robot_in_map.y)
    if from_robot is None:
        return None
    fits = np.isfinite(from_robot.values) & (costs.clearance >= costs.turning + SPARE)
    rows, columns = np.nonzero(fits)
    places = np.stack([columns + 0.5, rows + 0.5], axis=1) * raster.cell + (raster.x, raster.y)
    cost = from_robot.values[rows, columns].astype(np.float64)
    # in a crowd it has no room to turn, and drives either way as well
    bearing = np.arctan2(places[:, 1] - robot_in_map.y, places[:, 0] - robot_in_map.x)
    along = np.abs(np.cos(bearing - robot_in_map.theta))
    cost += TURN * np.arccos(np.minimum(along, 1.0))
    cost[~free(places)] = np.inf
    if not np.isfinite(cost).any():
        return None
    x, y = places[int(cost.argmin())].tolist()
    to_go = CostToGo.of(prices, raster, x, y)
    here = robot_in_map.x, robot_in_map.y
    return to_go if to_go is not None and isfinite(to_go.at(*here)) else None


def _from_way(walker: Mover, ahead: Float, places: Float) -> Float:
    """Return the distances of places (N, 2) from the way of somebody [m] in a direction (2,)."""
    there = places - (walker.x, walker.y)
    along = np.clip(there @ ahead, 0.0, AHEAD)
    apart: Float = np.hypot(*(there - along[:, None] * ahead).T)
    return apart


def _with_bodies(seen: Float, walkers: Sequence[Mover]) -> Float:
    angles = np.linspace(0, 2 * np.pi, 12, endpoint=False)
    ring = PERSON_RADIUS * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    return np.concatenate([seen, *(ring + np.array((each.x, each.y)) for each in walkers)])


def _window(costs: CostMap, x: float, y: float) -> CostMap:
    """Return the part of the costs around a place [m]."""
    raster = costs.raster
    u, v = raster.in_cells(np.array([[x, y]]))[0]
    reach = WINDOW / raster.cell
    low, left = max(0, int(v - reach)), max(0, int(u - reach))
    part = np.s_[low : max(0, int(v + reach)), left : max(0, int(u + reach))]
    clearance = costs.clearance[part]
    height, width = clearance.shape
    return replace(
        costs,
        raster=Raster(
            x=raster.x + left * raster.cell,
            y=raster.y + low * raster.cell,
            cell=raster.cell,
            height=height,
            width=width,
        ),
        clearance=clearance,
        closed=costs.closed[part],
        speeds=costs.speeds[part],
    )
