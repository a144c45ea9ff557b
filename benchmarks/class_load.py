"""A class at work: its pages and its students' programs, on loopback.

    uv run python -m benchmarks.class_load --students 20 --seconds 20

Starts `pioneer3 class`, lets every student join, opens the page of each, and the teacher's, in one
process, and lets a program drive each robot from another. It prints the gaps between frames of a
student's page, the sessions that programs lost, and the share of a core that the class needs.
"""

import argparse
import asyncio
import json
import os
import re
import sys
import tempfile
from asyncio.subprocess import PIPE, Process
from contextlib import suppress
from pathlib import Path
from time import monotonic
from urllib.request import Request, urlopen

import numpy as np
from websockets.asyncio.client import connect

from pioneer3 import connect_async
from pioneer3.errors import LinkError, MotionError
from pioneer3.robot.supervisor import Connection

BAR_GAP, BAR_CPU = 300.0, 150.0
"""Of 99 % of the frames [ms]; of one core [%]."""
SETTLE = 5.0
"""Time before it is measured [s]."""
TICKS = os.sysconf("SC_CLK_TCK")
JSON = {"Content-Type": "application/json"}


def main() -> None:
    """Measure, and print."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--students", type=int, default=20)
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--no-programs", action="store_true", help="pages only")
    parser.add_argument("--role", choices=["all", "pages", "programs"], default="all")
    parser.add_argument("--base", default="")
    parser.add_argument("--token", default="")
    options = parser.parse_args()
    roles = {"all": measure, "pages": pages, "programs": programs}
    asyncio.run(roles[options.role](options))


async def measure(options: argparse.Namespace) -> None:
    """Start all processes, wait, and print the results."""
    with tempfile.TemporaryDirectory() as folder:
        server = await asyncio.create_subprocess_exec(
            *(sys.executable, "-c", START, str(options.students), folder), stdout=PIPE
        )
        try:
            base, token = await _address(server)
            common = ("--students", options.students, "--seconds", options.seconds)
            parts = ["pages"] if options.no_programs else ["pages", "programs"]
            clients = [
                await _part(role, *common, "--base", base, "--token", token) for role in parts
            ]
            await asyncio.sleep(SETTLE)
            begun, cpu = monotonic(), _cpu(server.pid)
            await asyncio.sleep(options.seconds)
            share = 100 * (_cpu(server.pid) - cpu) / (monotonic() - begun)
            outputs = [(await client.communicate())[0].decode() for client in clients]
        finally:
            server.terminate()
            await server.wait()
    print("".join(outputs), end="")
    print(f"the class needs {share:.0f} % of a core (bar {BAR_CPU:.0f} %)")


START = """
import asyncio, sys
from pathlib import Path
from pioneer3.web.classroom.live import ClassOptions, class_live
def tell(line): print(line, flush=True)
asyncio.run(class_live(ClassOptions(students=int(sys.argv[1]), folder=Path(sys.argv[2]),
    sim_port=0, web_port=0, show_tokens=True), tell))
"""


async def _part(role: str, *arguments: object) -> Process:
    words = map(str, ("--role", role, *arguments))
    return await asyncio.create_subprocess_exec(
        sys.executable, "-m", "benchmarks.class_load", *words, stdout=PIPE
    )


async def _address(server: Process) -> tuple[str, str]:
    """Return the address of the page and the token, once all is up."""
    assert server.stdout is not None
    found = ("", "")
    while line := (await server.stdout.readline()).decode():
        if match := re.search(r"http://localhost:(\d+)/join#([\w-]+)", line):
            found = f"http://127.0.0.1:{match[1]}", match[2]
        if line.startswith("Runs are handed in"):
            return found
    raise SystemExit("the class did not start")


def _cpu(process: int) -> float:
    """Return the time that a process has computed [s]."""
    fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / TICKS


def _join(options: argparse.Namespace, number: int) -> str:
    """Let a student join; return the cookie."""
    body = json.dumps({"token": options.token, "name": f"Student {number}"}).encode()
    request = Request(f"{options.base}/api/class/join", body, JSON)
    with urlopen(request) as answer:
        return str(answer.headers["Set-Cookie"]).partition(";")[0]


async def pages(options: argparse.Namespace) -> None:
    """Open the page of each student, and the teacher's; print the gaps between their frames."""
    gaps: list[list[float]] = [[] for _ in range(options.students)]
    until = monotonic() + SETTLE + options.seconds

    shared = Request(f"{options.base}/api/class/shared", b'{"shared": true}', JSON, method="PUT")
    await asyncio.to_thread(urlopen, shared)  # all are at this computer

    async def page(number: int) -> None:
        cookie = await asyncio.to_thread(_join, options, number)
        url = f"{options.base.replace('http', 'ws')}/ws"
        async with connect(url, additional_headers={"Cookie": cookie}, max_size=None) as socket:
            last, pinged = 0.0, monotonic()
            async for text in socket:
                now = monotonic()
                if now > until:
                    return
                if now - pinged > 1.0:
                    pinged = now
                    await socket.send('{"type":"ping","t":1}')
                if str(text).startswith('{"type":"robots"'):
                    if last and now > until - options.seconds:
                        gaps[number].append(1000 * (now - last))
                    last = now

    async def teacher() -> None:
        frames = 0
        url = f"{options.base.replace('http', 'ws')}/ws?view=class"
        async with connect(url, max_size=None) as socket:
            async for text in socket:
                frames += str(text).startswith('{"type":"class_robots"')
                if monotonic() > until:
                    break
        rate = frames / (SETTLE + options.seconds)
        print(f"the teacher's page: {rate:.1f} frames a second", flush=True)

    await asyncio.gather(teacher(), *map(page, range(options.students)))
    all_ = np.concatenate([np.array(each) for each in gaps])
    rate = len(all_) / options.seconds / options.students
    p50, p99 = np.percentile(all_, [50, 99])
    print(
        f"{options.students} students' pages: {rate:.1f} frames a second, gap p50 {p50:.0f} ms, "
        f"p99 {p99:.0f} ms (bar {BAR_GAP:.0f} ms), longest {all_.max():.0f} ms"
    )


async def programs(options: argparse.Namespace) -> None:
    """Drive each robot by a program of its own; print the sessions that they lost."""
    with urlopen(f"{options.base}/api/class") as answer:
        urls = [seat["url"] for seat in json.loads(answer.read())["seats"]]
    until = monotonic() + SETTLE + options.seconds
    lost = refused = 0

    async def program(url: str) -> None:
        nonlocal lost, refused
        async with connect_async(url) as robot:
            while monotonic() < until:
                try:
                    robot.drive(0.15, 0.5)
                except (LinkError, MotionError):
                    refused += 1
                    with suppress(LinkError, MotionError):
                        robot.drive(0.0)
                status = robot.supervisor.status.latest
                lost += status is not None and status.connection is Connection.LOST
                await asyncio.sleep(0.1)

    await asyncio.gather(*map(program, urls))
    print(f"{len(urls)} programs: {lost} lost moments, {refused} refused commands", flush=True)


if __name__ == "__main__":
    main()
