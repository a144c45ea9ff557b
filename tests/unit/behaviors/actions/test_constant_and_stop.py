from pioneer3.behaviors.action import Desire
from pioneer3.behaviors.actions import ConstantVelocity, Stop
from tests.unit.behaviors.support import seen


def test_a_constant_velocity_is_wanted_straight_ahead() -> None:
    assert ConstantVelocity().decide(seen()) == Desire(v=0.4, turn=0.0, reason="onwards")
    assert ConstantVelocity(-0.15).decide(seen()).v == -0.15


def test_stop_leaves_nothing_to_others() -> None:
    desire = Stop().decide(seen())
    assert (desire.v, desire.turn) == (0.0, 0.0)
