"""Who guesses is slowed down; who makes a mistake is not."""

from pioneer3.web.access.access import GUESSES, GUESSES_IN_ALL, MOST_KEYS, RateLimiter
from tests.unit.web.access.test_invitations import Clock


def test_the_first_attempts_pass_and_the_next_waits_for_a_pause() -> None:
    clock = Clock()
    throttle = RateLimiter(clock)
    assert [throttle.wait("a") for _ in range(GUESSES.burst)] == [0.0] * GUESSES.burst
    assert throttle.wait("a") == GUESSES.pause
    clock.now = GUESSES.pause
    assert throttle.wait("a") == 0.0
    assert throttle.wait("a") > 0


def test_who_is_refused_does_not_wait_longer_for_trying() -> None:
    throttle = RateLimiter(Clock())
    for _ in range(GUESSES.burst + 100):
        throttle.wait("a")
    assert throttle.wait("a") == GUESSES.pause


def test_one_address_does_not_shut_out_another() -> None:
    throttle = RateLimiter(Clock())
    for _ in range(1000):
        throttle.wait("a")
    assert throttle.wait("b") == 0.0


def test_many_addresses_together_are_slowed() -> None:
    clock = Clock()
    throttle = RateLimiter(clock)
    assert all(throttle.wait(str(n)) == 0.0 for n in range(GUESSES_IN_ALL.burst))
    assert throttle.wait("new") == GUESSES_IN_ALL.pause
    clock.now = GUESSES_IN_ALL.pause
    assert throttle.wait("new") == 0.0


def test_addresses_are_forgotten_in_time() -> None:
    clock = Clock()
    throttle = RateLimiter(clock)
    for n in range(MOST_KEYS + 10):
        clock.now = n * GUESSES_IN_ALL.pause
        assert throttle.wait(str(n)) == 0.0
    assert len(throttle._by_key) <= MOST_KEYS
