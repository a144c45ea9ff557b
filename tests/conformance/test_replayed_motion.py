"""Our simulated robot moves as the old emulator did, but for the latter's faults.

Distances, speeds, headings and places agree within 5 % of what has been travelled or turned so
far, all along. Where they do not, the test says which fault of the old emulator (facts.md 9) is
the reason, and how much of the difference it makes:

1. Its reaction takes two cycles or three. Ours is compared :data:`LATENCY` late, give or take what
   a robot covers in a cycle.
2. To a heading it turns by the angle that is left in each second (9.3), so it stays behind the
   headings that ARIA commands one after the other; ours has them.
3. Without power it rolls out on its ramp (9.3); our wheels brake hard.
"""

from pathlib import Path

import numpy as np
import pytest

from pioneer3.arcos import commands
from tests.conformance.old_emulator import LATENCY, ROUNDED, headings
from tests.conformance.replay import (
    CAPTURES,
    CYCLE,
    MAP,
    MODEL,
    Float,
    capture,
    cycles_of,
    drift,
    pair,
    said,
)

pytestmark = pytest.mark.skipif(
    not (CAPTURES and MAP.exists()), reason="no captures or no maps beside this checkout"
)


def programs(*names: str) -> pytest.MarkDecorator:
    return pytest.mark.parametrize("path", [capture(name) for name in names], ids=names)


driven = programs("actionExample", "demo", "simpleMotionCommands", "wander")
steered_by_rates = programs("demo", "simpleMotionCommands")
steered_by_headings = programs("actionExample", "wander")

SHARE = 0.05
"""What may differ of all that has been travelled or turned so far."""


@driven
def test_the_distance_travelled_is_the_same_all_along(path: Path) -> None:
    theirs, ours = pair(path).tracks(LATENCY)
    allowed = SHARE * theirs.way + _one_cycle(theirs.speed, ours.speed)
    assert np.max(np.abs(ours.way - theirs.way) - allowed) <= 0
    assert ours.way[-1] == pytest.approx(theirs.way[-1], rel=0.02)


@driven
def test_the_speed_is_the_same_all_along(path: Path) -> None:
    theirs, ours = pair(path).tracks(LATENCY)
    powered = theirs.time < _motors_off_at(path)
    assert np.max(_outside(theirs.speed, ours.speed)[powered]) <= 0.01


@pytest.mark.planar("ramps to a third of a degree a second, as on the old emulator's plane")
@steered_by_rates
def test_the_turn_rate_is_the_same_all_along(path: Path) -> None:
    # 9.4: a reversal of the turn, at once there, is a ramp of two cycles here
    theirs, ours = pair(path).tracks(LATENCY)
    assert np.max(_outside(theirs.turn_rate, ours.turn_rate)) <= np.radians(0.3)


@steered_by_rates
def test_the_heading_is_the_same_all_along(path: Path) -> None:
    theirs, ours = pair(path).tracks(LATENCY)
    allowed = SHARE * theirs.rotation + _one_cycle(theirs.turn_rate, ours.turn_rate) + ROUNDED
    assert np.max(np.abs(ours.theta - theirs.theta) - allowed) <= 0


@steered_by_rates
def test_the_place_is_the_same_all_along(path: Path) -> None:
    theirs, ours = pair(path).tracks(LATENCY)
    apart = np.hypot(ours.x - theirs.x, ours.y - theirs.y)
    allowed = SHARE * theirs.way + _one_cycle(theirs.speed, ours.speed)
    assert np.max(apart - allowed) <= 0


@driven
def test_its_way_of_turning_leads_where_the_old_emulator_went(path: Path) -> None:
    expected = headings(path, MODEL.turn_acceleration)
    assert np.max(np.abs(expected - pair(path).theirs.track.theta)) <= 2 * ROUNDED


@steered_by_headings
def test_our_robot_follows_the_commanded_heading(path: Path) -> None:
    ours = pair(path).ours.track
    wanted = _commanded(path, ours.time)
    steered = np.convolve(np.isfinite(wanted), np.ones(10))[: len(wanted)] == 10  # for a second
    assert np.count_nonzero(steered) > 40
    # they come one or two degrees apart, each before the last is reached
    assert np.max(np.abs(ours.theta - wanted)[steered]) <= np.radians(3.0)


@steered_by_headings
def test_headings_differ_by_no_more_than_the_old_emulator_lacked_of_the_commanded(
    path: Path,
) -> None:
    theirs, ours = pair(path).tracks(LATENCY)
    lacked = np.abs(np.nan_to_num(_commanded(path, theirs.time) - theirs.theta))
    allowed = SHARE * theirs.rotation + np.maximum.accumulate(lacked) + ROUNDED
    assert np.max(np.abs(ours.theta - theirs.theta) - allowed) <= 0


@steered_by_headings
def test_places_differ_by_what_the_headings_make(path: Path) -> None:
    theirs, ours = pair(path).tracks(LATENCY)
    apart = np.hypot(ours.x - theirs.x, ours.y - theirs.y)
    allowed = SHARE * theirs.way + _one_cycle(theirs.speed, ours.speed)
    assert np.max(apart - drift(theirs, ours) - allowed) <= 0


def _one_cycle(theirs: Float, ours: Float) -> Float:
    """What a robot covers in a cycle, by which the old emulator's reaction is uncertain."""
    return np.maximum.accumulate(np.maximum(np.abs(theirs), np.abs(ours))) * CYCLE


def _outside(values: Float, of: Float) -> Float:
    """By how much `values` lie outside what `of` takes within a cycle before and after."""
    near = np.stack([np.roll(of, shift) for shift in (-1, 0, 1)])
    low, high = near.min(axis=0), near.max(axis=0)
    outside: Float = np.maximum(0, np.maximum(low - values, values - high))
    return outside


def _commanded(path: Path, times: Float) -> Float:
    """Return the heading the program wanted at each of `times` [rad], nan where it wanted none."""
    clock = cycles_of(path)
    orders = [
        (time, order.heading if isinstance(order, commands.Head) else np.nan)
        for time, order in said(path, clock)
        if isinstance(order, commands.Head | commands.RVel)
    ]
    at = np.searchsorted([time for time, _ in orders], times) - 1
    wanted: Float = np.where(at < 0, np.nan, np.array([heading for _, heading in orders])[at])
    return wanted


def _motors_off_at(path: Path) -> float:
    """When the program switched the motors off for good, on the old emulator's clock [s].

    Without power our wheels brake hard; the old emulator rolls out on its ramp (9.3).
    """
    clock = cycles_of(path)
    return max(t for t, order in said(path, clock) if order == commands.Enable(on=False))
