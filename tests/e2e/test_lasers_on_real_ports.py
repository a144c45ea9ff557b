"""Lasers on real sockets and pseudo terminals, by the driver and by `pioneer3 laser`."""

import asyncio
import json
import re
import signal
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import pytest

from pioneer3.doctor.lasers import laser_at
from pioneer3.models.lasers import LaserProtocol
from pioneer3.navigation.connect import connect_async
from pioneer3.sim.server.laser import SimulatedLaser
from pioneer3.sim.server.running import SimulatedRobot
from pioneer3.sim.server.start import simulator
from pioneer3.sim.worldfile import parse_equipment
from pioneer3.sim.worldfile.arguments import WorldOverrides
from tests.e2e.processes import free_port, pioneer3, running, until

pytestmark = pytest.mark.realtime


@asynccontextmanager
async def simulated(name: str) -> AsyncIterator[tuple[SimulatedRobot, SimulatedLaser]]:
    """Simulate a robot with this laser while the block lasts."""
    overrides = WorldOverrides(equipment=parse_equipment(f"laser={name}"), seed=1)
    async with simulator(map_name="office", port=0, overrides=overrides) as simulation:
        robot = simulation.robots[0]
        assert robot.laser is not None
        yield robot, robot.laser


@pytest.mark.parametrize(
    ("name", "terminal"),
    [
        ("utm-30lx", False),
        ("utm-30lx", True),
        ("lms-200", True),
        ("tim551", False),
    ],
)
async def test_a_robot_and_its_laser_scan(name: str, *, terminal: bool) -> None:
    async with simulated(name) as (robot, laser):
        port = laser.pty if terminal else laser.url
        assert port is not None
        assert laser.quiet
        async with connect_async(robot.url, lasers=[port]) as driver:
            scan = await driver.laser.reading()
            assert len(scan.ranges) > 100
            assert not laser.quiet
            assert driver.laser.lost is None
            laser.unplug()
            await until(lambda: driver.laser.lost)
            laser.plug_in()
            await until(lambda: driver.laser.lost is None)
        if not terminal:  # on a serial line a laser goes on, whoever listens
            await until(lambda: laser.quiet)


async def test_the_doctor_finds_out_the_protocol() -> None:
    async with simulated("urg-04lx") as (_, laser):
        assert laser.pty is not None
        found = await laser_at(laser.pty)
        assert found is not None
        assert found.protocol is LaserProtocol.SCIP
    assert await laser_at(f"tcp://127.0.0.1:{free_port()}") is None
    assert await laser_at("/dev/ttyNothing") is None


async def test_json_is_the_identity_and_then_a_line_for_each_scan() -> None:
    async with simulated("utm-30lx") as (_, laser):
        arguments = ("laser", laser.url, "--json", "--seconds", "1", "--laser-mask=-135:-90")
        code, out, err = await pioneer3(*arguments)
    assert (code, err) == (0, "")
    first, *lines = map(json.loads, out.splitlines())
    assert first["url"].startswith("tcp://")
    assert first["identity"]["product"] == "SOKUIKI Sensor UTM-30LX"
    sequences = [line["scan"]["sequence"] for line in lines]
    assert len(sequences) > 1  # 40 in a second, where no other program computes
    assert sequences == sorted(set(sequences))
    for line in lines:
        scan, closest = line["scan"], line["closest"]
        assert len(scan["ranges"]) == len(scan["angles"]) == 1081
        assert scan["ranges"][0] is None  # masked
        known = [metres for metres in scan["ranges"] if metres is not None]
        assert closest["range"] == min(known) > 0.02


async def test_without_a_terminal_there_is_a_line_each_second() -> None:
    async with simulated("tim551") as (_, laser), running("laser", laser.url) as command:
        assert await command.line() == f"laser at {laser.url}"
        told = {}
        while "scans/s" not in (line := await command.line()):
            name, _, value = line.partition("  ")
            told[name] = value.strip()
        assert told["vendor"] == "SICK"
        assert re.search(r"1[3-7] scans/s", await command.line())
        laser.unplug()
        line = ""
        while not line.startswith("LOST: "):
            line = await command.line()
        assert laser.url in line
        code, _ = await command.end(signal.SIGINT)
        assert code != 0


async def test_the_serial_number_is_all_that_id_prints() -> None:
    async with simulated("utm-30lx") as (_, laser):
        assert laser.pty is not None
        code, out, _ = await pioneer3("laser", "id", laser.pty)
    assert code == 0
    assert re.fullmatch(r"\S+\n", out)


async def test_mask_learns_nothing_where_nothing_is_near() -> None:
    async with simulated("tim551") as (_, laser):
        arguments = ("laser", "mask", laser.url, "--seconds", "1")
        nothing = "Nothing is nearer than 0.3 m in every scan: no mask is needed.\n"
        assert (await pioneer3(*arguments))[:2] == (0, nothing)
        code, out, _ = await pioneer3(*arguments, "--nearer-than", "50m")
    assert code == 0
    assert re.fullmatch(r"--laser-mask=\S+\nmasked_deg = \[\[.*\n", out)


@pytest.mark.thorough
async def test_where_no_laser_answers_one_sentence_says_so() -> None:
    async def nobody(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        await reader.read()
        writer.close()

    listening = await asyncio.start_server(nobody, "127.0.0.1", 0)
    async with listening:
        url = f"tcp://127.0.0.1:{listening.sockets[0].getsockname()[1]}"
        code, _, said = await pioneer3("laser", "id", url)
    assert code == 3
    assert url in said


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("laser", "nowhere"), "names no port"),
        (("laser", "lms200@/dev/ttyUSB0"), "did you mean lms-200?"),
        (("laser", "/dev/a", "--laser-pose", "1,2"), "--laser-pose 1,2"),
        (("laser", "/dev/a", "--laser-mask", "1-2"), "--laser-mask 1-2"),
        (("move", "1m", "--laser-pose", "0,0,0"), "--laser-pose: 1 given, but lasers: 0"),
    ],
)
async def test_wrong_options_are_refused_in_a_sentence(
    arguments: tuple[str, ...], words: str
) -> None:
    code, _, said = await pioneer3(*arguments)
    assert code == 2
    assert words in " ".join(said.split())
