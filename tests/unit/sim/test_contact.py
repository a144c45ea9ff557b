"""Bumpers: which segments something touches, at rest and driven."""

from dataclasses import replace
from math import atan2, cos, inf, pi, radians, sin

import numpy as np
import pytest
from numpy.typing import NDArray

from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.maps import LineMap
from pioneer3.models import RobotModel, load_model
from pioneer3.sim.body import Body
from pioneer3.sim.collision import REACH, pressed_segments
from pioneer3.sim.world import World

Float = NDArray[np.float64]

SEGMENTS = 5
MODEL = replace(load_model("p3at"), front_bumpers=SEGMENTS, rear_bumpers=SEGMENTS)
SHORT = replace(MODEL, length_front=0.1, length_rear=0.1, front_bumpers=7, rear_bumpers=7)
POST = 0.01
"""Width of a thin wall that a robot meets face on [m]."""


def bit(segment: int) -> int:
    """Return the bit of a segment, counted from 0 (protocol.md 4.7)."""
    return 2 << segment


def bearing_of(segment: int, count: int = SEGMENTS) -> float:
    """Return where the middle of a front segment lies [rad] (protocol.md 4.7)."""
    return radians(67.5 - (segment + 0.5) * 135 / count)


def edge(model: RobotModel, bearing: float) -> float:
    """Return how far the outline is from the pose at a bearing [m]."""
    c, s = cos(bearing), sin(bearing)
    ahead = model.length_front if c > 0 else model.length_rear
    along = ahead / abs(c) if abs(c) > 1e-9 else inf
    return min(along, model.width / 2 / abs(s) if abs(s) > 1e-9 else inf)


def post(bearing: float, distance: float, pose: Pose2 = ORIGIN) -> Float:
    """Return a thin wall across a bearing from a pose, shape (1, 4)."""
    middle = pose @ Pose2(0, 0, bearing) @ Pose2(distance)
    one, other = middle @ Pose2(0, POST / 2), middle @ Pose2(0, -POST / 2)
    return np.array([[one.x, one.y, other.x, other.y]])


@pytest.mark.parametrize("pose", [ORIGIN, Pose2(3.0, -2.0, 2.5)])
@pytest.mark.parametrize("segment", range(SEGMENTS))
def test_a_thin_wall_presses_the_segment_that_it_lies_before(segment: int, pose: Pose2) -> None:
    front, rear = bearing_of(segment), bearing_of(segment) + pi
    for bearing, pressed in ((front, (bit(segment), 0)), (rear, (0, bit(segment)))):
        near = post(bearing, edge(MODEL, bearing) + REACH / 3, pose)
        assert pressed_segments(MODEL, pose, near) == pressed
        far = post(bearing, edge(MODEL, bearing) + 2 * REACH, pose)
        assert pressed_segments(MODEL, pose, far) == (0, 0)


def test_at_the_sides_there_is_no_bumper() -> None:
    for bearing in (pi / 2, -pi / 2):
        assert pressed_segments(MODEL, ORIGIN, post(bearing, edge(MODEL, bearing))) == (0, 0)


def test_a_robot_without_bumpers_feels_nothing() -> None:
    bare = replace(MODEL, front_bumpers=0, rear_bumpers=0)
    assert pressed_segments(bare, ORIGIN, post(0.0, bare.length_front)) == (0, 0)
    assert pressed_segments(MODEL, ORIGIN, np.empty((0, 4))) == (0, 0)


@pytest.mark.parametrize("model", [MODEL, SHORT])
def test_a_long_wall_presses_every_segment_along_it(model: RobotModel) -> None:
    count = model.front_bumpers
    corner = atan2(model.width / 2 + REACH, model.length_front)
    reached = [
        n for n in range(count) if abs(bearing_of(n, count)) - radians(67.5 / count) < corner
    ]
    expected = sum(bit(n) for n in reached)
    ahead, behind = model.length_front, -model.length_rear
    wall = np.array([[ahead, -3.0, ahead, 3.0]])
    assert pressed_segments(model, ORIGIN, wall) == (expected, 0)
    assert pressed_segments(model, ORIGIN, wall[:, [2, 3, 0, 1]]) == (expected, 0)
    assert pressed_segments(model, ORIGIN, np.array([[behind, -3.0, behind, 3.0]])) == (0, expected)
    assert len(reached) == (3 if model is MODEL else 7)


def test_in_a_corner_both_walls_press() -> None:
    ahead, left = MODEL.length_front, MODEL.width / 2
    walls = np.array([[ahead, -3.0, ahead, 3.0], [-3.0, left, 3.0, left]])
    front, rear = pressed_segments(MODEL, ORIGIN, walls)
    assert front == bit(0) + bit(1) + bit(2) + bit(3)
    assert rear == bit(3) + bit(4)  # the rear left, from its corner on


def drive(world: World, body: Body, speed: float, turn_rate: float, seconds: float = 4.0) -> None:
    body.enable_motors(on=True)
    body.drive.linear.go(speed)
    body.drive.angular.go(turn_rate)
    for _ in range(round(seconds / 0.02)):
        world.step(0.02)


@pytest.mark.parametrize("backwards", [False, True])
@pytest.mark.parametrize("segment", [1, 2, 3])
def test_a_robot_that_drives_into_something_stalls_and_feels_where(
    segment: int, *, backwards: bool
) -> None:
    side = MODEL.length_front * np.tan(bearing_of(segment))
    ahead, y = (-1.0, -side) if backwards else (1.0, side)
    wall = np.array([[ahead, y - POST / 2, ahead, y + POST / 2]])
    body = Body(MODEL)
    world = World(LineMap(name="post", walls=wall), [body])
    drive(world, body, 0.4 * np.sign(ahead), 0.0)
    assert body.stalled
    pressed = (body.front_bumpers, body.rear_bumpers)
    assert pressed == ((0, bit(segment)) if backwards else (bit(segment), 0))
    drive(world, body, 0.0, 0.0, 1.0)
    assert not body.stalled
    assert (body.front_bumpers, body.rear_bumpers) == pressed  # it still leans there
    drive(world, body, -0.2 * np.sign(ahead), 0.0, 1.0)
    assert (body.front_bumpers, body.rear_bumpers) == (0, 0)


@pytest.mark.parametrize(
    ("turn_rate", "bearing", "felt"),
    [(1.0, 60, (bit(0), 0)), (-1.0, -60, (bit(4), 0)), (1.0, -120, (0, bit(0)))],
)
def test_a_robot_that_turns_into_something_feels_it_at_its_side(
    turn_rate: float, bearing: float, felt: tuple[int, int]
) -> None:
    angle = radians(bearing)
    wall = post(angle, 0.34)
    body = Body(MODEL)
    world = World(LineMap(name="post", walls=wall), [body])
    drive(world, body, 0.0, turn_rate)
    assert body.stalled
    assert (body.front_bumpers, body.rear_bumpers) == felt


def test_robots_that_meet_feel_each_other() -> None:
    one, other = Body(MODEL), Body(MODEL, Pose2(2.0, 0.0, pi))
    world = World(None, [one, other])
    one.enable_motors(on=True)
    one.drive.linear.go(0.3)
    drive(world, other, 0.3, 0.0)
    face = bit(1) + bit(2) + bit(3)
    assert (one.front_bumpers, one.rear_bumpers) == (face, 0)
    assert (other.front_bumpers, other.rear_bumpers) == (face, 0)
    world.remove(other)
    assert one.front_bumpers == 0


def test_a_robot_that_stands_feels_who_drives_into_it() -> None:
    standing, driver = Body(MODEL, Pose2(2.0, 0.0, pi)), Body(MODEL)
    world = World(None, [standing, driver])
    drive(world, driver, 0.5, 0.0)
    assert driver.front_bumpers
    assert standing.front_bumpers
    assert not standing.stalled
    drive(world, driver, -0.5, 0.0, 1.0)
    assert (standing.front_bumpers, driver.front_bumpers) == (0, 0)


@pytest.mark.parametrize("heading", [-60, -45, -10, 0, 20, 45, 60])
@pytest.mark.parametrize("dt", [0.02, 0.1])
def test_whoever_was_stopped_is_near_enough_to_feel_it(heading: float, dt: float) -> None:
    body = Body(MODEL, Pose2(0.0, 0.0, radians(heading)))
    wall = np.array([[0.8, -5.0, 0.8, 5.0]])
    world = World(LineMap(name="wall", walls=wall), [body])
    body.enable_motors(on=True)
    body.drive.linear.go(0.7)
    for _ in range(round(6 / dt)):
        world.step(dt)
    assert body.stalled
    assert body.front_bumpers
    assert not body.rear_bumpers
