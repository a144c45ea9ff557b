"""Rooms full of furniture that somebody walks through, made from seeds."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from math import atan2, ceil, cos, hypot, pi, radians, sin

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap
from pioneer3.sim.worldfile import Box, Person

Point = tuple[float, float]
Float = NDArray[np.float64]

LENGTH, WIDTH = 10.0, 8.0
"""Of the room, its middle in the origin [m]."""
WAY = 26.0
"""At least so long is the way [m]: 0.4 m/s for 60 s, and some."""
LEGS = 1.5, 3.5
"""Length between two turns [m]."""
TURNS = radians(30), radians(100)
"""How far people turn, to either side."""
FROM_WALLS = 1.0
"""The way keeps this far from the walls of the room [m]."""
CLEARANCE = 0.7
"""And this far from furniture [m]: the person's shoulders pass it at 0.45 m."""
BESIDE = 0.9
"""Furniture stands at most this much farther from the way [m]."""
FURNITURE = 14


@dataclass(frozen=True, slots=True)
class Passer:
    """Somebody else, who is there from `comes` to `goes` [s]."""

    person: Person
    comes: float
    goes: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Course:
    """A room and a way through it.

    Attributes:
        room: Walls and furniture.
        path: Of the person [m].
        heading: In which they set out [rad].
        passers: Others who walk there.
    """

    room: LineMap
    path: tuple[Point, ...]
    heading: float
    passers: tuple[Passer, ...] = ()


def make_course(seed: int, clearance: float = CLEARANCE) -> Course:
    """Return the course of a seed."""
    rng = np.random.default_rng(seed)
    path = _path(rng)
    (x0, y0), (x1, y1) = path[:2]
    heading = atan2(y1 - y0, x1 - x0)
    behind = x0 - 1.5 * cos(heading), y0 - 1.5 * sin(heading)  # where the robot stands
    way = np.array(list(points_of((behind, *path))))
    boxes = list(_furniture(rng, way, clearance))
    corners = [(-LENGTH / 2, -WIDTH / 2), (LENGTH / 2, -WIDTH / 2)]
    corners += [(LENGTH / 2, WIDTH / 2), (-LENGTH / 2, WIDTH / 2)]
    room = np.array([(*a, *b) for a, b in zip(corners, corners[1:] + corners[:1], strict=True)])
    walls = np.concatenate([room, *(box.outline for box in boxes)])
    return Course(room=LineMap(name=f"course {seed}", walls=walls), path=path, heading=heading)


def _path(rng: Generator) -> tuple[Point, ...]:
    while True:
        heading = rng.uniform(-pi, pi)
        path = [(rng.uniform(-2, 2), rng.uniform(-2, 2))]
        if not _inside(path[0][0] - 1.5 * cos(heading), path[0][1] - 1.5 * sin(heading)):
            continue
        for _ in range(200):
            x, y = path[-1]
            turn = rng.choice((-1, 1)) * rng.uniform(*TURNS) if len(path) > 1 else 0.0
            leg = rng.uniform(*LEGS)
            there = x + leg * cos(heading + turn), y + leg * sin(heading + turn)
            if _inside(*there):
                path.append((float(there[0]), float(there[1])))
                heading += turn
            if sum(hypot(c - a, d - b) for (a, b), (c, d) in pairwise(path)) >= WAY:
                return tuple(path)


def _inside(x: float, y: float) -> bool:
    return abs(x) < LENGTH / 2 - FROM_WALLS and abs(y) < WIDTH / 2 - FROM_WALLS


def points_of(path: tuple[Point, ...]) -> Iterator[Point]:
    """Yield points of a way, 0.1 m apart at most."""
    for (a, b), (c, d) in pairwise(path):
        count = ceil(hypot(c - a, d - b) / 0.1)
        yield from ((a + (c - a) * i / count, b + (d - b) * i / count) for i in range(count + 1))


def _furniture(rng: Generator, way: Float, clearance: float) -> Iterator[Box]:
    """Yield boxes and low walls, each beside the way."""
    placed = 0
    while placed < FURNITURE:
        shape = (rng.uniform(0.3, 1.2), rng.uniform(0.3, 0.8))
        size = (rng.uniform(1.5, 2.5), 0.1) if rng.random() < 0.25 else shape
        x, y = rng.uniform(-LENGTH / 2, LENGTH / 2), rng.uniform(-WIDTH / 2, WIDTH / 2)
        box = Box(pose=Pose2(x, y, rng.uniform(-pi, pi)), size=size)
        if clearance <= distance(box, way) <= clearance + BESIDE:
            placed += 1
            yield box


def distance(box: Box, points: Float) -> float:
    """Return the distance of the nearest of `points` (N, 2) from a box [m]."""
    c, s = cos(box.pose.theta), sin(box.pose.theta)
    dx, dy = points[:, 0] - box.pose.x, points[:, 1] - box.pose.y
    ahead = (abs(c * dx + s * dy) - box.size[0] / 2).clip(min=0)
    aside = (abs(c * dy - s * dx) - box.size[1] / 2).clip(min=0)
    return float(np.hypot(ahead, aside).min())
