from math import radians

import numpy as np
import pytest

from pioneer3.arcos import commands, reports
from pioneer3.arcos.commands import GyroMode
from pioneer3.geometry import Pose2, wrap
from pioneer3.sim.accessories.heading import SimulatedGyro
from tests.unit.sim.accessories.carrier import FakeCarrier

ON, OFF = commands.Gyro(GyroMode.ON), commands.Gyro(GyroMode.OFF)
ARIA_STEP_DEG = 5 / 1023 * 300 / 2.5 * 1.626
"""Degrees a second that ARIA reads in one count (protocol.md 5.4)."""


def gyro(
    carrier: FakeCarrier, *, packets: bool = True, bias: float = 0, noise: float = 0
) -> SimulatedGyro:
    rng = np.random.default_rng(7)
    return SimulatedGyro(carrier, rng, packets=packets, bias=bias, noise=noise)


def turn(
    made: SimulatedGyro, carrier: FakeCarrier, rate: float, seconds: float = 1.0
) -> list[list[int]]:
    """Turn at `rate` [rad/s] in steps of 20 ms; return the samples of each cycle."""
    made.obey(ON, 0.0)
    heard = []
    for step in range(1, round(seconds / 0.02) + 1):
        now = step * 0.02
        carrier.robot_in_world = Pose2(0, 0, wrap(rate * now))
        made.tick(now)
        if step % 5 == 0:
            for report in made.reports(now, cycle=True):
                assert isinstance(report, reports.GyroRates)
                heard.append([sample.rate_raw for sample in report.samples])
    return heard


def test_at_rest_every_cycle_brings_four_samples_of_512() -> None:
    carrier = FakeCarrier()
    assert turn(gyro(carrier), carrier, 0.0) == [[512] * 4] * 10


@pytest.mark.parametrize("rate_deg", [-200, -30, 30, 90, 250])
def test_aria_reads_the_rate_back(rate_deg: float) -> None:
    carrier = FakeCarrier()
    for samples in turn(gyro(carrier), carrier, radians(rate_deg)):
        read = [-(raw - 512) * ARIA_STEP_DEG for raw in samples]
        assert read == pytest.approx([rate_deg] * 4, abs=ARIA_STEP_DEG / 2 + 1e-6)


def test_left_is_below_512() -> None:
    carrier = FakeCarrier()
    assert turn(gyro(carrier), carrier, 1.0)[0][0] < 512


def test_what_is_too_fast_stops_at_the_end_of_the_scale() -> None:
    carrier = FakeCarrier()
    assert turn(gyro(carrier), carrier, radians(600))[0] == [0] * 4
    carrier = FakeCarrier()
    assert turn(gyro(carrier), carrier, radians(-600))[0] == [1023] * 4


def test_being_put_elsewhere_is_not_a_turn() -> None:
    carrier = FakeCarrier()
    made = gyro(carrier)
    made.obey(ON, 0.0)
    carrier.robot_in_world = Pose2(1, 1, 3.0)
    made.tick(0.02)
    (report,) = made.reports(0.1, cycle=True)
    assert isinstance(report, reports.GyroRates)
    assert {sample.rate_raw for sample in report.samples} == {512}


def test_a_bias_shows_at_rest() -> None:
    carrier = FakeCarrier()
    made = gyro(carrier, bias=radians(5 * ARIA_STEP_DEG))
    assert turn(made, carrier, 0.0)[0] == [507] * 4


def test_noise_is_seeded_and_has_its_deviation() -> None:
    runs = []
    for _ in range(2):
        carrier = FakeCarrier()
        runs.append(turn(gyro(carrier, noise=radians(4 * ARIA_STEP_DEG)), carrier, 0.0, 20.0))
    assert runs[0] == runs[1]
    assert np.std(np.concatenate(runs[0])) == pytest.approx(4.0, rel=0.1)


def test_off_and_hung_up_it_is_silent() -> None:
    carrier = FakeCarrier()
    made = gyro(carrier)
    assert list(made.reports(0.1, cycle=True)) == []
    made.obey(ON, 0.1)
    assert len(made.reports(0.2, cycle=True)) == 1
    assert list(made.reports(0.25, cycle=False)) == []
    made.obey(OFF, 0.3)
    assert list(made.reports(0.4, cycle=True)) == []
    made.obey(ON, 0.4)
    made.hang_up()
    assert list(made.reports(0.5, cycle=True)) == []


def test_a_gyro_that_the_controller_uses_sends_nothing() -> None:
    made = gyro(FakeCarrier(), packets=False)
    assert made.obey(commands.Gyro(GyroMode.ONLY), 0.0)
    assert list(made.reports(0.1, cycle=True)) == []


def test_a_long_silence_leaves_no_more_samples_than_fit_a_packet() -> None:
    made = gyro(FakeCarrier())
    made.obey(ON, 0.0)
    made.tick(1000.0)
    (report,) = made.reports(1000.1, cycle=True)
    assert isinstance(report, reports.GyroRates)
    assert len(report.samples) <= 12


def test_calibrations_are_taken() -> None:
    made = gyro(FakeCarrier())
    assert made.obey(commands.GyroCW(940), 0.0)
    assert made.obey(commands.GyroCCW(950), 0.0)
    assert not made.obey(commands.Sonar(on=True), 0.0)
