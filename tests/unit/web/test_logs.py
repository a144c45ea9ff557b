"""The logs of this computer's user on a page of robots: for their owners, and for nobody else."""

import asyncio
import os
import time
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from functools import partial
from pathlib import Path
from urllib.parse import quote

import pytest
from starlette.types import ASGIApp

from pioneer3.log.folder import create, create_log, is_pinned, user_logs
from pioneer3.log.mcap import McapFile
from pioneer3.log.reader import open_log
from pioneer3.log.target import UserFolder
from pioneer3.log.topics import END, GOES_ON, PROGRAM, LogTopic
from pioneer3.log.writer import LogWriter
from pioneer3.models import load_model
from pioneer3.runtime.recording import RobotLog
from pioneer3.state import Snapshot
from pioneer3.tasks import running
from pioneer3.web.access.sessions import Role, SessionKind
from pioneer3.web.app import make_app
from pioneer3.web.logs import MOST_REPLAYS, PageLogs
from pioneer3.web.page import Page
from pioneer3.web.requests import NOT_REPLAYED, REPLAYED
from tests.unit.web.asking import ELSEWHERE, LAN, Script
from tests.unit.web.browser import Browser
from tests.unit.web.replay.logs import drive, snapshot

pytestmark = pytest.mark.realtime

NAME = "2026-03-01T09-30-00Z-drive.mcap"
PATIENCE = 20.0
POLICY_VIOLATION = 1008
OUTSIDE = (
    "../secret.mcap",
    "..%2fsecret.mcap",
    "%2e%2e/secret.mcap",
    "/etc/passwd",
    f"./{NAME}",
    f"x/../{NAME}",
    NAME.removesuffix(".mcap"),
    f"{NAME}\x00",
    f"{NAME}\n",
    "2026-03-01T09-30-01Z-link.mcap",
    "2026-03-01T09-30-02Z-folder.mcap",
    "kept.mcap",
    "",
    "ä\u202e" * 50,
)
"""Names of what no page may have."""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Return a user's folder with one log, and with what only looks like one."""
    made = tmp_path / "logs"
    made.mkdir()
    drive(made / NAME)
    drive(tmp_path / "secret.mcap")
    drive(made / "kept.mcap")
    (made / "2026-03-01T09-30-01Z-link.mcap").symlink_to(tmp_path / "secret.mcap")
    (made / "2026-03-01T09-30-02Z-folder.mcap").mkdir()
    return made


@asynccontextmanager
async def opened(folder: Path) -> AsyncIterator[tuple[ASGIApp, Page]]:
    """Serve a page whose user has that folder."""
    page = Page()
    page.logs = PageLogs(page.clients, folder)
    async with running(page.run()):
        yield make_app(page), page


def as_role(page: Page, role: Role) -> str:
    """Return the cookie of a new session."""
    _, secret = page.access.sessions.open("Vera", role, SessionKind.BROWSER)
    return f"pioneer3-8080={secret}"


async def until(condition: Callable[[], object]) -> None:
    """Wait for threads."""
    async with asyncio.timeout(PATIENCE):
        while not condition():  # noqa: ASYNC110 - a thread sets no event
            await asyncio.sleep(0.01)


async def test_an_owner_lists_and_downloads(folder: Path) -> None:
    async with opened(folder) as (app, _):
        script = Script(app)
        (listed,) = (await script.ask("GET", "/api/logs")).json
        assert (listed["file"], listed["robot"], listed["goes_on"]) == (NAME, "MobileSim", False)
        assert listed["seconds"] == pytest.approx(19.9)
        answer = await script.ask("GET", f"/api/logs/{NAME}")
        assert answer.body == (folder / NAME).read_bytes()
        assert answer.headers["content-disposition"] == f'attachment; filename="{NAME}"'


@pytest.mark.parametrize("name", OUTSIDE)
async def test_no_name_leads_out_of_the_folder(folder: Path, name: str) -> None:
    async with opened(folder) as (app, page):
        for path in (f"/api/logs/{quote(name, safe='')}", f"/api/logs/{name}"):
            answer = await Script(app).ask("GET", path)
            assert answer.status in {404, 405, 307} or (not name and answer.status == 200)
            assert b"MCAP" not in answer.body
        with pytest.raises(Exception, match="there is no log"):
            page.logs.find(name)


@pytest.mark.parametrize("role", [Role.VIEWER, Role.STUDENT])
async def test_nobody_else_sees_anything_of_them(folder: Path, role: Role) -> None:
    async with opened(folder) as (app, page):
        cookie = as_role(page, role)
        script = Script(app, host=LAN, peer=ELSEWHERE).with_headers(cookie=cookie)
        stranger = Script(app, host=LAN, peer=ELSEWHERE)
        for method, path in (("GET", ""), ("POST", ""), ("GET", f"/{NAME}")):
            body: object = {} if method == "POST" else None
            assert (await script.ask(method, f"/api/logs{path}", body)).status == 403
            assert (await stranger.ask(method, f"/api/logs{path}", body)).status == 401
        async with at_replay(app, host=LAN, peer=ELSEWHERE, cookie=cookie) as vera:
            await until(lambda: vera.closed)
            assert (vera.closed, vera.heard) == (POLICY_VIOLATION, [])


def at_replay(app: ASGIApp, name: str = NAME, **options: str) -> Browser:
    """Return a browser that opens a replay."""
    browser = Browser(app, **options)
    browser._scope["query_string"] = f"replay={quote(name)}".encode()
    return browser


async def test_a_replay_opens_beside_the_page_and_drives_nothing(folder: Path) -> None:
    async with opened(folder) as (app, _), Browser(app) as bob:
        async with at_replay(app) as ann, at_replay(app) as amy:
            await until(lambda: ann.all("robots") and amy.all("robots"))
            assert ann.latest("hello")["robots"][0]["kind"] == "REPLAY"
            ann.say("play", playing=True)
            ann.say("emergency_stop")
            await until(lambda: ann.all("refused") and ann.latest("replay")["playing"])
            assert ann.latest("refused")["message"] == REPLAYED
            assert not amy.latest("replay")["playing"]
        bob.say("play", playing=True)
        await until(lambda: bob.all("refused"))
        assert bob.latest("refused")["message"] == NOT_REPLAYED
        assert not bob.all("replay")


async def test_there_are_not_too_many_and_none_without_its_log(folder: Path) -> None:
    async with opened(folder) as (app, _):
        browsers = [at_replay(app) for _ in range(MOST_REPLAYS)]
        for each in browsers:
            await each.__aenter__()
        await until(lambda: all(each.all("replay") for each in browsers))
        async with at_replay(app) as late:
            await until(lambda: late.closed)
            assert late.latest("refused")["message"].startswith("4 replays are open here")
        for each in browsers:
            await each.leave()
        async with at_replay(app, "../secret.mcap") as mallory:
            await until(lambda: mallory.closed)
            assert mallory.latest("refused")["message"] == "there is no log ../secret.mcap"
        async with at_replay(app) as again:
            await until(lambda: again.all("replay"))


async def test_who_is_shown_out_loses_control_though_a_replay_was_opened(folder: Path) -> None:
    async with opened(folder) as (app, page):
        async with at_replay(app) as ann:
            await until(lambda: ann.all("replay"))
        ended: list[object] = []
        page.clients.release_control = ended.append  # type: ignore[method-assign, assignment]
        session, _ = page.access.sessions.open("Vera", Role.DRIVER, SessionKind.BROWSER)
        page.access.sessions.revoke(session.id)
        assert session in ended


async def test_the_last_minutes_are_saved_with_a_note(folder: Path) -> None:
    async with opened(folder) as (app, page):
        script = Script(app)
        answer = await script.ask("POST", "/api/logs", {"note": "why"})
        assert (answer.status, answer.detail) == (409, "nothing is recorded here")
        clock = asyncio.get_running_loop().time
        page.clients.log = writer = LogWriter(UserFolder(folder, "run", 10**9, clock), clock)
        writer._target.most = 1  # each snapshot is in another file
        log = RobotLog(writer)
        writer.describe("robot", {"name": "bob", "model": "p3dx-sh"})
        for number in range(3):
            log.snapshot(snapshot(float(number)), load_model("p3dx-sh"))
            await until(partial(lambda number: len(writer.files) > number + 1, number))
        answer = await script.ask("POST", "/api/logs", {"note": "it hit\x1b[2J the door"})
        assert answer.status == 200
        saved = folder / answer.json["file"]
        assert saved in user_logs(folder)
        assert is_pinned(saved)
        info = open_log(saved).info()
        assert (info.robot, info.end) == ("bob", "an excerpt")
        assert info.texts["note"]["by"] == "this computer"
        assert "\x1b" not in info.texts["note"]["text"]
        assert len(list(open_log(saved).snapshots())) == 3
        answer = await script.ask("GET", f"/api/logs/{Path(writer.path).name}")
        assert (answer.status, answer.detail[:20]) == (409, "it is being written:")
        writer.close("done")
        assert (await script.ask("POST", "/api/logs", {"note": "x" * 201})).status == 400


async def test_the_last_minutes_are_those_of_the_log_whatever_the_computers_clock_was_set_to(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with opened(folder) as (app, page):
        clock, wall = asyncio.get_running_loop().time, time.time_ns
        page.clients.log = writer = LogWriter(UserFolder(folder, "run", 10**9, clock), clock)
        RobotLog(writer).snapshot(snapshot(0.0), load_model("p3dx-sh"))
        for hours in (-1, 1):
            monkeypatch.setattr(time, "time_ns", lambda hours=hours: wall() + hours * 3600 * 10**9)
            answer = await Script(app).ask("POST", "/api/logs", {})
            assert answer.status == 200
            assert len([*open_log(folder / answer.json["file"]).snapshots()]) == 1
        writer.close("done")


async def test_what_cannot_be_saved_is_told_and_leaves_nothing(folder: Path) -> None:
    async with opened(folder) as (app, page):
        clock = asyncio.get_running_loop().time
        page.clients.log = writer = LogWriter(UserFolder(folder, "run", 10**9, clock), clock)
        answer = await Script(app).ask("POST", "/api/logs", {})
        assert (answer.status, answer.detail.endswith("no messages were logged")) == (409, True)
        writer.close("done")
        assert not [path for path in user_logs(folder) if "saved" in path.name]


def part(folder: Path, number: int, why: str) -> Path:
    """Write a file of a log that goes on in others."""
    path = folder / f"2026-03-02T09-30-0{number}Z-run.mcap"
    file = McapFile(create(path))
    file.add_metadata(PROGRAM, {"command": "pioneer3 run", "began_ns": str(10**18)})
    began = 10**18 + number * 10 * 10**9
    file.add(LogTopic("snapshot", Snapshot), [(began + n, snapshot(n / 10)) for n in range(3)])
    file.add_metadata(END, {"why": why})
    file.finish()
    return path


async def test_a_log_in_several_files_is_one(folder: Path) -> None:
    first, second = part(folder, 0, GOES_ON), part(folder, 1, "left as usual")
    async with opened(folder) as (app, _):
        listed, other = (await Script(app).ask("GET", "/api/logs")).json
        assert (listed["file"], listed["more"], other["file"]) == (first.name, [second.name], NAME)
        assert (listed["end"], round(listed["seconds"])) == ("left as usual", 10)
        async with at_replay(app, first.name) as ann:
            await until(lambda: ann.all("replay"))
            told = ann.latest("replay")
            assert round(told["ended"] - told["began"]) == 10


async def test_a_run_that_was_handed_in_is_replayed_for_owners_alone(folder: Path) -> None:
    run = drive(folder.parent / "Ann-1.mcap")
    async with opened(folder) as (app, page):
        page.logs = PageLogs(page.clients, folder, {run.name: run}.get)
        async with at_replay(app, run.name) as teacher:
            await until(lambda: teacher.all("robots"))
            assert teacher.latest("hello")["robots"][0]["kind"] == "REPLAY"
        cookie = as_role(page, Role.STUDENT)
        async with at_replay(app, run.name, host=LAN, peer=ELSEWHERE, cookie=cookie) as ann:
            await until(lambda: ann.closed)
            assert (ann.closed, ann.heard) == (POLICY_VIOLATION, [])


async def test_damaged_logs_are_left_out_of_the_list(folder: Path) -> None:
    path, descriptor = create_log(folder, "bad", 0.0)
    os.write(descriptor, b"no log")
    os.close(descriptor)
    async with opened(folder) as (app, _):
        assert [each["file"] for each in (await Script(app).ask("GET", "/api/logs")).json] == [NAME]
        async with at_replay(app, path.name) as ann:
            await until(lambda: ann.closed)
            assert "is no log" in ann.latest("refused")["message"]
