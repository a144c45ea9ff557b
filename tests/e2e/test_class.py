"""`pioneer3 class` over real sockets: students, their programs, and the teacher."""

import asyncio
import json
import re
import shutil
from collections.abc import AsyncIterator, Callable
from contextlib import AsyncExitStack, asynccontextmanager, suppress
from dataclasses import dataclass, field
from math import hypot
from pathlib import Path
from typing import Any
from urllib.error import HTTPError
from urllib.request import Request, urlopen

import pytest
from websockets.asyncio.client import ClientConnection, connect

from pioneer3 import Robot, connect_async
from pioneer3.errors import ConfigError, LinkError, MotionError
from pioneer3.log.reader import open_log
from pioneer3.sim.server.start import simulator
from pioneer3.web.classroom import robot as class_robot
from pioneer3.web.classroom.live import ClassOptions, class_live
from pioneer3.web.hosting import ConnectTarget
from tests.support import disk_of, until

pytestmark = pytest.mark.realtime

PATIENCE = 30.0


@dataclass(frozen=True)
class Answer:
    """The answer to an HTTP request."""

    status: int
    body: bytes
    cookie: str

    @property
    def json(self) -> Any:
        """The body, which is JSON."""
        return json.loads(self.body)


@dataclass
class Caller:
    """Somebody at the class: the teacher, or with a cookie a student."""

    base: str
    cookie: str = ""

    async def ask(self, method: str, path: str, **body: object) -> Answer:
        """Return the answer to a request to the API."""
        return await asyncio.to_thread(self._ask, method, path, body)

    def _ask(self, method: str, path: str, body: dict[str, object]) -> Answer:
        request = Request(f"{self.base}/api{path}", method=method)
        request.add_header("Cookie", self.cookie)
        if body:
            request.add_header("Content-Type", "application/json")
            request.data = json.dumps(body).encode()
        try:
            with urlopen(request, timeout=PATIENCE) as answer:
                cookie = str(answer.headers.get("Set-Cookie", "")).partition(";")[0]
                return Answer(answer.status, answer.read(), cookie)
        except HTTPError as error:
            return Answer(error.code, error.read(), "")

    @asynccontextmanager
    async def page(self, query: str = "") -> AsyncIterator["OpenPage"]:
        """Open the page."""
        url = f"{self.base.replace('http', 'ws')}/ws{query}"
        async with connect(url, additional_headers={"Cookie": self.cookie}) as socket:
            page = OpenPage(socket)
            reading = asyncio.ensure_future(page.read())
            try:
                await until(lambda: "class" in page.latest)
                yield page
            finally:
                reading.cancel()


@dataclass
class OpenPage:
    """A page: the newest message of each type, and all of some."""

    socket: ClientConnection
    latest: dict[str, Any] = field(default_factory=dict)
    refused: list[str] = field(default_factory=list)
    told: list[str] = field(default_factory=list)
    seen: set[int] = field(default_factory=set)
    pose: dict[int, Any] = field(default_factory=dict)

    async def read(self) -> None:
        """Keep what comes."""
        async for text in self.socket:
            message = json.loads(text)
            self.latest[message["type"]] = message
            if message["type"] in {"refused", "edit_refused"}:
                self.refused.append(message["message"])
            elif message["type"] == "told":
                self.told.append(message["message"])
            elif message["type"] in {"robots", "class_robots"}:
                for snapshot in message["snapshots"]:
                    self.seen.add(snapshot["robot"])
                    self.pose[snapshot["robot"]] = snapshot["robot_in_map"]

    async def say(self, type_: str, **fields: object) -> None:
        """Send a request."""
        await self.socket.send(json.dumps({"type": type_, **fields}))

    async def drive(self, robot: int | None, seconds: float, v: float = 0.2) -> None:
        """Hold a key."""
        for _ in range(round(seconds / 0.066)):
            await self.say("drive", v=v, w=0.4, robot=robot)
            await asyncio.sleep(0.066)

    async def drive_until(self, robot: int, holds: Callable[[], object]) -> None:
        """Hold a key until something holds; let go in between, as a busy machine may ask for."""
        async with asyncio.timeout(PATIENCE):
            while not holds():
                await self.drive(robot, 1.0)
                await self.say("drive", v=0, w=0, robot=robot)
                await asyncio.sleep(0.1)

    def seat(self, robot: int) -> dict[str, Any]:
        """Return the part of the last message about a robot's seat."""
        found = [seat for seat in self.latest["class"]["seats"] if seat["robot"] == robot]
        assert len(found) == 1
        return dict(found[0])


@dataclass
class School:
    """A class that runs."""

    teacher: Caller
    token: str
    folder: Path
    lines: list[str]

    async def join(self, name: str) -> tuple[Caller, dict[str, Any]]:
        """Let a student join; return the caller, and the answer."""
        student = Caller(self.teacher.base)
        answer = await student.ask("POST", "/class/join", token=self.token, name=name)
        assert answer.status == 200, answer.body
        student.cookie = answer.cookie
        return student, answer.json

    async def seat(self, robot: int) -> dict[str, Any]:
        """Return the seat of a robot, as the teacher sees it."""
        state = (await self.teacher.ask("GET", "/class")).json
        return dict(next(seat for seat in state["seats"] if seat["robot"] == robot))

    async def true_pose(self, robot: int) -> tuple[float, float]:
        """Return a robot's place in the map."""
        async with self.teacher.page("?view=class") as page:
            await until(lambda: robot in page.pose)
            x, y, _ = page.pose[robot]
            return x, y


@asynccontextmanager
async def school(
    tmp_path: Path, students: int = 2, fleet: tuple[ConnectTarget, ...] = ()
) -> AsyncIterator[School]:
    """Run a class on loopback."""
    lines: list[str] = []
    ready = asyncio.Event()

    def tell(line: str) -> None:
        lines.append(line)
        if line.startswith("Runs are handed in"):
            ready.set()

    options = ClassOptions(
        students=students,
        fleet=fleet,
        map_name="lab",
        folder=tmp_path / "runs",
        sim_port=0,
        web_port=0,
        show_tokens=True,
    )
    task = asyncio.ensure_future(class_live(options, tell))
    waiting = asyncio.ensure_future(ready.wait())
    await asyncio.wait({task, waiting}, timeout=PATIENCE, return_when=asyncio.FIRST_COMPLETED)
    waiting.cancel()
    if task.done():
        task.result()
    try:
        text = "\n".join(lines)
        url = re.findall(r"http://localhost:(\d+)/join#([\w-]+)", text)[0]
        teacher = Caller(f"http://127.0.0.1:{url[0]}")
        yield School(teacher, url[1], tmp_path / "runs", lines)
    finally:
        task.cancel()
        with suppress(asyncio.CancelledError):
            await task


async def driving(robot: Robot, v: float = 0.2) -> None:
    """Drive in a circle until cancelled."""
    while True:
        try:
            robot.drive(v, 0.4)
        except (LinkError, MotionError):  # after another had it: let go, then ask anew
            with suppress(LinkError, MotionError):
                robot.drive(0.0)
        await asyncio.sleep(0.05)


async def test_each_student_sees_and_drives_the_own_robot_only(tmp_path: Path) -> None:
    async with school(tmp_path) as the:
        ann, joined = await the.join("Ann")
        bob, _ = await the.join("Ann")
        assert (joined["robot"], joined["name"]) == (1, "Ann")
        async with ann.page() as anns, bob.page() as bobs, the.teacher.page("?view=class") as all_:
            assert anns.latest["hello"]["class"] == {"teacher": False, "robot": 1}
            assert [robot["name"] for robot in anns.latest["hello"]["robots"]] == ["Ann"]
            assert [robot["name"] for robot in bobs.latest["hello"]["robots"]] == ["Ann 2"]
            assert anns.latest["hello"]["models"] is None
            assert anns.latest["class"]["join_url"] is None
            assert the.token in all_.latest["class"]["join_url"]
            await until(lambda: bool(anns.seen) and all_.seen == {1, 2})
            before = dict(all_.pose)
            await anns.drive(None, 0.2)
            await anns.drive_until(1, lambda: hypot(*_between(all_.pose[1], before[1])) > 0.05)
            anns.refused.clear()
            await anns.drive(2, 0.5)
            await until(lambda: anns.refused != [])
            assert anns.seen == {1}
            assert set(anns.refused) == {"this is not your robot"}
            assert all_.pose[2] == before[2]
            assert {client["name"] for client in anns.latest["people"]["clients"]} == {"Ann"}
            for refused in (
                "pause",
                "pause_robots",
                "put_back",
                "free_seat",
                "lock_joining",
                "share_addresses",
            ):
                fields = {"paused": True} if refused.startswith("pause") else {"robot": 1}
                fields = {"locked": True} if refused == "lock_joining" else fields
                fields = {"shared": True} if refused == "share_addresses" else fields
                count = len(anns.refused)
                await anns.say(refused, **fields)
                await until(lambda n=count: len(anns.refused) > n)  # type: ignore[misc]
                assert anns.refused[-1] == "only your teacher may do this"


async def test_the_api_is_as_strict(tmp_path: Path) -> None:
    async with school(tmp_path) as the:
        ann, _ = await the.join("Ann")
        forbidden: list[tuple[str, str, dict[str, object]]] = [
            ("POST", "/robots/2/drive", {"v": 0.2}),
            ("POST", "/robots/2/stop", {}),
            ("POST", "/robots/2/emergency_stop", {}),
            ("GET", "/robots/2/snapshot", {}),
            ("PUT", "/robots/2/control", {"take_over": True}),
            ("PUT", "/class/paused", {"paused": True}),
            ("PUT", "/class/robots/1/paused", {"paused": True}),
            ("POST", "/class/put_back", {}),
            ("POST", "/class/robots/1/put_back", {}),
            ("PUT", "/class/locked", {"locked": True}),
            ("PUT", "/class/shared", {"shared": True}),
            ("DELETE", "/class/robots/2", {}),
            ("PUT", "/class/robots/2/recording", {"step": "begin"}),
            ("GET", "/class/link", {}),
            ("POST", "/tokens", {"name": "x"}),
            ("POST", "/invitations", {"role": "driver"}),
            ("GET", "/sessions", {}),
        ]
        for method, path, body in forbidden:
            answer = await ann.ask(method, path, **body)
            assert answer.status == 403, (method, path, answer.body)
        assert the.token not in (await ann.ask("GET", "/class")).body.decode()
        assert [robot["id"] for robot in (await ann.ask("GET", "/robots")).json] == [1]
        assert (await ann.ask("POST", "/robots/1/stop")).status == 200
        assert (await ann.ask("POST", "/robots/1/drive", v=0.1)).status == 200
        assert (await ann.ask("POST", "/emergency_stop")).status == 204
        stopped = [
            (await the.teacher.ask("GET", f"/robots/{n}/snapshot")).json["emergency_stop"]
            for n in (1, 2)
        ]
        assert stopped == [True, False]


@pytest.mark.skipif(shutil.which("curl") is None, reason="curl is not installed")
async def test_the_examples_of_the_reference_run(tmp_path: Path) -> None:
    text = (Path(__file__).parents[2] / "docs/reference/http-api.md").read_text("utf-8")
    examples = re.findall(r"```sh\n((?:(?!```).)*/class.*?)```", text, re.DOTALL)
    assert len(examples) == 2
    async with school(tmp_path) as the:
        for example in examples:
            bash = await asyncio.create_subprocess_exec(
                *("bash", "-euo", "pipefail", "-c"),
                example.replace("http://127.0.0.1:8080", the.teacher.base),
                cwd=tmp_path,
                env={"TOKEN": the.token, "PATH": "/usr/local/bin:/usr/bin:/bin"},
                stdout=asyncio.subprocess.PIPE,
                stderr=asyncio.subprocess.PIPE,
            )
            async with asyncio.timeout(PATIENCE):
                _, error = await bash.communicate()
            assert bash.returncode == 0, error.decode()


async def test_students_load_the_wheel_and_programs_with_the_address_of_their_robot(
    tmp_path: Path,
) -> None:
    def load(path: str, cookie: str = "", host: str = "") -> tuple[int, bytes]:
        request = Request(f"{the.teacher.base}{path}", headers={"Cookie": cookie})
        if host:
            request.add_header("Host", host)
        try:
            with urlopen(request, timeout=PATIENCE) as answer:
                return answer.status, answer.read()
        except HTTPError as error:
            return error.code, error.read()

    async with school(tmp_path) as the:
        told = (await Caller(the.teacher.base).ask("GET", "/class/installation")).json
        wheel = told["command"].rpartition("/")[2]
        assert told["command"] == f"pip install {the.teacher.base}/{wheel}"
        status, data = await asyncio.to_thread(load, f"/{wheel}")
        assert (status, data[:2]) == (200, b"PK")
        assert the.token.encode() not in data
        bob, joined = await the.join("Bob")
        assert "square.py" in told["programs"]
        status, program = await asyncio.to_thread(load, "/programs/square.py", bob.cookie)
        assert status == 200
        assert f'"{joined["url"]}"' in program.decode()
        assert the.token.encode() not in program
        second = await asyncio.to_thread(load, "/programs/square.py?robot=2")
        assert f'"{(await the.seat(2))["url"]}"' in second[1].decode()
        other = await asyncio.to_thread(load, "/programs/square.py?robot=2", bob.cookie)
        assert other == (200, program)  # a student's own robot, whatever is asked for
        for path, status in (
            ("/programs/square.py?robot=3", 404),
            ("/programs/..%2froster.py", 404),
            ("/programs/roster.py", 404),
            ("/pioneer3-9.9-py3-none-any.whl", 404),
            ("/wheels/", 404),
            ("/wheels/..%2f..%2fetc%2fpasswd", 404),
        ):
            assert (await asyncio.to_thread(load, path))[0] == status, path
        elsewhere = await asyncio.to_thread(load, "/programs/square.py", "", "192.168.1.20")
        assert elsewhere[0] == 401  # from another computer, without a session


async def test_joining_is_for_who_has_the_token_while_there_is_room(tmp_path: Path) -> None:
    async with school(tmp_path) as the:
        stranger = Caller(the.teacher.base)
        wrong = await stranger.ask("POST", "/class/join", token="guess", name="Eve")
        assert wrong.status == 403
        ann, _ = await the.join("Ann")
        again = await ann.ask("POST", "/class/join", token=the.token, name="Anna")
        assert again.json["robot"] == 1
        assert again.json["name"] == "Anna"
        await the.teacher.ask("PUT", "/class/locked", locked=True)
        locked = await stranger.ask("POST", "/class/join", token=the.token, name="Eve")
        assert (locked.status, b"nobody else can join" in locked.body) == (409, True)
        await the.teacher.ask("PUT", "/class/locked", locked=False)
        await the.join("Bob")
        full = await stranger.ask("POST", "/class/join", token=the.token, name="Eve")
        assert (full.status, b"the class is full" in full.body) == (409, True)
        async with ann.page() as page:
            assert (await the.teacher.ask("DELETE", "/class/robots/1")).status == 204
            await asyncio.wait_for(page.socket.wait_closed(), PATIENCE)
            assert page.socket.close_code == 4401
        assert (await ann.ask("POST", "/robots/1/drive", v=0.1)).status in {401, 200}
        _, joined = await the.join("Eve")
        assert joined["robot"] == 1


async def test_who_throws_the_cookie_away_gets_no_second_seat(tmp_path: Path) -> None:
    async with school(tmp_path) as the:
        await the.teacher.ask("PUT", "/class/shared", shared=False)
        ann, _ = await the.join("Ann")
        again = await Caller(the.teacher.base).ask(
            "POST", "/class/join", token=the.token, name="Eve"
        )
        assert (again.status, b"ask your teacher" in again.body) == (409, True)
        assert (await the.seat(2))["name"] is None
        kept = await ann.ask("POST", "/class/join", token=the.token, name="Anna")
        assert kept.json["robot"] == 1


async def test_a_program_comes_before_the_page_and_the_teacher_before_both(tmp_path: Path) -> None:
    async with (
        school(tmp_path) as the,
        the.teacher.page("?view=class") as teacher,
    ):
        ann, joined = await the.join("Ann")
        async with ann.page() as page:
            async with connect_async(joined["url"]) as robot:
                moving = asyncio.ensure_future(driving(robot))
                await until(lambda: page.seat(1)["program"] is not None)
                begun = teacher.pose[1]
                await until(lambda: hypot(*_between(teacher.pose[1], begun)) > 0.1)
                await until(lambda: 1 in page.seen)
                await page.drive(1, 0.5)
                assert "your program drives your robot" in page.refused[-1]
                await teacher.say("take_over", robot=1)
                await until(lambda: page.seat(1)["program"] is None)
                assert page.seat(1)["refusal"] == "your teacher drives your robot"
                await page.say("take_over", robot=1)
                await until(lambda: page.refused[-1] == "your teacher drives your robot")
                await teacher.say("release_control", robot=1)
                await until(lambda: page.seat(1)["program"] is not None)
                begun = teacher.pose[1]
                await until(lambda: hypot(*_between(teacher.pose[1], begun)) > 0.1)
                moving.cancel()
            await until(lambda: page.seat(1)["program"] is None)
            begun = teacher.pose[1]
            await page.drive_until(1, lambda: hypot(*_between(teacher.pose[1], begun)) > 0.05)
            assert page.seat(1)["refusal"] == ""


async def test_a_paused_robot_stands_whoever_drives_it_and_goes_on_afterwards(
    tmp_path: Path,
) -> None:
    async with school(tmp_path) as the, the.teacher.page("?view=class") as teacher:
        ann, _ = await the.join("Ann")
        _, bobs = await the.join("Bob")
        async with ann.page() as page, connect_async(bobs["url"]) as robot:
            moving = asyncio.ensure_future(driving(robot))
            await until(lambda: abs(_speed(robot)) > 0.1)
            assert (await the.teacher.ask("PUT", "/class/paused", paused=True)).status == 204
            await until(lambda: _speed(robot) == 0.0)
            await page.drive(1, 0.5)
            assert page.refused[-1] == "the teacher has paused all robots"
            assert page.latest["class"]["paused"]
            still = dict(teacher.pose)
            await asyncio.sleep(1.0)
            assert teacher.pose == still
            assert teacher.seat(2)["program"] is not None
            await teacher.say("pause_robots", paused=False, robot=2)
            await until(lambda: abs(_speed(robot)) > 0.1)
            assert teacher.seat(1)["paused"]
            assert not teacher.seat(2)["paused"]
            moving.cancel()


async def test_robots_are_put_back_where_they_began(tmp_path: Path) -> None:
    async with school(tmp_path) as the, the.teacher.page("?view=class") as teacher:
        ann, _ = await the.join("Ann")
        await until(lambda: teacher.seen == {1, 2})
        begun = dict(teacher.pose)
        async with ann.page() as page:
            await page.drive_until(1, lambda: hypot(*_between(teacher.pose[1], begun[1])) > 0.1)
            assert (await the.teacher.ask("POST", "/class/put_back")).status == 204
            await until(lambda: hypot(*_between(teacher.pose[1], begun[1])) < 0.03)


async def test_a_run_is_recorded_handed_in_and_played(tmp_path: Path) -> None:
    async with school(tmp_path) as the:
        ann, joined = await the.join("Änn ../é")
        bob, _ = await the.join("Bob")
        recording = "/class/robots/1/recording"
        async with ann.page() as page:
            assert (await ann.ask("PUT", recording, step="begin")).status == 200
            await page.drive(1, 1.5)
            async with connect_async(joined["url"]) as robot:
                moving = asyncio.ensure_future(driving(robot))
                await asyncio.sleep(2.0)
                moving.cancel()
            assert (await ann.ask("PUT", recording, step="begin")).status == 409
            handed_in = await ann.ask("PUT", recording, step="hand_in")
            run = handed_in.json["handed_in"]
            assert run["file"] == "Änn-é-1.mcap"
            assert run["seconds"] > 3.0
            await until(lambda: len(page.latest["class"]["handed_in"]) == 1)
        assert [path.name for path in the.folder.iterdir()] == ["Änn-é-1.mcap"]
        path = "/class/runs/%C3%84nn-%C3%A9-1.mcap"
        got = await the.teacher.ask("GET", path)
        assert got.body == (the.folder / run["file"]).read_bytes()
        assert (await ann.ask("GET", path)).body == got.body
        assert (await bob.ask("GET", path)).status == 404
        assert (await bob.ask("GET", "/class/runs")).json == []
        for name in ("..%2F..%2Fetc%2Fpasswd", "%2e%2e", ".robot-1"):
            assert (await the.teacher.ask("GET", f"/class/runs/{name}")).status == 404
    async with connect_async(f"replay:{tmp_path / 'runs' / run['file']}") as replayed:
        speeds = [snapshot.odometry.twist.v async for snapshot in replayed.snapshots(3.0)]
        assert max(speeds) > 0.15
    topics = open_log(tmp_path / "runs" / run["file"]).topics()
    assert topics >= {"snapshot", "truth", "map"}  # a replay shows them


async def test_a_disk_that_fills_ends_a_run_and_not_the_class(tmp_path: Path) -> None:
    async with school(tmp_path) as the:
        ann, _ = await the.join("Ann")
        async with ann.page() as page:
            with disk_of(5000):
                await page.say("record_run", step="begin")
                await until(lambda: any("File too large; hand it in" in one for one in page.told))
                begun = page.pose[1]
                await page.drive_until(1, lambda: abs(page.pose[1]["x"] - begun["x"]) > 0.05)
            await page.say("record_run", step="hand_in")
            await until(lambda: len(page.latest["class"]["handed_in"]) == 1)


async def test_a_run_that_grows_too_long_ends_is_told_and_can_be_handed_in(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(class_robot, "MOST_BYTES", 5000)
    async with school(tmp_path) as the:
        ann, _ = await the.join("Ann")
        async with ann.page() as page:
            await page.say("record_run", step="begin")
            await until(lambda: any("greatest length" in told for told in page.told))
            recording = page.seat(1)["recording"]
            assert recording["ended"] == "it has reached the greatest length"
            assert recording["seconds"] is not None
            size = next(the.folder.iterdir()).stat().st_size
            await asyncio.sleep(1.0)
            assert next(the.folder.iterdir()).stat().st_size == size < 30_000
            await page.say("record_run", step="hand_in")
            await until(lambda: len(page.latest["class"]["handed_in"]) == 1)
            assert page.seat(1)["recording"] is None
            await page.say("record_run", step="hand_in")
            await until(lambda: page.refused != [])
            assert page.refused == ["nothing was recorded: press Record first"]
            await page.say("record_run", step="begin")
            await until(lambda: page.seat(1)["recording"] is not None)
        assert (await the.teacher.ask("DELETE", "/class/robots/1")).status == 204
        assert [path.name for path in the.folder.iterdir()] == ["Ann-1.mcap"]


async def test_a_class_that_shares_one_address_is_not_slowed_down(tmp_path: Path) -> None:
    async with school(tmp_path, 6) as the:
        students = [(await the.join(f"Student {n}"))[0] for n in range(6)]
        for student in students:
            for _ in range(250):  # 1500 requests; an address alone may make 1000 in a row
                assert (await student.ask("GET", "/me")).status == 200
        for _ in range(60):
            await students[0].ask("POST", "/class/join", token="guess", name="x")
        late = await students[0].ask("POST", "/class/join", token="guess", name="x")
        assert late.status == 429


async def test_a_map_with_too_little_room_says_how_many_fit(tmp_path: Path) -> None:
    small = tmp_path / "small.map"
    small.write_text(
        "2D-Map\nLineMinPos: 0 0\nLineMaxPos: 3000 3000\nNumLines: 4\nLINES\n"
        "0 0 3000 0\n3000 0 3000 3000\n3000 3000 0 3000\n0 3000 0 0\n"
    )
    options = ClassOptions(
        students=30, map_name=str(small), folder=tmp_path, sim_port=0, web_port=0
    )
    with pytest.raises(ConfigError, match=r"room for [1-9]\d? robots, not for 30"):
        await class_live(options, print)


async def test_the_robots_of_a_fleet_make_a_class_too(tmp_path: Path) -> None:
    async with AsyncExitStack() as stack:
        robots = []
        for name in ("front", "back"):
            here = simulator(map_name="lab", robot="p3dx", port=0)
            url = (await stack.enter_async_context(here)).url
            robots.append(ConnectTarget(url=url, name=name))
        the = await stack.enter_async_context(school(tmp_path, fleet=tuple(robots)))
        ann, joined = await the.join("Ann")
        assert (await the.seat(2))["name"] is None
        async with ann.page() as page:
            assert [robot["name"] for robot in page.latest["hello"]["robots"]] == ["Ann"]
            await until(lambda: 1 in page.seen)
            begun = page.pose[1]
            await page.drive_until(1, lambda: abs(page.pose[1]["theta"] - begun["theta"]) > 0.05)
            async with connect_async(joined["url"]):
                await until(lambda: page.seat(1)["program"] is not None)
        refused = await the.teacher.ask("POST", "/class/robots/1/put_back")
        assert (refused.status, b"only simulated robots" in refused.body) == (409, True)


def _speed(robot: Robot) -> float:
    snapshot = robot.snapshot
    return snapshot.odometry.twist.v if snapshot else 0.0


def _between(a: Any, b: Any) -> tuple[float, float]:
    return a[0] - b[0], a[1] - b[1]
