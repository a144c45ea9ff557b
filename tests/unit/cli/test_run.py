"""`pioneer3 run`: options, and what is told. The rest is in `tests/e2e/test_commands.py`."""

import asyncio
import contextlib
import re
import socket
from collections.abc import AsyncIterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from pioneer3 import ConfigError, PortBusyError, PortNotFoundError
from pioneer3.cli.main import app, execute
from pioneer3.cli.run import run
from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.sim.equipment import EquipmentOptions
from pioneer3.sim.server.start import simulator
from pioneer3.sim.worldfile import RobotSpec
from pioneer3.sim.worldfile.arguments import WorldOverrides
from pioneer3.web import live as live_module
from pioneer3.web.access import hosts
from pioneer3.web.access.sessions import LoginSession, Role, SessionKind
from pioneer3.web.hosting import ConnectTarget, hosted
from pioneer3.web.live import RunOptions, live
from pioneer3.web.page import Page
from pioneer3.web.scene import RobotScene
from pioneer3.web.server import serve
from tests.support import until

PATIENCE = 20.0
TWO = (RobotSpec(model="p3at"), RobotSpec(model="p3dx"))
R2D2 = (RobotSpec(model="r2d2"),)
NOBODY = ConnectTarget(url="tcp://127.0.0.1:1")


def given(
    line: str, monkeypatch: pytest.MonkeyPatch, environment: dict[str, str] | None = None
) -> RunOptions:
    """Return the options that a command line amounts to."""
    monkeypatch.delenv("PIONEER3_PORT", raising=False)
    monkeypatch.delenv("PIONEER3_BAUD", raising=False)
    for name, value in (environment or {}).items():
        monkeypatch.setenv(name, value)
    seen: list[RunOptions] = []

    async def note(options: RunOptions, tell: object) -> int:
        seen.append(options)
        return 0

    monkeypatch.setattr(live_module, "live", note)
    assert app(line.split(), exit_on_error=False, result_action="return_value") == 0
    return seen[0]


def urls(options: RunOptions) -> tuple[str, ...]:
    return tuple(robot.url for robot in options.remote)


def test_without_options_it_simulates_and_only_this_machine_may_drive(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    options = given("run", monkeypatch)
    assert (options.remote, options.robots) == ((), ())
    assert options.host == "127.0.0.1"
    assert (options.sim_port, options.web_port) == (8101, 8080)


def test_every_option_arrives(monkeypatch: pytest.MonkeyPatch) -> None:
    line = (
        "run -p tcp://r:1 -b 38400 -m lab.map -r p3dx --sim-port 1 --web-port 2 --host 0.0.0.0 "
        "--max-speed 0.4"
    )
    options = given(line, monkeypatch)
    assert [(robot.url, robot.model) for robot in options.remote] == [("tcp://r:1", "p3dx")]
    assert (options.map_name, options.baud) == ("lab.map", 38400)
    assert (options.sim_port, options.web_port, options.host) == (1, 2, "0.0.0.0")
    assert options.max_speed == 0.4


def test_the_simulated_world_may_be_chosen(monkeypatch: pytest.MonkeyPatch) -> None:
    line = "run -m lab --start random --fit compass --seed 7 --ideal"
    options = given(line, monkeypatch)
    assert options.map_name == "lab"
    assert options.ideal
    assert options.overrides == WorldOverrides(
        starts=("random",), equipment=EquipmentOptions(compass=True), seed=7
    )
    assert given("run", monkeypatch).overrides == WorldOverrides()


def test_robots_are_given_by_port_or_by_model(monkeypatch: pytest.MonkeyPatch) -> None:
    options = given("run -r p3at -r p3dx:bob", monkeypatch)
    assert options.robots == (RobotSpec(model="p3at"), RobotSpec(model="p3dx", name="bob"))
    assert given("run -r p3dx -n 3", monkeypatch).robots == (RobotSpec(model="p3dx"),) * 3
    assert given("run -n 2", monkeypatch).robots == (RobotSpec(model="p3at-sh"),) * 2
    options = given("run -p tcp://a:1 -p tcp://b:2 -r p3at", monkeypatch)
    assert urls(options) == ("tcp://a:1", "tcp://b:2")
    assert [robot.model for robot in options.remote] == ["p3at", "p3at"]
    options = given("run -p tcp://a:1 -r p3dx:bob --model p3at", monkeypatch)
    assert [(robot.model, robot.name) for robot in options.remote] == [("p3dx", "bob")]
    options = given("run -p tcp://a:1 --model p3at", monkeypatch)
    assert [robot.model for robot in options.remote] == ["p3at"]


@pytest.mark.parametrize(
    ("line", "says"),
    [
        ("-p tcp://a:1 -p tcp://a:1", "--port tcp://a:1: given twice"),
        ("-p tcp://a:1 -p tcp://b:1 -p tcp://c:1 -r p3at -r p3dx", "2 given, but ports: 3"),
        ("-r :bob", "expected a model"),
        ("-p tcp://a:1 -n 2", "--number 2: of simulated robots only, without --port"),
    ],
)
def test_what_does_not_go_together_is_refused(
    line: str, says: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert execute(["run", *line.split()]) == 2
    assert says in capsys.readouterr().err


@pytest.mark.parametrize("option", ["--ideal", "--seed 7", "--start home", "--fit gyro"])
def test_a_real_robot_takes_no_options_of_the_simulator(
    option: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert execute(["run", "-p", "/dev/ttyUSB0", *option.split()]) == 2
    assert "simulated robots only, without --port" in capsys.readouterr().err


def test_the_port_may_come_from_the_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    environment = {"PIONEER3_PORT": "/dev/ttyUSB7", "PIONEER3_BAUD": "9600"}
    options = given("run", monkeypatch, environment)
    assert (urls(options), options.baud) == (("/dev/ttyUSB7",), 9600)
    assert urls(given("run -p /dev/ttyS0", monkeypatch, environment)) == ("/dev/ttyS0",)


def test_the_function_has_the_defaults_of_the_options() -> None:
    defaults = run.__kwdefaults__ or {}
    options = RunOptions()
    for name in ("baud", "sim_port", "web_port", "host", "max_speed"):
        assert defaults[name] == getattr(options, name)
    assert (defaults["port"], defaults["robot"]) == (options.remote, options.robots)


async def told_by(options: RunOptions, count: int, words: str = "") -> list[str]:
    """Run until `count` lines with `words` have been told; return all."""
    lines: list[str] = []
    enough = asyncio.Event()

    def tell(line: str) -> None:
        lines.append(line)
        if sum(words in each for each in lines) == count:
            enough.set()

    running = asyncio.ensure_future(live(options, tell))
    waiting = asyncio.ensure_future(enough.wait())
    await asyncio.wait([running, waiting], timeout=PATIENCE, return_when="FIRST_COMPLETED")
    waiting.cancel()
    running.cancel()
    with contextlib.suppress(asyncio.CancelledError):
        await running
    return lines


@pytest.mark.realtime
async def test_on_loopback_there_is_nothing_to_warn_of() -> None:
    lines = await told_by(RunOptions(sim_port=0, web_port=0), 1, "Drive it at http://127.0.0.1:")
    assert lines[0].startswith("Connected to a SIMULATOR: Pioneer 3-AT (p3at-sh), on ")
    assert not any("WARNING" in line for line in lines)


def test_the_usual_robot_has_a_laser_where_kernels_are_compiled(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(live_module, "CACHE", SimpleNamespace(is_complete=True, can_keep=True))
    monkeypatch.setattr(live_module, "numba_version", lambda: "0.61")
    assert live_module.usual_robot().equipment.laser == "lms-200"
    monkeypatch.setattr(live_module, "numba_version", lambda: None)
    assert live_module.usual_robot().equipment.laser is None


@pytest.mark.realtime
async def test_every_robot_of_a_world_is_connected() -> None:
    lines = await told_by(RunOptions(map_name="lab", sim_port=0, web_port=0), 3)
    who = [re.findall(r"^Connected to a SIMULATOR: (.*), on tcp://127", line) for line in lines[:2]]
    assert sorted(who) == [["alice, Pioneer 3-DX (p3dx-sh)"], ["bob, Pioneer 3-AT (p3at-sh)"]]
    assert lines[2].startswith("Drive them at http://127.0.0.1:")


@pytest.mark.realtime
async def test_a_robot_that_begins_in_a_wall_is_pointed_out() -> None:
    options = RunOptions(
        overrides=WorldOverrides(starts=(Pose2(0.0, 0.0),)), sim_port=0, web_port=0
    )
    lines = await told_by(options, 3)
    assert lines[0].startswith("WARNING: p3at-sh begins in a wall")


@pytest.mark.realtime
async def test_beyond_loopback_others_are_told_to_pair() -> None:
    lines = await told_by(RunOptions(sim_port=0, web_port=0, host="0.0.0.0"), 5)
    assert lines[2].startswith("For other devices, after pairing: http://")
    assert "https://" in lines[2]
    assert "SHA-256 " in lines[3]
    assert "pioneer3 access" in lines[4]
    assert "#" not in "".join(lines)  # no token where lines may be kept


@pytest.mark.realtime
async def test_a_person_at_a_terminal_is_shown_a_code_and_two_tokens() -> None:
    options = RunOptions(sim_port=0, web_port=0, host="0.0.0.0", show_tokens=True)
    lines = await told_by(options, 2, "/pair#")
    tokens = re.findall(r"/pair#([\w-]+)", "\n".join(lines))
    assert len(tokens) == len(set(tokens)) == 2
    assert all(len(token) * 6 >= 128 for token in tokens)  # bits
    assert any("█" in line for line in lines)


@pytest.mark.realtime
async def test_who_wants_others_in_but_has_no_network_is_told(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(hosts, "lan_addresses", lambda host: [])
    lines = await told_by(RunOptions(sim_port=0, web_port=0, host="0.0.0.0"), 1, "No other device")
    assert "this computer has no address in a network" in lines[-1]


@pytest.mark.realtime
async def test_a_busy_port_is_refused_with_the_option_that_changes_it() -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        with pytest.raises(PortBusyError, match=f"127.0.0.1:{port}: in use.* with --sim-port"):
            await live(RunOptions(sim_port=port, web_port=0), print)
        with pytest.raises(PortBusyError, match=f"127.0.0.1:{port}: in use.* with --web-port"):
            await live(RunOptions(sim_port=0, web_port=port), print)


@pytest.mark.realtime
async def test_https_does_not_take_the_port_of_a_simulated_robot(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    seen: dict[str, Any] = {}

    def note(page: Page, **options: Any) -> Any:
        seen.update(options)
        return serve(page, **options)

    monkeypatch.setattr(live_module, "serve", note)
    lines = await told_by(RunOptions(robots=TWO, sim_port=0, web_port=0), 2, "Connected")
    told = {int(line.rsplit(":", 1)[1]) for line in lines if "Connected" in line}
    assert sorted(seen["taken"]) == sorted(told)


@pytest.mark.realtime
async def test_the_map_of_a_simulator_in_another_program_is_shown_and_the_robot_in_it() -> None:
    page, told = Page(), list[str]()
    async with simulator(map_name="lab", port=0) as there:
        target = ConnectTarget(url=there.url, scene=RobotScene())
        async with hosted(page, [target], told.append):
            scene = page.robots[1].scene
            await until(lambda: scene.map_now and scene.remote and scene.remote.pose)
            assert scene.map_now is not None
            assert scene.map_now.name == "lab"
            home = there.body.robot_in_world
            drawn = scene.robot_in_map(ORIGIN)
            assert (drawn.x, drawn.y) == pytest.approx((home.x, home.y), abs=0.002)
            assert drawn.theta == pytest.approx(home.theta, abs=0.01)
            page.join(Onlooker())
            assert '"name":"lab"' in "".join(page.audiences.first.retained.since(0))
    assert "SIMULATOR" in told[0]


@dataclass(eq=False)
class Onlooker:
    name: str = "ann"
    role: Role = Role.VIEWER
    session: LoginSession = field(
        default_factory=lambda: LoginSession(
            id="1", name="ann", role=Role.VIEWER, kind=SessionKind.BROWSER
        )
    )

    def tell(self, news: str) -> None: ...

    def show(self, message: object) -> None: ...

    def wake(self) -> None: ...


@pytest.mark.realtime
@pytest.mark.parametrize(
    ("options", "error"),
    [
        (RunOptions(remote=(NOBODY,), web_port=0), PortNotFoundError),
        (RunOptions(remote=(NOBODY,), map_name="nowhere", web_port=0), ConfigError),
        (RunOptions(remote=(replace(NOBODY, model="r2d2"),), web_port=0), ConfigError),
        (
            RunOptions(remote=(NOBODY, replace(NOBODY, url="tcp://127.0.0.1:2")), web_port=0),
            PortNotFoundError,
        ),
        (RunOptions(robots=R2D2 * 2, sim_port=0, web_port=0), ConfigError),
        (RunOptions(sim_port=0, web_port=0, max_speed=-1.0), ConfigError),
    ],
)
async def test_what_cannot_be_started_is_raised_and_leaves_no_task(
    options: RunOptions, error: type[Exception], tmp_path: Path
) -> None:
    lines: list[str] = []
    with pytest.raises(error):
        await live(options, lines.append)
    assert lines == []
    assert asyncio.all_tasks() == {asyncio.current_task()}


FLEET = """\
[[robot]]
name = "p3at-1"
address = "192.0.2.1"
port = "tcp://p3at-1:8101"
[[robot]]
name = "p3at-2"
address = "192.0.2.2"
port = "tcp://p3at-2:8101"
camera = "http://192.0.2.3/video"
navigation.planner.margin = 0.05
[groups]
front = ["p3at-1", "p3at-2"]
"""


def test_robots_of_the_fleet_are_shown_by_their_names(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("fleet.toml").write_text(FLEET)
    options = given("run --robot front", monkeypatch, {"PIONEER3_PORT": "/dev/ttyUSB7"})
    assert [(robot.url, robot.model, robot.name) for robot in options.remote] == [
        ("tcp://192.0.2.1:8101", None, "p3at-1"),
        ("tcp://192.0.2.2:8101", None, "p3at-2"),
    ]
    (robot,) = given("run --robot p3at-2 --fleet fleet.toml --model p3dx", monkeypatch).remote
    assert (robot.url, robot.model) == ("tcp://192.0.2.2:8101", "p3dx")
    assert given("run --robot p3at", monkeypatch).remote == ()


def test_robots_of_the_fleet_have_their_cameras(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("fleet.toml").write_text(FLEET)
    options = given("run --robot front", monkeypatch)
    targets = asyncio.run(hosted_by(options, monkeypatch))
    assert [target.camera for target in targets] == [
        None,
        "http://192.0.2.3/video",
    ]


def test_navigation_is_as_the_fleet_file_says_and_before_that_as_the_option(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("fleet.toml").write_text(FLEET)
    options = given("run --robot front --set localizer.particles=100", monkeypatch)
    targets = asyncio.run(hosted_by(options, monkeypatch))
    assert [target.settings.planner.margin for target in targets] == [0.07, 0.05]
    assert {target.settings.localizer.particles for target in targets} == {100}
    options = given("run --robot front --set planner.margin=9cm", monkeypatch)
    targets = asyncio.run(hosted_by(options, monkeypatch))
    assert {target.settings.planner.margin for target in targets} == {0.09}
    with pytest.raises(ConfigError, match=r"did you mean planner\.margin"):
        given("run --set planner.margn=9cm", monkeypatch)


@pytest.mark.parametrize("robots", ["-r p3at -r p3dx", "-p tcp://a:1 -p tcp://b:2", "-m {world}"])
def test_a_camera_is_of_one_robot_and_one_in_the_environment_is_not_for_several(
    robots: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    (tmp_path / "two.toml").write_text(
        '[world]\nmap = "empty"\n[[robot]]\nmodel = "p3at"\n[[robot]]\nmodel = "p3dx"\n'
    )
    line = "run " + robots.format(world=tmp_path / "two.toml")
    monkeypatch.delenv("PIONEER3_CAMERA", raising=False)
    with pytest.raises(ConfigError, match="--camera: of one robot only"):
        asyncio.run(hosted_by(given(f"{line} --camera http://cam/", monkeypatch), monkeypatch))
    environment = {"PIONEER3_CAMERA": "http://cam/"}
    for asked, cameras in ((line, [None, None]), ("run -r p3at", ["http://cam/"])):
        options = given(asked, monkeypatch, environment)
        targets = asyncio.run(hosted_by(options, monkeypatch))
        assert [target.camera for target in targets] == cameras


async def hosted_by(options: RunOptions, monkeypatch: pytest.MonkeyPatch) -> list[ConnectTarget]:
    """Return the robots that are connected to, but connect to none."""
    seen: list[ConnectTarget] = []

    @contextlib.asynccontextmanager
    async def note(
        page: Page, targets: list[ConnectTarget], tell: object, record: object
    ) -> AsyncIterator[None]:
        seen.extend(targets)
        yield

    monkeypatch.setattr(live_module, "hosted", note)
    task = asyncio.create_task(live(replace(options, web_port=0, sim_port=0), lambda _: None))
    try:
        await until(lambda: seen or task.done())
        if task.done():
            await task
    finally:
        task.cancel()
        with contextlib.suppress(asyncio.CancelledError, ConfigError):
            await task
    return seen


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("run --robot p3at-1 --port /dev/ttyUSB0", "--port /dev/ttyUSB0 and --robot p3at-1: give"),
        ("run --robot p3at --fleet fleet.toml", "no robot 'p3at', did you mean p3at-"),
        ("info --robot p3at-1 --port /dev/ttyUSB0", "--port /dev/ttyUSB0 and --robot p3at-1: give"),
        ("wander --robot p3at-9", "no robot 'p3at-9', did you mean p3at-"),
        ("doctor --robot front", "front is a group; one robot is needed here"),
        ("sim --fleet fleet.toml --robot p3at", "--fleet gives the robots; leave --robot"),
        ("sim --fleet none.toml", "none.toml: cannot read this fleet file"),
    ],
)
def test_robots_that_the_fleet_does_not_tell_are_refused(
    line: str,
    words: str,
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("PIONEER3_PORT", raising=False)
    Path("fleet.toml").write_text(FLEET)
    assert execute(line.split()) == 2
    assert words in capsys.readouterr().err
