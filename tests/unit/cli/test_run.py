"""`pioneer3 run`: options, and what is told. The rest is in `tests/e2e/test_commands.py`."""

import asyncio
import contextlib
from pathlib import Path

import pytest

from pioneer3 import ConfigError, PortNotFoundError
from pioneer3.cli.main import app, execute
from pioneer3.cli.run import run
from pioneer3.geometry import Pose2
from pioneer3.sim.worldfile import Fitting
from pioneer3.sim.worldfile.arguments import Wishes
from pioneer3.web import live as live_module
from pioneer3.web.live import Options, live

PATIENCE = 20.0


def given(
    line: str, monkeypatch: pytest.MonkeyPatch, environment: dict[str, str] | None = None
) -> Options:
    """Return the options that a command line amounts to."""
    monkeypatch.delenv("PIONEER3_PORT", raising=False)
    monkeypatch.delenv("PIONEER3_BAUD", raising=False)
    for name, value in (environment or {}).items():
        monkeypatch.setenv(name, value)
    seen: list[Options] = []

    async def note(options: Options, tell: object) -> int:
        seen.append(options)
        return 0

    monkeypatch.setattr(live_module, "live", note)
    assert app(line.split(), exit_on_error=False, result_action="return_value") == 0
    return seen[0]


def test_without_options_it_simulates_and_only_this_machine_may_drive(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    options = given("run", monkeypatch)
    assert options.port is None
    assert options.host == "127.0.0.1"
    assert (options.sim_port, options.web_port) == (8101, 8080)


def test_every_option_arrives(monkeypatch: pytest.MonkeyPatch) -> None:
    line = (
        "run -p tcp://r:1 -b 38400 -m lab.map -r p3dx --sim-port 1 --web-port 2 --host 0.0.0.0 "
        "--max-speed 0.4"
    )
    options = given(line, monkeypatch)
    assert (options.port, options.baud) == ("tcp://r:1", 38400)
    assert (options.map_name, options.robot) == ("lab.map", "p3dx")
    assert (options.sim_port, options.web_port, options.host) == (1, 2, "0.0.0.0")
    assert options.max_speed == 0.4


def test_the_simulated_world_may_be_chosen(monkeypatch: pytest.MonkeyPatch) -> None:
    line = "run -m lab --start random --fit compass --seed 7 --ideal"
    options = given(line, monkeypatch)
    assert options.map_name == "lab"
    assert options.ideal
    assert options.wishes == Wishes(starts=("random",), equipment=Fitting(compass=True), seed=7)
    assert given("run", monkeypatch).wishes == Wishes()


@pytest.mark.parametrize("option", ["--ideal", "--seed 7", "--start home", "--fit gyro"])
def test_a_real_robot_takes_no_options_of_the_simulator(
    option: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert execute(["run", "-p", "/dev/ttyUSB0", *option.split()]) == 2
    assert "simulated robots only, without --port" in capsys.readouterr().err


def test_the_port_may_come_from_the_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    environment = {"PIONEER3_PORT": "/dev/ttyUSB7", "PIONEER3_BAUD": "9600"}
    options = given("run", monkeypatch, environment)
    assert (options.port, options.baud) == ("/dev/ttyUSB7", 9600)
    assert given("run -p /dev/ttyS0", monkeypatch, environment).port == "/dev/ttyS0"


def test_the_function_has_the_defaults_of_the_options() -> None:
    defaults = run.__kwdefaults__ or {}
    options = Options()
    for name in ("port", "baud", "robot", "sim_port", "web_port", "host", "max_speed"):
        assert defaults[name] == getattr(options, name)


async def told_by(options: Options, count: int) -> list[str]:
    """Run until `count` lines have been told."""
    lines: list[str] = []
    enough = asyncio.Event()

    def tell(line: str) -> None:
        lines.append(line)
        if len(lines) == count:
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
    lines = await told_by(Options(sim_port=0, web_port=0), 2)
    assert lines[0].startswith("Connected to a SIMULATOR: MobileSim, Pioneer 3-AT (p3at-sh), on ")
    assert lines[1].startswith("Drive it at http://127.0.0.1:")
    assert not any("WARNING" in line for line in lines)


@pytest.mark.realtime
async def test_the_page_is_the_first_robots_and_the_others_are_told() -> None:
    lines = await told_by(Options(map_name="lab", sim_port=0, web_port=0), 3)
    assert lines[0].startswith("Also simulated: bob, Pioneer 3-AT, on tcp://127.0.0.1:")
    assert lines[1].startswith("Connected to a SIMULATOR: MobileSim, Pioneer 3-DX (p3dx-sh), on ")


@pytest.mark.realtime
async def test_a_robot_that_begins_in_a_wall_is_pointed_out() -> None:
    options = Options(wishes=Wishes(starts=(Pose2(0.0, 0.0),)), sim_port=0, web_port=0)
    lines = await told_by(options, 3)
    assert lines[0].startswith("WARNING: p3at-sh begins in a wall")


@pytest.mark.realtime
async def test_beyond_loopback_people_are_warned() -> None:
    host = "0.0.0.0"
    lines = await told_by(Options(sim_port=0, web_port=0, host=host), 3)
    assert lines[2].startswith("WARNING: anybody")


@pytest.mark.realtime
@pytest.mark.parametrize(
    ("options", "error"),
    [
        (Options(port="tcp://127.0.0.1:1", web_port=0), PortNotFoundError),
        (Options(port="tcp://127.0.0.1:1", map_name="nowhere", web_port=0), ConfigError),
        (Options(port="tcp://127.0.0.1:1", robot="r2d2", web_port=0), ConfigError),
        (Options(sim_port=0, web_port=0, max_speed=-1.0), ConfigError),
    ],
)
async def test_what_cannot_be_started_is_raised_and_leaves_no_task(
    options: Options, error: type[Exception], tmp_path: Path
) -> None:
    lines: list[str] = []
    with pytest.raises(error):
        await live(options, lines.append)
    assert lines == []
    assert asyncio.all_tasks() == {asyncio.current_task()}
