"""Sonar and laser that are wrong by so much as they should be."""

from collections.abc import Callable
from dataclasses import replace
from math import pi
from typing import cast

import numpy as np
import pytest
from numpy.random import default_rng
from numpy.typing import NDArray

from pioneer3.errors import ConfigError
from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.maps import LineMap
from pioneer3.models import load_model
from pioneer3.sim.body import Body
from pioneer3.sim.kernels import build_grid
from pioneer3.sim.realism import OdometryErrors, OdometryMode, Realism, SonarErrors
from pioneer3.sim.sensors import LASER_RANGE, SONAR_RANGE
from pioneer3.sim.world import World

Float = NDArray[np.float64]

DX = load_model("p3dx-sh")
IDEAL = Realism.ideal()
HEARD = np.linspace(0.2, 4.9, 16)


def heard(
    count: int = 4000,
    *,
    noise: float = 0.0,
    quantum: float = 0.0,
    drop_out: float = 0.0,
    cross_talk: float = 0.0,
) -> Float:
    """Return what is heard of the same ranges many times, shape (count, 16)."""
    sonar = SonarErrors(noise=noise, quantum=quantum, drop_out=drop_out, cross_talk=cross_talk)
    return sonar.spoil(np.tile(HEARD, (count, 1)), SONAR_RANGE, default_rng(0))


def test_sonar_without_errors_is_exact() -> None:
    np.testing.assert_array_equal(heard(2), np.tile(HEARD, (2, 1)))


def test_the_noise_of_sonar_is_a_share_of_the_range() -> None:
    off = heard(noise=0.01) / HEARD - 1
    np.testing.assert_allclose(off.std(axis=0), 0.01, rtol=0.06)
    np.testing.assert_allclose(off.mean(axis=0), 0.0, atol=0.0007)


def test_ranges_come_in_steps() -> None:
    found = heard(1, noise=0.01, quantum=0.05)
    np.testing.assert_allclose(found / 0.05, np.rint(found / 0.05), rtol=0, atol=1e-9)
    assert abs(found - heard(1, noise=0.01)).max() <= 0.025 + 1e-12


def test_echoes_are_missed_as_often_as_said() -> None:
    missed = heard(drop_out=0.03) == SONAR_RANGE
    assert missed.mean() == pytest.approx(0.03, abs=0.003)
    assert (missed.sum(axis=0) > 0).all()


def test_a_neighbour_is_mistaken_for_the_own_echo_only_if_it_is_nearer() -> None:
    far_then_near = HEARD[::-1]
    sonar = SonarErrors(noise=0.0, quantum=0.0, drop_out=0.0, cross_talk=0.04)
    ranges = np.tile(far_then_near, (4000, 1))
    found = sonar.spoil(ranges, SONAR_RANGE, default_rng(0))
    wrong = found != ranges
    assert wrong[:, 0].mean() == pytest.approx(0.04, abs=0.012)
    np.testing.assert_array_equal(found[wrong[:, 0], 0], far_then_near[1])
    assert not wrong[:, 1:].any()  # whoever is before them hears an echo from further away
    np.testing.assert_array_equal(heard(cross_talk=1.0)[0, 1:], HEARD[:-1])


def test_silence_stays_silence() -> None:
    silent = np.full((50, 16), SONAR_RANGE)
    found = replace(SonarErrors(), quantum=0.03).spoil(silent, SONAR_RANGE, default_rng(0))
    np.testing.assert_array_equal(found, silent)


def test_what_is_spoilt_is_a_copy() -> None:
    ranges = HEARD.copy()
    for errors in (SonarErrors(), SonarErrors(noise=0.0), SonarErrors(drop_out=1.0, cross_talk=0)):
        errors.spoil(ranges, SONAR_RANGE, default_rng(0))
        np.testing.assert_array_equal(ranges, HEARD)


def test_transducers_that_a_robot_has_not_hear_nothing() -> None:
    few = replace(DX, sonars=DX.sonars[:8])
    bodies = [Body(DX, Pose2(0, 1)), Body(few, Pose2(0, -1))]
    walls = np.array([[-2.0, -2, 2, -2], [2, -2, 2, 2], [2, 2, -2, 2], [-2, 2, -2, -2]])
    often = replace(Realism(), sonar=SonarErrors(cross_talk=0.9, drop_out=0.0))
    world = World(LineMap(name="room", walls=walls), bodies, realism=often)
    ranges = world.sonars()
    assert (ranges[1, 8:] == SONAR_RANGE).all()
    assert (ranges[1, :8] < SONAR_RANGE).any()
    assert world.sonar(bodies[1]).shape == (8,)


def test_a_corner_that_no_face_of_echoes_is_heard_from_near() -> None:
    box = np.array([[0.0, 0, 1, 1], [1, 1, 2, 0], [2, 0, 1, -1], [1, -1, 0, 0]])
    line_map = LineMap(name="box", walls=box)
    always = SonarErrors(cycle=0.0, drop_out=0.0, cross_talk=0.0, noise=0.0)
    mount, realism = DX.sonars[3], replace(IDEAL, sonar=always)
    for away, expected in ((0.99, 0.99), (1.01, SONAR_RANGE)):
        at = Pose2(-away) @ Pose2(mount.x, mount.y, mount.theta).inverse()
        body = Body(DX, at)
        assert World(line_map, [body], realism=realism).sonar(body)[3] == pytest.approx(expected)


def test_a_laser_is_as_noisy_as_said_and_silent_where_nothing_is() -> None:
    body = Body(DX)
    wall = LineMap(name="wall", walls=np.array([[5.0, -5.0, 5.0, 5.0]]))
    world = World(wall, [body], realism=replace(IDEAL, laser_noise=0.02))
    ahead = np.array([world.laser(body, ORIGIN, 0.0, pi, 2) for _ in range(2000)])
    assert ahead[:, 0].std() == pytest.approx(0.02, rel=0.06)
    assert ahead[:, 0].mean() == pytest.approx(5.0, abs=0.002)
    assert (ahead[:, 1] == LASER_RANGE).all()


@pytest.mark.parametrize(
    "wrong",
    [
        lambda: OdometryErrors(mode=cast("OdometryMode", "some")),
        lambda: OdometryErrors(wheel_ratio=0.0),
        lambda: OdometryErrors(base_ratio=float("nan")),
        lambda: OdometryErrors(way_noise=-0.1),
        lambda: OdometryErrors(slip=1.0),
        lambda: SonarErrors(rays=0),
        lambda: SonarErrors(critical=0.0),
        lambda: SonarErrors(width=pi),
        lambda: SonarErrors(drop_out=1.5),
        lambda: SonarErrors(cycle=-0.04),
        lambda: SonarErrors(edge_range=-0.1),
        lambda: SonarErrors(drop_out=0.6, cross_talk=0.6),
        lambda: Realism(laser_noise=float("inf")),
    ],
)
def test_what_no_robot_does_is_refused(wrong: Callable[[], object]) -> None:
    with pytest.raises(ConfigError):
        wrong()


def test_ideal_is_all_off_and_another_mode_changes_nothing_else() -> None:
    echoes = IDEAL.sonar.echoes(build_grid(np.array([[0.0, 0.0, 1.0, 0.0]])))
    assert (echoes.steep, echoes.edges, echoes.edge_range) == (0.0, None, 0.0)
    assert IDEAL.odometry.mode == "none"
    assert not World(None, [Body(DX)], realism=IDEAL).drives.noisy
    noisy = IDEAL.with_odometry("all")
    assert noisy.sonar == IDEAL.sonar
    assert noisy.odometry == replace(IDEAL.odometry, mode="all")
