"""Courses that are hard for a laser: passers-by, pillars, and the legs of chairs."""

from collections.abc import Iterator
from dataclasses import replace
from math import cos, pi, sin

import numpy as np

from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap
from pioneer3.sim.worldfile import Box, Person
from tests.e2e.follow_course import (
    LENGTH,
    WIDTH,
    Course,
    Float,
    Passer,
    Point,
    distance,
    make_course,
    points_of,
)

PASS_EVERY = 8.0
"""Somebody crosses the way after so long, as soon as that goes straight on [s]."""
STRAIGHT = 4.0, 1.5
"""The way is straight for so long before, and so long after [s]."""
PASSER_SPEED, COMES_FROM = 0.7, 4.0
"""[m/s], [m] aside."""
BETWEEN = 0.52
"""So far behind the middle of the person they pass, before the robot [m]."""
AROUND = 1.56
"""A robot that keeps 1 m stands so far from somebody [m]."""
CHAIRS, CHAIR, CHAIR_LEG = 16, 0.4, 0.05
"""How many, between their legs, and side of a leg [m]."""
CHAIR_CLEARANCE, CHAIR_BESIDE = 0.6, 0.7
"""Chairs keep so far from the way [m], and stand at most so much farther."""


def passed_by(seed: int) -> Course:
    """Return the course of a seed, on which others cross between the person and the robot."""
    course = make_course(seed)
    return replace(_furnished(course, []), passers=tuple(_passers(course.path)))


def behind_pillars(seed: int) -> Course:
    """Return a way to and fro around a robot that need only turn, behind pillars of a seed."""
    rng = np.random.default_rng(seed)
    angles = np.radians(np.concatenate([np.arange(0, 80, 5), np.arange(80, -80, -5)]))
    path = tuple((float(AROUND * cos(a)), float(AROUND * sin(a))) for a in (*angles, *angles[:8]))
    pillars = []
    for angle in np.radians([-45, 45]) + rng.uniform(-0.1, 0.1, 2):
        at = Pose2(theta=float(angle)) @ Pose2(float(rng.uniform(0.9, 1.1)))
        side = float(rng.uniform(0.15, 0.3))
        pillars.append(Box(pose=at, size=(side, side)))
    course = Course(room=make_course(seed).room, path=path, heading=0.0)
    return _furnished(course, pillars)


def among_chairs(seed: int) -> Course:
    """Return the way of a seed among chairs, whose legs are as thick as some people's."""
    course = make_course(seed)
    rng = np.random.default_rng(seed)
    way = _way(course)
    legs: list[Box] = []
    while len(legs) < 4 * CHAIRS:
        x, y = rng.uniform(-LENGTH / 2, LENGTH / 2), rng.uniform(-WIDTH / 2, WIDTH / 2)
        chair = Box(pose=Pose2(x, y, rng.uniform(-pi, pi)), size=(CHAIR, CHAIR))
        if 0 <= distance(chair, way) - CHAIR_CLEARANCE <= CHAIR_BESIDE:
            legs += _chair_legs(chair)
    return _furnished(course, legs)


def _way(course: Course) -> Float:
    """Return points of the way, from behind the robot on, shape (N, 2) [m]."""
    (x, y), heading = course.path[0], course.heading
    behind = x - 1.5 * cos(heading), y - 1.5 * sin(heading)
    return np.array(list(points_of((behind, *course.path))))


def _passers(path: tuple[Point, ...], speed: float = 0.4) -> Iterator[Passer]:
    somebody = Person(path=path, speed=speed, loop=False)
    when, side = PASS_EVERY, 1
    while when < 58:
        before, after = (somebody.pose_at(when + dt).theta for dt in (-STRAIGHT[0], STRAIGHT[1]))
        if before != after:
            when += 0.5
            continue
        middle = somebody.pose_at(when) @ Pose2(-BETWEEN, 0.0, side * pi / 2)
        ends = middle @ Pose2(-COMES_FROM), middle @ Pose2(COMES_FROM)
        walker = Person(path=tuple((end.x, end.y) for end in ends), speed=PASSER_SPEED)
        takes = COMES_FROM / PASSER_SPEED
        yield Passer(walker, when - takes, when + takes)
        when, side = when + PASS_EVERY, -side


def _chair_legs(chair: Box) -> Iterator[Box]:
    for ahead in (-CHAIR / 2, CHAIR / 2):
        for aside in (-CHAIR / 2, CHAIR / 2):
            yield Box(pose=chair.pose @ Pose2(ahead, aside), size=(CHAIR_LEG, CHAIR_LEG))


def _furnished(course: Course, boxes: list[Box]) -> Course:
    """Return a course with other furniture in the same room."""
    room: Float = course.room.walls[:4]
    walls = np.concatenate([room, *(box.outline for box in boxes)])
    return replace(course, room=LineMap(name=course.room.name, walls=walls))
