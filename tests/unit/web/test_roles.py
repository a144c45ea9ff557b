"""What viewers and strangers may do on the page. Virtual time."""

import asyncio

import pytest

from pioneer3.web.access.sessions import Role, SessionKind
from pioneer3.web.client import REVOKED
from pioneer3.web.requests import ONLY_DRIVERS
from tests.support import STAYED
from tests.unit.web.asking import ELSEWHERE, LAN, Script
from tests.unit.web.browser import Browser, Playground, Product, playground, product

POLICY_VIOLATION = 1008
DRIVERS_ONLY = [
    ("drive", {"v": 0.3, "w": 0.0}),
    ("motors", {"on": True}),
    ("reset_emergency_stop", {}),
    ("take_control", {}),
    ("take_over", {}),
    ("hand_over", {"to": 1}),
    ("release_control", {}),
    ("goto", {"x": 1, "y": 0}),
    ("end_mode", {}),
]
EDITS = [
    ("add_box", {"x": 1, "y": 1, "theta": 0, "length": 1, "width": 1}),
    ("move", {"id": 1, "x": 1, "y": 1, "theta": 0}),
    ("remove", {"id": 1}),
    ("stop_button", {"id": 1, "pressed": True}),
    ("cable", {"id": 1, "plugged": False}),
    ("charge", {"id": 1, "charge": 0.1}),
    ("pause", {"paused": True}),
    ("speed", {"speed": 10}),
    ("draw_wall", {"x0": 0, "y0": 0, "x1": 1, "y1": 0}),
    ("save_map", {"name": "lab"}),
]


def arrive(the: Product | Playground, role: Role, name: str = "Vera") -> Browser:
    """Return a paired browser on the network."""
    _, secret = the.page.access.sessions.open(name, role, SessionKind.BROWSER)
    return Browser(the.app, host=LAN, peer=ELSEWHERE, cookie=f"pioneer3-8080={secret}")


async def test_a_stranger_gets_no_socket() -> None:
    async with product() as the, Browser(the.app, host=LAN, peer=ELSEWHERE) as mallory:
        mallory.drive(0.3)
        await asyncio.sleep(1.0)
        assert mallory.closed == POLICY_VIOLATION
        assert mallory.heard == []
        assert the.travelled < STAYED


@pytest.mark.parametrize(
    "cookie",
    ["pioneer3-8080=guess", "pioneer3-8080=", "pioneer3-9999={}", "__Host-pioneer3-8080={}", "{}"],
)
async def test_a_cookie_that_is_not_quite_it_opens_nothing(cookie: str) -> None:
    async with product() as the:
        _, secret = the.page.access.sessions.open("Ann", Role.DRIVER, SessionKind.BROWSER)
        named = cookie.format(secret)
        async with Browser(the.app, host=LAN, peer=ELSEWHERE, cookie=named) as mallory:
            assert mallory.closed == POLICY_VIOLATION


@pytest.mark.parametrize(("request_", "fields"), DRIVERS_ONLY)
async def test_a_viewer_does_not_do_what_drivers_do(
    request_: str, fields: dict[str, object]
) -> None:
    async with product() as the, arrive(the, Role.VIEWER) as vera:
        vera.say(request_, **fields)
        await asyncio.sleep(0.5)
        assert vera.all("refused") == [{"type": "refused", "message": ONLY_DRIVERS}]
        assert the.control.holder is None
        assert the.travelled < STAYED


@pytest.mark.parametrize(("request_", "fields"), EDITS)
async def test_a_viewer_edits_nothing(request_: str, fields: dict[str, object]) -> None:
    async with playground() as the, arrive(the, Role.VIEWER) as vera:
        before = the.simulation.body.robot_in_world
        vera.say(request_, **fields)
        await asyncio.sleep(0.5)
        assert vera.all("edit_refused") == [{"type": "edit_refused", "message": ONLY_DRIVERS}]
        assert the.simulation.body.robot_in_world == before


@pytest.mark.parametrize("request_", ["stop", "emergency_stop"])
async def test_a_viewer_may_stop_the_robot(request_: str) -> None:
    async with (
        product() as the,
        arrive(the, Role.DRIVER) as ann,
        arrive(the, Role.VIEWER) as vera,
    ):
        driving = asyncio.ensure_future(ann.keep_driving(0.3, 3.0))
        await asyncio.sleep(1.5)
        assert the.speed == pytest.approx(0.3, abs=0.01)
        vera.say(request_)
        await asyncio.sleep(0.3)
        assert the.speed == 0.0
        await driving
        assert the.speed == 0.0


async def test_nobody_hands_control_to_a_viewer() -> None:
    async with product() as the, arrive(the, Role.DRIVER) as ann, arrive(the, Role.VIEWER) as vera:
        ann.say("take_control")
        ann.say("hand_over", to=vera.latest("people")["id"])
        await asyncio.sleep(0.2)
        assert "may drive" in ann.latest("refused")["message"]


async def test_revoking_stops_what_they_drive_and_closes_their_page() -> None:
    async with product() as the, arrive(the, Role.DRIVER) as ann:
        driving = asyncio.ensure_future(ann.keep_driving(0.3, 3.0))
        await asyncio.sleep(1.5)
        the.page.access.sessions.revoke(the.page.access.sessions.listed()[0].id)
        await asyncio.sleep(0.3)
        assert the.speed == 0.0
        assert ann.closed == REVOKED
        await driving
        assert the.speed == 0.0
        assert the.page.clients.connected == {}


async def test_a_page_that_is_open_all_day_is_not_idle() -> None:
    async with product() as the, arrive(the, Role.VIEWER) as vera:
        session = the.page.access.sessions.listed()[0]
        await asyncio.sleep(60.0)
        vera.say("ping", t=0)
        await asyncio.sleep(0.1)
        assert session.seen == pytest.approx(asyncio.get_running_loop().time(), abs=0.2)


async def test_everybody_is_told_who_is_here() -> None:
    async with (
        product() as the,
        arrive(the, Role.DRIVER, "Ann") as ann,
        arrive(the, Role.VIEWER) as vera,
    ):
        await asyncio.sleep(0.2)
        told = ann.latest("people")
        assert [(c["name"], c["role"]) for c in told["clients"]] == [
            ("Ann", "driver"),
            ("Vera", "viewer"),
        ]
        assert vera.latest("people")["role"] == "viewer"
        await vera.leave()
        await asyncio.sleep(0.2)
        assert [client["name"] for client in ann.latest("people")["clients"]] == ["Ann"]


async def test_who_asks_in_a_loop_is_refused_but_their_stops_are_not() -> None:
    async with product() as the:
        script = Script(the.app)
        statuses = [(await script.ask("GET", "/api/robots")).status for _ in range(1010)]
        assert statuses[:1000] == [200] * 1000
        assert statuses[-1] == 429
        refused = await script.ask("GET", "/api/robots")
        assert refused.headers["connection"] == "close"
        assert "too many requests" in refused.detail
        assert (await script.ask("POST", "/api/emergency_stop")).status == 204
        assert (await script.ask("POST", "/api/robots/1/stop")).status == 200
        assert the.robot.supervisor.pilot.emergency
        another = Script(the.app, peer="127.0.0.2")
        assert (await another.ask("GET", "/api/robots")).status == 200


async def test_a_stop_does_not_wait_for_others_turns() -> None:
    async with product() as the:
        script = Script(the.app)
        crowd = [asyncio.ensure_future(script.ask("GET", "/api/robots")) for _ in range(50)]
        await asyncio.sleep(0)
        assert (await script.ask("POST", "/api/emergency_stop")).status == 204
        assert not any(one.done() for one in crowd[5:])
        await asyncio.gather(*crowd)


async def test_so_many_pages_at_a_time_come_from_one_address() -> None:
    async with product() as the:
        closed = []
        for _ in range(100):
            async with Browser(the.app) as page:
                pass
            closed.append(page.closed)
        assert closed[:80] == [None] * 80
        assert closed[-1] == POLICY_VIOLATION
