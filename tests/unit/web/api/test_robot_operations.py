"""The API for scripts: what it does with the robot. Virtual time."""

import asyncio
import json
from math import pi

import pytest

from pioneer3.behaviors.modes import MODES
from pioneer3.geometry import Pose2
from pioneer3.tasks import running
from pioneer3.web.access.sessions import Role, SessionKind
from pioneer3.web.api.operation import openapi
from pioneer3.web.api.routes import LONGEST_BODY, OPERATIONS
from pioneer3.web.control import KEPT
from pioneer3.web.scene import RobotScene
from tests.support import STAYED
from tests.unit.web.asking import Script, stranger
from tests.unit.web.browser import Browser, Product, product

ROBOT = "/api/robots/1"
PATHS = [
    (one.method, one.path.replace("{robot}", "1").replace("{session}", "1"), one.needs)
    for one in OPERATIONS
]


def script_of(the: Product, role: Role) -> Script:
    """Return a script on the network with a token."""
    _, token = the.page.access.sessions.open("survey", role, SessionKind.SCRIPT)
    return stranger(the.app).with_headers(authorization=f"Bearer {token}")


async def test_scripts_are_told_of_a_robot_as_pages_are() -> None:
    async with product() as the, Browser(the.app) as ann:
        await ann.stay(0.5)
        script = Script(the.app)
        (robot,) = (await script.ask("GET", "/api/robots")).json
        assert robot == ann.latest("hello")["robots"][0]
        assert (robot["id"], robot["shape"]["model"]) == (1, "p3at-sh")
        assert robot["limits"]["speed"] == the.robot.info.limits.max_speed
        assert (await script.ask("GET", f"{ROBOT}/status")).json == ann.latest("status")
        assert (await script.ask("GET", f"{ROBOT}/snapshot")).json == ann.snapshot


async def test_the_poses_of_a_snapshot_say_their_frames() -> None:
    async with product(RobotScene(odom_in_map=Pose2(5.0, 1.0, pi / 2))) as the:
        snapshot = (await Script(the.app).ask("GET", f"{ROBOT}/snapshot")).json
        assert snapshot["robot_in_odom"] == {"x": 0.0, "y": 0.0, "theta": 0.0}
        assert snapshot["robot_in_map"] == {"x": 5.0, "y": 1.0, "theta": pi / 2}


def test_the_document_gives_each_name_to_one_type() -> None:
    schemas = json.loads(openapi(OPERATIONS))["components"]["schemas"]
    assert [name for name in schemas if "." in name] == []  # msgspec tells namesakes apart so


async def test_a_snapshot_says_what_the_robot_says() -> None:
    async with product() as the:
        snapshot = (await Script(the.app).ask("GET", f"{ROBOT}/snapshot")).json
        assert the.robot.snapshot is not None
        assert snapshot["sequence"] == the.robot.snapshot.sequence
        assert snapshot["battery"]["voltage"] == the.robot.snapshot.battery.voltage
        assert snapshot["why"] == str(the.robot.why_not_moving())
        assert len(snapshot["sonar"]["ranges"]) == 16


async def test_a_velocity_drives_for_half_a_second() -> None:
    async with product() as the:
        script = Script(the.app)
        for _ in range(20):
            answer = await script.ask("POST", f"{ROBOT}/drive", {"v": 0.3})
            assert answer.status == 200
            await asyncio.sleep(0.1)
        assert the.speed == pytest.approx(0.3, abs=0.01)
        assert answer.json == {"why": None}
        await asyncio.sleep(0.9)
        assert the.speed == 0.0


async def test_wheels_drive_for_half_a_second() -> None:
    async with product() as the:
        script = Script(the.app)
        for _ in range(20):
            wheels = {"left": 0.1, "right": 0.3}
            assert (await script.ask("POST", f"{ROBOT}/drive_wheels", wheels)).status == 200
            await asyncio.sleep(0.1)
        assert the.robot.snapshot is not None
        moving = the.robot.snapshot.odometry
        assert (moving.left_speed, moving.right_speed) == pytest.approx((0.1, 0.3), abs=0.02)
        await asyncio.sleep(0.9)
        assert the.speed == 0.0


async def test_zero_lets_go() -> None:
    async with product() as the:
        script = Script(the.app)
        for v in (0.3, 0.3, 0.0):
            await asyncio.sleep(0.4)
            await script.ask("POST", f"{ROBOT}/drive", {"v": v})
        await asyncio.sleep(0.3)
        assert the.speed == 0.0


@pytest.mark.parametrize("call", ["drive", "goto", "mode"])
async def test_nothing_drives_while_somebody_else_has_control(call: str) -> None:
    body = {
        "drive": {"v": 0.3},
        "goto": {"x": 1, "y": 0},
        "mode": {"mode": "wander"},
    }[call]
    method = "PUT" if call == "mode" else "POST"
    async with product() as the, Browser(the.app, user_agent="Mozilla") as ann:
        ann.say("take_control")
        await asyncio.sleep(0.1)
        script = Script(the.app)
        answer = await script.ask(method, f"{ROBOT}/{call}", body)
        assert (answer.status, answer.detail) == (409, "laptop has control")
        assert (await script.ask("PUT", f"{ROBOT}/control", {})).status == 409
        assert (await script.ask("DELETE", f"{ROBOT}/control")).status == 204  # not theirs: nothing
        assert (await script.ask("GET", f"{ROBOT}/control")).json == {
            "holder": "laptop",
            "yours": False,
        }
        await asyncio.sleep(1.0)
        assert the.travelled < STAYED


async def test_control_is_taken_over_openly() -> None:
    async with product() as the, Browser(the.app) as ann:
        await ann.keep_driving(0.3, 1.5)
        script = script_of(the, Role.DRIVER)
        taken = await script.ask("PUT", f"{ROBOT}/control", {"take_over": True})
        assert taken.json == {"holder": "survey", "yours": True}
        await asyncio.sleep(0.1)
        assert ann.latest("told")["message"] == "survey took over; you watch now"
        assert ann.latest("people")["control"] == [{"robot": 1, "id": None, "name": "survey"}]
        early = await script.ask("POST", f"{ROBOT}/drive", {"v": 0.3})
        assert (early.status, early.detail) == (409, "the robot is still stopping")
        assert (await script.ask("DELETE", f"{ROBOT}/control")).status == 204
        assert the.control.holder is None


async def test_it_goes_to_a_point_and_says_how_that_ended() -> None:
    async with product() as the:
        script = Script(the.app)
        begun = await script.ask("POST", f"{ROBOT}/goto", {"x": 1.0, "y": 0.0})
        assert begun.json["mode"] == "goto"
        await asyncio.sleep(20.0)
        ended = (await script.ask("GET", f"{ROBOT}/mode")).json
        how = {"mode": "goto", "done": True, "why": "done", "place": ""}
        assert ended == {"mode": None, "decided": [], "ended": how}
        assert the.sim.body.robot_in_world.x == pytest.approx(1.0, abs=0.3)


async def test_it_turns() -> None:
    async with product() as the:
        body = {"mode": "turn", "angle": pi / 2}
        assert (await Script(the.app).ask("PUT", f"{ROBOT}/mode", body)).status == 200
        await asyncio.sleep(10.0)
        assert the.sim.body.robot_in_world.theta == pytest.approx(pi / 2, abs=0.05)


async def test_a_mode_ends_when_asked_and_after_its_time() -> None:
    async with product() as the:
        script = Script(the.app)
        body = {"mode": "wander", "seconds": 2 * KEPT}  # scripts need not be heard of
        await script.ask("PUT", f"{ROBOT}/mode", body)
        assert (await script.ask("DELETE", f"{ROBOT}/mode")).json["mode"] is None
        await script.ask("PUT", f"{ROBOT}/mode", body)
        await asyncio.sleep(2 * KEPT - 0.5)
        assert the.speed > 0.1
        await asyncio.sleep(1.0)
        ended = (await script.ask("GET", f"{ROBOT}/mode")).json
        assert ended["ended"]["why"] == "its time was over"
        assert the.speed == 0.0


async def test_a_stop_ends_what_another_script_of_this_computer_drives() -> None:
    async with product() as the:
        driver, other = Script(the.app), Script(the.app)

        async def drive() -> None:
            while True:
                await driver.ask("POST", f"{ROBOT}/drive", {"v": 0.3, "w": 0.0})
                await asyncio.sleep(0.1)

        async with running(drive()):
            await asyncio.sleep(1.5)
            assert the.speed == pytest.approx(0.3, abs=0.01)
            assert (await other.ask("POST", f"{ROBOT}/stop")).status == 200
            await asyncio.sleep(1.5)
            assert the.speed == 0.0


async def test_the_emergency_stop_latches_and_its_reason_is_told() -> None:
    async with product() as the:
        script = Script(the.app)
        assert (await script.ask("POST", f"{ROBOT}/emergency_stop")).status == 200
        refused = await script.ask("POST", f"{ROBOT}/drive", {"v": 0.3})
        assert (refused.status, refused.detail) == (409, "the emergency stop is latched")
        switched = await script.ask("PUT", f"{ROBOT}/motors", {"on": True})
        assert switched.status == 409
        await asyncio.sleep(1.0)
        assert (await script.ask("POST", f"{ROBOT}/reset")).status == 200
        assert not the.sim.powered
        assert (await script.ask("PUT", f"{ROBOT}/motors", {"on": True})).status == 200
        await asyncio.sleep(1.0)
        assert the.sim.powered


async def test_a_lost_robot_is_a_conflict_in_words() -> None:
    async with product() as the:
        await the.sim.unplug()
        await asyncio.sleep(5.0)
        script = Script(the.app)
        for method, path, body in (
            ("GET", "snapshot", None),
            ("POST", "drive", {"v": 0.3}),
            ("POST", "goto", {"x": 1, "y": 0}),
        ):
            answer = await script.ask(method, f"{ROBOT}/{path}", body)
            assert answer.status == 409
            assert "connected" in answer.detail or "link was lost" in answer.detail


@pytest.mark.parametrize(("method", "path", "needs"), PATHS)
async def test_strangers_and_viewers_get_no_further_than_they_may(
    method: str, path: str, needs: Role | None
) -> None:
    async with product() as the:
        outside = await stranger(the.app).ask(method, path, {})
        viewer = await script_of(the, Role.VIEWER).ask(method, path, {})
        if needs is not None:
            assert outside.status == 401
            assert "pair" in outside.detail
        drives = needs in {Role.DRIVER, Role.STUDENT}
        assert (viewer.status == 403 and "viewer" in viewer.detail) is drives
        await asyncio.sleep(0.5)
        assert the.travelled < STAYED


@pytest.mark.parametrize(("method", "path", "needs"), PATHS)
async def test_a_foreign_page_gets_nowhere(method: str, path: str, needs: Role | None) -> None:
    async with product() as the:
        for origin in ("http://evil.example", "http://localhost:3000", "null"):
            page = Script(the.app).with_headers(origin=origin)
            assert (await page.ask(method, path, {})).status == 403
        rebound = Script(the.app, host="evil.example:8080").with_headers(
            origin="http://evil.example:8080"
        )
        assert (await rebound.ask(method, path, {})).status == 421


@pytest.mark.parametrize(
    ("raw", "kind", "status"),
    [
        (b"{", "application/json", 400),
        (b"\xff", "application/json", 400),
        (b"[]", "application/json", 400),
        (b'{"v": NaN}', "application/json", 400),
        (b'{"v": 1e999}', "application/json", 400),
        (b'{"v": "1"}', "application/json", 400),
        (b'{"v": 1, "fast": true}', "application/json", 400),
        (b"", "application/json", 400),
        (b"v=1", "application/x-www-form-urlencoded", 415),
        (b'{"v": 1}', "text/plain", 415),
        (b" " * (LONGEST_BODY + 1), "application/json", 413),
    ],
)
async def test_what_is_no_velocity_is_refused_in_words(raw: bytes, kind: str, status: int) -> None:
    async with product() as the:
        script = Script(the.app).with_headers(content_type=kind)
        answer = await script.ask("POST", f"{ROBOT}/drive", raw=raw)
        assert answer.status == status
        assert answer.detail
        assert the.control.holder is None


@pytest.mark.parametrize("number", ["2", "0", "-1", "01", "x", "1.0"])
async def test_there_is_one_robot(number: str) -> None:
    async with product() as the:
        answer = await Script(the.app).ask("POST", f"/api/robots/{number}/stop")
        assert answer.status == 404
        assert "no robot" in answer.detail


async def test_an_error_of_ours_is_a_problem_with_the_usual_headers(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    async with product() as the:
        monkeypatch.setattr(the.robot, "why_not_moving", lambda: 1 / 0)
        answer = await Script(the.app).ask("POST", f"{ROBOT}/stop")
        assert answer.status == 500
        assert "log" in answer.detail
        assert "default-src 'self'" in answer.headers["content-security-policy"]


def test_the_document_names_every_operation_once() -> None:
    document = json.loads(openapi(OPERATIONS))
    names = [one["operationId"] for path in document["paths"].values() for one in path.values()]
    assert sorted(names) == sorted({one.name for one in OPERATIONS})
    assert all(one["summary"] for path in document["paths"].values() for one in path.values())
    assert "ErrorResponse" in document["components"]["schemas"]


async def test_every_mode_has_a_form() -> None:
    async with product() as the:
        forms = {one["name"]: one for one in (await Script(the.app).ask("GET", "/api/modes")).json}
    assert list(forms) == [mode.name() for mode in MODES]
    x, _, heading, _ = forms["goto"]["fields"]
    assert (x["unit"], x["scale"], x["required"], x["low"]) == ("m", 1.0, True, -10_000.0)
    assert (heading["unit"], heading["default"]) == ("deg", None)
    assert heading["scale"] == pytest.approx(pi / 180)
    preset, speed = forms["wander"]["fields"]
    assert [one["name"] for one in preset["choices"]] == ["lab", "aria", "explore"]
    assert (preset["default"], speed["low"], speed["high"]) == ("lab", 0.0, 10.0)
