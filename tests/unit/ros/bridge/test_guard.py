"""Velocity commands over a bridge: the end of each."""

from math import inf, nan
from types import SimpleNamespace
from typing import Any

import pytest

from pioneer3.ros.bridge.guard import ZERO, CommandGuard, is_finite, moves

TIMEOUT = 0.5


def twist(v: float = 0.0, w: float = 0.0) -> Any:
    zeros = {"y": 0.0}
    return SimpleNamespace(
        linear=SimpleNamespace(x=v, z=0.0, **zeros), angular=SimpleNamespace(x=0.0, z=w, **zeros)
    )


AHEAD, BACK, STAND = twist(0.3), twist(-0.3), twist()


def sent(guard: CommandGuard, message: Any, now: float, sender: str = "keys") -> list[Any]:
    assert guard.take(message, sender, f"/{sender}", now) is None
    return list(guard.due(now))


def stream(guard: CommandGuard, until: float) -> None:
    for number in range(round(until / 0.1)):
        assert sent(guard, AHEAD, number * 0.1) == [AHEAD]


def test_a_command_is_passed_on_at_once_and_a_zero_when_it_has_expired() -> None:
    guard = CommandGuard(TIMEOUT)
    assert sent(guard, AHEAD, 1.0) == [AHEAD]
    assert guard.deadline == 1.0 + TIMEOUT
    assert list(guard.due(1.4)) == []
    assert list(guard.due(1.5)) == [ZERO]
    assert guard.deadline == inf
    assert list(guard.due(9.0)) == []


def test_a_zero_needs_no_other() -> None:
    guard = CommandGuard(TIMEOUT)
    sent(guard, AHEAD, 1.0)
    assert sent(guard, STAND, 1.1) == [STAND]
    assert guard.deadline == inf
    assert guard.left("keys") is None
    assert guard.end() is None


def test_who_leaves_while_it_drives_is_followed_by_a_zero() -> None:
    guard = CommandGuard(inf)
    sent(guard, AHEAD, 1.0)
    assert guard.deadline == inf
    assert guard.left("other") is None
    assert guard.left("keys") is ZERO
    assert guard.left("keys") is None


def test_a_bridge_that_ends_stops_who_is_driven() -> None:
    guard = CommandGuard(inf)
    assert guard.end() is None
    sent(guard, AHEAD, 1.0)
    assert guard.end() is ZERO
    assert guard.end() is None


def test_the_last_of_two_drives() -> None:
    guard = CommandGuard(TIMEOUT)
    sent(guard, AHEAD, 1.0, "one")
    sent(guard, BACK, 1.1, "two")
    assert guard.left("one") is None
    assert guard.left("two") is ZERO


def test_a_stream_that_was_cut_off_goes_on_when_it_has_come_steadily() -> None:
    guard = CommandGuard(TIMEOUT)
    stream(guard, 1.0)
    assert list(guard.due(1.5)) == [ZERO]
    passed = [sent(guard, AHEAD, 4.0 + number * 0.11) for number in range(5)]
    assert passed == [[], [], [], [AHEAD], [AHEAD]]


def test_a_stream_that_was_cut_off_goes_on_only_after_a_zero_by_the_strict_rule() -> None:
    guard = CommandGuard(TIMEOUT, resumes=False)
    stream(guard, 1.0)
    assert list(guard.due(1.5)) == [ZERO]
    assert guard.take(AHEAD, "keys", "/keys", 4.0) is None
    assert list(guard.due(4.0)) == []  # perhaps a new press
    assert "fell silent" in str(guard.take(AHEAD, "keys", "/keys", 4.1))
    assert list(guard.due(4.3)) == []
    assert sent(guard, STAND, 4.4) == [STAND]
    assert sent(guard, AHEAD, 4.5) == [AHEAD]


def test_a_press_after_a_stream_counts_a_moment_later() -> None:
    guard = CommandGuard(TIMEOUT)
    stream(guard, 1.0)
    assert list(guard.due(1.5)) == [ZERO]
    assert guard.take(AHEAD, "keys", "/keys", 4.0) is None
    assert list(guard.due(guard.deadline)) == [AHEAD]
    assert guard.left("keys") is ZERO


def test_a_press_that_waits_is_dropped_when_its_sender_leaves() -> None:
    guard = CommandGuard(TIMEOUT)
    stream(guard, 1.0)
    list(guard.due(1.5))
    guard.take(AHEAD, "keys", "/keys", 4.0)
    assert guard.left("keys") is None
    assert list(guard.due(9.0)) == []


@pytest.mark.parametrize("lasting", [TIMEOUT, inf])
def test_who_left_while_it_drove_and_is_back_needs_a_zero(lasting: float) -> None:
    guard = CommandGuard(lasting)
    stream(guard, 1.0)
    list(guard.due(1.5))
    guard.left("keys")
    for now in (2.0, 15.0, 15.1):
        assert "left while it drove" in str(guard.take(AHEAD, "keys", "/keys", now))
        assert list(guard.due(now)) == []
    assert sent(guard, AHEAD, 15.2, "other") == [AHEAD]
    assert sent(guard, STAND, 15.3) == [STAND]
    assert sent(guard, AHEAD, 15.4) == [AHEAD]


@pytest.mark.parametrize("number", [nan, inf, -inf])
def test_what_is_not_finite_is_seen_wherever_it_is(number: float) -> None:
    assert is_finite(AHEAD)
    assert not is_finite(twist(w=number))
    sideways = twist()
    sideways.linear.y = number
    assert not is_finite(SimpleNamespace(twist=sideways))


def test_every_component_is_a_motion() -> None:
    sideways = twist()
    sideways.linear.y = 0.1
    assert moves(sideways)
    assert not moves(SimpleNamespace(twist=STAND))


def test_many_senders_are_forgotten_oldest_first() -> None:
    guard = CommandGuard(TIMEOUT)
    for number in range(200):
        assert sent(guard, AHEAD, number * 0.01, str(number)) == [AHEAD]
    assert guard.left("199") is ZERO
