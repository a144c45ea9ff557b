"""The last check of a command: whatever is asked for, no outline comes nearer than it may."""

from itertools import combinations
from math import cos, sin

import numpy as np
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from pioneer3.geometry import STILL, Pose2, Twist2, arc
from pioneer3.limits import Limits
from pioneer3.models import RobotModel, load_model
from pioneer3.nav.clearance import Clearance
from tests.combinations import examples

Float = NDArray[np.float64]
MARGIN, TICK, FINE = 0.02, 0.1, 0.01
"""Kept [m], time between commands [s], and the step of the world [s]."""
SAMPLES = np.linspace(0.0, 1.0, 201)[:, None]


def room_of(model: RobotModel, at: Pose2, walls: Float) -> Float:
    """Return the room beside an outline, by points along each wall and its radius, shape (S,).

    Among them is the deepest one: two of the outline's sides are equally far from it.
    """
    c, s = cos(at.theta), sin(at.theta)
    forward, left = np.array([c, s]), np.array([-s, c])
    off = walls[:, :4].reshape(-1, 2, 2) - (at.x, at.y)
    along, aside = off @ forward, off @ left
    sides = (
        model.length_front - along,
        along + model.length_rear,
        model.width / 2 - aside,
        model.width / 2 + aside,
    )
    shares = [np.broadcast_to(SAMPLES[:, 0], (len(walls), len(SAMPLES)))]
    for one, other in combinations(sides, 2):
        begin, end = (one - other).T
        crossing = np.divide(begin, begin - end, out=np.zeros(len(walls)), where=begin != end)
        shares.append(crossing.clip(0.0, 1.0)[:, None])
    share = np.hstack(shares)[..., None]
    points = walls[:, None, :2] * (1 - share) + walls[:, None, 2:4] * share
    dx, dy = points[..., 0] - at.x, points[..., 1] - at.y
    x, y = c * dx + s * dy, c * dy - s * dx
    off_x = np.maximum(x - model.length_front, -model.length_rear - x)
    off_y = np.abs(y) - model.width / 2
    outside = np.hypot(np.maximum(off_x, 0.0), np.maximum(off_y, 0.0))
    room: Float = np.where(outside > 0, outside, np.maximum(off_x, off_y)).min(axis=1)
    return room - walls[:, 4]


def ramped(now: float, wanted: float, faster: float, slower: float) -> float:
    step = FINE * (faster if abs(wanted) > abs(now) and wanted * now >= 0 else slower)
    return min(wanted, now + step) if wanted > now else max(wanted, now - step)


speeds, rates = st.floats(-0.75, 0.75), st.floats(-1.7, 1.7)
limits = st.builds(
    Limits,
    max_speed=st.just(0.75),
    max_turn_rate=st.just(1.7),
    acceleration=st.floats(0.1, 1.0),
    deceleration=st.floats(0.2, 1.0),
    turn_acceleration=st.floats(0.5, 3.0),
    turn_deceleration=st.floats(0.5, 3.0),
)
place = st.floats(-1.5, 1.5)
wall = st.tuples(place, place, place, place) | st.tuples(place, place).map(lambda p: (*p, *p))
radius = st.sampled_from([0.0, 0.0, 0.1, 0.28])
walls_around = st.lists(
    st.tuples(wall, radius).map(lambda each: (*each[0], each[1])), min_size=1, max_size=6
).map(np.array)
models = st.sampled_from(["p3at-sh", "p3dx-sh", "amigo-sh"]).map(load_model)


@settings(deadline=None, max_examples=examples(60))
@given(models, limits, walls_around, st.data(), st.floats(0.0, 0.1))
def test_no_command_brings_an_outline_nearer_than_it_may(
    model: RobotModel, bounds: Limits, walls: Float, data: st.DataObject, delay: float
) -> None:
    """A driver asks for the worst that it can find, over seconds; the robot obeys late."""
    at, twist = Pose2(), STILL
    kept = np.minimum(room_of(model, at, walls), MARGIN)
    assume((kept > -0.1).all())
    clearance = Clearance(model=model, limits=bounds, margin=MARGIN)
    obeyed = STILL
    for tick in range(15):
        asked = Twist2(data.draw(speeds), data.draw(rates))
        ends = seen_from(at, walls)
        passed = clearance.limit(asked, twist, ends, tick * TICK)
        assert abs(passed.v) <= abs(asked.v) + 1e-9
        assert abs(passed.w) <= abs(asked.w) + 1e-9
        for fine in range(round(TICK / FINE)):
            wanted = passed if fine * FINE >= delay else obeyed
            twist = Twist2(
                ramped(twist.v, wanted.v, bounds.acceleration, bounds.deceleration),
                ramped(twist.w, wanted.w, bounds.turn_acceleration, bounds.turn_deceleration),
            )
            at = at @ arc(twist.v, twist.w, FINE)
            room = room_of(model, at, walls)
            assert (room > kept - 0.002).all()
        obeyed = passed
        kept = np.maximum(kept, np.minimum(room, MARGIN))  # what it has gained, it keeps


def seen_from(at: Pose2, walls: Float) -> Float:
    c, s = cos(at.theta), sin(at.theta)
    rows = []
    for ax, ay, bx, by, around in walls.tolist():
        row: list[float] = []
        for x, y in ((ax, ay), (bx, by)):
            row += [c * (x - at.x) + s * (y - at.y), c * (y - at.y) - s * (x - at.x)]
        rows.append([*row, around])
    return np.array(rows)
