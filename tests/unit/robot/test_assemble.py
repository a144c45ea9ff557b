"""Raw reports become SI snapshots; counters become one continuous pose."""

from dataclasses import replace
from math import hypot, inf, isnan, pi

import pytest
from msgspec import structs

from pioneer3.arcos.reports import Config, Fault, Sip, SipFlag, SonarReading
from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.models import load_model
from pioneer3.robot.assemble import Assembler, Odometer
from pioneer3.state import Charging, Snapshot
from pioneer3.units import HEADING_UNITS

MODEL = replace(
    load_model("p3dx-sh"), distance_factor=0.001, wheel_base=0.4, front_bumpers=5, rear_bumpers=5
)
CONFIG = Config(family="Pioneer", model="p3dx-sh", serial_number="1", low_battery_decivolts=115)
QUARTER = HEADING_UNITS // 4


def snapshot(sip: Sip, config: Config | None = None) -> Snapshot:
    assembler = Assembler()
    assembler.session_opened(MODEL)
    return assembler.assemble(sip, 0.0, model=MODEL, config=config)


def test_the_first_reading_is_the_origin_wherever_the_counters_stand() -> None:
    odometer = Odometer()
    assert odometer.update(Sip(x_raw=12345, y_raw=77, heading_raw=1000), MODEL) == ORIGIN


def test_counters_become_metres_in_the_frame_of_the_start() -> None:
    odometer = Odometer()
    odometer.update(Sip(x_raw=500, y_raw=0, heading_raw=QUARTER), MODEL)
    here = odometer.update(Sip(x_raw=500, y_raw=1000, heading_raw=QUARTER), MODEL)
    assert here.x == pytest.approx(1.0)  # it looked along y when it began: that is ahead
    assert here.y == pytest.approx(0.0)
    assert here.theta == pytest.approx(0.0)


def test_a_drive_over_the_wrap_of_the_counter_is_continuous() -> None:
    odometer, last = Odometer(), ORIGIN
    odometer.update(Sip(x_raw=32700), MODEL)
    for step in range(1, 50):
        here = odometer.update(Sip(x_raw=(32700 + 50 * step) % 32768), MODEL)
        assert here.x - last.x == pytest.approx(0.05)
        last = here
    assert last.x == pytest.approx(2.45)


def test_a_restart_goes_on_from_the_present_pose() -> None:
    odometer = Odometer()
    odometer.update(Sip(), MODEL)
    before = odometer.update(Sip(x_raw=2000, heading_raw=QUARTER), MODEL)
    odometer.restart()
    assert odometer.update(Sip(x_raw=9, y_raw=9, heading_raw=77), MODEL) == before
    after = odometer.update(Sip(x_raw=9, y_raw=9, heading_raw=77 + QUARTER), MODEL)
    assert after.theta == pytest.approx(pi)
    assert hypot(after.x - before.x, after.y - before.y) == pytest.approx(0)


def test_the_encoders_own_pose_knows_nothing_of_the_sessions_before() -> None:
    odometer = Odometer()
    odometer.restart(Pose2(1, 2, 0.5))
    odometer.update(Sip(x_raw=400, heading_raw=QUARTER), MODEL)
    odometer.update(Sip(x_raw=900, y_raw=32768 - 100, heading_raw=QUARTER), MODEL)
    assert odometer.robot_in_encoder == Pose2(0.5, -0.1, pi / 2)


def test_a_restart_may_name_the_pose() -> None:
    odometer = Odometer()
    odometer.restart(Pose2(1, 2, 0.5))
    assert odometer.update(Sip(x_raw=400, heading_raw=100), MODEL) == Pose2(1, 2, 0.5)


def test_wheel_speeds_become_a_twist() -> None:
    odometry = snapshot(Sip(left_speed_raw=100, right_speed_raw=300)).odometry
    factor = MODEL.speed_factor
    assert (odometry.left_speed, odometry.right_speed) == (100 * factor, 300 * factor)
    assert odometry.twist.v == pytest.approx(200 * factor)
    assert odometry.twist.w == pytest.approx(200 * factor / 0.4)


def full(**changes: int) -> Sip:
    """Return a long report, every field behind the sonars present."""
    fields = {
        "analog_port": 0,
        "gripper_state": 0,
        "analog": 0,
        "digital_in": 0,
        "digital_out": 0,
        "battery_decivolts_wide": 0,
        "charge_state": 0,
        "turn_rate_decidegrees": 0,
        "faults": Fault(0),
        "lateral_speed_mm": 0,
        "temperature_celsius": -128,
        "charge_percent": 0,
        **changes,
    }
    return Sip(**fields)  # type: ignore[arg-type]


def test_a_measured_turn_rate_is_preferred() -> None:
    twist = snapshot(full(turn_rate_decidegrees=900)).odometry.twist
    assert twist.w == pytest.approx(pi / 2)


def test_sonars_are_nan_until_read_and_inf_where_nothing_echoes() -> None:
    assembler = Assembler()
    assembler.session_opened(MODEL)
    first = Sip(sonar=(SonarReading(0, 1500), SonarReading(2, 5000)), flags=SipFlag.SONAR_1)
    sonar = assembler.assemble(first, 0.0, model=MODEL, config=None).sonar
    assert sonar.ranges[0] == pytest.approx(1.5)
    assert isnan(sonar.ranges[1])
    assert sonar.ranges[2] == inf
    assert sonar.fresh == (0, 2)
    assert sonar.enabled
    assert sonar.nearest == pytest.approx(1.5)
    second = Sip(sonar=(SonarReading(1, 700),))
    sonar = assembler.assemble(second, 0.1, model=MODEL, config=None).sonar
    assert sonar.ranges[:2] == pytest.approx((1.5, 0.7))
    assert sonar.fresh == (1,)
    assert not sonar.enabled


def test_a_transducer_that_the_model_does_not_know_is_kept() -> None:
    ranges = snapshot(Sip(sonar=(SonarReading(20, 1000),))).sonar.ranges
    assert len(ranges) == 21
    assert ranges[20] == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("sip", "config", "voltage", "low"),
    [
        (Sip(battery_decivolts=121), CONFIG, 12.1, False),
        (Sip(battery_decivolts=114), CONFIG, 11.4, True),
        (Sip(battery_decivolts=114), None, 11.4, False),
        (Sip(battery_decivolts=0), CONFIG, 0.0, False),
        (full(battery_decivolts_wide=268), CONFIG, 26.8, False),
        (full(battery_decivolts_wide=130, faults=Fault.UNDERVOLTAGE), CONFIG, 13.0, True),
    ],
)
def test_the_battery_is_low_below_the_robots_own_alarm(
    sip: Sip, config: Config | None, voltage: float, low: bool
) -> None:
    battery = snapshot(sip, config).battery
    assert battery.voltage == pytest.approx(voltage)
    assert battery.low is low


@pytest.mark.parametrize(
    ("state", "charging"),
    [(0, Charging.NONE), (1, Charging.BULK), (3, Charging.FLOAT), (9, Charging.UNKNOWN)],
)
def test_the_charger_is_named(state: int, charging: Charging) -> None:
    battery = snapshot(full(charge_state=state, charge_percent=80)).battery
    assert battery.charging is charging
    assert battery.charge == 0.8


def test_short_reports_leave_unknown_what_they_do_not_say() -> None:
    here = snapshot(Sip())
    assert here.battery.charging is Charging.UNKNOWN
    assert here.battery.charge is None
    assert here.inputs.temperature is None
    assert here.inputs.compass is None
    assert here.faults == ()


def test_motor_and_stall_bits_are_told_apart_from_bumpers() -> None:
    sip = Sip(
        flags=SipFlag.MOTORS_ENABLED | SipFlag.STOP_BUTTON,
        left_stall_rear_bumpers=0b00000011,
        right_stall_front_bumpers=0b00100000,
    )
    here = snapshot(sip)
    assert here.motors.enabled
    assert here.motors.stop_button
    assert here.motors.left_stalled
    assert not here.motors.right_stalled
    assert here.motors.stalled
    assert here.bumpers.rear == (True, False, False, False, False)
    assert here.bumpers.front == (False, False, False, False, True)


def test_bumpers_are_counted_by_config_where_it_says_so() -> None:
    config = structs.replace(CONFIG, front_bumpers=3, rear_bumpers=0)
    bumpers = snapshot(Sip(), config).bumpers
    assert (len(bumpers.front), len(bumpers.rear)) == (3, 5)


def test_inputs_become_volts_radians_and_degrees() -> None:
    sip = structs.replace(full(analog=255, temperature_celsius=40, digital_in=5), compass_raw=45)
    inputs = snapshot(sip).inputs
    assert inputs.analog == pytest.approx(5.0)
    assert inputs.compass == pytest.approx(pi / 2)
    assert inputs.temperature == 40
    assert inputs.digital_in == 5
    assert snapshot(full(temperature_celsius=-127)).inputs.temperature is None


def test_faults_are_named() -> None:
    assert snapshot(full(faults=Fault.HIGH_TEMPERATURE | Fault.GYRO_FAULT)).faults == (
        "high temperature",
        "gyro fault",
    )


def test_reports_are_counted_per_second_session_and_life() -> None:
    assembler = Assembler()
    assembler.session_opened(MODEL)
    for tenth in range(25):
        here = assembler.assemble(Sip(), tenth / 10, model=MODEL, config=None, bad_checksums=3)
    assert here.link.rate == pytest.approx(10, abs=1)
    assert (here.link.reports, here.sequence, here.link.sessions) == (25, 25, 1)
    assert here.link.bad_checksums == 3
    assembler.session_opened(MODEL)
    here = assembler.assemble(Sip(), 9.0, model=MODEL, config=None)
    assert (here.link.reports, here.sequence, here.link.sessions) == (1, 26, 2)
