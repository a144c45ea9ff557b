"""`pioneer3` as people use it: exit codes, signals, and what is said when something is wrong."""

import asyncio
import os
import signal
import socket
import subprocess
import sys
import urllib.request
from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import asynccontextmanager
from pathlib import Path

import pytest
from websockets.asyncio.client import connect as connect_page

from pioneer3 import connect_async
from pioneer3.arcos.commands import Close, Enable, Sonar, Stop, Vel
from pioneer3.cli.main import execute
from pioneer3.sim.server.start import simulator
from tests.e2e.processes import (
    COMMAND,
    KILLED,
    PATIENCE,
    Command,
    environment,
    p3,
    running,
    until,
    words_of,
)
from tests.support import Wire

pytestmark = pytest.mark.realtime

SERIAL_NODE = "/dev/ttyS0"


Complaint = Callable[..., tuple[int, str]]


def one_line(code: int, stdout: str, stderr: str) -> tuple[int, str]:
    """Return the code and the one line on stderr of a command that failed."""
    assert stdout == ""
    lines = stderr.splitlines()
    assert len(lines) == 1, stderr
    assert lines[0].startswith("pioneer3: ")
    return code, lines[0].removeprefix("pioneer3: ")


@pytest.fixture
def complaint(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> Iterator[Complaint]:
    """Return a function that runs a command that fails, in this process."""
    for name in set(os.environ) - set(environment()):
        monkeypatch.delenv(name)
    with Path(os.devnull).open() as nothing:
        monkeypatch.setattr(sys, "stdin", nothing)
        yield lambda *arguments: one_line(execute(arguments), *capsys.readouterr())


@pytest.mark.parametrize("line", ["fly", "run --port /dev/none"])
def test_a_mistake_in_a_process_of_its_own(line: str, complaint: Complaint) -> None:
    ended = p3(*line.split())
    assert one_line(ended.returncode, ended.stdout, ended.stderr) == complaint(*line.split())


def closed_port() -> int:
    """Return a port on which nobody listens."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        port: int = server.getsockname()[1]
    return port


@pytest.mark.parametrize(
    ("line", "code", "clues"),
    [
        ("fly", 2, ['"fly"', "sim"]),
        ("sim --fly", 2, ["--fly"]),
        ("sim -p abc", 2, ["-p", "abc"]),
        ("sim -p 70000", 2, ["70000", "65535"]),
        ("sim -p -1", 2, ["-1", "0"]),
        ("run --sim-port 70000", 2, ["--sim-port", "65535"]),
        ("run --web-port -1", 2, ["--web-port", "0"]),
        ("run --max-speed fast", 2, ["--max-speed", "fast"]),
        ("run --sim-port 0 --web-port 0 --max-speed nan", 2, ["--max-speed", "nan"]),
        ("run --sim-port 0 --web-port 0 --max-speed -1", 2, ["--max-speed", "-1"]),
        ("sim -p 0 --map nowhere", 2, ["nowhere", "office"]),
        ("sim -p 0 --map ./none.map", 2, ["./none.map", "no such file"]),
        ("sim -p 0 --robot r2d2", 2, ["r2d2", "p3at-sh"]),
        ("sim -p 0 --robot none.toml", 2, ["none.toml", "No such file"]),
        ("run --port ftp://localhost", 2, ["ftp://localhost", "tcp://"]),
        ("run --port tcp://x.invalid:8101", 3, ["x.invalid", "no host"]),
        ("run --port /dev/none", 3, ["/dev/none", "no such port"]),
        ("drive", 2, ["terminal"]),
        ("drive --speed nan", 2, ["speed", "nan"]),
        ("drive --speed inf", 2, ["speed", "inf"]),
        ("drive --speed -0.3", 2, ["--speed", "positive"]),
        ("drive --turn-rate 0", 2, ["--turn-rate", "positive"]),
    ],
)
def test_a_mistake_is_told_in_one_line(
    line: str, code: int, clues: list[str], complaint: Complaint
) -> None:
    ended, told = complaint(*line.split())
    assert ended == code
    for clue in clues:
        assert clue in told


MALFORMED = {
    "lab.map": ("2D-Map\nNumLines: 1\nLINES\n1 2 3\n", ["lab.map:4: ", "LINES"]),
    "none.map": ("hello\n", ["none.map:1: ", "header"]),
    "bot.toml": ('name = "bot"\ncolour = "red"\n', ["bot.toml:2: ", "colour"]),
    "bad.toml": ("max_speed = \n", ["bad.toml:1: "]),
    "bot.p": ("ConfigVersion 2.0\nRobotLength long\n", ["bot.p:2: ", "RobotLength"]),
}


@pytest.mark.parametrize("name", [*MALFORMED])
def test_a_malformed_file_is_named_with_line_and_field(
    name: str, tmp_path: Path, complaint: Complaint
) -> None:
    text, clues = MALFORMED[name]
    path = tmp_path / name
    path.write_text(text)
    option = "--map" if path.suffix == ".map" else "--robot"
    code, told = complaint("sim", "-p", "0", option, str(path))
    assert code == 2
    for clue in clues:
        assert clue in told


@pytest.mark.parametrize("command", ["sim -p {}", "run --sim-port {}", "run --web-port {}"])
def test_a_port_in_use_is_told_with_the_option_that_helps(
    command: str, complaint: Complaint
) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        others = " --sim-port 0" if "--web-port" in command else ""
        code, told = complaint(*(command.format(port) + others).split())
    assert code == 1
    assert f"127.0.0.1:{port}: in use" in told


@pytest.mark.parametrize("command", ["run", "info"])
def test_a_closed_port_is_not_reachable(command: str, complaint: Complaint) -> None:
    port = closed_port()
    code, told = complaint(command, "--port", f"tcp://127.0.0.1:{port}")
    assert code == 3
    assert f"tcp://127.0.0.1:{port}: nobody listens there" in told


@pytest.mark.skipif(os.geteuid() == 0, reason="root may open everything")
@pytest.mark.skipif(
    not Path(SERIAL_NODE).exists() or os.access(SERIAL_NODE, os.R_OK), reason="no such port"
)
def test_a_port_that_is_not_ours_to_open_has_a_code_of_its_own(complaint: Complaint) -> None:
    code, told = complaint("run", "--port", SERIAL_NODE)
    assert code == 4
    assert SERIAL_NODE in told


VANISHING = """
import os, sys, time
from pioneer3 import connect
robot = connect(sys.argv[1])
while abs(robot.snapshot.odometry.twist.v) < 0.15:
    robot.drive(0.3)
    time.sleep(0.05)
os._exit(9)
"""


async def test_the_simulator_outlives_a_client_that_vanishes_while_driving() -> None:
    async with running("sim", "-p", "0") as sim:
        url = (await sim.line()).rpartition(" ")[2]
        client = await asyncio.create_subprocess_exec(sys.executable, "-c", VANISHING, url)
        async with asyncio.timeout(PATIENCE):
            assert await client.wait() == 9
        async with connect_async(url) as robot:
            await until(lambda: robot.snapshot and robot.snapshot.odometry.twist.is_zero)
        code, stderr = await sim.end(signal.SIGTERM)
        assert (code, stderr) == (143, "")


async def test_the_simulator_outlives_scanners_and_noise() -> None:
    async with running("sim", "-p", "0") as sim:
        url = (await sim.line()).rpartition(" ")[2]
        address = ("127.0.0.1", int(url.rpartition(":")[2]))
        for data in (b"", b"GET / HTTP/1.1\r\n\r\n", bytes(range(256)) * 8, b"\xfa\xfb\xff" * 99):
            with socket.create_connection(address) as stranger:
                stranger.sendall(data)
                reset = b"\1\0\0\0\0\0\0\0"  # close with RST
                stranger.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, reset)
        async with connect_async(url) as robot:
            assert robot.info.identity.model == "p3at-sh"
        code, stderr = await sim.end(signal.SIGTERM)
        assert (code, stderr) == (143, "")


INTERRUPTED = """
import os, sys
module, how = sys.argv[1:3]
del sys.argv[1:3]

class Interrupt:
    def __del__(self):
        os.kill(os.getpid(), 2)

def watch(event, arguments):
    if event == "import" and arguments[0] == module:
        if how == "destructor":
            Interrupt()
        else:
            os.kill(os.getpid(), 2)

sys.addaudithook(watch)
from pioneer3.__main__ import main
main()
"""
"""Starts a command that gets Ctrl-C while it imports a module, or in a destructor meanwhile."""


@pytest.mark.parametrize("how", ["import", "destructor"])
@pytest.mark.parametrize("module", ["pioneer3.cli.main", "cyclopts", "asyncio"])
def test_ctrl_c_while_a_command_starts_ends_it_quietly(module: str, how: str) -> None:
    start = (sys.executable, "-c", INTERRUPTED, module, how)
    ended = subprocess.run(
        [*start, "wander", "--port", "localhost:1"],
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        env=environment(),
        check=False,
    )
    assert (ended.returncode, ended.stdout, ended.stderr) == (130, "", "")


async def test_the_simulator_says_what_it_simulates_and_how_to_drive_it() -> None:
    async with running("sim", "-p", "0", "--robot", "p3dx-sh") as sim:
        first, second = await sim.line(), await sim.line()
        url = first.rpartition(" ")[2]
        assert first.startswith("SIMULATOR: Pioneer 3-DX (p3dx-sh) in office on tcp://127.0.0.1:")
        assert f"pioneer3 drive --port {url}" in second


async def page_of(command: Command) -> str:
    """Return the address of the page that `run` tells."""
    line = await command.line()
    return next(word for word in line.split() if word.startswith("http://"))


def fetch(address: str) -> str:
    """Return the page."""
    with urllib.request.urlopen(address, timeout=PATIENCE) as answer:
        return str(answer.read().decode())


async def test_run_tells_what_it_is_connected_to_and_serves_the_page() -> None:
    async with running("run", "--sim-port", "0", "--web-port", "0") as command:
        first = await command.line()
        assert first.startswith("Connected to a SIMULATOR: ")
        assert "Pioneer 3-AT (p3at-sh), on tcp://127.0.0.1:" in first
        address = await page_of(command)
        assert "<title>" in await asyncio.to_thread(fetch, address)
        assert (await command.end(signal.SIGINT))[0] == 130
        with pytest.raises(OSError, match="refused"):
            await asyncio.to_thread(fetch, address)


async def test_run_without_a_robot_leaves_nothing_running() -> None:
    port = closed_port()
    async with running("run", "--port", f"tcp://127.0.0.1:{port}", "--web-port", "0") as command:
        code, stderr = await command.end()
        assert code == 3
        assert len(stderr.splitlines()) == 1


@asynccontextmanager
async def overheard(url: str) -> AsyncIterator[tuple[str, Wire]]:
    """Stand between a host and the robot at `url`; yield where, and what the host says."""
    wire = Wire()
    clock = asyncio.get_running_loop().time
    host, port = url.removeprefix("tcp://").split(":")

    async def pass_on(
        reader: asyncio.StreamReader, writer: asyncio.StreamWriter, wire: Wire
    ) -> None:
        while data := await reader.read(4096):
            wire.chunks.append((clock(), data))
            writer.write(data)
        writer.close()

    async def join(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        robot_reader, robot_writer = await asyncio.open_connection(host, port)
        await asyncio.gather(
            pass_on(reader, robot_writer, wire),
            pass_on(robot_reader, writer, Wire()),
            return_exceptions=True,
        )

    async with await asyncio.start_server(join, "127.0.0.1", 0) as server:
        yield f"tcp://127.0.0.1:{server.sockets[0].getsockname()[1]}", wire


@pytest.mark.parametrize(
    ("number", "code"),
    [
        (signal.SIGTERM, 143),
        (signal.SIGINT, 130),
        pytest.param(signal.SIGHUP, 129, marks=pytest.mark.thorough),
        pytest.param(signal.SIGQUIT, KILLED - signal.SIGQUIT, marks=pytest.mark.thorough),
    ],
)
async def test_run_that_is_ended_while_driving_says_goodbye_to_the_robot(
    number: signal.Signals, code: int
) -> None:
    async with simulator(port=0) as simulated, overheard(simulated.url) as (url, wire):
        body = simulated.body
        async with running("run", "--port", url, "--web-port", "0") as command:
            assert "SIMULATOR" in await command.line()
            address = await page_of(command)
            async with connect_page(f"{address.replace('http', 'ws')}/ws") as page:

                async def hold() -> None:
                    while True:
                        await page.send('{"type":"drive","v":0.3,"w":0}')
                        await asyncio.sleep(0.05)

                holding = asyncio.ensure_future(hold())
                await until(lambda: body.speeds[0] > 0.2)
                assert await command.end(number) == (code, "")
                await asyncio.wait([holding])
                assert holding.exception() is not None  # the page has been closed
        await until(lambda: body.speeds[0] == 0.0)
        assert not body.drive.powered
        assert any(isinstance(command, Vel) and command.speed > 0 for command in wire.commands)
        assert wire.commands[-4:] == [Stop(), Enable(on=False), Sonar(on=False), Close()]


@pytest.mark.parametrize(
    "line", ["--help", "--version", "sim -p 0", "run --sim-port 0 --web-port 0"]
)
def test_output_that_nobody_reads_is_no_traceback(line: str) -> None:
    ours, theirs = os.pipe()
    os.close(ours)
    try:
        ended = subprocess.run(
            words_of(*line.split()),
            stdin=subprocess.DEVNULL,
            stdout=theirs,
            stderr=subprocess.PIPE,
            text=True,
            timeout=PATIENCE,
            env=environment(),
            check=False,
        )
    finally:
        os.close(theirs)
    assert ended.stderr == ""
    assert ended.returncode in {0, 1}


def test_help_fits_and_names_every_command() -> None:
    ended = p3("--help")
    assert (ended.returncode, ended.stderr) == (0, "")
    for command in ("run", "sim", "drive", "info", "monitor", "doctor", "find-port"):
        assert f" {command} " in ended.stdout


def test_standard_input_that_is_closed_is_no_terminal() -> None:
    ended = subprocess.run(
        ["sh", "-c", '"$@" <&-', "sh", *COMMAND, "drive"],
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        env=environment(),
        check=False,
    )
    assert ended.returncode == 2
    assert ended.stderr.startswith("pioneer3: driving with the keyboard needs a terminal")
