"""Coming in through the API: tokens good, replayed, expired and guessed; cookies. Virtual time."""

import asyncio
from http.cookies import SimpleCookie

import pytest

from pioneer3.web.access import invitations
from pioneer3.web.access.access import GUESSES, device
from pioneer3.web.access.sessions import Role
from tests.unit.web.asking import LAN, Answer, Script, stranger
from tests.unit.web.browser import product

DRIVER, VIEWER = Role.DRIVER, Role.VIEWER


def cookie_in(answer: Answer) -> str:
    """Return what the browser would send from now on."""
    cookie = next(iter(SimpleCookie(answer.headers["set-cookie"]).values()))
    return f"{cookie.key}={cookie.value}"


async def test_a_token_opens_a_session_once() -> None:
    async with product() as the:
        phone = stranger(the.app).with_headers(origin=f"http://{LAN}")
        token = the.page.access.invitations.invite(DRIVER)
        answer = await phone.ask("POST", "/api/pair", {"token": token, "name": "Ann"})
        assert answer.json == {
            "id": "1",
            "name": "Ann",
            "role": "driver",
            "invites": False,
            "urls": [],
        }
        assert token not in answer.body.decode()
        paired = phone.with_headers(cookie=cookie_in(answer))
        assert (await paired.ask("GET", "/api/me")).json["name"] == "Ann"
        again = await phone.ask("POST", "/api/pair", {"token": token})
        assert again.status == 403
        assert "set-cookie" not in again.headers
        assert "it was used" in again.detail


async def test_an_expired_token_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    assert invitations.TERM == 600.0
    monkeypatch.setattr(invitations, "TERM", 5.0)
    async with product() as the:
        token = the.page.access.invitations.invite(DRIVER)
        await asyncio.sleep(5.1)
        answer = await stranger(the.app).ask("POST", "/api/pair", {"token": token})
        assert answer.status == 403
        assert the.page.access.sessions.listed() == []


async def test_guessing_is_slowed_down_and_then_not_even_a_good_token_passes() -> None:
    async with product() as the:
        mallory = stranger(the.app)
        statuses = [
            (await mallory.ask("POST", "/api/pair", {"token": f"guess{n}"})).status
            for n in range(GUESSES.burst + 5)
        ]
        assert statuses == [403] * GUESSES.burst + [429] * 5
        token = the.page.access.invitations.invite(DRIVER)
        assert (await mallory.ask("POST", "/api/pair", {"token": token})).status == 429
        elsewhere = Script(the.app, host=LAN, peer="192.168.0.5")
        assert (await elsewhere.ask("POST", "/api/pair", {"token": token})).status == 200
        await asyncio.sleep(GUESSES.pause + 0.1)
        assert (await mallory.ask("POST", "/api/pair", {"token": "x"})).status == 403


@pytest.mark.parametrize(
    ("offered", "wished", "got"),
    [
        (DRIVER, None, "driver"),
        (DRIVER, "viewer", "viewer"),
        (VIEWER, None, "viewer"),
        (VIEWER, "driver", "viewer"),
    ],
)
async def test_a_role_may_be_less_than_offered_but_not_more(
    offered: Role, wished: str | None, got: str
) -> None:
    async with product() as the:
        token = the.page.access.invitations.invite(offered)
        body = {"token": token, "role": wished}
        assert (await stranger(the.app).ask("POST", "/api/pair", body)).json["role"] == got


@pytest.mark.parametrize(
    ("scheme", "name", "secure"),
    [("http", "pioneer3-8080", False), ("https", "__Host-pioneer3-8080", True)],
)
async def test_the_cookie_is_out_of_reach_of_scripts_and_other_sites(
    scheme: str, name: str, secure: bool
) -> None:
    async with product() as the:
        phone = Script(the.app, host=LAN, peer="192.168.0.5", scheme=scheme)
        token = the.page.access.invitations.invite(DRIVER)
        answer = await phone.ask("POST", "/api/pair", {"token": token})
        morsel = SimpleCookie(answer.headers["set-cookie"])[name]
        assert morsel["httponly"] is True
        assert morsel["samesite"] == "Strict"
        assert bool(morsel["secure"]) is secure
        assert morsel["path"] == "/"
        assert morsel["domain"] == ""
        assert len(morsel.value) * 6 >= 128  # bits


@pytest.mark.parametrize(
    ("agent", "name"),
    [
        ("Mozilla/5.0 (iPhone) Mobile/15E148", "phone"),
        ("Mozilla/5.0 (iPad)", "tablet"),
        ("Mozilla/5.0 (X11; Linux)", "laptop"),
        ("curl/8", "script"),
    ],
)
async def test_who_gives_no_name_is_called_after_the_device(agent: str, name: str) -> None:
    async with product() as the:
        phone = stranger(the.app).with_headers(user_agent=agent)
        for expected in (name, f"{name} 2"):
            token = the.page.access.invitations.invite(VIEWER)
            answer = await phone.ask("POST", "/api/pair", {"token": token})
            assert answer.json["name"] == expected


def test_a_page_tells_that_it_is_on_a_phone_whose_browser_says_that_it_is_a_laptop() -> None:
    assert device("Mozilla/5.0 (X11; Linux)", "phone") == "phone"
    assert device("Mozilla/5.0 (X11; Linux)", "mainframe") == "laptop"


async def test_tokens_for_scripts_end_with_the_session_that_made_them() -> None:
    async with product() as the:
        sessions = the.page.access.sessions
        token = the.page.access.invitations.invite(DRIVER)
        phone = stranger(the.app)
        paired = await phone.ask("POST", "/api/pair", {"token": token})
        ann = phone.with_headers(cookie=cookie_in(paired))
        made = (await ann.ask("POST", "/api/tokens", {"name": "survey"})).json
        script = phone.with_headers(authorization=f"Bearer {made['token']}")
        assert (await script.ask("GET", "/api/me")).json["name"] == "survey"
        assert (await script.ask("POST", "/api/tokens", {})).status == 403
        listed = (await ann.ask("GET", "/api/sessions")).json
        assert [(one["name"], one["kind"]) for one in listed] == [
            ("script", "browser"),
            ("survey", "script"),
        ]
        assert made["token"] not in str(listed)
        assert (await ann.ask("DELETE", "/api/me")).status == 204
        assert (await script.ask("GET", "/api/me")).status == 401
        assert (await ann.ask("GET", "/api/me")).status == 401
        assert sessions.listed() == []


async def test_a_revoked_script_that_drives_stops() -> None:
    async with product() as the:
        here = Script(the.app)
        made = (await here.ask("POST", "/api/tokens", {"name": "survey"})).json
        script = stranger(the.app).with_headers(authorization=f"Bearer {made['token']}")
        body = {"mode": "wander", "seconds": 100}
        assert (await script.ask("PUT", "/api/robots/1/mode", body)).status == 200
        await asyncio.sleep(3.0)
        assert the.speed > 0
        assert (await here.ask("GET", "/api/robots/1/control")).json["holder"] == "survey"
        assert (await here.ask("DELETE", f"/api/sessions/{made['id']}")).status == 204
        await asyncio.sleep(0.5)
        assert the.speed == 0.0
        assert (await script.ask("GET", "/api/me")).status == 401


async def test_drivers_elsewhere_see_and_revoke_only_their_own() -> None:
    async with product() as the:
        sessions = the.page.access.sessions
        made = (await Script(the.app).ask("POST", "/api/tokens", {"name": "a"})).json
        other = (await Script(the.app).ask("POST", "/api/tokens", {"name": "b"})).json
        script = stranger(the.app).with_headers(authorization=f"Bearer {made['token']}")
        assert [one["name"] for one in (await script.ask("GET", "/api/sessions")).json] == ["a"]
        refused = await script.ask("DELETE", f"/api/sessions/{other['id']}")
        assert (refused.status, len(sessions.listed())) == (404, 2)


async def test_only_this_computer_invites_and_only_when_others_can_come() -> None:
    async with product() as the:
        here = Script(the.app)
        assert "--lan" in (await here.ask("POST", "/api/invitations", {})).detail
        the.page.access.urls = ("http://192.168.0.7:8080",)
        made = (await here.ask("POST", "/api/invitations", {"role": "viewer"})).json
        assert made["url"].startswith("http://192.168.0.7:8080/pair#")
        assert made["svg"].startswith("<svg")
        token, _, role = made["url"].partition("#")[2].partition(".")
        assert role == "viewer"  # the page offers no more than the token is good for
        phone = stranger(the.app)
        paired = await phone.ask("POST", "/api/pair", {"token": token})
        assert paired.json["role"] == "viewer"
        ann = phone.with_headers(cookie=cookie_in(paired))
        assert (await ann.ask("POST", "/api/invitations", {})).status == 403


@pytest.mark.parametrize("word", ["Bearer", "Bearer guess", "Basic Og==", "guess", "Bearer  "])
async def test_a_wrong_authorization_is_refused_even_on_this_computer(word: str) -> None:
    async with product() as the:
        answer = await Script(the.app).with_headers(authorization=word).ask("GET", "/api/me")
        assert answer.status == 401
        assert answer.headers["www-authenticate"] == "Bearer"


async def test_no_token_is_in_the_log(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level("DEBUG")
    async with product() as the:
        token = the.page.access.invitations.invite(DRIVER)
        answer = await stranger(the.app).ask("POST", "/api/pair", {"token": token})
        made = (await Script(the.app).ask("POST", "/api/tokens", {})).json
        secrets = [token, cookie_in(answer).partition("=")[2], made["token"]]
    assert all(secret not in caplog.text for secret in secrets)
