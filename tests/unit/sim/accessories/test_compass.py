from math import pi, radians

import numpy as np
import pytest

from pioneer3.arcos import commands, reports
from pioneer3.arcos.commands import Tcm2Mode
from pioneer3.geometry import Pose2, wrap
from pioneer3.sim.accessories.base import NOTHING
from pioneer3.sim.accessories.heading import SimulatedCompass
from tests.unit.sim.accessories.carrier import FakeCarrier, answers, cycles


def compass(theta: float = 0.0, north: float = pi / 2, noise: float = 0.0) -> SimulatedCompass:
    carrier = FakeCarrier(robot_in_world=Pose2(1, 2, theta))
    return SimulatedCompass(carrier, np.random.default_rng(3), north=north, noise=noise)


def packet(made: SimulatedCompass) -> reports.Compass:
    made.obey(commands.Tcm2(Tcm2Mode.ONCE), 0.0)
    (report,) = answers(made)
    assert isinstance(report, reports.Compass)
    return report


@pytest.mark.parametrize(
    ("theta_deg", "heading_deg"),
    [(0, 90), (90, 0), (180, 270), (-90, 180), (60, 30), (91, 359), (-179.9, 269.9)],
)
def test_it_reads_clockwise_from_the_y_axis(theta_deg: float, heading_deg: float) -> None:
    made = compass(radians(theta_deg))
    assert packet(made).heading_decidegrees == round(heading_deg * 10)
    assert made.inputs(NOTHING, 0.0).compass_raw == round(heading_deg / 2) % 180


def test_north_may_lie_elsewhere() -> None:
    assert packet(compass(0.3, north=0.3)).heading_decidegrees == 0


@pytest.mark.parametrize("theta", [wrap(0.001 * k) for k in range(0, 6284, 61)])
def test_readings_stay_in_their_ranges(theta: float) -> None:
    made = compass(theta)
    assert 0 <= packet(made).heading_decidegrees < 3600
    assert 0 <= made.inputs(NOTHING, 0.0).compass_raw < 180


def test_the_field_points_north() -> None:
    north, west = packet(compass(pi / 2)), packet(compass(pi))
    assert (north.magnetic_x_hundredths, north.magnetic_y_hundredths) == (2000, 0)
    assert (west.magnetic_x_hundredths, west.magnetic_y_hundredths) == (0, 2000)


def test_off_there_is_no_heading_in_the_standard_report() -> None:
    made = compass()
    assert made.inputs(NOTHING, 0.0).compass_raw == 45
    made.obey(commands.Tcm2(Tcm2Mode.OFF), 0.0)
    assert made.inputs(NOTHING, 0.0).compass_raw == 0
    made.obey(commands.Tcm2(Tcm2Mode.SIP_ONLY), 0.0)
    assert made.inputs(NOTHING, 0.0).compass_raw == 45


@pytest.mark.parametrize("mode", [Tcm2Mode.SIP_ONLY, Tcm2Mode.SOFT_RESET, Tcm2Mode.OFF])
def test_other_modes_end_the_stream(mode: Tcm2Mode) -> None:
    made = compass()
    made.obey(commands.Tcm2(Tcm2Mode.STREAM), 0.0)
    made.obey(commands.Tcm2(mode), 0.0)
    assert cycles(made, 3) == []


def test_a_calibration_gives_scores_and_a_reset_takes_them() -> None:
    made = compass()
    assert packet(made).calibration_h == 0
    made.obey(commands.Tcm2(Tcm2Mode.STOP_CALIBRATION), 0.0)
    assert packet(made).calibration_h == 0
    made.obey(commands.Tcm2(Tcm2Mode.STREAM), 0.0)
    made.obey(commands.Tcm2(Tcm2Mode.USER_CALIBRATION), 0.0)
    made.obey(commands.Tcm2(Tcm2Mode.STOP_CALIBRATION), 0.0)
    assert len(cycles(made, 3)) == 3
    assert packet(made).calibration_v == 9
    made.obey(commands.Tcm2(Tcm2Mode.SOFT_RESET), 0.0)
    assert packet(made).calibration_h == 0


def test_noise_has_its_deviation() -> None:
    made = compass(0.0, noise=radians(2))
    heard = [packet(made).heading_decidegrees / 10 for _ in range(500)]
    assert np.mean(heard) == pytest.approx(90, abs=0.5)
    assert np.std(heard) == pytest.approx(2, rel=0.15)
