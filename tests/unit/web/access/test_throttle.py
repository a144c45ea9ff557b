"""Who guesses is slowed down; who makes a mistake is not."""

from pioneer3.web.access.throttle import (
    IN_ALL,
    MOST_ADDRESSES,
    PAUSE_IN_ALL,
    PAUSE_PER_ADDRESS,
    PER_ADDRESS,
    Throttle,
)
from tests.unit.web.access.test_invitations import Clock


def test_the_first_attempts_pass_and_the_next_waits_for_a_pause() -> None:
    clock = Clock()
    throttle = Throttle(clock)
    assert [throttle.wait("a") for _ in range(PER_ADDRESS)] == [0.0] * PER_ADDRESS
    assert throttle.wait("a") == PAUSE_PER_ADDRESS
    clock.now = PAUSE_PER_ADDRESS
    assert throttle.wait("a") == 0.0
    assert throttle.wait("a") > 0


def test_who_is_refused_does_not_wait_longer_for_trying() -> None:
    throttle = Throttle(Clock())
    for _ in range(PER_ADDRESS + 100):
        throttle.wait("a")
    assert throttle.wait("a") == PAUSE_PER_ADDRESS


def test_one_address_does_not_shut_out_another() -> None:
    throttle = Throttle(Clock())
    for _ in range(1000):
        throttle.wait("a")
    assert throttle.wait("b") == 0.0


def test_many_addresses_together_are_slowed() -> None:
    clock = Clock()
    throttle = Throttle(clock)
    assert all(throttle.wait(str(n)) == 0.0 for n in range(IN_ALL))
    assert throttle.wait("new") == PAUSE_IN_ALL
    clock.now = PAUSE_IN_ALL
    assert throttle.wait("new") == 0.0


def test_addresses_are_forgotten_in_time() -> None:
    clock = Clock()
    throttle = Throttle(clock)
    for n in range(MOST_ADDRESSES + 10):
        clock.now = n * PAUSE_IN_ALL
        assert throttle.wait(str(n)) == 0.0
    assert len(throttle._by_address) <= MOST_ADDRESSES
