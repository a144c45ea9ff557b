"""Sessions: found by their secret, named, ended."""

import pytest

from pioneer3.names import NAME, clean_name
from pioneer3.web.access.sessions import IDLE, MOST, LoginSession, LoginSessions, Role, SessionKind
from tests.unit.web.access.test_invitations import Clock

DRIVER, VIEWER = Role.DRIVER, Role.VIEWER


def test_a_session_is_found_by_its_secret_only() -> None:
    sessions = LoginSessions(Clock())
    ann, secret = sessions.open("Ann", DRIVER, SessionKind.BROWSER)
    assert sessions.find(secret) is ann
    assert sessions.find(ann.id) is None
    assert sessions.find("") is None
    assert sessions.find(secret[:-1]) is None


def test_revoking_ends_it_and_what_it_made_and_says_so() -> None:
    sessions = LoginSessions(Clock())
    ended: list[LoginSession] = []
    sessions.on_end = ended.append
    ann, secret = sessions.open("Ann", DRIVER, SessionKind.BROWSER)
    script, token = sessions.open("script", DRIVER, SessionKind.SCRIPT, parent=ann.id)
    bob, other = sessions.open("Bob", VIEWER, SessionKind.BROWSER)
    assert sessions.revoke(ann.id)
    assert ended == [ann, script]
    assert ann.ended.is_set()
    assert sessions.find(secret) is sessions.find(token) is None
    assert sessions.find(other) is bob
    assert not sessions.revoke(ann.id)
    assert not sessions.revoke("")


def test_a_session_that_nobody_uses_ends() -> None:
    clock = Clock()
    sessions = LoginSessions(clock)
    ann, secret = sessions.open("Ann", DRIVER, SessionKind.BROWSER)
    clock.now = IDLE - 1
    assert sessions.find(secret) is ann
    clock.now += IDLE - 1
    assert sessions.listed() == [ann]
    clock.now += 1
    assert sessions.listed() == []
    assert ann.ended.is_set()


def test_names_are_unique() -> None:
    sessions = LoginSessions(Clock())
    names = [sessions.open("phone", VIEWER, SessionKind.BROWSER, others=["phone 2"])[0].name]
    names += [sessions.open("phone", VIEWER, SessionKind.BROWSER, others=["phone 2"])[0].name]
    assert names == ["phone", "phone 3"]
    assert sessions.open("", VIEWER, SessionKind.SCRIPT)[0].name == "script"


@pytest.mark.parametrize(
    ("given", "clean"),
    [
        ("  Ann \n of  Green ", "Ann of Green"),
        ("a\u202eb\x00c\u200b", "a b c"),
        ("x" * 100, "x" * NAME),
        ("\t", ""),
    ],
)
def test_names_are_short_and_printable(given: str, clean: str) -> None:
    assert clean_name(given) == clean


def test_there_is_an_end_to_it() -> None:
    sessions = LoginSessions(Clock())
    for _ in range(MOST):
        sessions.open("a", VIEWER, SessionKind.BROWSER)
    with pytest.raises(OverflowError, match="revoke"):
        sessions.make_room()
    with pytest.raises(OverflowError, match="revoke"):
        sessions.open("a", VIEWER, SessionKind.BROWSER)


def test_drivers_may_do_what_viewers_may() -> None:
    assert DRIVER.covers(VIEWER)
    assert DRIVER.covers(DRIVER)
    assert VIEWER.covers(VIEWER)
    assert not VIEWER.covers(DRIVER)
