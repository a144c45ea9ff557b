"""Checks where robots start and go: free of walls, inside the map, within reach."""

from collections.abc import Iterator

import numpy as np

from pioneer3.geometry import Pose2
from pioneer3.models import RobotModel
from pioneer3.sim.collision import footprint_hits
from pioneer3.sim.maps.distance import distances
from pioneer3.sim.maps.line_map import Bounds, LineMap, MapObject
from pioneer3.sim.worldfile.reach import Floor
from pioneer3.sim.worldfile.remark import Remark, some, warning

GOALS = ("Goal", "GoalWithHeading")
FORBIDDEN = ("ForbiddenLine", "ForbiddenArea")


def check_places(
    line_map: LineMap, model: RobotModel, lines: dict[int, int] | None = None
) -> Iterator[Remark]:
    """Yield which homes have no room for the robot, and which goals it cannot get to.

    Args:
        line_map: The map.
        model: The robot.
        lines: The line of the file of each object, by its index in the map, as far as known.
    """
    known = lines or {}
    placed = [(item, known.get(at)) for at, item in enumerate(line_map.objects)]
    if not len(line_map.walls):
        yield warning("there is no wall")
        return
    homes = [(item, line) for item, line in placed if item.kind == "RobotHome"]
    if not homes:
        yield warning("there is no RobotHome: robots start at the origin of the map")
    for item, line in homes:
        problem = room(item.pose, line_map, model)
        if problem:
            yield warning(f"{shown(item)} {problem}", line)
    goals = [(item, line) for item, line in placed if item.kind in GOALS]
    yield from some(_unreachable(line_map, model, goals), "goals")


def room(pose: Pose2, line_map: LineMap, model: RobotModel) -> str:
    """Return why `model` has no room at `pose`, or nothing."""
    walls, bounds = line_map.walls, line_map.bounds
    if not (bounds.x_min <= pose.x <= bounds.x_max and bounds.y_min <= pose.y <= bounds.y_max):
        return "is outside the walls"
    if footprint_hits(pose, model.length_front, model.length_rear, model.width / 2, walls):
        return f"stands in a wall: no room for {model.name}"
    nearest = float(distances(np.array([pose.x, pose.y]), walls).min())
    if nearest < model.radius:
        return f"is {nearest:.2f} m from a wall: {model.name} needs {model.radius:.2f} m to turn"
    return ""


def shown(item: MapObject) -> str:
    """Return what to call an object in a message."""
    name = "".join(c if c.isprintable() else "?" for c in item.name[:30])
    kind = "".join(c if c.isprintable() else "?" for c in item.kind[:30])
    return f'{kind} "{name}"' if name else f"{kind} at {item.pose.x:.2f} {item.pose.y:.2f}"


def _unreachable(
    line_map: LineMap, model: RobotModel, goals: list[tuple[MapObject, int | None]]
) -> Iterator[Remark]:
    """Yield the goals that cannot be reached, keeping off walls and what is forbidden."""
    starts = [(home.x, home.y) for home in line_map.homes]
    origin = "any home"
    if not starts:
        others = [item for item in line_map.objects if item.kind.startswith("Dock")]
        first = (others or [item for item, _ in goals])[:1]
        starts = [(item.pose.x, item.pose.y) for item in first]
        origin = shown(first[0]) if first else ""
    if not starts or not goals:
        return
    forbidden = [side for o in line_map.objects if o.kind in FORBIDDEN for side in o.sides]
    barriers = np.concatenate([line_map.walls, np.array(forbidden).reshape(-1, 4)])
    floor = Floor(barriers, _around(line_map, starts, goals), model.width / 2)
    reached = floor.reached_from(starts)
    for item, line in goals:
        if not floor.is_free(item.pose.x, item.pose.y):
            yield warning(f"{shown(item)} is too near to a wall or forbidden line", line)
        elif not reached[floor.cell_of((item.pose.x, item.pose.y))]:
            yield warning(f"{shown(item)} cannot be reached from {origin}", line)


def _around(
    line_map: LineMap,
    starts: list[tuple[float, float]],
    goals: list[tuple[MapObject, int | None]],
) -> Bounds:
    """Return a box around walls and places [m]."""
    bounds = line_map.bounds
    xs = [x for x, _ in starts] + [item.pose.x for item, _ in goals]
    ys = [y for _, y in starts] + [item.pose.y for item, _ in goals]
    return Bounds(
        min(bounds.x_min, *xs),
        min(bounds.y_min, *ys),
        max(bounds.x_max, *xs),
        max(bounds.y_max, *ys),
    )
