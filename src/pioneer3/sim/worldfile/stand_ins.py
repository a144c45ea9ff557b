"""Worlds of other simulators: their parts are collected, models and lasers of ours stand in."""

import logging
import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from pioneer3.arrays import Float
from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap
from pioneer3.models import load_model
from pioneer3.names import clean_name, free_name, printable
from pioneer3.sim.equipment import NO_OPTIONS, EquipmentOptions
from pioneer3.sim.relief import WALL_HEIGHT, Solid
from pioneer3.sim.worldfile.spec import Box, Place, RobotSpec, Wall, WorldFile

log = logging.getLogger(__name__)

THIN = 0.01
"""Shortest side of a box [m]."""
TALLEST = 100.0
"""Highest that anything is made [m]."""
LASER_SAMPLES = 30
"""A sensor of so many readings is a laser."""
_PIONEERS = (
    (re.compile(r"amigo"), "amigo-sh"),
    (re.compile(r"people[-_ ]?bot"), "peoplebot-sh"),
    (re.compile(r"power[-_ ]?bot"), "powerbot-sh"),
    (re.compile(r"patrol[-_ ]?bot"), "patrolbot-sh"),
    (re.compile(r"seekur[-_ ]?jr"), "seekurjr"),
    (re.compile(r"seekur"), "seekur"),
    (re.compile(r"pioneer[-_ ]?lx"), "pioneer-lx"),
    (re.compile(r"p(ioneer)?[-_ ]?2[-_ ]?(?P<kind>d8|pb|at)"), "p2{kind}"),
    (re.compile(r"pioneer[-_ ]?2|p[-_ ]?2[-_ ]?dx"), "p2dx"),
    (re.compile(r"pioneer[-_ ]?3?[-_ ]?at|p[-_ ]?3[-_ ]?at"), "p3at-sh"),
    (re.compile(r"pioneer|p[-_ ]?3[-_ ]?dx"), "p3dx-sh"),
)
"""Models by a part of a name in small letters; the first that fits counts."""
_BY_SIZE = ("p3dx-sh", "p3at-sh", "amigo-sh")
"""Models that stand for a robot of another maker."""
_FAR = 15.0
"""Range that only large lasers have [m]."""
_NEAR = 5.4
"""Range up to which a laser is a small one [m]."""
_SENSORS = (
    (re.compile(r"utm|ust"), "utm-30lx"),
    (re.compile(r"urg|ubg|hokuyo"), "urg-04lx"),
    (re.compile(r"lms[-_ ]?1"), "lms-111"),
    (re.compile(r"lms[-_ ]?5"), "lms-511"),
    (re.compile(r"tim[-_ ]?5"), "tim571"),
    (re.compile(r"sick|lms"), "lms-200"),
)


class FoundWorld:
    """The parts of a world that have counterparts, and the names of those that have none."""

    def __init__(self) -> None:
        self.segments: list[Float] = []
        self.boxes: list[Box] = []
        self.solids: list[Solid] = []
        self.left: dict[str, None] = {}
        self._walls: list[Wall] = []
        self._robots: list[RobotSpec] = []
        self._names: set[str] = set()
        self._others: dict[str, str] = {}

    def __bool__(self) -> bool:
        """Whether anything in it stops a robot."""
        return bool(self.segments or self._walls or self.boxes or self.solids)

    def add_wall(self, corners: Float, height: float | None) -> None:
        """Add a wall through corners (P, 2), closed if there are more than two."""
        spots = tuple((x, y) for x, y in corners.tolist())
        self._walls.append(Wall(points=spots, closed=len(spots) > 2, height=height))

    def add_robot(
        self, kinds: Sequence[str], name: str, start: Pose2, *, laser: str, usual: str
    ) -> None:
        """Add a robot: the model that its kinds tell, or else the `usual` one."""
        model = pioneer_of(kinds)
        if not model:
            model = self._others[next(filter(None, kinds), "a robot")] = usual
        equipment = EquipmentOptions(laser=laser) if laser else NO_OPTIONS
        robot = RobotSpec(model=model, name=self.name(name), start=start, equipment=equipment)
        self._robots.append(robot)

    def name(self, told: str) -> str:
        """Return the name of a robot or box that no other has, empty where none is told."""
        name = clean_name(told)
        if name:
            name = free_name(name, self._names)
            self._names.add(name)
        return name

    def file(
        self, path: Path, missing: Sequence[str], wall_height: float = WALL_HEIGHT
    ) -> WorldFile:
        """Return the world; warn once of all that is missing or has no counterpart."""
        told = [
            *missing,
            *(f"{ours} stands for {kind}, no Pioneer" for kind, ours in self._others.items()),
        ]
        if self.left:
            told.append(f"left out, without a counterpart: {', '.join(self.left)}")
        if told:
            log.warning("%s: %s", path, printable("; ".join(told)))
        name = printable(path.stem)
        walls = np.concatenate(self.segments) if self.segments else None
        return WorldFile(
            name=name,
            map="empty" if walls is None else LineMap(name=name, walls=walls),
            wall_height=wall_height,
            robots=tuple(self._robots),
            boxes=tuple(self.boxes),
            walls=tuple(self._walls),
            solids=tuple(self.solids),
            places=tuple(
                Place(kind="RobotHome", pose=robot.start, name=robot.name)
                for robot in self._robots
                if isinstance(robot.start, Pose2)
            ),
            source=str(path),
        )


def pioneer_of(names: Sequence[str]) -> str:
    """Return the model that one of `names` tells, the first that does; empty if none does."""
    for name in names:
        for pattern, model in _PIONEERS:
            if found := pattern.search(name.lower()):
                return model.format(**found.groupdict())
    return ""


def robot_of_size(length: float, width: float) -> str:
    """Return the model whose length and width [m] are nearest to those of a robot."""

    def distance(name: str) -> float:
        model = load_model(name)
        return abs(model.length_front + model.length_rear - length) + abs(model.width - width)

    return min(_BY_SIZE, key=distance)


def laser_of(names: Sequence[str], farthest: float) -> str:
    """Return the laser that one of `names` tells, or that of a range [m]; 0 for an unknown one."""
    for name in names:
        for pattern, laser in _SENSORS:
            if pattern.search(name.lower()):
                return "utm-30lx" if laser == "urg-04lx" and farthest > _FAR else laser
    if farthest > _FAR:
        return "utm-30lx"
    return "urg-04lx" if 0 < farthest < _NEAR else "lms-200"
