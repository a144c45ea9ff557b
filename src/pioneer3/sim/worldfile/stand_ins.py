"""Models and lasers for robots of other simulators: by their names, else by their sizes."""

import re
from collections.abc import Sequence

from pioneer3.geometry import Pose2
from pioneer3.models import load_model
from pioneer3.sim.worldfile.spec import Place, RobotSpec

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


def homes_of(robots: Sequence[RobotSpec]) -> tuple[Place, ...]:
    """Return the places of robots as homes, for those that are put in their stead."""
    return tuple(
        Place(kind="RobotHome", pose=robot.start, name=robot.name)
        for robot in robots
        if isinstance(robot.start, Pose2)
    )


def laser_of(names: Sequence[str], farthest: float) -> str:
    """Return the laser that one of `names` tells, or that of a range [m]; 0 for an unknown one."""
    for name in names:
        for pattern, laser in _SENSORS:
            if pattern.search(name.lower()):
                return "utm-30lx" if laser == "urg-04lx" and farthest > _FAR else laser
    if farthest > _FAR:
        return "utm-30lx"
    return "urg-04lx" if 0 < farthest < _NEAR else "lms-200"
