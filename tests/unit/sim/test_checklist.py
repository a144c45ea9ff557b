"""What real ARIA needs of a simulated robot, point by point (facts.md 12; 13 where it is silent).

That robots listen from port 8101 on, which point 1 begins with, is tested with the server.
"""

from itertools import pairwise
from math import pi, radians
from struct import unpack_from

import pytest

from pioneer3.arcos import commands, reports
from pioneer3.arcos.commands import Command, SimLaserMode
from pioneer3.arcos.packet import encode
from pioneer3.arcos.reports import (
    Config,
    Encoders,
    Io,
    Report,
    SimLaser,
    SimLaserExtended,
    Sip,
    SyncEcho,
    SyncIdentity,
)
from pioneer3.models import load_model
from pioneer3.sim.equipment import Equipment
from tests.support import DISTINCT, frame, wall_at
from tests.unit.sim.bench import ON, SYNCS, Bench

EVERY_MODEL = [name for name in DISTINCT if load_model(name).controller == "ARCOS"]
LASER_SETUP = (
    commands.OldLaserStart(radians(-90)),
    commands.OldLaserEnd(radians(90)),
    commands.OldLaserStep(radians(1)),
)


@pytest.fixture
def bench() -> Bench:
    made = Bench().open()
    made.hear()
    return made


def raw_sip(bench: Bench) -> bytes:
    """Return the payload of a standard report, for those who count bytes."""
    return reports.to_payload(bench.sip())


def test_1_frames_come_in_pieces_and_broken_ones_are_dropped(bench: Bench) -> None:
    broken = bytearray(frame(commands.SetV(0.9)))
    broken[5] ^= 1
    said = frame(ON) + bytes(broken) + b"\xfa" + frame(commands.SetV(0.3)) + b"\xfb\x00"
    for byte in said:
        bench.firmware.receive(bytes([byte]), bench.now)
    assert bench.body.drive.powered
    assert bench.body.drive.linear.top == pytest.approx(0.3)


def test_2_syncs_are_answered_with_a_name_that_has_its_laser_simulated() -> None:
    bench = Bench()
    bench.firmware.receive(SYNCS, 0.0)
    raw = bench.firmware.device.outgoing()
    assert raw.endswith(encode(b"\x02MobileSim\0Pioneer\0p3at-sh\0"))
    bench.firmware.receive(SYNCS, 0.0)
    kinds = [type(report) for report in bench.hear()]
    assert kinds == [SyncEcho, SyncEcho, SyncIdentity]


def test_3_reports_come_from_open_to_close_ten_times_a_second_also_at_rest() -> None:
    bench = Bench()
    bench.firmware.receive(SYNCS, 0.0)
    bench.say(ON, commands.Vel(0.3), commands.RequestConfig())
    assert len(bench.wait(1.0, pulse=False)) == 3
    bench.say(commands.Open())
    bench.hear()
    resting = bench.wait(1.0)
    assert [report.number for report in resting if isinstance(report, Sip)] == [0x32] * 10
    bench.say(ON, commands.Vel(0.3))
    moving = bench.wait(0.3)
    assert [report.number for report in moving if isinstance(report, Sip)] == [0x33] * 3
    bench.say(commands.Close())
    bench.hear()
    assert bench.wait(1.0, pulse=False) == []
    bench.open()
    kinds = [type(report) for report in bench.hear()]
    assert kinds == [SyncEcho, SyncEcho, SyncIdentity, Sip]


@pytest.mark.parametrize("model", EVERY_MODEL)
def test_4_config_comes_at_once_with_limits_that_let_it_move_both_ways(model: str) -> None:
    bench = Bench(model=model)
    bench.firmware.receive(SYNCS, 0.0)
    (who,) = (report for report in bench.hear() if isinstance(report, SyncIdentity))
    bench.say(commands.Open())
    bench.hear()
    bench.say(commands.RequestConfig())
    (config,) = bench.hear()
    assert isinstance(config, Config)
    assert (config.name, config.family, config.model) == (who.name, who.family, who.model)
    assert config.serial_number == "SIM"
    limits = (
        config.speed_top_mm_s,
        config.rotation_top_deg_s,
        config.accel_top_mm_s2,
        config.rotation_accel_top_deg_s2,
        config.speed_max_mm_s,
        config.rotation_max_deg_s,
        config.accel_mm_s2,
        config.decel_mm_s2,
        config.rotation_accel_deg_s2,
        config.rotation_decel_deg_s2,
    )
    assert all(limit and limit > 0 for limit in limits)


@pytest.mark.parametrize("model", EVERY_MODEL)
def test_5_raw_odometry_changes_in_small_steps_and_headings_are_4096ths(model: str) -> None:
    bench = Bench(model=model).open()
    top = bench.body.model.max_speed
    bench.say(ON, commands.SetV(top), commands.SetA(2.0), commands.Vel(-top))
    places = [report.x_raw for report in bench.wait(4.0) if isinstance(report, Sip)]
    steps = [(after - before + 0x4000) % 0x8000 - 0x4000 for before, after in pairwise(places)]
    assert all(0 <= place <= 0x7FFF for place in places)
    assert all(-4096 <= step <= 0 for step in steps)
    assert sum(steps) * bench.body.model.distance_factor < -1.0
    sip = bench.sip()
    assert sip.left_speed_raw * bench.body.model.speed_factor == pytest.approx(-top, abs=0.002)
    assert sip.left_speed_raw == sip.right_speed_raw
    assert sip.turn_rate_decidegrees == 0
    assert sip.faults is not None
    bench.say(commands.SetO())
    sip = bench.firmware.information(bench.now)
    assert (sip.x_raw, sip.y_raw, sip.heading_raw) == (0, 0, 0)
    bench.say(commands.SetO(x=0.0, y=0.0, heading=radians(90)))
    assert bench.firmware.information(bench.now).heading_raw == 1024


def test_6_the_port_comes_before_the_gripper_and_no_temperature_is_not_a_cold_robot() -> None:
    bench = Bench(equipment=Equipment(gripper=True)).open()
    bench.say(commands.AdSel(5))
    payload = raw_sip(bench)
    sonars = payload[19]
    port, gripper, _, digital_in, digital_out = payload[20 + 3 * sonars :][:5]
    assert (port, gripper, digital_in, digital_out) == (5, 0x30, 0xFF, 0xFF)
    (celsius,) = unpack_from("<b", payload, 20 + 3 * sonars + 5 + 2 + 1 + 2 + 2 + 2)
    assert celsius == round(bench.body.motor_temperature) != reports.NO_TEMPERATURE


def test_7_all_that_aria_sends_is_taken_and_the_unknown_ignored(bench: Bench) -> None:
    quiet: tuple[Command, ...] = (
        commands.SetA(0.3),
        commands.SetA(-0.3),
        commands.SetRA(1.0),
        commands.SetRA(-1.0),
        commands.SetV(0.75),
        commands.SetRV(1.5),
        commands.Enable(on=True),
        commands.Sonar(on=True),
        commands.named("SOUNDTOG", False),
        commands.JoyInfo(commands.RequestMode.STREAM),
        commands.SetPbioPort(port=11, on=True),
        commands.Gyro(commands.GyroMode.ON),
        commands.EStop(),
        commands.Head(0.0),
        commands.Move(0.0),
        commands.Vel2(left_units=0, right_units=0),
        commands.Vel(0.0),
        commands.RVel(0.0),
        commands.Stop(),
        commands.named("JOYDRIVE", True),
        commands.named("JOYDRIVE", False),
        *(commands.Unknown(number, b"\x3b\x01\x00") for number in (14, 119, 173, 254)),
    )
    bench.say(*quiet)
    for bare in (b"\0\x3b\x10\x00", b"\x1d", b"\x1d\x3b\x01\x00", b"\x37", b"\x37\x3b\x01\x00"):
        bench.firmware.receive(encode(bare), bench.now)  # PULSE, STOP, ESTOP, with and without
    assert bench.hear() == []
    for request, kind in ((b"\x28", Io), (b"\x13", Encoders)):
        bench.firmware.receive(encode(request + b"\x3b\x01\x00"), bench.now)
        assert [type(report) for report in bench.hear()] == [kind]


def test_7_two_bytes_in_one_argument_and_the_uncounted_nul_of_a_string(bench: Bench) -> None:
    bench.say(ON)
    bench.firmware.receive(encode(bytes.fromhex("20 1b f6 09")), bench.now)  # left -200, right 200
    bench.wait(2.0)
    assert bench.speed == pytest.approx(0.0)
    assert bench.turn_rate > 0.5
    bench.firmware.receive(encode(b"\xee\x2b\x02hi\x00"), bench.now)
    assert list(bench.firmware.console.messages) == ["hi"]


def test_8_without_motors_nothing_moves_and_silence_stops_it(bench: Bench) -> None:
    motion: tuple[Command, ...] = (
        commands.Vel(0.3),
        commands.RVel(0.3),
        commands.Rotate(0.3),
        commands.Vel2(left_units=10, right_units=10),
        commands.Move(1.0),
        commands.Head(pi / 2),
        commands.DHead(pi / 2),
    )
    bench.say(*motion)
    bench.wait(1.0)
    bench.say(ON)
    bench.wait(1.0)
    assert bench.body.robot_in_world.x == bench.body.robot_in_world.theta == 0.0
    bench.say(commands.Vel(0.3))
    bench.wait(1.9, pulse=False)
    assert bench.speed == pytest.approx(0.3)
    bench.wait(1.5, pulse=False)
    assert bench.speed == 0.0


@pytest.mark.parametrize(
    ("setup", "start", "kind", "readings"),
    [
        (LASER_SETUP, commands.OldLaser(SimLaserMode.EXTENDED), SimLaserExtended, 181),
        (LASER_SETUP, commands.OldLaser(SimLaserMode.RANGES), SimLaser, 181),
        ((), commands.SimLrfEnable(SimLaserMode.EXTENDED), SimLaserExtended, 181),
        ((), commands.SimLrfEnable(SimLaserMode.RANGES, laser=0), SimLaser, 181),
        (
            (
                commands.SimLrfSetFovStart(angle=radians(-135)),
                commands.SimLrfSetFovEnd(angle=radians(135)),
                commands.SimLrfSetRes(step=radians(0.5)),
            ),
            commands.SimLrfEnable(SimLaserMode.EXTENDED, laser=0),
            SimLaserExtended,
            541,
        ),
    ],
)
def test_9_the_laser_brings_whole_sweeps_behind_every_report(
    setup: tuple[Command, ...], start: Command, kind: type[Report], readings: int
) -> None:
    bench = Bench(wall_at(3.0)).open()
    bench.hear()
    bench.say(*setup, start)
    for _ in range(3):
        sip, *sweep = bench.wait(0.1)
        assert isinstance(sip, Sip)
        assert {type(packet) for packet in sweep} == {kind}
        counts: list[int] = []
        for packet in sweep:
            assert isinstance(packet, SimLaser | SimLaserExtended)
            assert (packet.total, packet.first) == (readings, sum(counts))
            part = packet.ranges_mm if isinstance(packet, SimLaser) else packet.readings
            counts.append(len(part))
        assert sum(counts) == readings
        assert max(counts) <= 32


@pytest.mark.parametrize("model", EVERY_MODEL)
def test_10_every_sonar_is_told_in_a_frame_of_at_most_200_bytes(model: str) -> None:
    bench = Bench(wall_at(0.8), model=model).open()
    sip = bench.sip()
    loaded = load_model(model)
    assert [reading.number for reading in sip.sonar] == list(range(len(loaded.sonars)))
    assert len(sip.sonar) <= 127
    assert len(encode(reports.to_payload(sip))) <= 200
    true = bench.world.sonar(bench.body)
    told = [reading.range_raw * loaded.range_factor for reading in sip.sonar]
    assert told == pytest.approx(true.tolist(), abs=loaded.range_factor / 2 + 1e-9)
