"""Boxes and people: they are where they are now, and nobody walks over a robot."""

from dataclasses import replace
from math import cos, inf, pi, radians, sin

import numpy as np
import pytest
from numpy.typing import NDArray

from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.models import load_model
from pioneer3.sim.body import Body
from pioneer3.sim.kernels import Kernels
from pioneer3.sim.obstacles import POLITE, at_laser_height
from pioneer3.sim.realism import Realism
from pioneer3.sim.sensors import LASER_RANGE, SONAR_RANGE
from pioneer3.sim.world import World
from pioneer3.sim.worldfile import Box, Person
from tests.support import wall_at

Float = NDArray[np.float64]

MODEL = load_model("p3dx-sh")
AHEAD = replace(MODEL, sonars=(replace(MODEL.sonars[0], x=0.0, y=0.0, theta=0.0),))
BOX = Box(pose=Pose2(2.0, 0.0, 0.0), size=(0.4, 0.6), movable=True, name="crate")
QUIET = replace(Realism().sonar, noise=0.0, quantum=0.0, drop_out=0.0, cross_talk=0.0)
CONES = replace(Realism.ideal(), sonar=QUIET)


@pytest.fixture(scope="module")
def kernels() -> Kernels:
    return Kernels()


def walk(world: World, seconds: float) -> None:
    for _ in range(round(seconds / 0.1)):
        world.step(0.1)


def test_a_box_is_seen_and_touched_where_it_is_now(kernels: Kernels) -> None:
    body = Body(AHEAD)
    world = World(None, [body], kernels)
    box = world.add_obstacle(BOX)
    assert world.sonar(body)[0] == pytest.approx(1.8)
    world.move_obstacle(box, Pose2(1.0, 0.0, pi / 2))
    assert world.sonar(body)[0] == pytest.approx(0.7)
    assert world.laser(body, ORIGIN, 0.0, 1.0, 1)[0] == pytest.approx(0.7)
    assert not world.is_free(body, Pose2(0.6))
    body.enable_motors(on=True)
    body.drive.linear.go(0.5)
    walk(world, 3)
    assert body.stalled
    assert 0.7 - MODEL.length_front - body.robot_in_world.x == pytest.approx(0.0, abs=0.001)
    world.move_obstacle(box, Pose2(3.0, 0.0, 0.0))
    walk(world, 1)
    assert not body.stalled
    world.remove_obstacle(box)
    assert world.sonar(body)[0] == SONAR_RANGE
    walk(world, 8)
    assert body.robot_in_world.x > 3.0


def test_a_box_put_in_the_way_of_a_driving_robot_stops_it(kernels: Kernels) -> None:
    body = Body(MODEL)
    world = World(None, [body], kernels)
    far = world.add_obstacle(replace(BOX, pose=Pose2(50.0, 0.0)))
    body.enable_motors(on=True)
    body.drive.linear.go(0.5)
    walk(world, 3)
    ahead = body.robot_in_world.x + MODEL.length_front + 0.3
    world.move_obstacle(far, Pose2(ahead + 0.2, 0.0))
    walk(world, 3)
    assert body.stalled
    assert body.robot_in_world.x + MODEL.length_front == pytest.approx(ahead, abs=0.001)


def test_a_person_is_as_round_for_sonar_as_an_octagon_can_be(kernels: Kernels) -> None:
    """Whatever the side they are seen from, they echo, at their radius or up to 8 % further out."""
    radius = 0.25
    body = Body(AHEAD)
    world = World(None, [body], kernels, realism=CONES)
    world.add_obstacle(Person(path=((2.0, 0.0),), radius=radius))
    for bearing in np.linspace(-pi, pi, 73).tolist():
        body.robot_in_world = Pose2(2.0 - 1.5 * cos(bearing), -1.5 * sin(bearing), bearing)
        range_ = float(world.sonar(body)[0])
        assert 1.5 - radius / cos(pi / 8) - 1e-9 <= range_ <= 1.5 - radius + 1e-9


def test_a_wall_seen_as_slantingly_as_a_person_may_be_is_silent(kernels: Kernels) -> None:
    body = Body(AHEAD, Pose2(0.0, 0.0, radians(50)))
    assert World(wall_at(1.0), [body], kernels, realism=CONES).sonar(body)[0] == SONAR_RANGE


LANE = Person(path=((0.0, 0.0), (6.0, 0.0)), speed=1.0, loop=False)


def test_people_wait_for_a_robot_and_then_walk_on(kernels: Kernels) -> None:
    body = Body(MODEL, Pose2(3.0, 0.0, pi / 2))
    world = World(None, [body], kernels)
    person = world.add_obstacle(LANE)
    walk(world, 5)
    gap = 3.0 - MODEL.width / 2 - (person.pose.x + LANE.radius)
    assert POLITE - 0.11 < gap <= POLITE + 0.1
    assert world.is_free(body, body.robot_in_world)
    waited = person.pose
    walk(world, 5)
    assert person.pose == waited
    body.robot_in_world = Pose2(3.0, 2.0, pi / 2)
    walk(world, 2)
    assert person.pose.x == pytest.approx(waited.x + 2.0)


def test_nobody_waits_for_ever(kernels: Kernels) -> None:
    body = Body(MODEL, Pose2(3.0, 0.0, pi / 2))
    world = World(None, [body], kernels)
    person = world.add_obstacle(LANE)
    walk(world, 5)
    waited = person.pose
    walk(world, LANE.patience - 1)
    assert person.pose.x < waited.x
    assert abs(person.pose.theta) == pytest.approx(pi)
    walk(world, 2)
    body.robot_in_world = Pose2(3.0, 2.0, pi / 2)
    walk(world, 2 * 6.0)
    assert 0.0 <= person.pose.x <= 6.0
    stubborn = world.add_obstacle(replace(LANE, patience=inf))
    body.robot_in_world = Pose2(3.0, 0.0, pi / 2)
    walk(world, 5)
    waited = stubborn.pose
    walk(world, 60)
    assert stubborn.pose == waited


def test_who_is_too_close_already_may_walk_away(kernels: Kernels) -> None:
    body = Body(MODEL, Pose2(-0.5, 0.0))
    world = World(None, [body], kernels)
    person = world.add_obstacle(LANE)
    walk(world, 2)
    assert person.pose.x == pytest.approx(2.0)


def test_nobody_waits_for_a_ghost(kernels: Kernels) -> None:
    body = Body(MODEL, Pose2(3.0, 0.0))
    body.ghost = True
    world = World(None, [body], kernels)
    person = world.add_obstacle(LANE)
    walk(world, 5)
    assert person.pose.x == pytest.approx(5.0)


def test_a_person_who_is_carried_away_walks_the_same_path_from_there(kernels: Kernels) -> None:
    world = World(None, [], kernels)
    person = world.add_obstacle(LANE)
    walk(world, 1)
    world.move_obstacle(person, Pose2(person.pose.x, 3.0))
    walk(world, 2)
    assert (person.pose.x, person.pose.y) == pytest.approx((3.0, 3.0))


def crowd(kernels: Kernels) -> World:
    bodies = [Body(MODEL, Pose2(1.5 * n, 0.2 * n, 0.5 * n)) for n in range(4)]
    for n, body in enumerate(bodies):
        body.enable_motors(on=True)
        body.drive.linear.go(0.2 + 0.1 * n)
        body.drive.angular.go(0.3 - 0.2 * n)
    return World(wall_at(20.0), bodies, kernels, realism=Realism())


def states(bodies: list[Body]) -> list[bytes]:
    """Return all that there is of some robots."""
    said = []
    for body in bodies:
        drives, n = body.drives, body.number
        parts = [body.outlines.state[:, n], *(array[..., n] for array in drives.arrays)]
        said.append(b"".join(np.ascontiguousarray(part).tobytes() for part in parts))
    return said


def test_who_joins_or_leaves_leaves_the_others_as_they_are_to_the_last_bit(
    kernels: Kernels,
) -> None:
    world = crowd(kernels)
    walk(world, 3)
    bodies = list(world.robots)
    others, before = [bodies[0], bodies[2], bodies[3]], states([bodies[0], *bodies[2:]])
    world.remove(bodies[1])
    assert states(others) == before
    joined = Body(MODEL, Pose2(-5.0, -5.0))
    world.add(joined)
    assert states(others) == before
    box = world.add_obstacle(BOX)
    person = world.add_obstacle(LANE)
    assert states(others) == before
    world.remove_obstacle(box)
    world.remove_obstacle(person)
    world.remove(joined)
    assert states(others) == before
    assert world.robots == tuple(others)
    walk(world, 1)
    assert all(now != then for now, then in zip(states(others), before, strict=True))


def test_without_noise_the_others_also_drive_on_to_the_last_bit(kernels: Kernels) -> None:
    """Far things that come and go change nothing of where anybody goes."""
    alone, visited = crowd(kernels), crowd(kernels)
    for world in (alone, visited):
        world.realism = Realism.ideal()
        world.drives.errors[4:] = 0.0
    ends = []
    for world in (alone, visited):
        for step in range(60):
            if world is visited and step == 20:
                guest = Body(MODEL, Pose2(-9.0, -9.0))
                world.add(guest)
                world.drives.errors[4:] = 0.0
                box = world.add_obstacle(replace(BOX, pose=Pose2(-12.0, 5.0)))
            if world is visited and step == 40:
                world.remove(guest)
                world.remove_obstacle(box)
            world.step(0.1)
        ends.append(states(list(world.robots)))
    assert ends[0] == ends[1]


def test_a_laser_sees_the_legs_of_a_person_and_all_else_the_body(kernels: Kernels) -> None:
    body = Body(AHEAD)
    world = World(None, [body], kernels)
    world.add_obstacle(Person(path=((2.0, 0.0), (9.0, 0.0)), pause=1.0))
    half = radians(30)
    beams = np.linspace(-half, half, 601)
    ranges = world.laser(body, ORIGIN, -half, 2 * half / 600, 601)
    seen = beams[ranges < 5.0]
    right, left = seen[seen < 0], seen[seen > 0]
    assert np.sin(right.mean()) * 2.0 == pytest.approx(-0.125, abs=0.01)
    assert np.sin(left.mean()) * 2.0 == pytest.approx(0.125, abs=0.01)
    assert (left[-1] - left[0]) * 2.0 == pytest.approx(0.12, abs=0.02)
    assert ranges[300] == LASER_RANGE  # between the legs
    assert world.sonar(body)[0] == pytest.approx(1.75)
    assert world.sight(body, ORIGIN, 0.0, 1.0, 1)[0] == pytest.approx(1.75)
    assert not world.is_free(body, Pose2(1.7))


def test_the_legs_go_with_the_person_wherever_they_are_put(kernels: Kernels) -> None:
    body = Body(AHEAD)
    world = World(None, [body], kernels)
    world.add_obstacle(BOX)
    person = world.add_obstacle(Person(path=((2.0, 3.0), (9.0, 3.0)), speed=0.5))
    walk(world, 0.9)
    world.move_obstacle(person, Pose2(-1.0, 1.0, pi / 2))
    left, right = person.legs
    # after 0.9 s the feet are as far apart as they get: a step of 0.3 m
    assert left.x == pytest.approx(-1.125)
    assert abs(left.y - right.y) == pytest.approx(0.3, abs=0.01)
    assert left.x - right.x == pytest.approx(-0.25)
    assert world.laser(body, Pose2(theta=pi), 0.0, 1.0, 1)[0] == LASER_RANGE
    assert world.laser(body, ORIGIN, 0.0, 1.0, 1)[0] == pytest.approx(1.8)  # the box


def test_where_nobody_is_lasers_see_the_outlines_themselves(kernels: Kernels) -> None:
    world = World(None, [Body(AHEAD)], kernels)
    box = world.add_obstacle(BOX)
    assert box.legs == ()
    assert at_laser_height(world.outlines, world.obstacles, kernels) is world.outlines
