"""`pioneer3 sim` as people and scripts start it: many robots, worlds, ports, MobileSim's flags."""

import asyncio
import re
import signal
from contextlib import aclosing
from dataclasses import dataclass
from pathlib import Path

import pytest

from pioneer3 import Robot, connect_async
from pioneer3.robot.devices import Acts
from tests.e2e.processes import Command, environment, pioneer3, running, until, words_of

pytestmark = pytest.mark.realtime

LINE = re.compile(
    r"SIMULATOR: (?:(?P<name>\S+)  +)?(?P<title>[\w -]+) \((?P<model>\S+)\) in (?P<map>\S+) on "
    r"(?:(?P<pty>/dev/\S+) and )?(?P<url>tcp://\S+)"
)
PARAMETERS = """; a robot of our own
Subclass ours
RobotRadius 250
RobotWidth 425
RobotLength 500
MaxVelocity 2200
MaxRVelocity 500
AngleConvFactor 0.00153
DistConvFactor 1.0
DiffConvFactor 0.0056
SonarNum 2
SonarUnit 0 147 136 90
SonarUnit 1 193 119 50
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Told:
    """What the command says of a robot."""

    name: str | None
    title: str
    model: str
    map: str
    pty: str | None
    url: str


async def robots(sim: Command, count: int) -> list[Told]:
    """Return what the command says of each of its robots."""
    found = []
    for _ in range(count):
        line = await sim.line()
        match = LINE.fullmatch(line)
        assert match, line
        found.append(Told(**match.groupdict()))
    while (line := await sim.line()).startswith("CAMERA:"):  # of robots with mass
        pass
    assert "pioneer3 drive --port " in line
    return found


def is_driven(robot: Robot) -> bool:
    """Drive on; return whether it moves."""
    robot.drive(0.2, 0.0)
    return robot.snapshot is not None and robot.snapshot.odometry.twist.v > 0.05


async def test_many_robots_have_a_line_and_a_port_each() -> None:
    async with running("sim", "-p", "0", "-r", "p3at", "-r", "p3dx:bob", "-r", "p3at") as sim:
        told = await robots(sim, 3)
        assert [each.name for each in told] == ["p3at", "bob", "p3at-2"]
        assert [each.model for each in told] == ["p3at", "p3dx", "p3at"]
        assert len({each.url for each in told}) == 3
        for each in told:
            async with connect_async(each.url) as robot:
                assert robot.info.identity.model == each.model
                assert robot.info.identity.name == "MobileSim"
        assert await sim.end(signal.SIGTERM) == (143, "")


async def test_one_robot_without_a_name_is_told_without_one() -> None:
    async with running("sim", "-p", "0", "-r", "p3at") as sim:
        (told,) = await robots(sim, 1)
        assert (told.name, told.title, told.model) == (None, "Pioneer 3-AT", "p3at")
        assert told.map == "office"


async def test_the_lab_that_ships_has_two_robots() -> None:
    async with running("sim", "-p", "0", "-m", "lab") as sim:
        alice, bob = await robots(sim, 2)
        assert (alice.name, bob.name, bob.map) == ("alice", "bob", "lab")
        async with connect_async(bob.url) as robot:
            assert robot.info.identity.model == "p3at-sh"


async def test_a_parameter_file_of_aria_is_a_model(tmp_path: Path) -> None:
    path = tmp_path / "ours.p"
    path.write_text(PARAMETERS)
    async with running("sim", "-p", "0", "-r", f"{path}:eve") as sim:
        (told,) = await robots(sim, 1)
        assert told.model == "ours"
        async with connect_async(told.url) as robot:
            await until(lambda: robot.snapshot and len(robot.snapshot.sonar.ranges) == 2)


async def test_a_serial_port_is_told_and_leads_to_the_robot() -> None:
    async with running("sim", "-p", "0", "--pty", "-r", "p3dx-sh") as sim:
        (told,) = await robots(sim, 1)
        async with connect_async(f"serial:{told.pty}") as robot:
            assert robot.info.identity.model == "p3dx-sh"
        assert await sim.end(signal.SIGTERM) == (143, "")


async def test_a_factory_serves_several_clients_at_one_port() -> None:
    async with running("sim", "-p", "0", "-R", "p3dx") as sim:
        line = await sim.line()
        assert line.startswith("SIMULATOR: a robot for every client in office on tcp://127.0.0.1:")
        url = line.rpartition(" ")[2]
        async with connect_async(url) as one, connect_async(url) as two:
            assert one.info.identity.model == two.info.identity.model == "p3dx"
        code, stderr = await sim.end(signal.SIGTERM)
        assert code == 143
        assert [line for line in stderr.splitlines() if not line.startswith("Compiling")] == []


async def test_it_needs_no_display_and_no_terminal() -> None:
    blind = {k: v for k, v in environment().items() if k not in {"DISPLAY", "WAYLAND_DISPLAY"}}
    process = await asyncio.create_subprocess_exec(
        *words_of("sim", "-p", "0", "--no-gui", "--noninteractive"),
        stdin=asyncio.subprocess.DEVNULL,
        stdout=asyncio.subprocess.PIPE,
        stderr=asyncio.subprocess.PIPE,
        env=blind | {"TERM": "dumb"},
        start_new_session=True,
    )
    sim = Command(process)
    try:
        (told,) = await robots(sim, 1)
        async with connect_async(told.url) as robot:
            assert robot.info.identity.model == "p3at-sh"
        assert await sim.end(signal.SIGTERM) == (143, "")
    finally:
        if process.returncode is None:
            process.kill()


@pytest.mark.parametrize(
    ("number", "code"),
    [
        (signal.SIGTERM, 143),
        (signal.SIGINT, 130),
        pytest.param(signal.SIGHUP, 129, marks=pytest.mark.thorough),
    ],
)
async def test_a_signal_ends_it_while_robots_drive(number: signal.Signals, code: int) -> None:
    async with running("sim", "-p", "0", "-m", "lab", "--pty") as sim:
        alice, bob = await robots(sim, 2)
        async with connect_async(alice.url) as one, connect_async(f"serial:{bob.pty}"):
            await until(lambda: is_driven(one))
            assert await sim.end(number) == (code, "")
        await until(lambda: not Path(bob.pty or "").exists())


async def test_beyond_loopback_it_warns_and_tells_an_address_that_others_can_use() -> None:
    async with running("sim", "-p", "0", "--bind-to-address", "0.0.0.0", "--no-announce") as sim:
        (told,) = await robots(sim, 1)
        assert "0.0.0.0" not in told.url
        async with connect_async(told.url) as robot:
            assert robot.info.identity.name == "MobileSim"
        _, stderr = await sim.end(signal.SIGTERM)
        assert stderr.startswith("WARNING: there is no password: whoever reaches 0.0.0.0 can drive")


async def test_flags_of_mobilesim_that_change_nothing_say_so() -> None:
    flags = ("--update-interval", "50", "--resolution", "20", "--no-error", "--nomap")
    async with running("sim", "-p", "0", *flags) as sim:
        (told,) = await robots(sim, 1)
        assert told.map == "empty"
        _, stderr = await sim.end(signal.SIGTERM)
        assert [line.split()[1] for line in stderr.splitlines()] == [
            "--update-interval",
            "--resolution",
        ]


async def test_a_start_in_a_wall_is_pointed_out() -> None:
    async with running("sim", "-p", "0", "--start", "0,5000,0", "-r", "p3dx:bob") as sim:
        await robots(sim, 1)
        _, stderr = await sim.end(signal.SIGTERM)
        assert stderr.startswith("WARNING: bob begins in a wall or an obstacle and cannot move")


@pytest.mark.parametrize(
    ("line", "clues"),
    [
        ("-r r2d2", ["'r2d2'", "p3at-sh"]),
        ("-R r2d2", ["'r2d2'", "p3at-sh"]),
        ("-r p3at:bob -r p3dx:bob", ["bob", "2 robots have this name"]),
        ("--start random --start home", ["--start", "2 given, but robots: 1"]),
        ("-m labb", ["'labb'", "lab"]),
        ("--nomap -r amigo-sh --start 1,2", ["--start '1,2'", "3000,3100,90"]),
        ("--fit camera=canon", ["--fit: camera", "vcc4"]),
        ("--fault drop=2", ["drop", "from 0 to 1"]),
    ],
)
async def test_a_mistake_is_told_in_one_line(line: str, clues: list[str]) -> None:
    code, out, err = await pioneer3("sim", "-p", "0", *line.split())
    assert (code, out) == (2, "")
    (told,) = err.splitlines()
    for clue in clues:
        assert clue in told


async def test_a_crowd_without_room_is_refused(tmp_path: Path) -> None:
    world = tmp_path / "cell.toml"
    world.write_text(
        "[world]\n[[wall]]\npoints = [[0, 0], [2, 0], [2, 2], [0, 2]]\nclosed = true\n"
        + "[[robot]]\nstart = 'random'\n" * 5
    )
    code, _, err = await pioneer3("sim", "-p", "0", "-m", str(world))
    assert code == 2
    assert "no room left for a p3at-sh" in err


async def test_a_colour_tracker_for_each_robot_is_told_and_answers() -> None:
    two = ("-r", "p3dx:a", "-r", "p3dx:b")
    async with running("sim", "-p", "0", "--acts", "0", *two) as sim:
        for _ in range(2):
            assert LINE.fullmatch(await sim.line())
        urls = []
        for name in "ab":
            line = await sim.line()
            assert line.startswith(f"ACTS: what {name} sees on tcp://127.0.0.1:")
            urls.append(line.rpartition(" ")[2])
        for url in urls:
            async with aclosing(Acts(url).pictures()) as pictures:
                assert len((await anext(pictures)).channels) == 32
