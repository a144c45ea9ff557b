"""The stacks that people choose."""

from math import radians

import pytest

from pioneer3.behaviors.action import Stack
from pioneer3.behaviors.actions import RatioInput
from pioneer3.behaviors.engine import resolve
from pioneer3.behaviors.modes import (
    MODES,
    Follow,
    Goto,
    Turn,
    Wander,
    goto,
    wander,
)
from pioneer3.behaviors.modes.by_hand import teleop, unguarded
from pioneer3.behaviors.modes.group import GROUP_MODES, Membership
from pioneer3.behaviors.surroundings import NOTHING_SENSED
from pioneer3.geometry import Twist2
from tests.unit.behaviors.support import LIMITS, around, seen


def places(stack: Stack) -> list[tuple[int, str]]:
    return [(ranked.priority, ranked.action.name) for ranked in stack.actions]


def test_the_lab_wanders_as_its_seed_has_it() -> None:
    # facts.md 7.7; the limiter of the sweep and the way out are ours
    assert places(wander()) == [
        (100, "stall recover"),
        (95, "near limiter"),
        (90, "far limiter"),
        (85, "limiter sweep"),
        (55, "unstick"),
        (50, "avoid near"),
        (49, "avoid far"),
        (25, "constant velocity"),
    ]


def test_aria_wanders_as_its_group_has_it() -> None:
    assert places(wander(preset="aria")) == [
        (100, "bumpers"),
        (90, "stall recover"),
        (85, "limiter sweep"),
        (80, "unstick"),
        (79, "avoid front"),
        (50, "constant velocity"),
    ]


@pytest.mark.parametrize(
    ("preset", "speed", "v"),
    [("lab", None, 0.15), ("aria", None, 0.4), ("explore", None, 0.3), ("lab", 0.1, 0.1)],
)
def test_speeds_of_wandering(preset: str, speed: float | None, v: float) -> None:
    stack = wander(preset=preset, speed=speed)  # type: ignore[arg-type]
    assert resolve([stack], seen()).twist == Twist2(v, 0.0)


def test_there_are_no_other_presets() -> None:
    with pytest.raises(ValueError, match="no preset 'fast'; take lab or aria"):
        wander(preset="fast")  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("distance", "v"),
    # front at 0.313: 0.2 * (d - 0.3) / 0.8 of the far limiter; 0.25 * (d - 0.3) / 0.3 of the near
    [(1.013, 0.1), (0.613, 0.0), (0.5, 0.0)],
)
def test_the_lab_slows_down_before_a_wall(distance: float, v: float) -> None:
    decision = resolve([wander()], seen(around=around((distance, 0.0))))
    assert decision.twist.v == pytest.approx(v)


@pytest.mark.parametrize("preset", ["lab", "explore"])
def test_nobody_wanders_blind(preset: str) -> None:
    stack = wander(preset=preset)  # type: ignore[arg-type]
    assert resolve([stack], seen(around=NOTHING_SENSED)).twist.v == 0.0


def test_teleop_is_guarded_and_unguarded_is_not() -> None:
    ratios, wall = RatioInput(), seen(around=around((0.45, 0.0)))
    ratios.push(1.0, 0.0)
    assert resolve([teleop(ratios)], wall).twist.v == 0.0
    assert resolve([unguarded(ratios)], wall).twist.v == 0.75


def test_teleop_does_not_swing_a_corner_into_something() -> None:
    ratios, leg = RatioInput(), seen(around=around((0.43, radians(45))))  # 6 degrees off a corner
    ratios.push(0.0, 1.0)
    assert resolve([unguarded(ratios)], leg).twist.w > 0.5
    assert 0 < resolve([teleop(ratios)], leg).twist.w * 0.402 <= 0.05


def test_each_stack_has_actions_of_its_own() -> None:
    one, other = wander(), wander()
    assert not {id(r.action) for r in one.actions} & {id(r.action) for r in other.actions}


def test_each_mode_is_described_and_makes_its_stack() -> None:
    for mode in MODES:
        required = {one.name: 1.0 for one in mode.parameters() if one.required}
        stack = mode(**required).stack(LIMITS)
        assert (stack.name, stack.hint, stack.priority) == (mode.name(), mode.doing, 20)
        assert mode.summary().endswith(".")
        assert set(mode.arguments) <= {one.name for one in mode.parameters()}
        for one in mode.parameters():
            assert one.quantity or one.choices
            assert one.help or one.choices


def test_each_mode_of_groups_is_described_and_makes_a_stack_for_each_robot() -> None:
    for mode in GROUP_MODES:
        made = mode()
        one, two = (
            made.stack(Membership(leader="ann", number=number, peers=list), LIMITS)
            for number in (1, 2)
        )
        assert (one.name, one.hint, one.priority) == (mode.name(), mode.doing, 20)
        assert not {id(r.action) for r in one.actions} & {id(r.action) for r in two.actions}
        assert len(made.places(3)) == 3
        assert made.nearest >= 1.0
        assert mode.summary().endswith(".")
        assert all(one.help or one.choices for one in mode.parameters())


def test_no_mode_is_faster_than_the_robot_may_be() -> None:
    turn = Turn(angle=1.0, rate=9.0).stack(LIMITS)
    for stack, v, w in (
        (Wander(speed=9.0).stack(LIMITS), LIMITS.max_speed, 0.0),
        (Goto(x=9.0, y=0.0, speed=9.0).stack(LIMITS), LIMITS.max_speed, 0.0),
        (turn, 0.0, LIMITS.max_turn_rate),
    ):
        assert resolve([stack], seen()).twist == Twist2(v, w)


@pytest.mark.parametrize(
    ("value", "wrong"),
    [(0.05, "at least 0.1 m"), (4.0, "at most 3 m")],
)
def test_a_parameter_out_of_range_is_told(value: float, wrong: str) -> None:
    (keep,) = (one for one in Follow.parameters() if one.name == "keep")
    with pytest.raises(ValueError, match=wrong):
        keep.check(value)


def test_goto_is_done_where_it_was_sent() -> None:
    stack = goto(0.05, 0.0)
    resolve([stack], seen())
    assert stack.done
