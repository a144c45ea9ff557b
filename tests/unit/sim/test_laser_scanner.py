"""A laser that turns on a robot: each reading is of the robot's place at that reading's time."""

from dataclasses import replace
from math import cos, inf, pi, radians, sin

import numpy as np
import pytest
from numpy.typing import NDArray

from pioneer3.geometry import ORIGIN, Pose2, arc
from pioneer3.maps import LineMap
from pioneer3.maps.materials import Material, codes_of
from pioneer3.models import load_model
from pioneer3.models.lasers import LASERS, LaserModel
from pioneer3.sim.body import Body
from pioneer3.sim.kernels import Kernels
from pioneer3.sim.laser_scanner import Arc, LaserScanner
from pioneer3.sim.raycast import cast_reference
from pioneer3.sim.realism import RangeFinderErrors, Realism
from pioneer3.sim.world import World
from pioneer3.sim.worldfile import Box

Float = NDArray[np.float64]

UTM = LASERS["utm-30lx"]
SQUARE = np.array([[-4, -3, 4, -3], [4, -3, 4, 3], [4, 3, -4, 3], [-4, 3, -4, -3]], dtype=float)
NO_ERRORS = RangeFinderErrors(systematic=0.0, noise=0.0, spot=False)


def world_of(
    walls: Float,
    *materials: Material,
    at: Pose2 = ORIGIN,
    errors: RangeFinderErrors = NO_ERRORS,
    seed: int = 0,
    delay: float = 0.0,
) -> tuple[World, Body]:
    """Return a world whose robot's laser is at the robot's pose."""
    model = load_model("p3dx-sh")
    assert model.laser is not None
    body = Body(
        replace(model, laser=replace(model.laser, x=0.0, y=0.0, theta=0.0, delay=delay)), at
    )
    line_map = LineMap(name="test", walls=walls, materials=codes_of(materials))
    realism = replace(Realism.ideal(), range_finder=errors)
    return World(line_map, [body], Kernels(), seed=seed, realism=realism), body


def arc_of(model: LaserModel, count: int = 0) -> Arc:
    beam_time = model.turn * model.step / (2 * pi)
    count = count or model.count
    return Arc(first=model.first, step=model.step, count=count, beam_time=beam_time)


def scan_at_rest(world: World, body: Body, model: LaserModel, turn: Arc) -> tuple[Float, Float]:
    scanner = LaserScanner(world, body, model)
    scanner.begin(turn, world.time)
    world.step(0.1)
    assert scanner.look(world.time)
    return scanner.readings()


def straight_ahead(
    world: World, body: Body, model: LaserModel = UTM, count: int = 400
) -> tuple[Float, Float]:
    """Return many readings nearly straight ahead."""
    turn = Arc(first=0.0, step=1e-7, count=count, beam_time=1e-5)
    return scan_at_rest(world, body, model, turn)


def test_a_robot_at_rest_measures_what_the_oracle_does() -> None:
    world, body = world_of(SQUARE, at=Pose2(0.5, -0.7, 0.3))
    ranges, intensities = scan_at_rest(world, body, UTM, arc_of(UTM))
    angles = 0.3 + UTM.first + UTM.step * np.arange(UTM.count, dtype=np.float64)
    expected = cast_reference(np.array([0.5, -0.7]), angles, SQUARE, 30.0)
    assert ranges == pytest.approx(expected, abs=1e-6)
    assert intensities == pytest.approx(0.8)


@pytest.mark.parametrize(("v", "w"), [(0.0, radians(100)), (1.0, 0.0), (0.6, radians(-60))])
@pytest.mark.parametrize(("tick", "delay"), [(0.005, 0.0), (0.02, 0.0), (0.02, 0.05)])
def test_each_reading_is_of_the_robots_place_at_its_time(
    v: float, w: float, tick: float, delay: float
) -> None:
    start = Pose2(-1.0, 0.5, 0.4)
    world, body = world_of(SQUARE, at=start, delay=delay)
    scanner, turn = LaserScanner(world, body, UTM), arc_of(UTM)
    while world.time < delay:
        scanner.look(world.time)
        world.step(tick)
        body.robot_in_world = start @ arc(v, w, world.time)
    began = world.time + 0.003
    scanner.begin(turn, began)
    while not scanner.look(world.time):
        world.step(tick)
        body.robot_in_world = start @ arc(v, w, world.time)
    ranges, _ = scanner.readings()
    for k in range(0, UTM.count, 20):
        place = start @ arc(v, w, began - delay + k * turn.beam_time)
        angle = np.array([place.theta + UTM.first + k * UTM.step])
        exact = cast_reference(np.array([place.x, place.y]), angle, SQUARE, 30.0)[0]
        # half a piece of 2.5 ms on the way, seen at a slant
        assert ranges[k] == pytest.approx(exact, abs=2e-4 + v * 2.5e-3), k


def test_a_scan_of_a_turning_robot_is_bent() -> None:
    world, body = world_of(SQUARE)
    scanner = LaserScanner(world, body, UTM)
    scanner.begin(arc_of(UTM), 0.0)
    while not scanner.look(world.time):
        world.step(0.02)
        body.robot_in_world = Pose2(0.0, 0.0, radians(100) * world.time)
    bent = scanner.readings()[0]
    still = scan_at_rest(*world_of(SQUARE), UTM, arc_of(UTM))[0]
    # after 18.75 ms the last beam looks 1.875 degrees further
    assert bent[0] == pytest.approx(still[0], abs=1e-6)
    last = cast_reference(np.zeros(2), np.array([UTM.last + radians(1.875)]), SQUARE, 30.0)[0]
    assert bent[-1] == pytest.approx(last, abs=1e-4)
    assert abs(bent[-1] - still[-1]) > 0.05


def test_readings_are_taken_only_when_they_are_due() -> None:
    world, body = world_of(SQUARE)
    scanner = LaserScanner(world, body, UTM)
    scanner.begin(arc_of(UTM), 0.01)
    world.step(0.02)
    assert not scanner.look(world.time)
    body.robot_in_world = Pose2(1.0, 0.0, 0.0)  # moved by hand
    world.step(0.02)
    assert scanner.look(world.time)
    ranges, _ = scanner.readings()
    angles = UTM.first + UTM.step * np.arange(UTM.count, dtype=np.float64)
    before = cast_reference(np.zeros(2), angles, SQUARE, 30.0)
    after = cast_reference(np.array([1.0, 0.0]), angles, SQUARE, 30.0)
    due = int(0.01 / arc_of(UTM).beam_time)
    assert ranges[:due] == pytest.approx(before[:due], abs=1e-6)
    assert ranges[due + 2 :] == pytest.approx(after[due + 2 :], abs=1e-6)


def test_a_laser_that_stands_sees_what_comes_moves_and_goes() -> None:
    body, other = (Body(load_model("p3dx-sh"), at) for at in (ORIGIN, Pose2(0.0, 2.0)))
    world = World(LineMap(name="test", walls=SQUARE), [body, other], Kernels())
    scanner = LaserScanner(world, body, UTM)

    def scan() -> Float:
        scanner.begin(arc_of(UTM), world.time)
        world.step(0.1)
        assert scanner.look(world.time)
        return scanner.readings()[0]

    empty = scan()
    assert (scan() == empty).all()
    box = world.add_obstacle(Box(pose=Pose2(2.0, 0.0, 0.0), size=(0.4, 0.4)))
    near = scan()
    assert (near < empty).any()
    world.move_obstacle(box, Pose2(1.0, 0.0, 0.0))
    assert scan().min() < near.min()
    world.remove_obstacle(box)
    assert (scan() == empty).all()
    other.ghost = True  # in the same place
    assert (scan() > empty).any()


def test_nothing_within_its_range_is_no_reading() -> None:
    wall = np.array([[20.0, -1.0, 20.0, 1.0]])
    assert straight_ahead(*world_of(wall))[0][0] == pytest.approx(20.0)
    ranges, intensities = straight_ahead(*world_of(wall), LASERS["ust-10lx"])
    assert (ranges == inf).all()
    assert (intensities == 0.0).all()


@pytest.mark.parametrize("name", ["utm-30lx", "lms-200", "urg-04lx"])
def test_noise_and_the_lasting_error_are_those_of_the_model(name: str) -> None:
    model, sigmas, biases = LASERS[name], [], []
    wall = np.array([[2.0, -1.0, 2.0, 1.0]])
    noisy = RangeFinderErrors(spot=False)
    for seed in range(40):
        ranges, _ = straight_ahead(*world_of(wall, errors=noisy, seed=seed), model)
        sigmas.append(ranges.std())
        biases.append(ranges.mean() - 2.0)
    error = next(error for error in model.errors if error.up_to >= 2.0)
    largest = error.systematic + 2.0 * error.share
    assert np.mean(sigmas) == pytest.approx(error.sigma, rel=0.05)
    assert max(map(abs, biases)) <= largest + 4 * error.sigma / 20
    # a uniform draw between plus and minus the largest
    assert np.std(biases) == pytest.approx(largest / 3**0.5, rel=0.3)


def test_the_lasting_error_of_a_unit_lasts() -> None:
    wall = np.array([[2.0, -1.0, 2.0, 1.0]])
    world, body = world_of(wall, errors=RangeFinderErrors(noise=0.0, spot=False), seed=5)
    scanner = LaserScanner(world, body, UTM)
    found = []
    for _ in range(3):
        scanner.begin(Arc(first=0.0, step=1e-7, count=2, beam_time=1e-5), world.time)
        world.step(0.1)
        assert scanner.look(world.time)
        found.append(float(scanner.readings()[0][0]))
    assert found[0] == found[1] == found[2] != 2.0


def test_an_edge_gives_readings_between_front_and_back() -> None:
    # a wide wall at 6 m, and in front of its left half one at 3 m, that ends 1.3 mrad to the left
    walls = np.array([[6.0, -3.0, 6.0, 3.0], [3.0, 0.004, 3.0, 3.0]])
    errors = RangeFinderErrors(systematic=0.0, noise=0.0)
    seen = []
    for seed in range(60):
        turn = Arc(first=radians(-2), step=UTM.step, count=17, beam_time=1e-5)
        seen.append(scan_at_rest(*world_of(walls, errors=errors, seed=seed), UTM, turn)[0])
    readings = np.array(seen)
    between = (readings > 3.05) & (readings < 5.95)
    assert between.any()
    # only beside the edge: a spot is 5 to 9 mrad wide, a step 4.4 mrad
    angles = radians(-2) + UTM.step * np.arange(17, dtype=np.float64)
    assert abs(angles[between.any(axis=0)]).max() < 0.01
    mixed = readings[between]
    assert mixed.min() < 4.0
    assert mixed.max() > 5.0
    assert readings[:, 0] == pytest.approx(6.0 / cos(angles[0]), abs=1e-6)
    assert readings[:, -1] == pytest.approx(3.0 / cos(angles[-1]), abs=1e-6)


def test_without_spots_there_are_no_readings_between() -> None:
    walls = np.array([[6.0, -3.0, 6.0, 3.0], [3.0, 0.0, 3.0, 3.0]])
    turn = Arc(first=radians(-2), step=UTM.step, count=17, beam_time=1e-5)
    ranges = scan_at_rest(*world_of(walls), UTM, turn)[0]
    assert ((ranges < 3.05) | (ranges > 5.95)).all()


def wall_at(angle_deg: float, middle: float) -> Float:
    """Return a long wall that a beam ahead meets at so many degrees to its normal."""
    a = radians(90 - angle_deg)
    x, y = 40 * cos(a), 40 * sin(a)
    return np.array([[middle - x, -y, middle + x, y]])


def ahead(walls: Float) -> tuple[Float, Float]:
    """Return errors [m] and intensities of readings of a UTM-30LX nearly straight ahead."""
    turn = Arc(first=radians(-1), step=UTM.step, count=9, beam_time=1e-5)
    angles = turn.first + turn.step * np.arange(9, dtype=np.float64)
    exact = cast_reference(np.zeros(2), angles, walls, 60.0)
    errors = RangeFinderErrors(systematic=0.0)
    scans = [
        scan_at_rest(*world_of(walls, errors=errors, seed=seed), UTM, turn) for seed in range(60)
    ]
    found = np.array([ranges - exact for ranges, _ in scans])
    return found, np.array([light for _, light in scans])


def test_a_slanted_wall_is_noisy_and_sends_less_light_back() -> None:
    front, slanted = ahead(wall_at(0, 8.0)), ahead(wall_at(80, 8.0))
    assert front[0].std() == pytest.approx(0.01, rel=0.1)
    # a spot of (4 + 10 / 8) mrad is 8 x tan(80 deg) x 5.25 mrad deep, to whole rays
    assert slanted[0].std() == pytest.approx(0.24 / 8, rel=0.3)
    assert front[1] == pytest.approx(0.8, rel=1e-3)
    assert slanted[1].mean() == pytest.approx(0.8 * cos(radians(80)), rel=0.05)


def test_a_slanted_wall_is_lost_from_afar() -> None:
    # 10 m to 10 % of remission: 0.8 cos(80 deg) reaches 11.8 m
    assert np.isfinite(ahead(wall_at(80, 10.0))[0]).all()
    assert np.isinf(ahead(wall_at(80, 14.0))[0]).all()
    assert np.isfinite(ahead(wall_at(0, 14.0))[0]).all()


def test_the_same_seed_gives_the_same_readings() -> None:
    errors = RangeFinderErrors()
    first, second = (
        scan_at_rest(*world_of(SQUARE, errors=errors, seed=3), UTM, arc_of(UTM)) for _ in "ab"
    )
    assert first[0].tobytes() == second[0].tobytes()
    other = scan_at_rest(*world_of(SQUARE, errors=errors, seed=4), UTM, arc_of(UTM))
    assert first[0].tobytes() != other[0].tobytes()


@pytest.mark.parametrize("name", [*LASERS])
def test_every_model_scans(name: str) -> None:
    model = LASERS[name]
    world, body = world_of(SQUARE, errors=RangeFinderErrors(systematic=0.0))
    ranges, _ = scan_at_rest(world, body, model, arc_of(model))
    angles = model.first + model.step * np.arange(model.count, dtype=np.float64)
    exact = cast_reference(np.zeros(2), angles, SQUARE, 30.0)
    there = np.isfinite(ranges)
    assert there.all() or model.far < 6.0
    assert ranges[there] == pytest.approx(exact[there], abs=0.2)
