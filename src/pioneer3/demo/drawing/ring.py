"""The robot and what its range sensors see, to scale."""

from collections.abc import Iterable, Sequence
from math import isfinite, radians

from pioneer3.demo.drawing.canvas import Canvas, Ink
from pioneer3.models import RobotModel, SonarMount

REACHES = (1.0, 2.0, 3.0, 5.0)
"""From the robot to the nearest edge of the picture [m]."""
LEAVING = 0.8
"""A picture gets nearer when its echoes fill less than this part of the smaller reach."""
HALF_BEAM = radians(10)
"""Half the width of an echo's arc: an echo may come from anywhere in the beam."""
NOSE = 0.08
"""Of the mark that shows where the front is [m]."""
NEAR, CLOSE = 0.5, 1.0
"""Below these ranges [m] an echo is red, or yellow."""


def ring(
    model: RobotModel,
    ranges: Sequence[float],
    columns: int,
    rows: int,
    *,
    reach: float = 3.0,
    laser: Iterable[tuple[float, float]] = (),
    trail: Iterable[tuple[float, float]] = (),
) -> Canvas:
    """Return the picture: the robot facing up, an arc for each echo, rings of metres.

    Args:
        model: Sizes and places of the sonars.
        ranges: Of each sonar [m]; what is not finite is not drawn.
        columns: Width [characters].
        rows: Height [characters].
        reach: From the robot's centre to the nearest edge of the picture [m].
        laser: Points that the laser hit, (x, y) in the robot's frame [m].
        trail: Where the robot has been, in the same frame.

    Raises:
        ValueError: there is no room, or nothing to reach.
    """
    canvas = Canvas(columns, rows, reach)
    _grid(canvas, reach)
    for x, y in trail:
        canvas.dot(x, y, Ink.TRAIL)
    for x, y in laser:
        canvas.dot(x, y, Ink.LASER)
    _body(canvas, model)
    for mount, distance in zip(model.sonars, ranges, strict=False):
        if isfinite(distance):
            _echo(canvas, mount, distance)
    return canvas


def reach_for(ranges: Iterable[float], before: float = REACHES[-1]) -> float:
    """Return the reach [m] that shows half of the echoes, steadily.

    Args:
        ranges: Of each sonar [m]; what is not finite does not count.
        before: The reach until now, which is kept while it fits as well.
    """
    echoes = sorted(filter(isfinite, ranges))
    if not echoes:
        return before
    middle = echoes[len(echoes) // 2]
    fitting = next((reach for reach in REACHES if middle <= reach), REACHES[-1])
    if fitting < before and middle > LEAVING * fitting:
        return min(reach for reach in REACHES if reach > fitting)
    return fitting


def nearness(distance: float) -> Ink:
    """Return the ink for an echo at `distance` [m]."""
    return Ink.NEAR if distance < NEAR else Ink.CLOSE if distance < CLOSE else Ink.FAR


def _grid(canvas: Canvas, reach: float) -> None:
    """Draw a ring for each metre, the half ones where there is room; name the outermost."""
    step = 0.5 if reach <= 1.0 else 1.0
    number = 1
    while (radius := number * step) <= reach:
        canvas.arc(0.0, 0.0, radius, Ink.GRID, gap=4)
        canvas.write(radius - 2 * canvas.scale, 0.0, f"{radius:g} m", Ink.GRID)
        number += 1


def _body(canvas: Canvas, model: RobotModel) -> None:
    half, front = model.width / 2, model.length_front
    canvas.box(-model.length_rear, -half, front, half, Ink.BODY)
    canvas.line(front, 0.0, front + NOSE, 0.0, Ink.BODY)


def _echo(canvas: Canvas, mount: SonarMount, distance: float) -> None:
    """Draw from where the echo may have come."""
    start, end = mount.theta - HALF_BEAM, mount.theta + HALF_BEAM
    canvas.arc(mount.x, mount.y, distance, nearness(distance), start=start, end=end)
