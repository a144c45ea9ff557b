from collections.abc import Iterable

import pytest

from pioneer3.arcos import commands, reports
from pioneer3.arcos.commands import GripperAction, RequestMode
from pioneer3.arcos.reports import GripperSwitch
from pioneer3.errors import ConfigError
from pioneer3.sim.accessories.base import NOTHING
from pioneer3.sim.accessories.gripper import IDLE, OPENING, HeldObject, NoGripper, SimulatedGripper
from tests.unit.sim.accessories.carrier import answers

S = GripperSwitch
PADDLES = S.LEFT_PADDLE_LOW | S.RIGHT_PADDLE_LOW
BEAMS = S.OUTER_BEAM_BROKEN | S.INNER_BEAM_BROKEN
OPEN_DOWN = PADDLES
"""Delivered: open switch and lift limit pressed (0), nothing at the paddles."""


class Hand:
    """A gripper in time."""

    def __init__(self) -> None:
        self.gripper = SimulatedGripper()
        self.now = 100.0
        self.gripper.switches(self.now)

    def do(self, *actions: GripperAction) -> None:
        for action in actions:
            assert self.gripper.obey(commands.Gripper(action), self.now)

    def value(self, seconds: float) -> None:
        assert self.gripper.obey(commands.GripperVal(seconds), self.now)

    def wait(self, seconds: float) -> GripperSwitch:
        """Let cycles pass; return what the last one shows."""
        for _ in range(round(seconds / 0.02)):
            self.now += 0.02
            self.gripper.switches(self.now)
        return self.gripper.switches(self.now)


@pytest.fixture
def hand() -> Hand:
    return Hand()


def test_it_is_delivered_open_and_down(hand: Hand) -> None:
    assert hand.wait(1.0) == OPEN_DOWN


def test_closing_takes_two_seconds_and_ends_with_both_paddles(hand: Hand) -> None:
    hand.do(GripperAction.CLOSE)
    assert hand.wait(1.0) == PADDLES | S.OPEN_LOW | S.GRIP_MOVING
    assert hand.gripper.opening == pytest.approx(OPENING / 2)
    assert hand.wait(0.9) & PADDLES
    assert hand.wait(0.5) == S.OPEN_LOW
    assert hand.gripper.opening == 0.0
    hand.do(GripperAction.OPEN)
    assert hand.wait(1.9) & S.GRIP_MOVING
    assert hand.wait(0.2) == OPEN_DOWN


def test_the_lift_takes_three_seconds_and_shows_both_limits(hand: Hand) -> None:
    hand.do(GripperAction.LIFT_UP)
    assert hand.wait(1.5) == OPEN_DOWN | S.LIFT_LIMIT_LOW | S.LIFT_MOVING
    assert hand.wait(1.4) & S.LIFT_MOVING
    assert hand.wait(0.2) == OPEN_DOWN
    assert hand.gripper.height == 1.0
    hand.do(GripperAction.LIFT_DOWN)
    assert hand.wait(3.1) == OPEN_DOWN
    assert hand.gripper.height == 0.0


def test_paddles_and_lift_stop_each_for_itself(hand: Hand) -> None:
    hand.do(GripperAction.CLOSE, GripperAction.LIFT_UP)
    hand.wait(0.5)
    hand.do(GripperAction.STOP)
    assert hand.wait(0.5) & (S.GRIP_MOVING | S.LIFT_MOVING) == S.LIFT_MOVING
    hand.do(GripperAction.LIFT_STOP)
    assert hand.wait(0.5) == PADDLES | S.OPEN_LOW | S.LIFT_LIMIT_LOW
    hand.do(GripperAction.STORE)
    hand.do(GripperAction.HALT)
    assert not hand.wait(0.5) & (S.GRIP_MOVING | S.LIFT_MOVING)


def test_store_lifts_and_closes_deploy_undoes_it(hand: Hand) -> None:
    hand.do(GripperAction.STORE)
    assert hand.wait(3.5) == S.OPEN_LOW
    assert hand.gripper.height == 1.0
    hand.do(GripperAction.DEPLOY)
    assert hand.wait(3.5) == OPEN_DOWN


@pytest.mark.parametrize(
    ("held", "beams"),
    [
        (HeldObject(), BEAMS),
        (HeldObject(outer=False), S.INNER_BEAM_BROKEN),
        (HeldObject(inner=False), S.OUTER_BEAM_BROKEN),
        (HeldObject(outer=False, inner=False), S(0)),
    ],
)
def test_a_thing_breaks_its_beams(hand: Hand, held: HeldObject, beams: GripperSwitch) -> None:
    hand.gripper.put(held)
    assert hand.gripper.held == held
    assert hand.wait(0.1) == OPEN_DOWN | beams
    hand.gripper.put(None)
    assert hand.wait(0.1) == OPEN_DOWN


def test_paddles_close_on_a_thing_and_lift_it(hand: Hand) -> None:
    hand.gripper.put(HeldObject(width=OPENING / 2))
    hand.do(GripperAction.CLOSE)
    assert hand.wait(1.1) == S.OPEN_LOW | BEAMS | S.GRIP_MOVING
    assert hand.wait(0.3) == S.OPEN_LOW | BEAMS
    assert hand.gripper.opening == pytest.approx(OPENING / 2)
    hand.do(GripperAction.LIFT_UP)
    assert hand.wait(3.1) == S.OPEN_LOW | BEAMS
    hand.gripper.put(None)
    assert hand.wait(0.1) == S.OPEN_LOW | PADDLES


def test_a_thing_must_fit(hand: Hand) -> None:
    hand.do(GripperAction.CLOSE)
    hand.wait(3.0)
    with pytest.raises(ConfigError, match="do not fit"):
        hand.gripper.put(HeldObject())
    with pytest.raises(ConfigError, match="a gripper opens to"):
        HeldObject(width=1.0)
    with pytest.raises(ConfigError, match="a gripper opens to"):
        HeldObject(width=float("nan"))


def test_pressure_sets_how_long_it_grasps(hand: Hand) -> None:
    hand.do(GripperAction.PRESSURE)
    assert hand.gripper.awaits_value
    hand.value(1.0)
    assert not hand.gripper.awaits_value
    hand.gripper.obey(commands.GripperPacRequest(RequestMode.ONCE), hand.now)
    (report,) = answers(hand.gripper, hand.now)
    assert report == reports.GripperState(2, OPEN_DOWN, 50)
    hand.do(GripperAction.CLOSE)
    assert hand.wait(2.9) & S.GRIP_MOVING
    assert not hand.wait(0.2) & S.GRIP_MOVING


def test_lift_carry_raises_for_a_while(hand: Hand) -> None:
    hand.do(GripperAction.LIFT_CARRY)
    assert not hand.wait(0.5) & S.LIFT_MOVING
    hand.value(0.6)
    assert hand.wait(0.5) & S.LIFT_MOVING
    assert not hand.wait(0.5) & S.LIFT_MOVING
    assert hand.gripper.height == pytest.approx(0.2)


def test_a_value_out_of_the_blue_changes_nothing(hand: Hand) -> None:
    hand.value(2.0)
    hand.do(GripperAction.PRESSURE, GripperAction.OPEN)
    hand.value(2.0)
    hand.gripper.obey(commands.GripperPacRequest(RequestMode.ONCE), hand.now)
    (report,) = answers(hand.gripper, hand.now)
    assert isinstance(report, reports.GripperState)
    assert report.grasp_time_20ms == 10
    assert hand.wait(1.0) == OPEN_DOWN


def test_the_standard_report_shows_the_same_switches(hand: Hand) -> None:
    hand.gripper.put(HeldObject(outer=False))
    assert hand.gripper.inputs(NOTHING, hand.now).gripper_state == OPEN_DOWN | S.INNER_BEAM_BROKEN


def test_the_end_of_the_session_stops_it(hand: Hand) -> None:
    hand.do(GripperAction.STORE)
    hand.wait(0.5)
    hand.gripper.hang_up()
    assert not hand.wait(0.1) & (S.GRIP_MOVING | S.LIFT_MOVING)


def paddle_states(switches: Iterable[GripperSwitch]) -> list[str]:
    """Return what ARIA's ArGripper makes of the bits (protocol.md 4.7)."""
    return [
        "closed" if not seen & PADDLES else "between" if seen & S.OPEN_LOW else "open"
        for seen in switches
    ]


def test_aria_sees_open_between_closed(hand: Hand) -> None:
    hand.do(GripperAction.CLOSE)
    seen = [hand.wait(0.02) for _ in range(110)]
    states = paddle_states([OPEN_DOWN, *seen])
    assert [a for a, b in zip(states, [*states[1:], ""], strict=True) if a != b] == [
        "open",
        "between",
        "closed",
    ]


def test_where_there_is_none_it_says_so() -> None:
    nothing = NoGripper()
    nothing.obey(commands.GripperPacRequest(RequestMode.ONCE), 0.0)
    assert list(answers(nothing)) == [reports.GripperState(0, IDLE, 0)]
    assert nothing.obey(commands.Gripper(GripperAction.CLOSE), 0.0)
    assert nothing.inputs(NOTHING, 0.0) == NOTHING
