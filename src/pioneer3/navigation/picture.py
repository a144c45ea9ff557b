"""A robot as a notebook shows it: readings, sonars, lasers, its trail, its map. As HTML with SVG.

Most lines have the colour of the text around them; the others are seen on light and dark.
"""

from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from html import escape
from math import cos, degrees, hypot, isfinite, radians, sin
from typing import TYPE_CHECKING, Final

from pioneer3.geometry import Pose2
from pioneer3.maps.drawing import SHOWN, to_svg
from pioneer3.models import RobotModel
from pioneer3.names import html_table, printable
from pioneer3.robot.supervisor import kind
from pioneer3.runtime.robot import Robot
from pioneer3.state import Snapshot

if TYPE_CHECKING:
    from pioneer3.navigation.navigator import Navigator

REACHES = (1.0, 2.0, 3.0, 5.0)
"""From the robot to the nearest edge of the picture [m]."""
LEAVING = 0.8
"""A picture gets nearer when its echoes fill less than this part of the smaller reach."""
HALF_BEAM = radians(10)
"""Half the width of an echo's arc: an echo may come from anywhere in the beam."""
NOSE = 0.08
"""Length of the mark at the robot's front [m]."""
NEAR = 0.5
"""Range below which an echo is red [m]."""
CLOSE = 1.0
"""Range below which an echo is yellow [m]."""


ROBOT_COLOUR: Final = "#2f9e44"
LASER_COLOUR: Final = "#c2255c"
WAY_COLOUR: Final = "#7048e8"
TRAIL_COLOUR: Final = "#1c7ed6"
NEAR_COLOUR: Final = "#e03131"
CLOSE_COLOUR: Final = "#e8590c"
FAR_COLOUR: Final = "#0c8599"
LASER_AGE: Final = 1.0
"""Scans that are older than this are not drawn [s]."""


def card(robot: Robot, trail: Iterable[tuple[float, float]] = ()) -> str:
    """Return a robot as HTML; the places of its trail are in its frame [m]."""
    info, snapshot, why = robot.info, robot.snapshot, robot.why_not_moving()
    name = f"{kind(info)} {info.identity.name}, {info.model.title}, on {info.url}"
    told = {"": str(why)} if why else {}
    if snapshot is None:
        return f"<b>{_clean(name)}</b>{html_table(told)}"
    alarms = {"alarms": ", ".join(snapshot.alarms)} if snapshot.alarms else {}
    around = [*_trail(trail), *_laser(robot, snapshot), *_sonar(info.model, snapshot)]
    around.append(_body(info.model))
    pictures = [_ring(around, reach_for(snapshot.sonar.ranges))]
    if robot.navigator is not None:
        told["place"] = robot.navigator.estimate.reason
        pictures.append(_on_map(around, robot.navigator, snapshot))
    boxes = [_box(html_table(snapshot.readings | alarms | told), 0), _box(pictures[0], 1)]
    boxes += [_box(each, 2) for each in pictures[1:]]
    flex = "display:flex;flex-wrap:wrap;gap:1em;align-items:flex-start"
    return f'<b>{_clean(name)}</b><div style="{flex}">{"".join(boxes)}</div>'


def _box(content: str, grow: int) -> str:
    return f'<div style="flex:{grow} 1 {18 if grow else 16}em;max-width:48em">{content}</div>'


def _ring(around: Sequence[str], reach: float) -> str:
    """Return what is around a robot that faces up."""
    size = 1.05 * reach
    step = 0.5 if reach <= 1.0 else 1.0
    rings = [step * number for number in range(1, int(reach / step) + 1)]
    return "".join(
        (
            f'<svg viewBox="{-size} {-size} {2 * size} {2 * size}"{SHOWN}>',
            *(f'<circle r="{r}" {_stroke("currentColor", 0.01)} opacity="0.4"/>' for r in rings),
            *(_label(f"{r:g} m", -r, size / 20) for r in rings),
            f'<g transform="rotate(-90)">{"".join(around)}</g></svg>',
        )
    )


def _label(text: str, y: float, size: float) -> str:
    return f'<text y="{y:.2f}" font-size="{size:.2f}" fill="currentColor">{text}</text>'


def _on_map(around: Sequence[str], navigator: "Navigator", snapshot: Snapshot) -> str:
    """Return the map with the robot, if it is sure where it is, and its way."""
    over: list[str] = []
    state = navigator.state.latest
    if state is not None and state.way is not None:
        over.append(_line(state.way.points.tolist(), WAY_COLOUR, 0.08))
    if navigator.estimate.sure:
        pose = navigator.odom_in_map @ snapshot.odometry.robot_in_odom
        place = f"translate({pose.x:.3f} {-pose.y:.3f}) rotate({-degrees(pose.theta):.1f})"
        halo = f'<circle r="0.6" fill="{ROBOT_COLOUR}" opacity="0.3"/>'
        over.append(f'<g transform="{place}">{halo}{"".join(around)}</g>')
    return to_svg(navigator.line_map.drawing, over=over, on_page=False)


def _trail(places: Iterable[tuple[float, float]]) -> Iterator[str]:
    if points := list(places):
        yield _line(points, TRAIL_COLOUR, 0.04)


def _laser(robot: Robot, snapshot: Snapshot) -> Iterator[str]:
    to_robot = snapshot.odometry.robot_in_odom.inverse()
    for laser in robot.lasers:
        scan = laser.latest
        if scan is not None and snapshot.stamp - scan.stamp < LASER_AGE:
            points = (to_robot @ Pose2(x, y) for x, y in scan.points_in_odom())
            dots = "".join(f"M{each.x:.2f} {-each.y:.2f}h0" for each in points)
            yield f'<path d="{dots}" {_stroke(LASER_COLOUR, 0.06)}/>'


def _sonar(model: RobotModel, snapshot: Snapshot) -> Iterator[str]:
    """Yield an arc for each echo: it may come from anywhere in the beam."""
    for mount, metres in zip(model.sonars, snapshot.sonar.ranges, strict=False):
        if isfinite(metres):
            bearings = (mount.theta - HALF_BEAM, mount.theta + HALF_BEAM)
            (x1, y1), (x2, y2) = (
                (mount.x + metres * cos(bearing), -mount.y - metres * sin(bearing))
                for bearing in bearings
            )
            colour = (
                NEAR_COLOUR if metres < NEAR else CLOSE_COLOUR if metres < CLOSE else FAR_COLOUR
            )
            arc = f"M{x1:.2f} {y1:.2f}A{metres:.2f} {metres:.2f} 0 0 0 {x2:.2f} {y2:.2f}"
            yield f'<path class="sonar" d="{arc}" {_stroke(colour, 0.05)}/>'


def _body(model: RobotModel) -> str:
    front, rear, half = model.length_front, model.length_rear, model.width / 2
    return (
        f'<path class="robot" fill="{ROBOT_COLOUR}" d="M{-rear:.3f} {-half:.3f}H{front:.3f}'
        f'L{front + NOSE:.3f} 0L{front:.3f} {half:.3f}H{-rear:.3f}Z"/>'
    )


def _line(points: Sequence[Sequence[float]], colour: str, width: float) -> str:
    ends = " ".join(f"{x:.2f},{-y:.2f}" for x, y in points)
    return f'<polyline points="{ends}" {_stroke(colour, width)}/>'


def _stroke(colour: str, width: float) -> str:
    return f'fill="none" stroke="{colour}" stroke-width="{width}" stroke-linecap="round"'


def _clean(text: str) -> str:
    return escape(printable(text))


def reach_for(ranges: Iterable[float], before: float = REACHES[-1]) -> float:
    """Return the reach [m] that shows half of the echoes, steadily.

    Ranges [m] that are not finite do not count; the reach `before` is kept while it fits as well.
    """
    echoes = sorted(filter(isfinite, ranges))
    if not echoes:
        return before
    middle = echoes[len(echoes) // 2]
    fitting = next((reach for reach in REACHES if middle <= reach), REACHES[-1])
    if fitting < before and middle > LEAVING * fitting:
        return min(reach for reach in REACHES if reach > fitting)
    return fitting


TRAIL_STEP = 0.05
"""Between two points [m]."""
TRAIL_LENGTH = 400
JUMP = 1.0
"""Farther than this [m] is not driven: the trail begins anew."""


class Trail:
    """Places in odometry's frame, seen from the robot."""

    def __init__(self) -> None:
        self._places: deque[tuple[float, float]] = deque(maxlen=TRAIL_LENGTH)

    def add(self, pose: Pose2) -> None:
        """Note where the robot is now."""
        if self._places:
            x, y = self._places[-1]
            way = hypot(pose.x - x, pose.y - y)
            if way < TRAIL_STEP:
                return
            if way > JUMP:
                self._places.clear()
        self._places.append((pose.x, pose.y))

    def seen_from(self, pose: Pose2) -> list[tuple[float, float]]:
        """Return the places in the frame of a robot at `pose` [m]."""
        to_robot = pose.inverse()
        places = (to_robot @ Pose2(x, y) for x, y in self._places)
        return [(place.x, place.y) for place in places]
