"""`pioneer3 sim`: its options. The rest is in `tests/e2e/test_sim_command.py`."""

import logging
from collections.abc import Iterator
from math import inf, pi
from pathlib import Path
from typing import Any

import pytest

from pioneer3.cli import sim as sim_module
from pioneer3.cli.main import execute
from pioneer3.geometry import Pose2
from pioneer3.models.own import own_folder
from pioneer3.sim.equipment import EquipmentOptions
from pioneer3.sim.realism import Realism
from pioneer3.sim.worldfile import RobotSpec
from pioneer3.sim.worldfile.arguments import WorldOverrides

Seen = list[dict[str, Any]]


@pytest.fixture
def simulated(monkeypatch: pytest.MonkeyPatch) -> Iterator[Seen]:
    """Note what would be simulated."""
    seen: Seen = []

    async def stay(simulation: object, *, announce: bool) -> int:
        return 0

    monkeypatch.setattr(
        "pioneer3.sim.server.start.simulator", lambda **choices: seen.append(choices)
    )
    monkeypatch.setattr(sim_module, "_simulate", stay)
    log = logging.getLogger("pioneer3")
    level, propagate, handlers = log.level, log.propagate, [*log.handlers]
    yield seen
    log.setLevel(level)
    log.propagate = propagate
    for handler in set(log.handlers) - set(handlers):
        log.removeHandler(handler)
        handler.close()


def given(line: str, seen: Seen) -> dict[str, Any]:
    """Return what a command line amounts to."""
    assert execute(["sim", *line.split()]) == 0
    return seen[-1]


def overrides(line: str, seen: Seen) -> WorldOverrides:
    """Return what a command line wants changed in the world."""
    asked = given(line, seen)["overrides"]
    assert isinstance(asked, WorldOverrides)
    return asked


def test_without_options_one_robot_drives_in_the_office_as_a_real_one(simulated: Seen) -> None:
    choices = given("", simulated)
    assert choices["map_name"] == "office"
    assert choices["overrides"] == WorldOverrides()
    assert (choices["port"], choices["host"], choices["ptys"]) == (8101, "127.0.0.1", False)
    assert choices["realism"] == Realism()
    assert (choices["pace"].speed, choices["pace"].lock_step) == (1.0, False)
    assert str(choices["faults"]) == "none"


@pytest.mark.parametrize("line", ["--map lab.map --port 8102", "-m lab.map -p 8102"])
def test_map_and_port_have_a_long_and_a_short_form(line: str, simulated: Seen) -> None:
    choices = given(line, simulated)
    assert (choices["map_name"], choices["port"]) == ("lab.map", 8102)


@pytest.mark.parametrize("option", ["-r", "--robot"])
def test_robots_are_given_one_by_one(option: str, simulated: Seen) -> None:
    asked = overrides(f"{option} p3at {option} p3dx:bob {option} params/mine.p", simulated)
    assert asked.robots == (
        RobotSpec(model="p3at"),
        RobotSpec(model="p3dx", name="bob"),
        RobotSpec(model="params/mine.p"),
    )


def test_starts_are_mobilesims_and_may_be_negative(simulated: Seen) -> None:
    asked = overrides(
        "--start -1000,2000,90 --start=random --start outside --start home", simulated
    )
    assert asked.starts == (Pose2(-1.0, 2.0, pi / 2), "random", "outside", "home")


@pytest.mark.parametrize("option", ["-R", "--robot-factory"])
def test_a_factory_makes_a_model(option: str, simulated: Seen) -> None:
    assert overrides(f"{option} p3dx", simulated) == WorldOverrides(factory="p3dx")


def test_the_world_may_be_changed(simulated: Seen) -> None:
    asked = overrides("-m lab --seed 7 --fit gripper,camera=vcc4 --keep-session", simulated)
    fitted = EquipmentOptions(gripper=True, camera="vcc4")
    assert asked == WorldOverrides(seed=7, equipment=fitted, keep_session=True)


def test_a_given_port_wins_over_the_worlds(simulated: Seen) -> None:
    assert overrides("-m lab", simulated).own_ports
    assert not overrides("-m lab -p 8101", simulated).own_ports


def test_no_map_is_an_empty_plane(simulated: Seen) -> None:
    assert given("--nomap", simulated)["map_name"] == "empty"


def test_time_passes_as_told(simulated: Seen) -> None:
    assert given("--speed 10", simulated)["pace"].speed == 10.0
    assert given("--fast", simulated)["pace"].speed == inf
    assert given("--lock-step", simulated)["pace"].lock_step


def test_a_robot_is_like_one_with_a_file_of_its_own(simulated: Seen) -> None:
    own_folder().mkdir(parents=True)
    (own_folder() / "rosie.toml").write_text('like = "p3dx-sh"\n[odometry]\nscale = 1.02')
    (robot,) = overrides("--like rosie", simulated).robots
    assert (robot.name, robot.model) == ("rosie", str(own_folder() / "rosie.toml"))
    assert execute(["sim", "--like", "rosie", "-r", "p3at"]) == 2
    assert execute(["sim", "--like", "nobody"]) != 0


def test_errors_can_be_chosen(simulated: Seen) -> None:
    assert given("--ideal", simulated)["realism"] == Realism.ideal()
    for mode in ("none", "constant", "random_init", "random_each_update", "all"):
        realism = given(f"--odom-error-mode {mode}", simulated)["realism"]
        assert realism == Realism().with_odometry(mode)
    assert given("--no-error", simulated)["realism"] == Realism().with_odometry("none")
    faults = given("--fault drop=0.01,corrupt=0.001,delay=0.2", simulated)["faults"]
    assert (faults.drop, faults.corrupt, faults.delay) == (0.01, 0.001, 0.2)


def test_serial_ports_on_demand(simulated: Seen) -> None:
    assert given("--pty", simulated)["ptys"]


@pytest.mark.parametrize("option", ["--bind", "--bind-to-address"])
def test_beyond_loopback_people_are_warned(
    option: str, simulated: Seen, capsys: pytest.CaptureFixture[str]
) -> None:
    assert given(f"{option} 0.0.0.0", simulated)["host"] == "0.0.0.0"
    assert capsys.readouterr().err.startswith("WARNING: there is no password: whoever reaches 0.0")


@pytest.mark.parametrize("address", ["127.0.0.1", "localhost", "::1"])
def test_on_loopback_there_is_nothing_to_warn_of(
    address: str, simulated: Seen, capsys: pytest.CaptureFixture[str]
) -> None:
    given(f"--bind {address}", simulated)
    assert capsys.readouterr().err == ""


def test_a_script_for_mobilesim_runs_unchanged(
    simulated: Seen, capsys: pytest.CaptureFixture[str]
) -> None:
    line = (
        "-m lab.map -r p3at-sh -r p3dx:bob -p 8201 --no-gui --noninteractive "
        "--start outside --odom-error-mode random_init --bind-to-address 127.0.0.1"
    )
    assert overrides(line, simulated).starts == ("outside",)
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize(
    "option",
    [
        "--update-interval 100",
        "--update-sim-time 100",
        "--resolution 20",
        "--ignore-command 4",
        "--ignore-command 4 --ignore-command 5",
    ],
)
def test_what_has_no_effect_is_said_to_have_none(
    option: str, simulated: Seen, capsys: pytest.CaptureFixture[str]
) -> None:
    given(option, simulated)
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"WARNING: {option.partition(' ')[0]} has no effect: ")


@pytest.mark.parametrize("option", ["-l", "--log-file"])
def test_the_log_goes_into_a_file(option: str, simulated: Seen, tmp_path: Path) -> None:
    given(f"{option} {tmp_path / 'sim.log'}", simulated)
    logging.getLogger("pioneer3.sim").info("somebody came")
    assert (tmp_path / "sim.log").read_text().endswith("INFO somebody came\n")


@pytest.mark.parametrize("port", [0, 1, 65535])
def test_every_port_there_is_may_be_given(port: int, simulated: Seen) -> None:
    assert given(f"-p {port}", simulated)["port"] == port


@pytest.mark.parametrize(
    "line",
    [
        *[f"-p {port}" for port in ("-1", "65536", "70000", "nan", "''")],
        "-m lab --nomap",
        "--speed 0",
        "--speed -1",
        "--speed nan",
        "--speed 2 --fast",
        "--start here",
        "--start 1,2",
        "--fit griper",
        "--fault drap=1",
        "--seed -1",
        "--seed x",
        "--odom-error-mode some",
        "--no-error --odom-error-mode constant",
        "--log-file /nowhere/sim.log",
        "-r p3dx:",
        "--fly",
    ],
)
def test_a_wrong_value_is_told_in_one_line(
    line: str, simulated: Seen, capsys: pytest.CaptureFixture[str]
) -> None:
    assert execute(["sim", *line.split()]) == 2
    assert simulated == []
    told = capsys.readouterr()
    assert told.out == ""
    assert told.err.startswith("pioneer3: ")
    assert told.err.count("\n") == 1


def test_only_verbose_tells_who_comes_and_goes(simulated: Seen) -> None:
    given("", simulated)
    assert not logging.getLogger("pioneer3").isEnabledFor(logging.INFO)
    given("-v", simulated)
    assert logging.getLogger("pioneer3").isEnabledFor(logging.INFO)


def test_the_help_names_every_option_and_shows_an_example(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert execute(["sim", "--help"]) == 0
    shown = capsys.readouterr().out
    assert "Example: pioneer3 sim " in shown
    for option in (
        "--robot -r",
        "--robot-factory -R",
        "--map -m",
        "--port -p",
        "--log-file -l",
        "--nomap",
        "--start",
        "--fit",
        "--seed",
        "--bind --bind-to-address",
        "--pty",
        "--speed",
        "--fast",
        "--lock-step",
        "--ideal",
        "--odom-error-mode",
        "--no-error",
        "--fault",
    ):
        assert option in shown


MOBILESIMS = (
    "--nomap --start random --no-error --odom-error-mode none --bind-to-address localhost",
    "-l {here}/log --log-file-max-size 1000 --log-timing-stats 30 --verbose --html",
    "--no-gui --no-graphics --lite-graphics --fullscreen-gui --maximize-gui --minimize-gui",
    "--noninteractive --no-crash-debug --no-crash-restart --no-network-discovery",
    "--update-interval 100 --update-sim-time 100 --resolution 20 --ignore-command 4",
    "--srisim-compat --no-srisim-laser-compat --log-packets-received --log-movement-sent",
    "--echo-stage-worldfile --warn-unsupported-commands --lines-chunksize 9 --points-chunksize 9",
)


@pytest.mark.parametrize("line", MOBILESIMS)
def test_the_options_of_mobilesim_are_taken(
    line: str, simulated: Seen, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    given(line.format(here=tmp_path), simulated)
    for told in capsys.readouterr().err.splitlines():
        assert told.startswith("WARNING: --")
        assert " has no effect: " in told
        assert told.split()[1] in line


@pytest.mark.parametrize("line", ["--daemonize"])
def test_an_option_of_mobilesim_that_would_lead_astray_is_refused_in_a_sentence(
    line: str, simulated: Seen, capsys: pytest.CaptureFixture[str]
) -> None:
    assert execute(["sim", *line.split()]) == 2
    assert "is not supported: " in capsys.readouterr().err
    assert not simulated


def test_a_folder_is_changed_to_before_maps_are_looked_for(
    simulated: Seen, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(Path.cwd())  # puts the folder back
    given(f"--cwd {tmp_path}", simulated)
    assert Path.cwd() == tmp_path
