"""What a simulated camera sees: derived from the pinhole, f = 80 / tan(24 deg) = 179.7 pixels."""

from math import pi, radians, tan

import numpy as np
import pytest

from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.maps import LineMap
from pioneer3.models import load_model
from pioneer3.sim.body import Body
from pioneer3.sim.eye import Eye, Patch, look
from pioneer3.sim.world import World
from pioneer3.sim.worldfile import Box, Person

EYE = Eye()
F = 80 / tan(radians(24))
FRONT = load_model("p3dx-sh").length_front


def world(*things: Box | Person, walls: LineMap | None = None) -> tuple[World, Body]:
    body = Body(load_model("p3dx-sh"), ORIGIN)
    made = World(walls, [body])
    for thing in things:
        made.add_obstacle(thing)
    return made, body


def box_at(x: float, y: float, width: float = 1.0) -> Box:
    """Return a box whose near side is at `x` from the camera."""
    return Box(pose=Pose2(FRONT + x + 0.1, y), size=(0.2, width), movable=True)


def seen(*things: Box | Person, walls: LineMap | None = None, pan: float = 0.0) -> list[Patch]:
    made, body = world(*things, walls=walls)
    return look(made, body, EYE, pan)


def test_a_box_straight_ahead_is_in_the_middle_and_as_large_as_it_should() -> None:
    (patch,) = seen(box_at(4.0, 0.0))
    assert patch.kind == "box"
    # 1 m at 4 m: 44.9 columns; from 0.4 m below the camera to 0.1 above: 60 + 18, 60 - 4.5
    assert patch.right - patch.left + 1 == pytest.approx(F / 4, abs=2)
    assert (patch.left + patch.right) / 2 == pytest.approx(79.5, abs=1)
    assert (patch.top, patch.bottom) == (55, 77)
    assert patch.area == (patch.right - patch.left + 1) * (77 - 55 + 1)
    assert (patch.x, patch.y) == pytest.approx((79.5, 66), abs=1)


def test_left_of_the_robot_is_left_in_the_picture() -> None:
    (patch,) = seen(box_at(4.0, 1.0, width=0.5))
    # 0.75 to 1.25 m to the left at 4 m
    assert patch.left == pytest.approx(80 - F * 1.25 / 4, abs=2)
    assert patch.right == pytest.approx(80 - F * 0.75 / 4, abs=2)


def test_a_person_stands_taller_than_the_picture_when_near() -> None:
    (patch,) = seen(Person(path=((FRONT + 2.0, 0.0),)))
    assert patch.kind == "person"
    assert patch.top == 0
    # the near side of a circle of 0.25 m is 1.75 m away: 60 + 0.4 * 179.7 / 1.75
    assert patch.bottom == pytest.approx(60 + 0.4 * F / 1.75, abs=2)


def test_what_is_behind_or_too_far_or_beside_is_not_seen() -> None:
    assert seen(box_at(-3.0, 0.0), box_at(13.0, 0.0), box_at(2.0, 3.0)) == []


def test_the_camera_can_be_turned_to_it() -> None:
    # 90 degrees to the left, seen from the front of the robot
    box = Box(pose=Pose2(FRONT, 3.0, 0.0), size=(0.5, 0.5), movable=True)
    assert seen(box) == []
    (patch,) = seen(box, pan=pi / 2)
    assert (patch.left + patch.right) / 2 == pytest.approx(79.5, abs=1)


def test_a_wall_hides_what_is_behind_it_and_half_a_wall_half_of_it() -> None:
    across = LineMap(name="wall", walls=np.array([[FRONT + 2, -5.0, FRONT + 2, 5.0]]))
    assert seen(box_at(4.0, 0.0), walls=across) == []
    half = LineMap(name="wall", walls=np.array([[FRONT + 2, 0.0, FRONT + 2, 5.0]]))
    (patch,) = seen(box_at(4.0, 0.0), walls=half)
    assert patch.left == pytest.approx(80, abs=1)


def test_what_is_nearer_hides_what_is_farther() -> None:
    box, person = box_at(4.0, 0.0), Person(path=((FRONT + 2.0, 0.25),))
    in_the_way, behind = sorted(seen(box, person), key=lambda patch: -patch.area)
    assert (in_the_way.kind, behind.kind) == ("person", "box")
    # the person covers the left half of the box, all that is left of the middle
    assert behind.left == pytest.approx(80, abs=1)
    assert in_the_way.right == behind.left - 1


def test_other_robots_are_seen_but_not_oneself() -> None:
    bodies = [Body(load_model("p3dx-sh"), ORIGIN), Body(load_model("p3dx-sh"), Pose2(3, 0, 0))]
    patches = look(World(None, bodies), bodies[0], EYE)
    assert [patch.kind for patch in patches] == ["robot"]


def test_looking_up_moves_everything_down() -> None:
    made, body = world(box_at(4.0, 0.0))
    (level,), (up,) = look(made, body, EYE), look(made, body, EYE, tilt=radians(5))
    assert up.top - level.top == pytest.approx(F * tan(radians(5)), abs=1)
