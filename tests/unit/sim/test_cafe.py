"""The cafe that ships: all its places can be reached, and it is as hard to see as it says."""

from dataclasses import replace
from math import inf, radians

import numpy as np
import pytest

from pioneer3.geometry import Pose2
from pioneer3.models import load_model
from pioneer3.models.lasers import LASERS
from pioneer3.sim.body import Body
from pioneer3.sim.kernels import Kernels
from pioneer3.sim.laser_scanner import Arc, LaserScanner
from pioneer3.sim.map_check import check_world
from pioneer3.sim.realism import RangeFinderErrors, Realism
from pioneer3.sim.world import World
from pioneer3.sim.worldfile import load_world

UTM = LASERS["utm-30lx"]


def scan(pose: Pose2, laser: str = "utm-30lx") -> list[tuple[float, float]]:
    """Return ranges [m] and intensities to the right, ahead and left of a laser at `pose`."""
    model = load_model("p3dx-sh")
    assert model.laser is not None
    body = Body(replace(model, laser=replace(model.laser, x=0.0)), pose)
    world = World(load_world("cafe").line_map(), [body], Kernels(), realism=Realism.ideal())
    scanner = LaserScanner(world, body, LASERS[laser])
    scanner.begin(Arc(first=radians(-20), step=radians(20), count=3, beam_time=1e-5), 0.0)
    world.step(0.1)
    assert scanner.look(world.time)
    ranges, light = scanner.readings()
    return list(zip(ranges.tolist(), light.tolist(), strict=True))


@pytest.mark.parametrize("model", ["p3dx-sh", "p3at-sh"])
def test_all_its_places_can_be_reached(model: str) -> None:
    assert check_world("cafe", load_model(model)) == ()


def test_a_laser_looks_through_the_front_onto_the_terrace() -> None:
    right, ahead, left = scan(Pose2(5.9, 1.0, radians(-90)))
    assert ahead[0] == pytest.approx(1.0)
    for range_, _ in (right, left):
        assert range_ == pytest.approx(4.0 / np.cos(radians(20)))


def test_the_counter_is_seen_from_near_only() -> None:
    assert scan(Pose2(3.6, 5.0, radians(90)))[1] == pytest.approx((1.25, 0.024))
    assert scan(Pose2(3.6, 1.0, radians(90)))[1] == (inf, 0.0)
    assert scan(Pose2(3.6, 1.0, radians(90)), "lms-111")[1][0] == pytest.approx(5.25)


def test_the_reflector_marks_the_dock() -> None:
    dock = next(place for place in load_world("cafe").places if place.kind == "Dock")
    assert scan(dock.pose)[1] == pytest.approx((10.97 - dock.pose.x, 10.0))


def test_a_laser_sees_the_thin_legs_of_a_chair() -> None:
    # the chair at (8.05, 1.5), from 2 m in front of it
    at = Pose2(8.05, 3.5, radians(-90))
    body = Body(load_model("p3dx-sh"), at)
    realism = replace(Realism.ideal(), range_finder=RangeFinderErrors(systematic=0.0))
    world = World(load_world("cafe").line_map(), [body], Kernels(), realism=realism)
    scanner = LaserScanner(world, body, UTM)
    scanner.begin(Arc(first=radians(-15), step=UTM.step, count=121, beam_time=1e-5), 0.0)
    world.step(0.1)
    assert scanner.look(world.time)
    ranges, _ = scanner.readings()
    legs = np.flatnonzero((ranges > 1.65) & (ranges < 2.3))
    groups = np.split(legs, np.flatnonzero(np.diff(legs) > 1) + 1)
    assert 2 <= len(groups) <= 4
    assert all(1 <= len(group) <= 8 for group in groups)
