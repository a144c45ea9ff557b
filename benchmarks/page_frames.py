"""Frames of the map in headless Chromium: `python -m benchmarks.page_frames`.

The real page hears made-up robots over a real WebSocket: 20 that drive circles through the office
and report 10 times a second, 3 of them with lasers of 181 beams, trails of some minutes behind
them. Headless Chromium has no GPU: every pixel is painted by the processor, which a desktop or a
phone does not do. So the bars are for the worst case.
"""

import argparse
import asyncio
import os
import shutil
import sys
import threading
import time
from collections.abc import Iterator
from concurrent.futures import Future
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import pairwise
from math import cos, pi, sin
from statistics import median

import msgspec
import uvicorn
from playwright.sync_api import CDPSession, Page, sync_playwright
from starlette.applications import Starlette
from starlette.responses import FileResponse, Response
from starlette.routing import Mount, Route, WebSocketRoute
from starlette.staticfiles import StaticFiles
from starlette.websockets import WebSocket, WebSocketDisconnect

from benchmarks.table import Row, percentile_99
from pioneer3.arcos.reports import Config
from pioneer3.geometry import Pose2, Twist2, wrap
from pioneer3.limits import Limits
from pioneer3.maps import shipped_map
from pioneer3.models import load_model
from pioneer3.robot.supervisor import RobotInfo
from pioneer3.state import Battery, Bumpers, Identity, Motors, Odometry, Scan, Snapshot, Sonar
from pioneer3.teleop.gamepad import SCHEME
from pioneer3.web import messages
from pioneer3.web.api.robot_operations import body_of
from pioneer3.web.app import STATIC
from pioneer3.web.broadcast import sweep
from pioneer3.web.robot_view import robot_part, snapshot_part
from pioneer3.web.world import map_message

ROBOTS, LASERS, BEAMS, RATE = 20, 3, 181, 10
SECONDS = 10.0
HISTORY = 120.0
"""Of trails before the measurement, played quickly [s]."""
FRAME = 1 / 60
MODEL = load_model("p3dx-sh")
RECORD = """
window.frames = {at: [], took: []};
const request = window.requestAnimationFrame.bind(window);
window.requestAnimationFrame = (act) => request((now) => {
  const began = performance.now();
  act(now);
  window.frames.at.push(now);
  window.frames.took.push(performance.now() - began);
});
"""
"""Notes when each frame was painted, and how long the page's own code took [ms]."""


def pose_at(number: int, now: float) -> Pose2:
    """Return where a robot is: on circles of 1 to 2 m through all of the office, at 0.4 m/s."""
    column, row = number % 5, number // 5
    radius = 1.0 + number % 3 / 2
    turned = now * 0.4 / radius + number
    return Pose2(
        2.5 + 3.7 * column + radius * cos(turned),
        2.0 + 3.3 * row + radius * sin(turned),
        wrap(turned + pi / 2),
    )


def snapshot(number: int, now: float) -> messages.SnapshotMessage:
    """Return what pages are told of a robot."""
    pose, twist = pose_at(number, now), Twist2(0.4, 0.3)
    ranges = tuple(1.2 + sin(now + number + beam) for beam in range(16))
    reading = Snapshot(
        stamp=now,
        sequence=int(now * RATE),
        odometry=Odometry(robot_in_odom=pose, twist=twist, left_speed=0.4, right_speed=0.4),
        battery=Battery(voltage=12.6, charge=0.8),
        motors=Motors(enabled=True),
        sonar=Sonar(ranges=ranges, enabled=True),
        bumpers=Bumpers(),
    )
    return snapshot_part(
        number, reading, robot_in_map=pose, why=None, emergency_stop=False, driver=None
    )


def scan(number: int, now: float) -> messages.LaserSweep:
    """Return what pages are told of a laser."""
    pose = pose_at(number, now)
    angles = tuple((beam - BEAMS // 2) * pi / (BEAMS - 1) for beam in range(BEAMS))
    return sweep(
        number,
        Scan(
            stamp=now,
            sequence=int(now * RATE),
            robot_in_odom=pose,
            sensor_in_robot=Pose2(),
            angles=angles,
            ranges=tuple(3.0 + sin(5 * angle + now) for angle in angles),
        ),
        pose,
    )


def hello() -> messages.Hello:
    """Return what pages are told first."""
    robots = tuple(
        msgspec.structs.replace(
            robot_part(
                number,
                f"robot-{number:02}",
                RobotInfo(
                    identity=Identity(
                        name=f"robot-{number:02}", family="Pioneer", model=MODEL.name
                    ),
                    model=MODEL,
                    limits=Limits(max_speed=0.75, max_turn_rate=1.7),
                    config=Config(family="Pioneer", model=MODEL.name, serial_number="SIM"),
                    url=f"memory:{number}",
                    speed=0,
                ),
            ),
            laser=number <= LASERS,
        )
        for number in range(1, ROBOTS + 1)
    )
    return messages.Hello("benchmark", robots, None, SCHEME, class_=None)


async def talk(socket: WebSocket) -> None:
    """Tell a page of all robots, ten times a second."""
    await socket.accept()
    numbers = range(1, ROBOTS + 1)

    async def say(message: messages.Message) -> None:
        await socket.send_text(messages.encode(message))

    async def say_all(now: float) -> None:
        await say(messages.Robots(tuple(snapshot(n, now) for n in numbers)))

    try:
        await say(hello())
        await say(map_message(shipped_map("office")))
        for tick in range(int(HISTORY * RATE)):
            await say_all(tick / RATE)
        began = asyncio.get_running_loop().time() - HISTORY
        while True:
            now = asyncio.get_running_loop().time() - began
            await say_all(now)
            scans = tuple(scan(number, now) for number in range(1, LASERS + 1))
            await say(messages.Scans(scans))
            await asyncio.sleep(1 / RATE)
    except (WebSocketDisconnect, RuntimeError):
        return


@contextmanager
def served() -> Iterator[str]:
    """Serve the page and the made-up robots in a thread; yield the address."""
    app = Starlette(
        routes=[
            Route("/", lambda _: FileResponse(STATIC / "index.html")),
            WebSocketRoute("/ws", talk),
            Route("/api/models/{model}", lambda _: Response(msgspec.json.encode(body_of(MODEL)))),
            Mount("/static", StaticFiles(directory=STATIC)),
        ]
    )
    config = uvicorn.Config(app, port=0, log_level="error", ws="websockets-sansio", lifespan="off")
    server = uvicorn.Server(config)
    ready: Future[int] = Future()

    async def run() -> None:
        task = asyncio.ensure_future(server.serve())
        while not server.started:
            await asyncio.sleep(0.01)
        ready.set_result(server.servers[0].sockets[0].getsockname()[1])
        await task

    thread = threading.Thread(target=asyncio.run, args=(run(),))
    thread.start()
    try:
        yield f"http://127.0.0.1:{ready.result(20)}"
    finally:
        server.should_exit = True
        thread.join()


@dataclass(frozen=True, slots=True)
class Costs:
    """Processor time used until now [s]: of the tab, and of all of Chromium."""

    tab: float
    all: float

    @classmethod
    def now(cls, session: CDPSession) -> "Costs":
        """Ask the browser."""
        processes = session.send("SystemInfo.getProcessInfo")["processInfo"]
        spent = [(process["type"], process["cpuTime"]) for process in processes]
        tab = max(seconds for kind, seconds in spent if kind == "renderer")
        return cls(tab, sum(seconds for _, seconds in spent))


def rest(page: Page, _: float) -> None:
    """Let the camera stand still."""
    page.wait_for_timeout(16)


def pan(page: Page, now: float) -> None:
    """Drag the map around in a circle, once in three seconds."""
    page.mouse.move(500 + 220 * cos(2 * now), 400 + 220 * sin(2 * now))
    page.wait_for_timeout(12)


def zoom(page: Page, now: float) -> None:
    """Turn the wheel to and fro."""
    page.mouse.wheel(0, 40 * (1 if sin(2 * now) > 0 else -1))
    page.wait_for_timeout(12)


def rows(seconds: float = SECONDS) -> Iterator[Row]:
    """Yield the figures."""
    names = ("chromium", "chromium-headless-shell", "chromium-browser")
    chromium = next(filter(None, map(shutil.which, names)), None)
    with served() as address, sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=chromium, args=["--no-sandbox", "--disable-gpu"]
        )
        session = browser.new_browser_cdp_session()
        page = browser.new_page(viewport={"width": 1440, "height": 900})
        page.add_init_script(RECORD)
        page.add_init_script("""localStorage.setItem("pioneer3.layers", '{"laser": true}')""")
        page.goto(address)
        while page.evaluate("(window.pioneer3?.state.scans ?? []).filter(Boolean).length") < LASERS:
            page.wait_for_timeout(200)
        page.wait_for_timeout(2000)
        for name, move in (("camera at rest", rest), ("panning", pan), ("zooming", zoom)):
            yield from phase(page, session, name, move, seconds)
        browser.close()


def phase(
    page: Page, session: CDPSession, name: str, move: object, seconds: float
) -> Iterator[Row]:
    """Measure while the camera is moved in one way."""
    assert callable(move)
    page.locator("#fit").click()
    page.wait_for_timeout(1000)
    move(page, 0.0)
    if move is pan:
        page.mouse.down()
    page.evaluate("window.frames.at.length = window.frames.took.length = 0")
    before, began = Costs.now(session), time.monotonic()
    while (now := time.monotonic() - began) < seconds:
        move(page, now)
    after, lasted = Costs.now(session), time.monotonic() - began
    frames = page.evaluate("window.frames")
    page.mouse.up()
    times, took = frames["at"], frames["took"]
    between = [later - earlier for earlier, later in pairwise(times)]
    tab, chromium = after.tab - before.tab, after.all - before.all
    yield Row(f"{name}: frames a second", len(times) / lasted, "1/s", None)
    yield Row(f"{name}: between frames, median", median(between), "ms", None)
    yield Row(f"{name}: between frames, 99th percentile", percentile_99(between), "ms", None)
    yield Row(f"{name}: the page's code, median", median(took), "ms", None)
    yield Row(f"{name}: the page's code, 99th percentile", percentile_99(took), "ms", None)
    yield Row(f"{name}: the tab's time a frame", 1000 * tab / len(times), "ms", 1000 * FRAME)
    yield Row(f"{name}: the tab's share of a core", 100 * tab / lasted, "%", None)
    yield Row(f"{name}: all of Chromium", 100 * chromium / lasted, "%", None)


def main() -> int:
    """Print the table; return 1 if a bar is missed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=SECONDS, help="of each phase")
    seconds = parser.parse_args().seconds
    print(f"{os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}; no GPU", flush=True)
    missed = 0
    for row in rows(seconds):
        print(row, flush=True)
        missed += not row.met
    return int(missed > 0)


if __name__ == "__main__":
    sys.exit(main())
