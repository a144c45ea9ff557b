"""Solids of a robot's links: boxes and cylinders, from its model. Needs no ROS."""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from math import atan2, copysign, hypot, pi
from types import MappingProxyType
from typing import Final

from pioneer3.geometry import Pose2
from pioneer3.models import BodyShape, LaserMount, RobotModel, shape_of
from pioneer3.models.description.tree import (
    BUMPER_HEIGHT,
    SCAN_HEIGHT,
    Frames,
    FrameTree,
    bumper_corners,
)

COLORS: Final[Mapping[str, tuple[float, float, float]]] = MappingProxyType(
    {
        "red": (0.75, 0.08, 0.08),
        "black": (0.08, 0.08, 0.09),
        "grey": (0.55, 0.56, 0.58),
        "gold": (0.80, 0.66, 0.30),
        "blue": (0.20, 0.35, 0.65),
    }
)
PLATE: Final = 0.006
"""Thickness of the top plate [m]."""
DISC: Final = 0.019
"""Radius of a sonar transducer [m]."""
ARRAY: Final = 0.05
"""Height of a row of sonars [m]."""
BUMPER: Final = 0.025
"""Thickness of a bumper [m]."""
COLUMN: Final = 0.5
"""Above the hull of a robot that is higher than this stands a column that touches things [m]."""
SHORTEST: Final = 0.12
"""Length of a body at least [m]."""
ARM: Final = 0.05
"""Length of a bumper's support inside the body [m]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkSolid:
    """A box, or a cylinder that stands on its z axis, in the frame of its link.

    Attributes:
        color: One of :data:`COLORS`.
        size: Along x, y and z [m]; a cylinder's x and y are its diameter.
        at: Its middle [m].
        turned: Roll, pitch and yaw [rad].
        hits: Whether it can touch things.
    """

    color: str
    size: tuple[float, float, float]
    at: tuple[float, float, float] = (0.0, 0.0, 0.0)
    turned: tuple[float, float, float] = (0.0, 0.0, 0.0)
    is_round: bool = False
    hits: bool = False


def solids_of(
    model: RobotModel,
    tree: FrameTree,
    frames: Frames,
    *,
    bumpers: tuple[int, int] | None = None,
    laser: bool = True,
) -> dict[str, tuple[LinkSolid, ...]]:
    """Return the solids of each link of `tree` that has any.

    `frames` are its names without the prefix, `bumpers` numbers of segments in front and behind,
    `None` for the model's; `laser` is that of its model.
    """
    if bumpers is None:
        bumpers = model.front_bumpers, model.rear_bumpers
    shape = shape_of(model)
    solids = {tree.base: _body(model, shape), "top_plate": _top(model)}
    for joint in tree.wheels:
        solids[joint.child] = _wheel(shape)
    if shape.caster is not None:
        solids["caster"] = _caster(shape)
    for number in range(len(model.sonars)):
        solids[frames.transducer(number)] = _transducer()
    if any(bumpers):
        solids[frames.bumper_link] = _bumpers(model, *bumpers)
    if laser and model.laser is not None:
        solids[frames.laser] = _laser(model.laser)
    return solids


def _ends(model: RobotModel) -> tuple[float, float]:
    """Return where the body begins and ends along the robot [m]: at its sonars, if it has any.

    Sonars on one end only, or near the middle, say nothing about the other end.
    """
    places = [mount.x for mount in model.sonars]
    front, rear = max(places, default=0.0), min(places, default=0.0)
    if front < model.length_front / 2:
        front = model.length_front - 0.05
    if rear > -model.length_rear / 2:
        rear = -model.length_rear + 0.05
    rear, front = max(rear, -model.length_rear + 0.02), min(front, model.length_front - 0.02)
    short = max(0.0, SHORTEST - (front - rear)) / 2
    return rear - short, front + short


def _body(model: RobotModel, shape: BodyShape) -> tuple[LinkSolid, ...]:
    """The hull between the wheels; above it, set back, the rows of sonars."""
    rear, front = _ends(model)
    between = shape.track - shape.wheel_width - 0.02
    top = min(shape.sonar_height - ARRAY / 2, shape.height - PLATE)
    hull = LinkSolid(
        color="red",
        size=(front - rear - 0.05, between, top - shape.clearance),
        at=((front + rear) / 2, 0.0, (top + shape.clearance) / 2),
        hits=True,
    )
    deck = LinkSolid(
        color="black",
        size=(front - rear - 0.10, 0.22, shape.height - top),
        at=((front + rear) / 2, 0.0, (shape.height + top) / 2),
        hits=shape.height > COLUMN,
    )
    return hull, deck


def _top(model: RobotModel) -> tuple[LinkSolid, ...]:
    """An octagon that covers the sonars: a cross, and a square on each of its inner corners."""
    rear, front = _ends(model)
    length, width = front - rear + 0.03, min(model.width, 0.38)
    cut = min(length, width) / 4
    at, low = (front + rear) / 2, -PLATE / 2
    x, y, side = length / 2 - cut, width / 2 - cut, cut * 2**0.5
    return (
        LinkSolid(color="black", size=(length, 2 * y, PLATE), at=(at, 0.0, low), hits=True),
        LinkSolid(color="black", size=(2 * x, width, PLATE), at=(at, 0.0, low), hits=True),
        *(
            LinkSolid(
                color="black",
                size=(side, side, PLATE),
                at=(at + ahead * x, left * y, low),
                turned=(0.0, 0.0, pi / 4),
            )
            for ahead in (1, -1)
            for left in (1, -1)
        ),
    )


def _wheel(shape: BodyShape) -> tuple[LinkSolid, ...]:
    """A tyre and its hub, about the link's y axis."""
    lying, width = (pi / 2, 0.0, 0.0), shape.wheel_width
    across, hub = 2 * shape.wheel_radius, shape.wheel_radius
    spoke = (hub * 1.5, width + 0.006, hub * 0.2)  # shows that it turns
    return (
        LinkSolid(
            color="black", size=(across, across, width), turned=lying, is_round=True, hits=True
        ),
        LinkSolid(color="grey", size=(hub, hub, width + 0.004), turned=lying, is_round=True),
        LinkSolid(color="grey", size=spoke),
    )


def _caster(shape: BodyShape) -> tuple[LinkSolid, ...]:
    across = 2 * shape.caster_radius
    arm = max(shape.clearance + 0.01 - shape.caster_radius, 0.01)
    return (
        LinkSolid(
            color="black", size=(across, across, 0.025), turned=(pi / 2, 0.0, 0.0), is_round=True
        ),
        LinkSolid(color="grey", size=(0.03, 0.035, arm), at=(shape.caster_trail, 0.0, arm / 2)),
    )


def _transducer() -> tuple[LinkSolid, ...]:
    """A facet with a golden disc that looks along x."""
    return (
        LinkSolid(color="black", size=(0.02, 0.06, ARRAY), at=(-0.011, 0.0, 0.0)),
        LinkSolid(
            color="gold", size=(2 * DISC, 2 * DISC, 0.002), turned=(0.0, pi / 2, 0.0), is_round=True
        ),
    )


def _bumpers(model: RobotModel, front: int, rear: int) -> tuple[LinkSolid, ...]:
    """A row of straight pieces around each end, and its supports."""
    ends = _ends(model)
    solids: list[LinkSolid] = []
    for corners, end in (
        (bumper_corners(model, front), ends[1]),
        (bumper_corners(model, rear, rear=True), ends[0]),
    ):
        solids += (_between(one, other) for one, other in pairwise(corners))
        reach = max((abs(corner.x) for corner in corners), default=0.0)
        arm = reach - abs(end) + ARM
        if corners and arm > 0:
            middle = copysign(reach - arm / 2, end)
            solids += (
                LinkSolid(color="grey", size=(arm, 0.02, 0.02), at=(middle, y, BUMPER_HEIGHT))
                for y in (-0.08, 0.08)
            )
    return tuple(solids)


def _between(one: Pose2, other: Pose2) -> LinkSolid:
    """A piece of a bumper that leads from one point to the other."""
    across, along = other.x - one.x, other.y - one.y
    return LinkSolid(
        color="black",
        size=(BUMPER, hypot(across, along), 0.05),
        at=((one.x + other.x) / 2, (one.y + other.y) / 2, BUMPER_HEIGHT),
        turned=(0.0, 0.0, atan2(-across, along)),
        hits=True,
    )


def _laser(mount: LaserMount) -> tuple[LinkSolid, ...]:
    """A SICK is a box with its window in front, others are a small cylinder."""
    if not mount.kind.lower().startswith("lms"):
        high = SCAN_HEIGHT + 0.02
        return (
            LinkSolid(
                color="grey", size=(0.06, 0.06, high), at=(0, 0, 0.02 - high / 2), is_round=True
            ),
        )
    return (
        LinkSolid(color="blue", size=(0.155, 0.155, 0.085), at=(0.0, 0.0, -0.0735), hits=True),
        LinkSolid(color="black", size=(0.110, 0.135, 0.062), at=(0.0, 0.0, 0.0)),
        LinkSolid(color="blue", size=(0.155, 0.155, 0.045), at=(0.0, 0.0, 0.0535)),
    )
