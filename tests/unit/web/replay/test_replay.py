"""A page of logs: everything is shown as if it were live, and nothing can be driven."""

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from functools import partial
from pathlib import Path
from typing import get_args

import pytest
from starlette.types import ASGIApp

from pioneer3.log.index import LogIndex
from pioneer3.tasks import running
from pioneer3.web import requests
from pioneer3.web.access.sessions import Role, SessionKind
from pioneer3.web.app import make_app
from pioneer3.web.page import Page
from pioneer3.web.replay.replay import LogPlayer
from tests.unit.analysis.support import write_parts
from tests.unit.web.asking import ELSEWHERE, LAN, Script
from tests.unit.web.browser import Browser
from tests.unit.web.replay.logs import BEGAN, SECOND, SPEED, drive
from tests.unit.web.replay.test_recorded import HALL

pytestmark = pytest.mark.realtime

PATIENCE = 20.0
START = BEGAN / SECOND
POINT: dict[str, object] = {"x": 1.0, "y": 1.0}
LINE: dict[str, object] = {"x0": 0, "y0": 0, "x1": 1, "y1": 1}
DRIVES: dict[str, dict[str, object]] = {
    "drive": {"v": 0.3, "w": 0.0},
    "stop": {},
    "emergency_stop": {},
    "reset_emergency_stop": {},
    "motors": {"on": True},
    "take_control": {},
    "take_over": {},
    "hand_over": {"to": 1},
    "release_control": {},
    "start_mode": {"mode": {"mode": "wander"}},
    "start_group_mode": {"robots": [1, 2], "mode": {"mode": "spread"}},
    "goto": POINT,
    "make_map": {"step": "begin"},
    "calibrate": {"step": "begin"},
    "end_mode": {},
    "patrol": {"places": [POINT, POINT]},
    "look_around": {},
    "place_robot": POINT,
    "plan_way": POINT,
    "add_box": {**POINT, "theta": 0, "length": 1, "width": 1},
    "add_person": {"path": [[0, 0]]},
    "add_robot": {"model": "p3dx", **POINT, "theta": 0},
    "move": {"id": 1, **POINT, "theta": 0},
    "remove": {"id": 1},
    "stop_button": {"id": 1, "pressed": True},
    "cable": {"id": 1, "plugged": False},
    "charge": {"id": 1, "charge": 0.1},
    "pause": {"paused": True},
    "step": {"seconds": 0.1},
    "speed": {"speed": 10},
    "erase_walls": LINE,
    "draw_wall": LINE,
    "forbid": {**LINE, "shape": "line"},
    "name_place": {"role": "goal", "name": "here", **POINT},
    "rename_object": {"number": 0, "version": 0, "name": "x"},
    "remove_object": {"number": 0, "version": 0},
    "undo_map_edit": {},
    "discard_map_edits": {},
    "save_map": {"name": "lab"},
    "pause_robots": {"paused": True},
    "put_back": {},
    "free_seat": {"robot": 1},
    "lock_joining": {"locked": True},
    "share_addresses": {"shared": True},
    "record_run": {"step": "begin"},
}
"""One of each request that is not about the replay itself."""


@asynccontextmanager
async def replayed(*paths: Path) -> AsyncIterator[tuple[ASGIApp, Page]]:
    """Serve the replay of logs."""
    async with played(*map(LogIndex, paths)) as served:
        yield served


@asynccontextmanager
async def played(*logs: LogIndex) -> AsyncIterator[tuple[ASGIApp, Page]]:
    """Serve the replay of logs that are open."""
    page = Page()
    replay = LogPlayer(logs, page.audiences)
    async with page.replaying(replay), running(page.run()):
        yield make_app(page), page


async def until(condition: Callable[[], object]) -> None:
    """Wait for the thread that reads."""
    async with asyncio.timeout(PATIENCE):
        while not condition():  # noqa: ASYNC110 - a thread sets no event
            await asyncio.sleep(0.01)


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """Return the log of a drive on a map."""
    return drive(tmp_path / "drive.mcap", line_map=HALL)


async def test_a_page_is_shown_the_begin_paused_and_labelled(path: Path) -> None:
    async with replayed(path) as (app, _), Browser(app) as ann:
        await until(lambda: ann.all("robots") and ann.all("replay_marks"))
        (robot,) = ann.latest("hello")["robots"]
        assert (robot["kind"], robot["name"], robot["laser"]) == ("REPLAY", "drive", True)
        state = ann.latest("replay")
        assert (state["began"], state["at"], state["playing"]) == (START, START, False)
        assert ann.latest("map")["map"]["name"] == "hall"
        assert ann.snapshot["robot_in_map"]["x"] == 10.0
        await until(lambda: ann.latest("replay")["looked"] == 1.0)
        await until(lambda: len(ann.latest("replay_marks")["marks"]) == 9)


async def test_a_file_that_has_gone_is_a_mark(tmp_path: Path) -> None:
    log = LogIndex(*write_parts(tmp_path, seconds=6.0, gone=25))
    async with played(log) as (app, _), Browser(app) as ann:
        await until(lambda: ann.all("replay_marks") and ann.latest("replay_marks")["marks"])
        (mark,) = ann.latest("replay_marks")["marks"]
        assert mark["text"] == "For 3 s nothing is known: a file of the log has gone"


async def test_it_plays_until_the_end_and_from_there_anew(path: Path) -> None:
    async with replayed(path) as (app, _), Browser(app) as ann:
        ann.say("play", playing=True, speed=32.0)
        await until(lambda: ann.all("replay") and ann.latest("replay")["at"] > START + 19.8)
        await until(lambda: not ann.latest("replay")["playing"])
        moved = [each["robot_in_map"]["x"] for each in ann.snapshots()]
        assert moved == sorted(moved)
        assert len(set(moved)) > 2  # there and on the way, on a busy computer too
        jumps = ann.latest("replay")["jumps"]
        ann.say("play", playing=True)
        await until(lambda: ann.latest("replay")["jumps"] > jumps)
        assert ann.latest("replay")["at"] < START + 19.0


async def test_anybody_goes_to_any_time_and_back(path: Path) -> None:
    async with replayed(path) as (app, _), Browser(app) as ann, Browser(app) as bob:
        for second in (12.5, 3.0, 17.0):
            ann.say("play", at=START + second)
            await until(partial(is_at, bob, second))
            assert bob.snapshot["emergency_stop"] == (second == 12.5)
        ann.say("play", at=START + 99.0)
        await until(lambda: bob.latest("replay")["at"] == bob.latest("replay")["ended"])


async def test_while_it_is_paused_the_robot_seems_there_and_its_laser_too(path: Path) -> None:
    async with replayed(path) as (app, _), Browser(app) as ann:
        ann.say("watch_lasers", on=True)
        ann.say("watch_details", on=True)
        ann.say("play", at=START + 5.6)
        await until(lambda: ann.all("scans") and ann.all("details"))
        seen = len(ann.snapshots())
        await until(lambda: len(ann.snapshots()) > seen + 2)
        assert len({each["sequence"] for each in ann.snapshots()[seen:]}) == 1
        assert ann.latest("details")["wheels"]["left"] == SPEED


def test_every_request_is_either_about_the_replay_or_refused() -> None:
    tags = {kind.__struct_config__.tag for kind in get_args(requests.AnyRequest)}
    allowed = {kind.__struct_config__.tag for kind in requests.FOR_REPLAYS}
    assert tags == allowed | DRIVES.keys()


async def test_whatever_drives_is_refused_by_one_sentence(path: Path) -> None:
    async with replayed(path) as (app, _), Browser(app) as ann:
        await until(lambda: ann.all("hello"))
        for kind, fields in DRIVES.items():
            told = len(refusals(ann))
            ann.say(kind, **fields)
            await until(partial(is_refused, ann, told))
        assert set(refusals(ann)) == {requests.REPLAYED}


def refusals(browser: Browser) -> list[str]:
    """Return all refusals so far."""
    return [each["message"] for each in browser.all("refused") + browser.all("edit_refused")]


def is_refused(browser: Browser, told: int) -> bool:
    """Whether there are more refusals than before."""
    return len(refusals(browser)) > told


def is_at(browser: Browser, second: float) -> bool:
    """Whether the robot is shown where it was then."""
    seen = browser.snapshots()
    x = 10.0 + SPEED * second
    return bool(seen) and abs(seen[-1]["robot_in_map"]["x"] - x) < 0.03


async def test_so_it_is_for_scripts(path: Path) -> None:
    async with replayed(path) as (app, _):
        script = Script(app)
        for method, what in (
            ("POST", "emergency_stop"),
            ("POST", "robots/1/drive"),
            ("PUT", "robots/1/control"),
            ("PUT", "robots/1/mode"),
            ("GET", "robots/1/snapshot"),
        ):
            answer = await script.ask(method, f"/api/{what}", {} if method != "GET" else None)
            assert (answer.status, answer.detail) == (409, requests.REPLAYED)
        assert (await script.ask("GET", "/api/me")).status == 200


async def test_viewers_look_on(path: Path) -> None:
    async with replayed(path) as (app, page):
        _, secret = page.access.sessions.open("Vera", Role.VIEWER, SessionKind.BROWSER)
        cookie = f"pioneer3-8080={secret}"
        async with Browser(app, host=LAN, peer=ELSEWHERE, cookie=cookie) as vera:
            vera.say("play", playing=True)
            await until(lambda: vera.all("refused"))
            assert vera.latest("refused")["message"] == requests.ONLY_DRIVERS
            await until(vera.snapshots)


async def test_logs_of_several_robots_go_by_one_clock(tmp_path: Path) -> None:
    early = drive(tmp_path / "early.mcap")
    late = drive(tmp_path / "late.mcap", begin=15)
    async with replayed(early, late) as (app, _), Browser(app) as ann:
        await until(lambda: ann.all("status"))
        assert [each["name"] for each in ann.latest("hello")["robots"]] == ["early", "late"]
        assert ann.latest("replay")["ended"] == pytest.approx(START + 34.9)
        ann.say("play", at=START + 17.0)
        await until(lambda: ann.snapshots(2))
        assert ann.snapshots(1)[-1]["robot_in_map"]["x"] == pytest.approx(SPEED * 17.0)
        assert ann.snapshots(2)[-1]["robot_in_map"]["x"] == pytest.approx(SPEED * 2.0)
        ann.say("play", at=START + 30.0)
        await until(lambda: ann.latest("replay")["jumps"] == 3)
        told = {each["robot"]: each["state"] for each in ann.all("status")}
        assert told == {1: "lost", 2: "connected"}


async def test_only_a_replay_can_be_played() -> None:
    page = Page()
    async with running(page.run()), Browser(make_app(page)) as ann:
        ann.say("play", playing=True)
        await until(lambda: ann.all("refused"))
        assert ann.latest("refused")["message"] == requests.NOT_REPLAYED
