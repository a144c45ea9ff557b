"""Robots with mass: they drive, slip, push, stall, come and go."""

from collections.abc import Iterator
from math import atan2, degrees, hypot, pi, radians, tan

import numpy as np
import pytest
from numpy.random import default_rng

from pioneer3.geometry import ORIGIN, Pose2, wrap
from pioneer3.models import load_model, physics_of
from pioneer3.sim.body import Body
from pioneer3.sim.dynamics import dynamics_of
from pioneer3.sim.relief import Ramp
from pioneer3.sim.world import World
from pioneer3.sim.worldfile import Box, Person, WorldFile
from pioneer3.sim.worldfile.spec import Physics, Wall

pytest.importorskip("mujoco")
from pioneer3.sim.physics.dynamics import MujocoDynamics

TICK = 0.02
WALL = WorldFile(name="wall", walls=(Wall(points=((1.5, -2.0), (1.5, 2.0))),))
TURNS = [(0.0, 0.2), (0.0, 1.0), (0.0, 2.0), (0.3, 0.3), (0.5, 0.5)]


def powered(model: str = "p3dx-sh", pose: Pose2 = ORIGIN) -> Body:
    body = Body(load_model(model), pose)
    body.enable_motors(on=True)
    return body


def physical(*bodies: Body, world: WorldFile | None = None) -> World:
    line_map = world.line_map() if world else None
    return World(line_map, bodies, dynamics=MujocoDynamics())


def run(world: World, seconds: float) -> None:
    for _ in range(round(seconds / TICK)):
        world.step(TICK)


@pytest.mark.parametrize("model", ["p3at-sh", "p3dx-sh", "amigo-sh", "peoplebot-sh"])
def test_a_robot_drives_straight_and_counts_its_way(model: str) -> None:
    body = powered(model)
    world = physical(body)
    body.drive.linear.travel(1.0)
    run(world, 8.0)
    pose, odom = body.robot_in_world, body.robot_in_odom
    assert pose.x == pytest.approx(1.0, abs=0.01)
    assert abs(pose.y) < 1e-3
    assert odom.x == pytest.approx(pose.x, abs=0.01)
    assert body.speeds == (0.0, 0.0)


@pytest.mark.parametrize(
    ("model", "track", "share"), [("p3at-sh", 0.59, 0.07), ("p3dx-sh", 0.33, 0.01)]
)
def test_turning_shows_the_track(model: str, track: float, share: float) -> None:
    body = powered(model)
    world = physical(body)
    for v, w in TURNS:
        body.drive.linear.go(v)
        body.drive.angular.top = 3.0
        body.drive.angular.go(w)
        run(world, 3.0)
        turned, before = 0.0, body.wheel_travel
        for _ in range(100):
            theta = body.robot_in_world.theta
            world.step(TICK)
            turned += wrap(body.robot_in_world.theta - theta)
        left, right = (now - then for now, then in zip(body.wheel_travel, before, strict=True))
        assert (right - left) / turned == pytest.approx(track, rel=share), (v, w)


@pytest.mark.parametrize("seed", [1, pytest.param(2, marks=pytest.mark.thorough)])
def test_a_p3dx_goes_where_it_goes_on_the_plane(seed: int) -> None:
    rng = default_rng(seed)
    bodies = [powered(), powered()]
    worlds = [physical(bodies[0]), World(None, bodies[1:])]
    commands = [(*rng.uniform((-0.4, -0.6), (0.4, 0.6)),) for _ in range(19)]
    for v, w in [*commands, (0.0, 0.0)]:
        for body, world in zip(bodies, worlds, strict=True):
            body.drive.linear.go(v)
            body.drive.angular.go(w)
            run(world, 3.0)
    one, other = (body.robot_in_world for body in bodies)
    assert hypot(one.x - other.x, one.y - other.y) < 0.01
    assert abs(degrees(wrap(one.theta - other.theta))) < 0.5


@pytest.mark.parametrize("model", ["p3at-sh", "p3dx-sh"])
def test_a_wall_stalls_a_robot_which_then_backs_off_at_once(model: str) -> None:
    body = powered(model)
    world = physical(body, world=WALL)
    body.drive.linear.go(0.3)
    run(world, 8.0)
    assert body.stalled
    stood = body.robot_in_world.x
    assert stood < 1.5
    assert abs(body.speeds[0]) < 0.05
    body.drive.linear.go(-0.2)
    run(world, 1.0)
    assert body.robot_in_world.x < stood - 0.04
    assert not body.stalled


def test_a_robot_that_wants_nothing_more_does_not_push_on() -> None:
    body = powered("p3dx-sh")
    world = physical(body, world=WALL)
    body.drive.linear.go(0.3)
    run(world, 8.0)
    dynamics = world.dynamics
    assert isinstance(dynamics, MujocoDynamics)
    most = physics_of(body.model).side_torque
    assert dynamics.scene.data.actuator_force == pytest.approx([most] * 2)
    body.drive.stop()
    run(world, 1.0)
    assert not body.stalled
    assert abs(dynamics.scene.data.actuator_force).max() < most / 4


def test_a_stall_lasts_while_things_come_and_go() -> None:
    body = powered("p3at-sh")
    world = physical(body, world=WALL)
    body.drive.linear.go(0.3)
    run(world, 8.0)
    world.add(powered("p3dx-sh", Pose2(0.0, 5.0, 0.0)))
    run(world, 0.1)
    assert body.stalled


@pytest.mark.parametrize("model", ["p3at-sh", "p3dx-sh", "amigo-sh", "peoplebot-sh"])
def test_wheels_follow_the_ramps(model: str) -> None:
    body = powered(model)
    world = physical(body)
    off = []
    for goal in (0.4, -0.3, 0.0):
        body.drive.linear.go(goal)
        for _ in range(150):
            world.step(TICK)
            off.append(abs(body.speeds[0] - body.drive.linear.velocity))
        assert body.speeds[0] == pytest.approx(goal, abs=1e-3)
    assert max(off) < 0.01


@pytest.mark.parametrize("model", ["p3at-sh", "p3dx-sh"])
def test_motors_that_go_off_brake_the_wheels_before_they_let_them_roll(model: str) -> None:
    body = powered(model)
    world = physical(body)
    body.drive.linear.go(0.3)
    run(world, 3.0)
    x = body.robot_in_world.x
    body.enable_motors(on=False)
    run(world, 0.6)
    assert body.robot_in_world.x - x < 0.04
    assert body.speeds[0] == pytest.approx(0.0, abs=0.01)


def test_a_box_is_pushed_and_a_person_is_not() -> None:
    body = powered("p3at-sh")
    world = physical(body)
    box = world.add_obstacle(Box(pose=Pose2(1.0, 0.0, 0.0), size=(0.4, 0.4), movable=True))
    person = world.add_obstacle(Person(path=((3.5, 0.0),)))
    body.drive.linear.go(0.3)
    run(world, 4.0)
    assert box.pose.x > 1.1
    run(world, 16.0)
    assert (person.pose.x, person.pose.y) == (3.5, 0.0)
    assert body.stalled
    assert body.robot_in_world.x < 3.0


def test_robots_without_power_are_pushed_along() -> None:
    first, second = powered("p3at-sh"), Body(load_model("p3dx-sh"), Pose2(0.8, 0.0, 0.0))
    world = physical(first, second)
    first.drive.linear.go(0.3)
    run(world, 6.0)
    assert second.robot_in_world.x > 1.0


def test_others_go_on_as_robots_and_boxes_come_and_go() -> None:
    body, late = powered(), powered("p3at-sh", Pose2(0.0, 5.0, 0.0))
    world = physical(body)
    body.drive.linear.go(0.3)
    run(world, 3.0)
    speed, x = body.speeds[0], body.robot_in_world.x
    world.add(late)
    box = world.add_obstacle(Box(pose=Pose2(9.0, 9.0, 0.0), size=(0.4, 0.4), movable=True))
    assert body.speeds[0] == pytest.approx(speed, abs=1e-9)
    world.step(TICK)
    assert body.robot_in_world.x == pytest.approx(x + speed * TICK, abs=1e-4)
    world.remove_obstacle(box)
    world.remove(late)
    run(world, 1.0)
    assert body.robot_in_world.x == pytest.approx(x + 1.02 * speed, abs=1e-3)


def test_a_robot_that_is_put_elsewhere_stands_there() -> None:
    body = powered()
    world = physical(body)
    run(world, 0.5)
    body.robot_in_world = Pose2(3.0, -2.0, pi / 2)
    run(world, 0.5)
    pose = body.robot_in_world
    assert (pose.x, pose.y, pose.theta) == pytest.approx((3.0, -2.0, pi / 2), abs=1e-3)


def test_a_robot_that_was_put_elsewhere_stays_there_when_things_come_before_time_passes() -> None:
    body = powered()
    world = physical(body)
    run(world, 0.5)
    body.robot_in_world = Pose2(3.0, -2.0, 1.0)
    world.add_obstacle(Box(pose=Pose2(9.0, 9.0, 0.0), size=(0.4, 0.4), movable=True))
    run(world, 0.5)
    assert body.robot_in_world.x == pytest.approx(3.0, abs=1e-3)


def test_a_hidden_robot_touches_nobody_and_stays_on_the_floor() -> None:
    body, other = powered("p3at-sh"), powered("p3at-sh", Pose2(1.2, 0.0, 0.0))
    world = physical(body, other)
    other.ghost = True
    body.drive.linear.go(0.3)
    run(world, 8.0)
    assert body.robot_in_world.x > 2.0
    assert other.robot_in_world.x == pytest.approx(1.2, abs=1e-3)
    other.ghost = False
    run(world, 0.5)
    assert other.robot_in_world.x == pytest.approx(1.2, abs=0.01)


def tracks() -> Iterator[bytes]:
    for _ in range(2):
        bodies = [powered("p3at-sh"), powered("p3dx-sh", Pose2(0.9, 0.1, 1.0))]
        world = physical(*bodies, world=WALL)
        for body in bodies:
            body.drive.linear.go(0.3)
            body.drive.angular.go(0.2)
        run(world, 5.0)
        yield world.outlines.poses.tobytes() + world.drives.wheels.tobytes()


def test_the_same_steps_give_the_same_bytes() -> None:
    first, second = tracks()
    assert first == second


def test_a_watchdog_and_an_emergency_stop_brake_by_the_wheels() -> None:
    body = powered("p3at-sh")
    world = physical(body)
    body.drive.linear.go(0.6)
    run(world, 4.0)
    body.drive.emergency_stop()
    x = body.robot_in_world.x
    run(world, 0.2)
    assert body.speeds[0] > 0.1
    assert not body.drive.obeys
    run(world, 1.0)
    assert body.robot_in_world.x - x < 0.15
    assert body.drive.obeys
    assert np.allclose(body.speeds, 0.0, atol=0.02)


def crowd() -> tuple[World, list[Body]]:
    bodies = [powered("p3at-sh", Pose2(2.0 * (n % 3), 2.0 * (n // 3))) for n in range(6)]
    for n, body in enumerate(bodies):
        body.drive.linear.go(0.05 * n)
        body.drive.angular.go(0.1 * n)
    return physical(*bodies), bodies


def step_beside(world: World) -> None:
    work = world.start(TICK)
    assert work is not None, "so many robots are worth a thread"
    world.finish(TICK)


def test_steps_of_another_thread_are_the_same_to_the_last_bit() -> None:
    (here, _), (beside, _) = crowd(), crowd()
    for _ in range(50):
        here.step(TICK)
        step_beside(beside)
    assert beside.outlines.state.tobytes() == here.outlines.state.tobytes()
    assert beside.drives.wheels.tobytes() == here.drives.wheels.tobytes()
    assert beside.time == here.time


def test_a_robot_that_is_put_elsewhere_while_the_thread_works_stands_there() -> None:
    world, bodies = crowd()
    for _ in range(20):
        step_beside(world)
    there, odom = Pose2(-5.0, -5.0, 1.0), bodies[5].robot_in_odom
    world.start(TICK)
    bodies[5].robot_in_world = there
    world.finish(TICK)
    assert bodies[5].robot_in_world == there
    assert hypot(bodies[5].robot_in_odom.x - odom.x, bodies[5].robot_in_odom.y - odom.y) < 0.02
    world.step(TICK)
    assert hypot(bodies[5].robot_in_world.x + 5.0, bodies[5].robot_in_world.y + 5.0) < 0.02


def test_robots_come_go_and_sense_while_the_thread_works() -> None:
    (here, _), (beside, bodies) = crowd(), crowd()
    for number in range(30):
        here.step(TICK)
        beside.start(TICK)
        if number == 10:
            beside.sonar(bodies[0])
        if number == 20:
            beside.remove(bodies[5])
        beside.finish(TICK)
        if number == 20:
            here.remove(here.robots[5])
    ways = [[body.wheel_travel for body in world.robots] for world in (here, beside)]
    assert ways[0] == pytest.approx(np.array(ways[1]), abs=1e-6)
    assert beside.time == pytest.approx(30 * TICK)


@pytest.mark.parametrize("physics", ["mujoco", "planar"])
def test_an_imu_feels_gravity_turns_and_braking(physics: Physics) -> None:
    body = powered("p3dx-sh")
    world = World(None, [body], dynamics=dynamics_of(physics))
    run(world, 1.0)
    assert world.imu(body).acceleration == pytest.approx((0.0, 0.0, 9.81), abs=0.01)
    body.drive.linear.go(0.4)
    body.drive.angular.go(0.5)
    run(world, 4.0)
    reading = world.imu(body)
    assert reading.rates == pytest.approx((0.0, 0.0, 0.5), abs=0.02)
    assert reading.acceleration == pytest.approx((0.0, 0.2, 9.81), abs=0.05)
    body.drive.angular.go(0.0)
    run(world, 1.0)
    body.drive.linear.go(0.0)
    run(world, 0.5)
    assert world.imu(body).acceleration[0] == pytest.approx(-0.3, abs=0.05)


def test_an_accelerometer_on_a_slope_shows_its_angle() -> None:
    ramp = Ramp(pose=ORIGIN, size=(4.0, 2.0), height=4.0 * tan(radians(8.0)))
    file = WorldFile(name="slope", solids=(ramp,))
    body = powered("p3dx-sh")
    line_map = file.line_map()
    world = World(line_map, [body], dynamics=MujocoDynamics(), relief=file.relief(line_map))
    run(world, 2.0)
    ahead, aside, up = world.imu(body).acceleration
    assert degrees(atan2(ahead, up)) == pytest.approx(8.0, abs=0.3)
    assert abs(aside) < 0.02


def test_an_emergency_stop_counts_also_while_the_thread_works() -> None:
    world, bodies = crowd()
    for _ in range(30):
        step_beside(world)
    world.start(TICK)
    bodies[5].drive.emergency_stop()
    world.finish(TICK)
    assert bodies[5].drive.braking


def test_bodies_that_overlap_without_a_solution_stand_still_and_are_told(
    caplog: pytest.LogCaptureFixture,
) -> None:
    body = powered("p3dx-sh")
    world = physical(body)
    run(world, 0.2)
    heap = [Box(pose=Pose2(2.0, 0.0), size=(0.5, 0.5), movable=True)] * 20
    boxes = world.add_obstacles(heap)
    body.drive.linear.go(0.2)
    run(world, 2.0)
    assert np.isfinite(world.outlines.poses).all()
    assert caplog.text.count("have no solution") == 1
    for box in boxes:
        world.remove_obstacle(box)
    x = body.robot_in_world.x
    run(world, 2.0)
    assert body.robot_in_world.x > x + 0.2


def test_no_time_is_no_step() -> None:
    world = physical(powered())
    before = world.outlines.poses.tobytes()
    world.step(0.0)
    assert world.outlines.poses.tobytes() == before
    assert np.isfinite(world.imu(world.robots[0]).acceleration).all()
