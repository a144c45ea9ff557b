"""A robot whose type is not known: it is read, and nothing drives it. Virtual time."""

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager, suppress
from pathlib import Path

import pytest

from pioneer3.arcos import commands
from pioneer3.arcos.commands import moves
from pioneer3.behaviors.action import Stack
from pioneer3.behaviors.modes import follow, goto, wander
from pioneer3.doctor.diagnose import diagnose, examine, exit_code
from pioneer3.doctor.facts import FAILED, LinkFacts
from pioneer3.errors import CommandError, MotionError
from pioneer3.fleet.inventory import read_fleet
from pioneer3.fleet.reach import given_model
from pioneer3.fleet.stop import stop_all
from pioneer3.links import Link
from pioneer3.models import Fallback, GivenModel, load_model
from pioneer3.navigation.connect import connect_async
from pioneer3.ros.node.node import RobotNode
from pioneer3.ros.node.parameter_reading import read_parameters
from pioneer3.runtime.robot import Robot
from pioneer3.sim.server.start import simulator
from pioneer3.tasks import running
from pioneer3.web.app import make_app
from pioneer3.web.page import Page
from pioneer3.web.scene import RobotScene
from tests.e2e.processes import pioneer3
from tests.fleets import ESCAPE, UP, driven, simulated
from tests.support import SimulatedRobot
from tests.unit.ros.fakes import FakeMiddleware
from tests.unit.web.asking import Script
from tests.unit.web.browser import Browser

FILE = """
ConfigVersion 2.0
Section General settings
Class Pioneer
Subclass p9at
RobotRadius 500
RobotWidth 505
RobotLength 626
MaxRVelocity 500
MaxVelocity 2200
Section Conversion factors
AngleConvFactor 0.00153
DistConvFactor 1.32
VelConvFactor 1.0
RangeConvFactor 0.268
DiffConvFactor 0.0034
Vel2Divisor 20
"""
"""A type that nobody knows: its millimetres are 1.32 of ours, and its echoes come in 0.268 mm."""
STANDS = (
    commands.Enable(on=False),
    commands.Vel(speed=0.0),
    commands.RVel(rate=0.0),
)


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "p9at.p"
    path.write_text(FILE)
    return path


@asynccontextmanager
async def connected(
    file: Path, model: GivenModel = None
) -> AsyncIterator[tuple[SimulatedRobot, Robot]]:
    """Connect to a robot of this type."""
    async with (
        SimulatedRobot(model=str(file)) as sim,
        connect_async(sim.open, model=model) as robot,
    ):
        yield sim, robot


def nothing_moved(sim: SimulatedRobot) -> bool:
    """Whether no command was sent that would move such a robot, or switch its motors on."""
    told = [command for wire in sim.wires for command in wire.commands]
    return not [each for each in told if moves(each) and each not in STANDS]


async def raw(robot: Robot) -> None:
    robot.send_unsafe(commands.Vel(speed=0.2))


async def power(robot: Robot) -> None:
    await robot.motors(on=True)


async def drive(robot: Robot) -> None:
    robot.drive(0.2)


@pytest.mark.parametrize(
    "way",
    [
        drive,
        raw,
        power,
        lambda robot: robot.move(1.0),
        lambda robot: robot.turn(1.0),
        lambda robot: robot.goto(1.0, 0.0),
    ],
    ids=["drive", "raw", "power", "move", "turn", "goto"],
)
async def test_a_program_is_refused(file: Path, way: Callable[[Robot], Awaitable[None]]) -> None:
    async with connected(file) as (sim, robot):
        with pytest.raises((MotionError, CommandError), match=r"'p9at'.*not known.*--model FILE.p"):
            await way(robot)
        await asyncio.sleep(1.0)
        assert "--model FILE.p" in str(robot.why_not_moving())
    assert nothing_moved(sim)


async def test_a_raw_command_from_before_its_type_was_told_is_not_sent(file: Path) -> None:
    async with SimulatedRobot() as known, SimulatedRobot(model=str(file)) as unknown:
        known.latency = unknown.latency = 0.05
        accepted = 0

        async def open_link() -> Link:
            return await (known if known.plugged else unknown).open()

        async with connect_async(open_link) as robot:
            await known.unplug()
            while robot.supervisor.pilot.refusal is None:
                with suppress(CommandError):
                    robot.send_unsafe(commands.Vel(speed=0.2))
                    accepted += bool(unknown.wires)
                await asyncio.sleep(0.01)
            await asyncio.sleep(1.0)
        assert accepted
        assert nothing_moved(unknown)


@pytest.mark.parametrize("mode", [wander(), follow(), goto(1.0, 0.0)], ids=lambda m: m.name)
async def test_no_mode_drives(file: Path, mode: Stack) -> None:
    async with connected(file) as (sim, robot):
        with pytest.raises(MotionError, match="'p9at'"):
            await robot.run(mode)
    assert nothing_moved(sim)


async def test_it_is_read_and_stopped(file: Path) -> None:
    async with connected(file) as (sim, robot):
        assert robot.snapshot is not None
        assert robot.snapshot.battery.voltage > 10
        assert "unknown robot type p9at" in robot.info.model.title
        robot.stop()
        robot.emergency_stop()
        await asyncio.sleep(1.0)
        assert {commands.Stop(), commands.EStop()} <= set(sim.wires[0].commands)


@pytest.mark.parametrize("given", [str, Path, load_model, Fallback], ids=lambda kind: kind.__name__)
async def test_with_its_model_a_metre_is_a_metre(
    file: Path, given: Callable[[object], GivenModel]
) -> None:
    async with connected(file, given(file)) as (sim, robot):
        await robot.move(1.0)
        assert sim.body.robot_in_world.x == pytest.approx(1.0, abs=0.01)
        assert robot.snapshot is not None
        assert robot.snapshot.odometry.robot_in_odom.x == pytest.approx(1.0, abs=0.01)


async def test_a_fallback_does_not_count_where_the_robot_is_known(file: Path) -> None:
    async with SimulatedRobot(model="p3at-sh") as sim:
        for given, name in ((Fallback(file), "p3at-sh"), (str(file), "p9at")):
            async with connect_async(sim.open, model=given) as robot:
                assert robot.info.model.name == name


async def test_a_fleets_file_counts_always_and_its_name_where_nothing_is_known(
    file: Path,
) -> None:
    path = file.with_name("fleet.toml")
    rows = '[[robot]]\nname = "a"\naddress = "127.0.0.1"\nport = "tcp://127.0.0.1:8101"\n{}\n'
    for line, wanted in (
        ("", None),
        ('model = "p3dx-sh"', Fallback("p3dx-sh")),
        ('model = "p9at.p"', str(file)),
    ):
        path.write_text(rows.format(line))
        fleet = read_fleet(path)
        assert given_model(fleet, fleet.robots[0]) == wanted


async def test_the_doctor_says_so_and_what_helps(file: Path) -> None:
    async with SimulatedRobot(model=str(file)) as sim:
        for model, code in ((None, FAILED), (file, 0)):
            found = diagnose(await examine(await sim.open(), 1.0, LinkFacts(url="memory:"), model))
            assert exit_code(found) == code
            (kind,) = (each for each in found if each.check == "type")
            assert ("--model FILE.p" in (kind.advice or "")) is (model is None)


async def test_neither_page_nor_script_drives_it(file: Path) -> None:
    async with connected(file) as (sim, robot):
        page = Page()
        async with (
            page.hosting(robot, RobotScene()),
            running(page.run()),
            Browser(make_app(page)) as ann,
        ):
            ann.say("drive", v=1.0, w=0.0, source="keys")
            ann.say("start_mode", mode={"mode": "wander"})
            ann.say("motors", on=True)
            await ann.stay(1.0)
            assert "--model FILE.p" in ann.snapshot["why"]
            assert ann.snapshot["mode"] is None
            script = Script(make_app(page))
            for method, path, told in (
                ("POST", "drive", {"v": 0.2}),
                ("PUT", "motors", {"on": True}),
                ("PUT", "mode", {"mode": "wander"}),
                ("POST", "goto", {"x": 1.0, "y": 0.0}),
            ):
                answer = await script.ask(method, f"/api/robots/1/{path}", told)
                assert "p9at" in str(answer.json), path
            await asyncio.sleep(1.0)
    assert nothing_moved(sim)


async def test_no_message_of_ros_drives_it(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    middleware = FakeMiddleware()
    monkeypatch.setattr(asyncio, "to_thread", middleware.at_once)
    async with connected(file) as (sim, robot):
        ready = asyncio.Event()
        node = RobotNode(robot, read_parameters({}), middleware)
        async with running(node.run(ready.set)):
            await ready.wait()
            for _ in range(10):
                middleware.drive("~cmd_vel", 0.3)
                await asyncio.sleep(0.1)
            assert any("--model FILE.p" in warning for warning in middleware.warnings)
            service = next(name for name in middleware.services if "enable" in name)
            answer = await middleware.call(service)
            assert not answer.success
            assert "--model FILE.p" in answer.message
    assert nothing_moved(sim)


async def test_a_fleet_stops_it_and_does_not_drive_it(file: Path) -> None:
    async with simulated(1, lambda: SimulatedRobot(model=str(file))) as here:
        async with driven(here) as fleet:
            fleet.press(UP)
            await asyncio.sleep(1.0)
            fleet.press(ESCAPE)
        (stopped,) = await stop_all(here.robots, here.connect)
        assert stopped.ok
        assert nothing_moved(fleet.sim(1))


@pytest.mark.realtime
async def test_commands_refuse_it_unless_they_are_told_what_it_is(file: Path) -> None:
    fleet = file.with_name("fleet.toml")
    async with simulator(port=0, robot=str(file)) as here:
        number = here.robots[0].url.rpartition(":")[2]
        fleet.write_text(
            f'[[robot]]\nname = "a"\naddress = "127.0.0.1"\nmodel = "p9at.p"\n'
            f'port = "tcp://127.0.0.1:{number}"\n'
        )
        begin = here.body.robot_in_world
        code, _, err = await pioneer3("move", "0.3", "--port", here.url)
        assert code == 1
        assert "--model FILE.p" in err
        moved = begin.inverse() @ here.body.robot_in_world
        assert (moved.x, moved.y, moved.theta) == pytest.approx((0, 0, 0), abs=1e-9)
        for model in (
            ("--port", here.url, "--model", str(file)),
            ("--robot", "a", "--fleet", str(fleet)),
        ):
            before = here.body.robot_in_world
            code, _, err = await pioneer3("move", "0.3", *model)
            assert (code, err) == (0, "")
            assert (before.inverse() @ here.body.robot_in_world).x == pytest.approx(0.3, abs=0.02)
