"""Wheels that are wrong by so much as they should be: UMBmark, noise, slip, seeds."""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from math import asin, hypot, pi, radians, sqrt

import numpy as np
import pytest
from numpy.typing import NDArray

from pioneer3.geometry import ORIGIN, Pose2, arc
from pioneer3.maps import LineMap
from pioneer3.models import load_model
from pioneer3.sim.body import Body
from pioneer3.sim.kernels import Kernels
from pioneer3.sim.kernels.drives import WAY_NOISE
from pioneer3.sim.realism import (
    MODES,
    OdometryErrors,
    OdometryMode,
    Realism,
)
from pioneer3.sim.world import World
from tests.support import moves

Float = NDArray[np.float64]

DX, AT = load_model("p3dx-sh"), load_model("p3at-sh")
CCW, CW = 1, -1
IDEAL = Realism.ideal()


def only(errors: OdometryErrors) -> Realism:
    """Return realism of the wheels and of nothing else."""
    return replace(IDEAL, odometry=errors)


def constant(**errors: float) -> Realism:
    right = {"wheel_ratio": 1.0, "base_ratio": 1.0, "scale": 1.0, "slip": 0.0}
    return only(OdometryErrors(mode="constant", **(right | errors)))


def finish(world: World, bodies: Iterable[Body]) -> None:
    """Let time pass until nobody moves."""
    bodies = tuple(bodies)
    while any(moves(body.drive) for body in bodies):
        world.step(0.1)


def drive_square(body: Body, world: World, side: float, sense: int) -> tuple[float, float]:
    """Drive a square by the odometry; return how far off the true end is from it [m]."""
    body.enable_motors(on=True)
    for _ in range(4):
        body.drive.linear.travel(side)
        finish(world, [body])
        body.turn_by(sense * pi / 2)
        finish(world, [body])
    truth, believed = body.robot_in_world, body.robot_in_odom
    assert hypot(believed.x, believed.y) < 1e-9
    return truth.x - believed.x, truth.y - believed.y


def square(realism: Realism, sense: int, side: float = 4.0) -> tuple[float, float]:
    body = Body(DX)
    return drive_square(body, World(None, [body], Kernels(), realism=realism), side, sense)


def textbook(wheel_ratio: float, base_ratio: float, side: float = 4.0) -> tuple[Float, Float]:
    """Return the errors at the end of a square, ccw and cw, by Borenstein and Feng's formulas.

    Every turn falls short by alpha (their "type A" error), every leg bends by beta ("type B").
    """
    alpha, beta = pi / 2 * (1 - 1 / base_ratio), 0.0
    if wheel_ratio != 1:
        radius = DX.wheel_base / 2 * (wheel_ratio + 1) / (wheel_ratio - 1)
        beta = 2 * asin(side / 2 / radius)
    ccw = -2 * side * alpha + 2 * side * beta, 2 * side * alpha - 2 * side * beta
    cw = -2 * side * alpha - 2 * side * beta, -2 * side * alpha - 2 * side * beta
    return np.array(ccw), np.array(cw)


@pytest.mark.parametrize(
    ("wheel_ratio", "base_ratio"),
    [(1.0, 1.003), (1.0, 0.997), (1.0005, 1.0), (0.9995, 1.0), (1.0003, 1.0015), (1.0002, 0.998)],
)
def test_the_umbmark_square_ends_where_the_textbook_says(
    wheel_ratio: float, base_ratio: float
) -> None:
    realism = constant(wheel_ratio=wheel_ratio, base_ratio=base_ratio)
    ends = textbook(wheel_ratio, base_ratio)
    largest = max(float(np.hypot(*end)) for end in ends)
    for sense, expected in zip((CCW, CW), ends, strict=True):
        error = np.array(square(realism, sense))
        assert np.hypot(*(error - expected)) < 0.02 * largest


@pytest.mark.parametrize(("wheel_ratio", "base_ratio"), [(1.0005, 1.002), (0.9996, 0.998)])
def test_umbmark_finds_the_ratios_that_were_configured(
    wheel_ratio: float, base_ratio: float
) -> None:
    side, realism = 4.0, constant(wheel_ratio=wheel_ratio, base_ratio=base_ratio)
    (x_ccw, _), (x_cw, _) = square(realism, CCW, side), square(realism, CW, side)
    alpha, beta = (x_cw + x_ccw) / (-4 * side), (x_cw - x_ccw) / (-4 * side)
    radius = side / 2 / np.sin(beta / 2)
    found_wheel = (radius + DX.wheel_base / 2) / (radius - DX.wheel_base / 2)
    found_base = (pi / 2) / (pi / 2 - alpha)
    assert found_wheel - 1 == pytest.approx(wheel_ratio - 1, rel=0.02)
    assert found_base - 1 == pytest.approx(base_ratio - 1, rel=0.02)


def test_large_errors_end_where_exact_arcs_do() -> None:
    """The textbook is right for small errors only; this is the same without approximations."""
    wheel, base = 1.01, 1.03
    difference = 2 * (wheel - 1) / (wheel + 1)
    for sense in (CCW, CW):
        end = ORIGIN
        for _ in range(4):
            end = end @ arc(4.0, 4.0 * difference / DX.wheel_base / base, 1.0)
            turn = sense * pi / 2
            end = end @ arc(difference * DX.wheel_base / 4 * turn, turn / base, 1.0)
        found = square(constant(wheel_ratio=wheel, base_ratio=base), sense)
        assert found == pytest.approx((end.x, end.y), abs=1e-6)


def test_the_scale_makes_a_square_larger_and_nothing_else() -> None:
    body = Body(DX)
    world = World(None, [body], Kernels(), realism=constant(scale=1.01))
    body.enable_motors(on=True)
    body.drive.linear.travel(4.0)
    finish(world, [body])
    assert body.robot_in_world.x == pytest.approx(4.04)
    assert body.robot_in_world.theta == 0.0


@pytest.mark.parametrize("sense", [CCW, CW])
def test_an_ideal_robot_closes_a_square_of_10_m_within_a_millimetre(sense: int) -> None:
    body = Body(AT)
    drive_square(body, World(None, [body], Kernels(), realism=IDEAL), 10.0, sense)
    assert hypot(body.robot_in_world.x, body.robot_in_world.y) < 0.001
    assert abs(body.robot_in_world.theta) < radians(0.01)


def fleet(realism: Realism, count: int, seed: int | None = 0, model: str = "p3dx-sh") -> World:
    """Return robots side by side, far enough from each other."""
    chosen = load_model(model)
    bodies = [Body(chosen, Pose2(0.0, 3.0 * n)) for n in range(count)]
    for body in bodies:
        body.enable_motors(on=True)
    return World(None, bodies, Kernels(), seed=seed, realism=realism)


def noises(world: World) -> Float:
    return world.drives.errors[WAY_NOISE:]


def systematic(world: World) -> Float:
    return world.drives.errors[:WAY_NOISE]


RIGHT = [[1.0], [0.0], [0.0], [1.0]]


@pytest.mark.parametrize("mode", MODES)
def test_a_mode_has_the_parts_that_it_says(mode: OdometryMode) -> None:
    world = fleet(only(OdometryErrors(mode=mode)), 3)
    alike = bool((systematic(world) == systematic(world)[:, :1]).all())
    right = bool((systematic(world) == RIGHT).all())
    assert right == (mode in {"none", "random_each_update"})
    assert alike == (mode in {"none", "constant", "random_each_update"})
    assert noises(world).any() == (mode in {"random_each_update", "all"})


@pytest.mark.parametrize("mode", ["random_init", "all"])
def test_each_robot_is_wrong_in_its_own_way_and_always_in_the_same(mode: OdometryMode) -> None:
    errors = OdometryErrors(mode=mode, slip=0.0)
    one, same, other = (fleet(only(errors), 40, seed) for seed in (1, 1, 2))
    np.testing.assert_array_equal(systematic(one), systematic(same))
    assert not (systematic(one) == systematic(other)).any(axis=1).any()
    scales = systematic(one)[0]
    assert len(set(scales.tolist())) == 40
    assert 1 / errors.scale <= scales.min() < 0.999
    assert 1.001 < scales.max() <= errors.scale


def test_a_robot_that_joins_is_as_wrong_as_one_that_was_there_from_the_start() -> None:
    realism = only(OdometryErrors(mode="random_init"))
    together, later = fleet(realism, 3), fleet(realism, 2)
    later.add(Body(DX, Pose2(0.0, 6.0)))
    np.testing.assert_array_equal(systematic(together), systematic(later))


@pytest.mark.parametrize(
    ("mode", "slips"),
    [("constant", True), ("random_init", True), ("all", True), ("none", False)],
)
def test_only_skid_steered_wheels_slip_and_only_in_turns(
    mode: OdometryMode, *, slips: bool
) -> None:
    exact = OdometryErrors(
        mode=mode,
        wheel_ratio=1.0,
        base_ratio=1.0,
        scale=1.0,
        way_noise=0.0,
        turn_noise=0.0,
        drift_noise=0.0,
        slip=0.1,
    )
    for model, turned in (("p3at-sh", 0.9 if slips else 1.0), ("p3dx-sh", 1.0)):
        world = fleet(only(exact), 1, model=model)
        body = world.robots[0]
        body.drive.linear.travel(2.0)
        finish(world, [body])
        body.turn_by(1.0)
        finish(world, [body])
        assert body.robot_in_odom.theta == pytest.approx(1.0)
        assert body.robot_in_world.theta == pytest.approx(turned)
        assert body.robot_in_world.x == pytest.approx(2.0)


MANY = 400


def spread_after(errors: OdometryErrors, way: float, turn: float, dt: float = 0.1) -> Float:
    """Return by how much x and heading of many robots differ from their odometry, (2, N)."""
    world = fleet(only(errors), MANY, seed=5)
    for body in world.robots:
        body.drive.linear.travel(way)
        body.drive.angular.travel(turn)
    while any(moves(body.drive) for body in world.robots):
        world.step(dt)
    pairs = [(body.robot_in_world, body.robot_in_odom) for body in world.robots]
    return np.array([(a.x - b.x, a.theta - b.theta) for a, b in pairs]).T


@pytest.mark.parametrize("dt", [0.1, 0.05])
def test_the_noise_of_the_way_grows_with_its_root_and_favours_nobody(dt: float) -> None:
    errors = OdometryErrors(
        mode="random_each_update", way_noise=0.01, turn_noise=0.0, drift_noise=0.0
    )
    for way in (0.5, 2.0):
        off, turned = spread_after(errors, way, 0.0, dt)
        sigma = 0.01 * sqrt(way)
        assert abs(off.mean()) < 4 * sigma / sqrt(MANY)
        assert off.std() == pytest.approx(sigma, rel=4 / sqrt(2 * MANY))
        assert not turned.any()


@pytest.mark.parametrize(("way", "turn"), [(2.0, 0.0), (0.0, 2.0), (0.0, 0.5), (1.0, 1.0)])
def test_the_noise_of_the_heading_grows_with_the_roots_of_way_and_turn(
    way: float, turn: float
) -> None:
    errors = OdometryErrors(
        mode="random_each_update", way_noise=0.0, turn_noise=0.03, drift_noise=0.02
    )
    _, turned = spread_after(errors, way, turn)
    sigma = sqrt(0.03**2 * turn + 0.02**2 * way)
    assert abs(turned.mean()) < 4 * sigma / sqrt(MANY)
    assert turned.std() == pytest.approx(sigma, rel=4 / sqrt(2 * MANY))


def busy_world(seed: int, realism: Realism) -> World:
    walls = np.array([[-4.0, -4, 4, -4], [4, -4, 4, 4], [4, 4, -4, 4], [-4, 4, -4, -4]])
    bodies = [
        Body(model, Pose2(1.5 * n - 2, 0.3 * n, n)) for n, model in enumerate((DX, AT, DX, AT))
    ]
    for n, body in enumerate(bodies):
        body.enable_motors(on=True)
        body.drive.linear.go(0.2 + 0.1 * n)
        body.drive.angular.go(0.3 - 0.2 * n)
    return World(LineMap(name="room", walls=walls), bodies, Kernels(), seed=seed, realism=realism)


def history(world: World, steps: Sequence[float]) -> list[bytes]:
    said = []
    for dt in steps:
        world.step(dt)
        body = world.robots[1]
        seen = world.sonars(), world.sonar(body), world.laser(body, ORIGIN, -1.0, 0.1, 21)
        arrays = (world.outlines.state, *world.drives.arrays, *seen)
        said.append(b"".join(array.tobytes() for array in arrays))
    return said


def test_the_same_seed_gives_the_same_run_to_the_last_bit() -> None:
    one, same, other = (history(busy_world(seed, Realism()), [0.1] * 80) for seed in (3, 3, 4))
    assert one == same
    assert all(a != b for a, b in zip(one, other, strict=True))


def test_one_long_step_is_many_of_the_longest_to_the_last_bit() -> None:
    one, other = busy_world(3, Realism()), busy_world(3, Realism())
    history(one, [1.0])
    for _ in range(10):
        other.step(0.1)
    np.testing.assert_array_equal(one.outlines.state, other.outlines.state)
    np.testing.assert_array_equal(one.drives.wheels, other.drives.wheels)


def test_without_noise_it_does_not_matter_how_time_is_cut() -> None:
    ends = []
    for dt in (0.1, 0.02):
        world = fleet(constant(wheel_ratio=1.01, base_ratio=1.02, scale=1.01), 1)
        body = world.robots[0]
        body.drive.linear.velocity = 0.5
        body.drive.linear.go(0.5)
        body.drive.angular.velocity = 0.4
        body.drive.angular.go(0.4)
        for _ in range(round(5 / dt)):
            world.step(dt)
        ends.append(world.outlines.poses.copy())
    np.testing.assert_allclose(ends[0], ends[1], rtol=0, atol=1e-9)


def test_wheels_that_cannot_turn_make_no_error() -> None:
    body = Body(DX, Pose2(1.0 - DX.length_front))
    wall = LineMap(name="wall", walls=np.array([[1.0, -5.0, 1.0, 5.0]]))
    world = World(wall, [body], realism=Realism())
    body.enable_motors(on=True)
    body.drive.linear.go(0.5)
    for _ in range(50):
        world.step(0.1)
    assert body.stalled
    assert body.robot_in_odom.x < 0.01
    assert abs(body.robot_in_world.x - body.home.x) < 0.01
