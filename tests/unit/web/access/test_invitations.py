"""One-time tokens: used, replayed, expired, guessed."""

import pytest

from pioneer3.web.access.invitations import MOST, TERM, Invitations
from pioneer3.web.access.sessions import Role


class Clock:
    """A time that is set."""

    now = 0.0

    def __call__(self) -> float:
        return self.now


@pytest.mark.parametrize("role", list(Role))
def test_a_token_is_good_for_its_role_once(role: Role) -> None:
    invitations = Invitations(Clock())
    token = invitations.invite(role)
    assert invitations.redeem(token) is role
    assert invitations.redeem(token) is None


def test_a_token_expires() -> None:
    clock = Clock()
    invitations = Invitations(clock)
    early, late = invitations.invite(Role.DRIVER), invitations.invite(Role.DRIVER)
    clock.now = TERM - 0.001
    assert invitations.redeem(early) is Role.DRIVER
    clock.now = TERM
    assert invitations.redeem(late) is None


def test_tokens_are_long_and_never_the_same() -> None:
    invitations = Invitations(Clock())
    tokens = {invitations.invite(Role.VIEWER) for _ in range(MOST)}
    assert len(tokens) == MOST
    assert all(len(token) * 6 >= 128 for token in tokens)  # bits


@pytest.mark.parametrize("guess", ["", "a", "a" * 43, "é\ud800", "a" * 10_000])
def test_a_guess_is_refused_and_spoils_nothing(guess: str) -> None:
    invitations = Invitations(Clock())
    token = invitations.invite(Role.DRIVER)
    assert invitations.redeem(guess) is None
    assert invitations.redeem(token[:-1]) is None
    assert invitations.redeem(f"{token} ") is None
    assert invitations.redeem(token) is Role.DRIVER


def test_too_many_invitations_push_out_the_oldest() -> None:
    invitations = Invitations(Clock())
    first, second = invitations.invite(Role.DRIVER), invitations.invite(Role.DRIVER)
    for _ in range(MOST - 1):
        invitations.invite(Role.VIEWER)
    assert invitations.redeem(first) is None
    assert invitations.redeem(second) is Role.DRIVER


def test_what_is_kept_does_not_contain_the_token() -> None:
    invitations = Invitations(Clock())
    token = invitations.invite(Role.DRIVER)
    assert token not in repr(vars(invitations))
