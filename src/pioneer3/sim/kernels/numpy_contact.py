"""Who may meet whom, with numpy alone: how much room there is, and who stands in whom."""

import numpy as np
from numpy.typing import NDArray

from pioneer3.sim.kernels.near import near_robots
from pioneer3.sim.kernels.numpy_frames import (
    boxes_of,
    frames_of,
    largest,
    outlines_from,
    seen_from,
    sides,
)
from pioneer3.sim.kernels.numpy_outlines import reach_into
from pioneer3.sim.kernels.numpy_truth import any_of
from pioneer3.sim.kernels.robots import Robots

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]
Int = NDArray[np.int64]
Int32 = NDArray[np.int32]

ROOM_OF_OTHERS = 3.0
"""How far from a robot others that move are looked for [m]."""


def room_of_others(robots: Robots, who: Int, poses: Float) -> Float:
    """Return the distance to the nearest other [m], up to `ROOM_OF_OTHERS`, of poses (3, F)."""
    room = np.full(len(who), ROOM_OF_OTHERS)
    beside, others = near_robots(robots, poses[0], poses[1], ROOM_OF_OTHERS, who)
    if len(others):
        dx, dy = robots.shapes.T[:2].take(others, axis=1) - poses[:2].take(beside, axis=1)
        np.minimum.at(room, beside, np.hypot(dx, dy) - robots.shapes[others, 2])
    return room


def may_meet(robots: Robots, who: Int | Int32, frames: Float, ways: Float) -> tuple[Bool, Bool]:
    """Tell who may meet another, where no point of robot `n` is more than `ways[n]` from its place.

    Returns:
        Whether it may meet another, and whether, there itself, it surely does not, both (F,).
    """
    meets = np.zeros(len(who), dtype=np.bool_)
    if len(who) == 0:
        return meets, ~meets
    reach = largest(robots, who) + 2 * float(ways.max(initial=0.0))
    beside, others = near_robots(robots, frames[0], frames[1], reach, who)
    hidden = robots.hidden.take(who.take(beside))
    if any_of(hidden):
        beside, others = beside[hidden == 0], others[hidden == 0]
    hit = np.zeros_like(meets)
    if len(others):
        seen = sides(outlines_from(robots, frames, beside, others))
        ends = seen.reshape(4, -1, len(others))
        middle, length, width = boxes_of(robots, who).take(beside, axis=1)
        for found, spread in ((meets, ways[others] + ways[who[beside]]), (hit, ways[others])):
            into = reach_into(ends, middle, length + spread, width + spread)
            if not any_of(into):
                break  # who has that much room has it with less spread too
            found[beside[into.any(axis=0)]] = True
    return meets, ~hit


def hit_after(around: tuple[Int, Float], boxes: Float, motions: Float, shares: Float) -> Bool:
    """Return whether robots would stand on what is around after shares (F, K) of their motions."""
    whose, ends = around
    hits = np.zeros(shares.shape, dtype=np.bool_)
    moved = motions[:, :, None] * shares
    seen = seen_from(frames_of(*moved), whose, ends[:, :, None])
    middle, length, width = boxes.take(whose, axis=1)[:, :, None]
    segment, share = np.nonzero(reach_into(seen, middle, length, width))
    hits[whose[segment], share] = True
    return hits
