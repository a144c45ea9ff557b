"""`pioneer3 move`, `turn`, `goto`, `wander` and `sonar` as people and programs run them."""

import json
import signal
from math import degrees, hypot, pi

import pytest

from pioneer3.geometry import Pose2
from pioneer3.models.own import own_path
from pioneer3.navigation.connect import connect_async
from pioneer3.sim.server.start import simulator
from tests.e2e.processes import KILLED, pioneer3, running, until

pytestmark = pytest.mark.realtime


@pytest.mark.parametrize(
    ("command", "end"),
    [
        (("move", "-0.2"), Pose2(-0.2)),
        (("turn", "-90"), Pose2(0, 0, -pi / 2)),
        (("goto", "0.5", "0", "90"), Pose2(0.5, 0, pi / 2)),
    ],
)
async def test_a_motion_ends_where_it_was_to(command: tuple[str, ...], end: Pose2) -> None:
    async with simulator(port=0) as simulated:
        begin = simulated.body.robot_in_world
        code, out, err = await pioneer3(*command, "--port", simulated.url)
        there = begin.inverse() @ simulated.body.robot_in_world
        await until(lambda: not simulated.body.drive.powered)
    assert (code, err) == (0, "")
    assert out.startswith("SIMULATOR: ")
    assert out.splitlines()[-1].startswith("done: x")
    assert hypot(there.x - end.x, there.y - end.y) < 0.12
    assert degrees(there.theta - end.theta) == pytest.approx(0, abs=4)


async def test_wander_drives_for_its_time_and_says_who_decides() -> None:
    async with simulator(port=0) as simulated:
        begin = simulated.body.robot_in_world
        code, out, _ = await pioneer3("wander", "--seconds", "2", "--json", "-p", simulated.url)
        there = simulated.body.robot_in_world
    told = [json.loads(text) for text in out.splitlines()]
    assert code == 0
    assert hypot(there.x - begin.x, there.y - begin.y) > 0.1
    assert all(reading["mode"] in {"wander", None} for reading in told)
    assert any("constant velocity" in " ".join(reading["decided"]) for reading in told)


@pytest.mark.parametrize(
    ("command", "told"),
    [
        (("wander", "--speed", "9", "--seconds", "1"), "--speed 9 m/s"),
        (("turn", "5", "--turn-rate", "30rad/s"), "--turn-rate 1719 deg/s"),
    ],
)
async def test_a_speed_beyond_the_robots_own_is_cut_and_told(
    command: tuple[str, ...], told: str
) -> None:
    async with simulator(port=0) as simulated:
        code, _, err = await pioneer3(*command, "--port", simulated.url)
    assert code == 0
    assert err.startswith(f"WARNING: {told} is more than this robot may: it is limited to ")
    assert err.count("\n") == 1


async def test_numbers_may_carry_units_and_the_port_needs_no_scheme() -> None:
    async with simulator(port=0) as simulated:
        begin = simulated.body.robot_in_world
        port = simulated.url.removeprefix("tcp://")
        assert (await pioneer3("move", "20cm", "--speed", "30cm/s", "-p", port))[0] == 0
        assert (await pioneer3("turn", "1.57rad", "--rate", "0.8rad/s", "-p", port))[0] == 0
        there = begin.inverse() @ simulated.body.robot_in_world
    assert hypot(there.x - 0.2, there.y) < 0.05
    assert degrees(there.theta) == pytest.approx(90, abs=4)


async def test_a_motion_that_takes_too_long_ends_and_says_so() -> None:
    async with simulator(port=0) as simulated:
        code, _, err = await pioneer3("turn", "720", "--seconds", "1", "-p", simulated.url)
        await until(lambda: not simulated.body.drive.powered)
    assert (code, err) == (1, "pioneer3: not there after 1 s: stopped\n")


async def test_a_robot_that_another_program_has_says_so() -> None:
    async with simulator(port=0) as simulated, connect_async(simulated.url):
        code, _, err = await pioneer3("move", "0.1", "-p", simulated.url)
    assert code == 3
    assert err.count("\n") == 1
    assert "is another one connected to it?" in err


@pytest.mark.parametrize(
    ("number", "code"),
    [
        (signal.SIGINT, 130),
        (signal.SIGTERM, 143),
        (signal.SIGKILL, KILLED - signal.SIGKILL),
        pytest.param(None, 1, id="the cable is cut"),
    ],
)
async def test_each_end_of_a_calibration_stops_the_robot_and_leaves_the_file_whole(
    number: signal.Signals | None, code: int
) -> None:
    path = own_path("MobileSim")
    assert path is not None
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text('like = "p3at-sh"\n')
    async with simulator(port=0) as simulated:
        arguments = ("calibrate", "--by-tape", "--yes", "--port", simulated.url)
        async with running(*arguments) as command:
            await until(lambda: abs(simulated.body.speeds[1]) > 0.2)
            another, _, told = await pioneer3(*arguments)
            assert (another, "is another one connected to it?" in told) == (3, True)
            assert abs(simulated.body.speeds[1]) > 0.2, "the first one goes on"
            if number is None:
                simulated.robots[0].port.faults.unplug()
            assert (await command.end(number))[0] == code
        await until(lambda: not any(simulated.body.speeds))
        await until(lambda: not simulated.body.drive.powered)
    assert [each.name for each in path.parent.iterdir()] == [path.name]
    assert path.read_text() == 'like = "p3at-sh"\n'


@pytest.mark.parametrize(
    ("number", "code"),
    [
        (signal.SIGINT, 130),
        (signal.SIGTERM, 143),
        pytest.param(signal.SIGHUP, 129, marks=pytest.mark.thorough),
        pytest.param(signal.SIGQUIT, KILLED - signal.SIGQUIT, marks=pytest.mark.thorough),
    ],
)
async def test_a_signal_stops_a_robot_that_wanders(number: signal.Signals, code: int) -> None:
    async with simulator(port=0) as simulated:
        async with running("wander", "--port", simulated.url) as command:
            while "constant velocity" not in await command.line():
                pass
            assert (await command.end(number))[0] == code
        await until(lambda: simulated.body.speeds[0] == 0.0)
        await until(lambda: not simulated.body.drive.powered)


async def test_sonar_prints_the_front_eight_and_moves_nothing() -> None:
    async with simulator(port=0) as simulated:
        code, out, _ = await pioneer3("sonar", "--seconds", "1", "-p", simulated.url)
        assert not simulated.body.drive.powered
    head, *lines = (text.split() for text in out.splitlines())
    assert code == 0
    assert head == [*map(str, range(8))]
    assert lines
    assert all(len(line) == 8 for line in lines)


async def test_a_place_without_a_map_is_on_the_map_of_the_simulator() -> None:
    pytest.importorskip("numba")
    pytest.importorskip("scipy")
    async with simulator(map_name="lab", port=0) as simulated:
        command = ("goto", "canteen", "--port", simulated.url)
        code, _, err = await pioneer3(*command)
    assert code == 2
    assert "place 'canteen': the map lab has none of this name" in err
