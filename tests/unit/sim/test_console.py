"""What a client asks of the simulator itself (protocol.md 3.3, 5.13)."""

import logging
from math import radians
from pathlib import Path

import pytest

import pioneer3
from pioneer3.arcos import commands, reports
from pioneer3.arcos.commands import RequestMode, SimOperation
from pioneer3.arcos.packet import encode
from pioneer3.arcos.reports import MapChanged, SimFlag, SimInfo, SimStat, Sip
from pioneer3.geometry import Pose2
from pioneer3.sim.equipment import Equipment
from pioneer3.sim.firmware.console import StepTimes
from pioneer3.sim.kernels.drives import V_OF_V, W_OF_W
from pioneer3.sim.worldfile import ClientMaps
from tests.support import frame, wall_at
from tests.unit.sim.bench import Bench

TWO_WALLS = "2D-Map\nLINES\n3000 -5000 3000 5000\n4000 -5000 4000 5000\n"


@pytest.fixture
def bench(tmp_path: Path) -> Bench:
    (tmp_path / "two.map").write_text(TWO_WALLS)
    made = Bench(wall_at(2.0), client_maps=ClientMaps(tmp_path)).open()
    made.hear()
    return made


def load(name: str, operation: SimOperation = SimOperation.LOAD_MAP) -> commands.SimCtrl:
    return commands.SimCtrl(operation, name)


def test_a_robot_may_be_put_somewhere_and_its_odometry_stays(bench: Bench) -> None:
    bench.body.reset_odometry(Pose2(0.5, 0.0, 0.0))
    bench.say(commands.SimSetPose(x=1.0, y=2.0, heading=radians(450)))
    assert bench.body.robot_in_world.x == 1.0
    assert bench.body.robot_in_world.theta == pytest.approx(radians(90))
    assert bench.body.robot_in_odom == Pose2(0.5, 0.0, 0.0)


def test_reset_brings_it_home_with_its_odometry(bench: Bench) -> None:
    bench.body.robot_in_world = Pose2(1, 2, 3)
    bench.body.reset_odometry(Pose2(4, 5, 1))
    bench.say(commands.SimReset())
    assert bench.body.robot_in_world == bench.body.home
    assert bench.body.robot_in_odom == Pose2()


def test_simstat_tells_the_truth(bench: Bench) -> None:
    bench.body.robot_in_world = Pose2(1.2345, -2.0, radians(-90))
    bench.firmware.console.step_times = StepTimes(simulated=0.02, wanted=0.01, measured=0.011)
    bench.say(commands.RequestSimStat(RequestMode.ONCE))
    (stat,) = bench.hear()
    assert isinstance(stat, SimStat)
    assert (stat.x_mm, stat.y_mm, stat.z_mm, stat.heading_deg) == (1234, -2000, 0, -90)
    assert (stat.step_ms, stat.interval_ms, stat.measured_ms) == (20, 10, 11)
    assert stat.flags == SimFlag.HAS_MAP
    assert stat.gps_quality == -1


def test_simstat_tells_what_the_wheels_see_wrong(bench: Bench) -> None:
    errors = bench.body.drives.errors[:, bench.body.number]
    errors[[V_OF_V, W_OF_W]] = 1 / 1.01, 1 / 0.98
    bench.say(commands.RequestSimStat(RequestMode.ONCE))
    (stat,) = bench.hear()
    assert isinstance(stat, SimStat)
    assert stat.flags & SimFlag.HAS_ODOMETRY_ERROR
    assert (stat.odometry_error_x_e7, stat.odometry_error_heading_e7) == (100_000, -200_000)


def test_simstat_fits_the_wire_wherever_the_robot_is(bench: Bench) -> None:
    bench.body.robot_in_world = Pose2(1e9, -1e9, 0.0)
    bench.firmware.console.step_times = StepTimes(simulated=100.0, wanted=0.0, measured=1e6)
    bench.say(commands.RequestSimStat(RequestMode.ONCE))
    (stat,) = bench.hear()
    assert isinstance(stat, SimStat)
    assert (stat.x_mm, stat.step_ms, stat.measured_ms) == (2**31 - 1, 0xFFFF, 0xFFFF)


def test_simstat_without_an_argument_is_one(bench: Bench) -> None:
    bench.firmware.receive(encode(bytes([commands.RequestSimStat.ID])), bench.now)
    assert [type(report) for report in bench.hear()] == [SimStat]


def test_a_stream_of_simstat_comes_before_every_standard_report(bench: Bench) -> None:
    bench.say(commands.RequestSimStat(RequestMode.STREAM))
    assert [type(report) for report in bench.wait(0.3)] == [SimStat, Sip] * 3
    bench.say(commands.RequestSimStat(RequestMode.STOP))
    assert [type(report) for report in bench.wait(0.2)] == [Sip] * 2
    bench.say(commands.RequestSimStat(RequestMode.STREAM), commands.Close())
    bench.open()
    assert {type(report) for report in bench.wait(0.2)} >= {Sip}
    assert [type(report) for report in bench.wait(0.2)] == [Sip] * 2


@pytest.mark.parametrize("operation", [SimOperation.LOAD_MAP, SimOperation.LOAD_MASTER_MAP])
def test_a_map_is_loaded_and_everybody_told(bench: Bench, operation: SimOperation) -> None:
    told: list[MapChanged] = []
    bench.firmware.on_map_changed = told.append
    bench.say(load("two.map", operation))
    assert told == [MapChanged(by_user=False, reloaded=1, file_name="two.map")]
    assert len(bench.world.map.walls) == 2
    assert bench.world.map.name == "two"


def test_a_map_that_a_client_loads_takes_its_own_heights(bench: Bench, tmp_path: Path) -> None:
    (tmp_path / "steps.toml").write_text(
        "[world]\nwall_height=2\n[[step]]\ncenter=[2,2]\nsize=[1,1]\nheight=0.1\n"
    )
    bench.say(load("steps.toml"))
    assert list(bench.world.relief.solids) == ["step_0"]
    assert bench.world.relief.wall_height == 2.0
    bench.say(load("two.map"))
    assert not bench.world.relief.solids
    assert bench.world.relief.heights_of(bench.world.map).tolist() == [1.0, 1.0]


def test_by_itself_it_tells_its_own_host(bench: Bench) -> None:
    bench.say(load("two.map\0"))
    assert bench.hear() == [MapChanged(by_user=False, reloaded=1, file_name="two.map")]


def test_who_knows_all_robots_has_every_robot_told(bench: Bench) -> None:
    benches = [bench, Bench().open(), Bench()]
    benches[1].hear()

    def tell_all(change: MapChanged) -> None:
        for each in benches:
            each.firmware.tell(change)

    bench.firmware.on_map_changed = tell_all
    bench.say(load("two.map"))
    heard = [[type(report) for report in each.hear()] for each in benches]
    assert heard == [[MapChanged], [MapChanged], []]


@pytest.mark.parametrize("name", ["no.map", "../two.map", "/etc/passwd", "", "a\0b"])
def test_a_map_that_clients_cannot_have_changes_nothing(bench: Bench, name: str) -> None:
    before = bench.world.map
    bench.say(load(name))
    (change,) = bench.hear()
    assert isinstance(change, MapChanged)
    assert (change.by_user, change.reloaded) == (False, 0)
    assert bench.world.map is before


def test_the_longest_name_is_answered(bench: Bench) -> None:
    bench.say(load("m" * 200))
    assert [type(report) for report in bench.hear()] == [MapChanged]


def test_siminfo_tells_program_and_devices(bench: Bench) -> None:
    bench.say(commands.SimCtrl(SimOperation.REQUEST_INFO))
    info, in_use = bench.hear()
    assert isinstance(info, SimInfo)
    assert in_use == MapChanged(by_user=True, reloaded=0, file_name=bench.world.map.name)
    assert (info.application, info.version) == ("pioneer3", pioneer3.__version__)
    assert [device.name for device in info.devices] == ["drive", "sonar", "laser"]


def test_siminfo_of_a_robot_with_everything_fits_a_packet() -> None:
    fitted = Equipment(gripper=True, compass=True, gyro_type=1, joystick=True, camera="vcc4")
    bench = Bench(equipment=fitted).open()
    bench.hear()
    bench.say(commands.SimCtrl(SimOperation.REQUEST_INFO))
    info, in_use = bench.hear()
    assert isinstance(info, SimInfo)
    assert in_use == MapChanged(by_user=True, reloaded=0, file_name=bench.world.map.name)
    assert len(info.devices) == 8
    assert len(reports.to_payload(info)) <= 200


def test_a_ghost_is_one_until_the_session_ends(bench: Bench) -> None:
    bench.say(commands.SimCtrl(SimOperation.GHOST))
    assert bench.body.ghost
    bench.say(commands.Close())
    assert not bench.body.ghost


@pytest.mark.parametrize(
    "operation",
    [SimOperation.CLEAR_MASTER_MAP, SimOperation.ROTATE_LOGS, SimOperation.SNAPSHOT],
)
def test_what_makes_no_sense_here_is_ignored(bench: Bench, operation: SimOperation) -> None:
    bench.say(commands.SimCtrl(operation), commands.SimModelConfig(b"abc"))
    assert bench.hear() == []


def test_the_state_goes_to_the_log(bench: Bench, caplog: pytest.LogCaptureFixture) -> None:
    bench.body.robot_in_world = Pose2(1.5, 0.0, 0.0)
    with caplog.at_level(logging.INFO):
        bench.say(commands.SimCtrl(SimOperation.LOG_STATE, "here\nI am"))
    (record,) = caplog.records
    assert "x=1.500" in record.message
    assert r"here\nI am" in record.message


def test_messages_are_kept_and_logged(bench: Bench, caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.INFO):
        bench.say(commands.SimMessage("hello"))
        bench.firmware.receive(frame(commands.OldMessage(b"\1\2\3old")), bench.now)
    assert list(bench.firmware.console.messages) == ["hello", "old"]
    assert "hello" in caplog.text


def test_only_the_last_messages_are_kept(bench: Bench) -> None:
    for number in range(250):
        bench.say(commands.SimMessage(str(number)))
    assert list(bench.firmware.console.messages) == [str(number) for number in range(150, 250)]


def test_no_client_ends_the_simulator(bench: Bench) -> None:
    bench.say(commands.SimExit(0))
    assert bench.firmware.device.is_open
    assert [type(report) for report in bench.wait(0.1)] == [Sip]


@pytest.mark.parametrize("number", [61, 62, 63, 64, 66, 67, 68, 69])
def test_old_simulator_commands_move_nothing(bench: Bench, number: int) -> None:
    before = bench.body.robot_in_world, bench.world.map
    bench.firmware.receive(encode(bytes([number, 0x3B, 0xE8, 0x03])), bench.now)
    assert (bench.body.robot_in_world, bench.world.map) == before
    assert bench.firmware.device.is_open
