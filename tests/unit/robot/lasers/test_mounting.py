"""Scans of mounted lasers against rotations in three dimensions and exact motions."""

from collections.abc import Callable, Iterator
from math import cos, inf, isnan, nan, pi, radians, sin

import numpy as np
import pytest
from numpy.typing import NDArray

from pioneer3.geometry import ORIGIN, Pose2, arc
from pioneer3.lasers.client import RawScan
from pioneer3.robot.lasers.mounting import Mounting, PoseAt, Sector

Matrix = NDArray[np.float64]
SIDEWAYS = Pose2(0.16, -0.07, radians(100))
PLACES = [
    Mounting(),
    Mounting(sensor_in_robot=SIDEWAYS),
    Mounting(sensor_in_robot=SIDEWAYS, upside_down=True),
    Mounting(sensor_in_robot=Pose2(-0.2, 0.1, pi), upside_down=True),
]


def raw_scan(count: int = 181, first: float = -1.2, step: float = 0.017) -> RawScan:
    """Return a scan in which every reading is another."""
    return RawScan(
        stamp=10.0,
        first=first,
        step=step,
        beam_time=0.025 / 360,
        period=0.025,
        near=0.02,
        far=30.0,
        ranges=tuple(1.0 + number / 50 for number in range(count)),
        intensities=tuple(range(count)),
        echoes=tuple((1.0 + number / 50, 9.0) for number in range(count)),
    )


def turned(pose: Pose2) -> Matrix:
    """Return the 4 x 4 transformation of a pose in the plane."""
    c, s = cos(pose.theta), sin(pose.theta)
    return np.array([[c, -s, 0, pose.x], [s, c, 0, pose.y], [0, 0, 1, 0], [0, 0, 0, 1.0]])


HEAD_DOWN = np.diag([1.0, -1.0, -1.0, 1.0])
"""Half a turn about the axis that looks straight ahead."""


def seen(raw: RawScan, mounting: Mounting, pose_at: PoseAt) -> Iterator[tuple[float, float]]:
    """Yield the point of each reading, from where the robot was at its very time."""
    for number, metres in enumerate(raw.ranges):
        angle = raw.first + number * raw.step
        place = turned(pose_at(raw.stamp + number * raw.beam_time))
        place = place @ turned(mounting.sensor_in_robot)
        if mounting.upside_down:
            place = place @ HEAD_DOWN
        x, y, *_ = place @ np.array([metres * cos(angle), metres * sin(angle), 0.0, 1.0])
        yield float(x), float(y)


def moving(v: float, w: float, begin: Pose2 = ORIGIN) -> Callable[[float], Pose2]:
    """Return where a robot that holds a twist is at any time."""
    return lambda time: begin @ arc(v, w, time - 10.0)


def in_order(points: list[tuple[float, float]], mounting: Mounting) -> list[tuple[float, float]]:
    return points[::-1] if mounting.upside_down else points


@pytest.mark.parametrize("mounting", PLACES)
def test_the_points_of_a_robot_that_stands_are_exact(mounting: Mounting) -> None:
    raw, here = raw_scan(), Pose2(3.0, -2.0, 2.5)
    scan = mounting.scan(raw, 7, "laser2", lambda time: here)
    expected = in_order(list(seen(raw, mounting, lambda time: here)), mounting)
    assert np.array(scan.points_in_odom()) == pytest.approx(np.array(expected), abs=1e-9)
    assert (scan.sequence, scan.laser, scan.last_in_odom) == (7, "laser2", None)
    assert (scan.near, scan.far, scan.period) == (0.02, 30.0, 0.025)


@pytest.mark.parametrize("mounting", PLACES)
@pytest.mark.parametrize("turn_rate", [radians(60), -radians(100)])
@pytest.mark.parametrize("heading", [0.0, pi - 1e-3])
def test_the_points_of_a_robot_that_turns_are_where_things_are(
    mounting: Mounting, turn_rate: float, heading: float
) -> None:
    raw, pose_at = raw_scan(), moving(0.0, turn_rate, Pose2(1.0, 2.0, heading))
    scan = mounting.scan(raw, 1, "laser", pose_at)
    expected = in_order(list(seen(raw, mounting, pose_at)), mounting)
    assert np.array(scan.points_in_odom()) == pytest.approx(np.array(expected), abs=1e-4)
    frozen = in_order(list(seen(raw, mounting, lambda time: pose_at(raw.stamp))), mounting)
    assert np.max(np.abs(np.array(frozen) - np.array(expected))) > 0.02


@pytest.mark.parametrize("mounting", PLACES)
def test_the_points_of_a_robot_that_drives_are_where_things_are(mounting: Mounting) -> None:
    raw, pose_at = raw_scan(), moving(0.7, 0.0, Pose2(1.0, 2.0, 2.0))
    scan = mounting.scan(raw, 1, "laser", pose_at)
    expected = in_order(list(seen(raw, mounting, pose_at)), mounting)
    assert np.array(scan.points_in_odom()) == pytest.approx(np.array(expected), abs=1e-9)
    curved = mounting.scan(raw, 1, "laser", moving(0.7, 1.0))
    expected = in_order(list(seen(raw, mounting, moving(0.7, 1.0))), mounting)
    assert np.array(curved.points_in_odom()) == pytest.approx(np.array(expected), abs=1e-4)


def test_invalid_readings_move_no_others() -> None:
    raw, pose_at = raw_scan(4), moving(0.0, 1.0)
    holes = RawScan(
        **{name: getattr(raw, name) for name in RawScan.__slots__ if name != "ranges"},
        ranges=(1.0, inf, nan, 4.0),
    )
    scan = Mounting().scan(holes, 1, "laser", pose_at)
    expected = list(seen(raw, Mounting(), pose_at))
    ratio = 4.0 / raw.ranges[3]
    last = (expected[3][0] * ratio, expected[3][1] * ratio)
    assert len(scan.points_in_odom()) == 2
    assert scan.points_in_odom()[0] == pytest.approx(expected[0])
    assert scan.points_in_odom()[1] == pytest.approx(last, abs=1e-6)


def test_upside_down_everything_is_mirrored_together() -> None:
    raw = raw_scan()
    scan = Mounting(upside_down=True).scan(raw, 1, "laser", lambda time: ORIGIN)
    last = raw.first + 180 * raw.step
    assert scan.angles[0] == pytest.approx(-last)
    assert scan.angles[-1] == pytest.approx(-raw.first)
    assert all(one < other for one, other in zip(scan.angles, scan.angles[1:], strict=False))
    assert scan.ranges == raw.ranges[::-1]
    assert scan.reflectances == raw.intensities[::-1]
    assert scan.echoes == raw.echoes[::-1]
    assert scan.stamp == pytest.approx(10.0 + 180 * raw.beam_time)
    assert scan.beam_time == -raw.beam_time


@pytest.mark.parametrize("upside_down", [False, True])
def test_masked_sectors_are_seen_from_above(*, upside_down: bool) -> None:
    mounting = Mounting(
        upside_down=upside_down, masked=(Sector(radians(30), radians(40)), Sector(-1.0, -0.9))
    )
    raw = raw_scan(271, radians(-135), radians(1))
    scan = mounting.scan(raw, 1, "laser", lambda time: ORIGIN)
    hidden = {
        round(np.degrees(a)) for a, r in zip(scan.angles, scan.ranges, strict=True) if isnan(r)
    }
    assert hidden == {*range(30, 41), *range(-57, -51)}
    assert len(scan.points_in_odom()) == 271 - len(hidden)


def test_a_sector_may_pass_through_behind() -> None:
    behind = Sector(radians(170), radians(-170))
    assert behind.holds(pi)
    assert behind.holds(-pi)
    assert behind.holds(radians(-175))
    assert behind.holds(radians(190))
    assert not behind.holds(0.0)
    assert not behind.holds(radians(-165))


def test_masks_differ_from_one_laser_to_the_next() -> None:
    raw = raw_scan(3, -0.1, 0.1)
    one = Mounting(masked=(Sector(-0.2, -0.05),)).scan(raw, 1, "laser", lambda time: ORIGIN)
    other = Mounting(masked=(Sector(0.05, 0.2),)).scan(raw, 1, "laser2", lambda time: ORIGIN)
    assert [isnan(r) for r in one.ranges] == [True, False, False]
    assert [isnan(r) for r in other.ranges] == [False, False, True]


@pytest.mark.parametrize("count", [0, 1])
@pytest.mark.parametrize("upside_down", [False, True])
def test_scans_of_one_reading_or_none_are_scans(count: int, *, upside_down: bool) -> None:
    mounting = Mounting(sensor_in_robot=SIDEWAYS, upside_down=upside_down)
    raw = raw_scan(count)
    scan = mounting.scan(raw, 1, "laser", moving(1.0, 1.0))
    expected = in_order(list(seen(raw, mounting, moving(1.0, 1.0))), mounting)
    assert len(scan.points_in_odom()) == count
    for point, wanted in zip(scan.points_in_odom(), expected, strict=True):
        assert point == pytest.approx(wanted)
