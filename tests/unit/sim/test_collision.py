"""Robot against walls, cases derived by hand."""

from math import pi

import numpy as np
import pytest

from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.sim.collision import footprint_hits


def hits(*wall: float, pose: Pose2 = ORIGIN) -> bool:
    # 0.4 m to the nose, 0.2 m to the tail, 0.5 m wide
    return footprint_hits(pose, 0.4, 0.2, 0.25, np.array([wall], dtype=float))


def test_no_walls_no_hit() -> None:
    assert not footprint_hits(ORIGIN, 0.4, 0.2, 0.25, np.empty((0, 4)))


@pytest.mark.parametrize(
    "wall",
    [
        (0.39, -1, 0.39, 1),
        (-0.19, -1, -0.19, 1),
        (-1, 0.24, 1, 0.24),
        (-9, -9, 9, 9),
        (0.1, 0.1, 0.2, 0.1),
        (0.1, 0.1, 0.1, 0.1),
        (0.3, 0, 5, 0),
    ],
)
def test_a_wall_across_the_robot_or_inside_it_hits(wall: tuple[float, ...]) -> None:
    assert hits(*wall)


@pytest.mark.parametrize(
    "wall",
    [
        (0.41, -1, 0.41, 1),
        (-0.21, -1, -0.21, 1),
        (-1, 0.26, 1, 0.26),
        # past a corner: the boxes overlap, the shapes do not
        (0.3, 0.5, 0.6, 0.1),
        (0.5, 0.0, 5.0, 0.0),
        (0.5, 0.5, 0.5, 0.5),
    ],
)
def test_a_wall_beside_the_robot_does_not(wall: tuple[float, ...]) -> None:
    assert not hits(*wall)


def test_touching_is_free() -> None:
    assert not hits(0.4, -1, 0.4, 1)
    assert not hits(-1, 0.25, 1, 0.25)
    assert not hits(0.4 - 0.9e-9, -1, 0.4 - 0.9e-9, 1)
    assert hits(0.4 - 1.1e-9, -1, 0.4 - 1.1e-9, 1)


def test_front_and_rear_turn_with_the_robot() -> None:
    ahead = (0.3, -1, 0.3, 1)
    assert hits(*ahead)
    assert not hits(*ahead, pose=Pose2(0, 0, pi))
    assert not hits(*ahead, pose=Pose2(0, 0, pi / 2))
    assert hits(*ahead, pose=Pose2(0.5, 0, pi))
    assert not hits(*ahead, pose=Pose2(0.51, 0, 0))
