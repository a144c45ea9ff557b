"""The poses of SDF: of links, frames, joints and models in the frame of their model or world."""

from math import cos, radians, sin

import numpy as np

from pioneer3.arrays import Float
from pioneer3.geometry import Pose2
from pioneer3.sim.worldfile.gazebo_text import SdfElement

ANYWHERE = 1e12
"""Farthest that a pose may be [m]: what fell through a floor is saved where it was at the end."""
NONE: Float = np.eye(4)
"""The pose of what is not moved, as a matrix (4, 4)."""


def pose_of(element: SdfElement) -> Float:
    """Return the pose that an element tells, as a matrix (4, 4); in SDF 1.0 by its `origin`."""
    pose = element.first("pose")
    if pose is None:
        origin = element.first("origin")
        return matrix(origin.numbers("pose", 6, ANYWHERE)) if origin else NONE
    if not pose.text:
        return NONE
    if pose.attributes.get("rotation_format") == "quat_xyzw":
        return _by_quaternion(pose, pose.read("pose", pose.text, 7, ANYWHERE))
    # Gazebo takes numbers that are missing at the end for 0
    told = pose.text + " 0" * (6 - len(pose.text.split(None, 6)))
    numbers = pose.read("pose", told, 6, ANYWHERE)
    if pose.attributes.get("degrees", "") in ("true", "1"):
        numbers = (*numbers[:3], *map(radians, numbers[3:]))
    return matrix(numbers)


def matrix(numbers: tuple[float, ...]) -> Float:
    """Return x, y, z, roll, pitch and yaw [m, rad] as a matrix; no numbers are no move."""
    if not numbers:
        return NONE
    (cr, sr), (cp, sp), (cy, sy) = ((cos(angle), sin(angle)) for angle in numbers[3:])
    turned = np.eye(4)
    turned[:3, :3] = [
        (cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr),
        (sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr),
        (-sp, cp * sr, cp * cr),
    ]
    turned[:3, 3] = numbers[:3]
    return turned


def flat(pose: Float) -> Pose2:
    """Return a pose as seen from above."""
    return Pose2(float(pose[0, 3]), float(pose[1, 3]), float(np.arctan2(pose[1, 0], pose[0, 0])))


def _by_quaternion(pose: SdfElement, numbers: tuple[float, ...]) -> Float:
    x, y, z, w = numbers[3:]
    length = (x * x + y * y + z * z + w * w) ** 0.5
    if length < 1e-6:
        raise pose.wrong("a rotation without length; no turn is 0 0 0 1")
    x, y, z, w = (each / length for each in (x, y, z, w))
    turned = np.eye(4)
    turned[:3, :3] = [
        (1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
        (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
        (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)),
    ]
    turned[:3, 3] = numbers[:3]
    return turned


class SdfFrames:
    """The frames of one model or world, by the names of what carries them.

    `moved` are poses that others tell for what carries a name: a saved state, an include.
    """

    def __init__(self, scope: SdfElement, moved: dict[str, Float]) -> None:
        tags = ("link", "frame", "joint", "model", "include")
        self._named = {named(each): each for each in scope.all(*tags)}
        self.moved = moved

    def of(self, element: SdfElement, within: tuple[str, ...] = ()) -> Float:
        """Return the pose of an element in the frame of the model or world, a matrix (4, 4)."""
        name = named(element)
        if name in self.moved and element.tag in ("model", "include"):
            return self.moved[name]
        pose = element.first("pose")
        told = pose.attributes.get("relative_to", pose.attributes.get("frame", "")) if pose else ""
        if not told and element.tag == "frame":
            told = element.attributes.get("attached_to", "")
        if not told and element.tag == "joint":
            told = element.told("child")
        if told in ("", "world", "__model__", "__root__"):
            return pose_of(element)
        if told in within or len(within) > 50:
            raise (pose or element).wrong(f"is relative to itself, by {told!a}")
        # the frame of a link in a model counts as that of the model
        carrier = self._named.get(told) or self._named.get(told.partition("::")[0])
        if carrier is None:
            raise (pose or element).wrong(f"relative to {told!a}, and there is no such frame here")
        return self.of(carrier, (*within, told)) @ pose_of(element)


def named(element: SdfElement) -> str:
    """Return the name of an element; that of an include is a child of it."""
    return element.told("name") if element.tag == "include" else element.name
