"""Commands become motion, the world becomes reports (protocol.md 2.7, 3, facts.md 12)."""

from math import degrees, radians

import pytest

from pioneer3.arcos import commands, reports
from pioneer3.arcos.commands import Command, RequestMode
from pioneer3.arcos.reports import Report
from pioneer3.geometry import Pose2
from pioneer3.sim.kernels.drives import LEFT
from tests.support import is_at, wall_at
from tests.unit.sim.bench import ON, SYNCS, Bench

ALL_SONARS = (
    reports.SipFlag.SONAR_1
    | reports.SipFlag.SONAR_2
    | reports.SipFlag.SONAR_3
    | reports.SipFlag.SONAR_4
)


@pytest.fixture
def bench() -> Bench:
    made = Bench().open()
    made.hear()
    return made


def test_before_open_it_only_answers() -> None:
    bench = Bench()
    bench.firmware.receive(SYNCS, 0.0)
    assert [type(r) for r in bench.wait(1.0)][:3] == [
        reports.SyncEcho,
        reports.SyncEcho,
        reports.SyncIdentity,
    ]
    assert bench.wait(1.0, pulse=False) == []


def test_from_open_on_it_reports_ten_times_a_second_beginning_at_once() -> None:
    bench = Bench().open()
    assert isinstance(bench.hear()[-1], reports.Sip)
    assert len(bench.wait(10.0)) == 100


def test_a_report_holds_what_the_robot_is_and_does(bench: Bench) -> None:
    bench.say(ON, commands.Vel(0.3), commands.RVel(radians(20)))
    sip = bench.wait(3.0)[-1]
    assert isinstance(sip, reports.Sip)
    model = bench.body.model
    assert sip.moving
    assert sip.flags == reports.SipFlag.MOTORS_ENABLED | ALL_SONARS
    half = radians(20) * bench.body.track / 2
    assert sip.left_speed_raw * model.speed_factor == pytest.approx(0.3 - half, abs=0.002)
    assert sip.right_speed_raw * model.speed_factor == pytest.approx(0.3 + half, abs=0.002)
    assert sip.turn_rate_decidegrees == pytest.approx(200, abs=2)
    assert sip.battery_decivolts == sip.battery_decivolts_wide
    assert sip.battery_decivolts == round(bench.body.battery.voltage * 10)
    assert len(sip.sonar) == len(model.sonars)
    assert sip.temperature_celsius == round(bench.body.motor_temperature)


@pytest.mark.parametrize("late", [0.0, 0.04, 0.06])
def test_the_first_reaction_is_in_the_next_report(bench: Bench, late: float) -> None:
    bench.say(ON)
    bench.wait(0.1 + late)
    bench.say(commands.Vel(0.3))
    sip = bench.wait(0.1 - late)[-1]
    assert isinstance(sip, reports.Sip)
    assert sip.moving
    assert sip.left_speed_raw > 0
    assert sip.x_raw > 0 or late > 0


def test_at_rest_the_report_has_the_other_number(bench: Bench) -> None:
    sip = bench.wait(0.1)[0]
    assert isinstance(sip, reports.Sip)
    assert sip.number == reports.SIP_STOPPED


def test_odometry_counts_in_fifteen_bits(bench: Bench) -> None:
    bench.body.reset_odometry(Pose2(-0.5, 40.0, 0.0))
    sip = bench.firmware.information(bench.now)
    unit = bench.body.model.distance_factor
    assert sip.x_raw == round(-0.5 / unit) % 32768
    assert sip.y_raw == round(40.0 / unit) % 32768


def test_with_motors_off_motion_commands_are_forgotten(bench: Bench) -> None:
    bench.say(commands.Vel(0.3), commands.Move(1.0), commands.DHead(1.0))
    bench.wait(1.0)
    bench.say(ON)
    bench.wait(1.0)
    assert is_at(bench.body.robot_in_world, Pose2())


def test_disabling_stops_hard(bench: Bench) -> None:
    bench.say(ON, commands.Vel(0.4))
    bench.wait(2.0)
    bench.say(commands.Enable(on=False))
    bench.wait(0.12)
    assert bench.speed == 0.0


def test_stop_slows_down_at_the_set_deceleration(bench: Bench) -> None:
    bench.say(ON, commands.SetA(-1.0), commands.Vel(0.4))
    bench.wait(2.0)
    bench.say(commands.Stop())
    bench.wait(0.2)
    assert bench.speed == pytest.approx(0.4 - 1.0 * 0.2)


@pytest.mark.parametrize("command", [commands.EStop(), commands.QStop()])
def test_an_emergency_stop_ignores_motion_until_it_stands(bench: Bench, command: Command) -> None:
    bench.say(ON, commands.Vel(0.4))
    bench.wait(2.0)
    bench.say(command, commands.Vel(0.4))
    bench.wait(0.8)
    assert bench.speed == 0.0
    bench.say(commands.Vel(0.4))
    bench.wait(1.0)
    assert bench.speed > 0.2


def test_an_emergency_stop_at_rest_is_no_life_sentence(bench: Bench) -> None:
    bench.say(ON, commands.EStop(), commands.Vel(0.4))
    bench.wait(1.0)
    assert bench.speed > 0.2


def test_setv_and_setrv_are_limits(bench: Bench) -> None:
    bench.say(ON, commands.SetV(0.2), commands.SetRV(radians(30)))
    bench.say(commands.Vel(0.6), commands.RVel(radians(90)))
    bench.wait(3.0)
    assert bench.speed == pytest.approx(0.2)
    assert bench.turn_rate == pytest.approx(radians(30))


def test_no_setting_lifts_a_robot_above_its_own_top(bench: Bench) -> None:
    bench.say(ON, commands.SetV(9.0), commands.SetA(9.0), commands.Vel(9.0))
    bench.wait(3.0)
    assert bench.speed == pytest.approx(bench.body.model.max_speed)


def test_accelerations_are_set_by_their_sign(bench: Bench) -> None:
    bench.say(commands.SetA(0.5), commands.SetA(-0.7), commands.SetRA(1.5), commands.SetRA(-2.0))
    linear, angular = bench.body.drive.linear, bench.body.drive.angular
    assert (linear.acceleration, linear.deceleration) == pytest.approx((0.5, 0.7))
    assert (angular.acceleration, angular.deceleration) == pytest.approx((1.5, 2.0), abs=0.01)
    bench.say(commands.SetA(0.0))
    assert linear.acceleration == pytest.approx(0.5)


def test_move_covers_its_distance(bench: Bench) -> None:
    bench.say(ON, commands.Move(-0.8))
    bench.wait(8.0)
    assert bench.body.robot_in_world.x == pytest.approx(-0.8, abs=0.001)


@pytest.mark.parametrize(
    ("said", "heading"),
    [
        ((commands.DHead(radians(90)),), 90),
        ((commands.Head(radians(-90)),), -90),
        ((commands.DHead(radians(170)), commands.Head(radians(-170))), -170),
    ],
)
def test_headings_are_reached(bench: Bench, said: tuple[Command, ...], heading: float) -> None:
    bench.say(ON)
    for command in said:
        bench.say(command)
        bench.wait(8.0)
    assert degrees(bench.body.robot_in_world.theta) == pytest.approx(heading, abs=0.2, rel=0.01)


def test_vel2_drives_each_wheel(bench: Bench) -> None:
    bench.say(ON, commands.Vel2(left_units=10, right_units=5))
    bench.wait(3.0)
    unit = bench.body.model.vel2_unit
    assert bench.speed == pytest.approx(7.5 * unit, abs=1e-3)
    assert bench.turn_rate == pytest.approx(-5 * unit / bench.body.track, abs=2e-3)


def test_rotate_is_another_name_for_rvel(bench: Bench) -> None:
    bench.say(ON, commands.Rotate(radians(20)))
    bench.wait(1.0)
    assert bench.turn_rate == pytest.approx(radians(20))


def test_the_watchdog_holds_and_any_packet_lets_go(bench: Bench) -> None:
    bench.say(ON, commands.Vel(0.3))
    bench.wait(1.0)
    bench.wait(1.98, pulse=False)
    assert bench.speed == pytest.approx(0.3)
    bench.wait(1.1, pulse=False)
    assert bench.speed == 0.0
    bench.say(commands.Pulse())
    bench.wait(1.1)
    assert bench.speed == pytest.approx(0.3)


def test_setting_the_odometry_moves_no_robot(bench: Bench) -> None:
    bench.body.robot_in_world = Pose2(5, 5, 1)
    bench.say(commands.SetO(x=1.0, y=-2.0, heading=radians(90)))
    assert bench.body.robot_in_odom == Pose2(1.0, -2.0, radians(90))
    assert bench.body.robot_in_world == Pose2(5, 5, 1)
    bench.say(commands.SetO())
    assert bench.body.robot_in_odom == Pose2()


def test_any_heading_it_is_told_stays_on_the_wire(bench: Bench) -> None:
    bench.say(commands.SetO(x=0.0, y=0.0, heading=radians(3000)))
    assert bench.body.robot_in_odom.theta == pytest.approx(radians(3000 - 8 * 360))
    assert isinstance(bench.wait(0.1)[0], reports.Sip)


def test_a_wall_stalls_both_sides() -> None:
    bench = Bench(wall_at(0.6)).open()
    bench.say(ON, commands.Vel(0.3))
    sip = bench.wait(5.0)[-1]
    assert isinstance(sip, reports.Sip)
    assert (sip.left_stall_rear_bumpers, sip.right_stall_front_bumpers) == (1, 1)


def test_sonars_may_be_switched_off(bench: Bench) -> None:
    bench.say(commands.Sonar(on=False))
    sip = bench.wait(0.1)[0]
    assert isinstance(sip, reports.Sip)
    assert sip.sonar == ()
    assert not sip.flags & ALL_SONARS


def test_the_stop_button_shows(bench: Bench) -> None:
    bench.say(ON)
    bench.body.stop_button = True
    sip = bench.wait(0.1)[0]
    assert isinstance(sip, reports.Sip)
    assert sip.flags & reports.SipFlag.STOP_BUTTON
    assert not sip.flags & reports.SipFlag.MOTORS_ENABLED


def test_config_tells_the_limits_in_force(bench: Bench) -> None:
    bench.say(commands.SetV(0.4), commands.SetA(-0.6), commands.RequestConfig())
    config = bench.hear()[0]
    assert isinstance(config, reports.Config)
    assert config.speed_max_mm_s == 400
    assert config.decel_mm_s2 == 600
    assert config.speed_top_mm_s == round(bench.body.model.max_speed * 1000)
    assert config.watchdog_ms == 2000
    assert config.sip_cycle_ms == 100


@pytest.mark.parametrize(
    ("request_", "kind"),
    [(commands.IoRequest, reports.Io), (commands.RequestEncoders, reports.Encoders)],
)
def test_extra_reports_come_once_or_with_every_cycle(
    bench: Bench, request_: type[Command], kind: type[Report]
) -> None:
    def count(seconds: float) -> int:
        return sum(isinstance(report, kind) for report in bench.wait(seconds))

    bench.say(request_(RequestMode.ONCE))
    assert count(1.0) == 1
    bench.say(request_(RequestMode.STREAM))
    assert count(1.0) == 10
    bench.say(request_(RequestMode.STOP))
    assert count(1.0) == 0


def test_encoders_count_beyond_what_their_field_holds(bench: Bench) -> None:
    bench.body.set_wheel(LEFT, 20_000.0)
    bench.say(commands.RequestEncoders(RequestMode.ONCE))
    encoders = bench.hear()[0]
    assert isinstance(encoders, reports.Encoders)
    assert encoders.left_counts == 20_000 * 138_000 - (1 << 32)


def test_outputs_are_set_by_mask(bench: Bench) -> None:
    bench.say(commands.DigOut(mask=0x0F, values=0x05), commands.IoRequest(RequestMode.ONCE))
    io = bench.hear()[0]
    assert isinstance(io, reports.Io)
    assert io.digital_out == (0xF5,)


def test_a_faked_battery_shows(bench: Bench) -> None:
    bench.say(commands.BatTest(11.2))
    sip = bench.wait(0.1)[0]
    assert isinstance(sip, reports.Sip)
    assert sip.battery_decivolts == 112
    bench.say(commands.BatTest(0.0))
    assert bench.body.battery.voltage > 12.9


def test_a_simulated_robot_may_be_put_somewhere_and_sent_home(bench: Bench) -> None:
    bench.say(commands.SimSetPose(x=1.0, y=2.0, heading=radians(90)))
    assert bench.body.robot_in_world == Pose2(1.0, 2.0, radians(90))
    bench.say(commands.SimReset())
    assert bench.body.robot_in_world == Pose2()


def test_what_this_robot_does_not_have_is_ignored(bench: Bench) -> None:
    bench.say(
        commands.named("SOUNDTOG", False),
        commands.named("JOYDRIVE", True),
        commands.Gyro(commands.GyroMode.ON),
    )
    assert [type(report) for report in bench.wait(0.1)] == [reports.Sip]


def test_closing_stops_everything(bench: Bench) -> None:
    bench.say(ON, commands.Vel(0.4), commands.IoRequest(RequestMode.STREAM))
    bench.wait(2.0)
    bench.say(commands.Close())
    bench.hear()
    assert bench.wait(1.0, pulse=False) == []
    assert bench.speed == 0.0
    assert not bench.body.drive.powered
    bench.open()
    assert not any(isinstance(report, reports.Io) for report in bench.wait(1.0))


def test_a_link_that_is_gone_for_good_ends_the_session(bench: Bench) -> None:
    bench.say(ON, commands.Vel(0.4))
    bench.wait(1.0)
    bench.firmware.hang_up(bench.now)
    bench.wait(0.2)
    assert bench.speed == 0.0
    assert not bench.firmware.device.is_open


def test_late_ticks_do_not_make_reports_pile_up(bench: Bench) -> None:
    bench.now += 5.0
    bench.firmware.tick(bench.now)
    assert len(bench.hear()) == 1
    bench.firmware.tick(bench.now + 0.05)
    assert bench.hear() == []
