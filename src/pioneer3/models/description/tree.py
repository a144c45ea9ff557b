"""The tree of frames on a robot: the one source of URDF, static and moving transforms."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields, replace
from itertools import pairwise
from math import cos, pi, sin
from typing import Final, Literal, NamedTuple

from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2, wrap
from pioneer3.models import RobotModel, shape_of

TINY: Final = 1e-9
HERE: Final = (0.0, 0.0, 0.0)
ARC: Final = 0.75 * pi
"""Angle of all segments of one bumper together, seen from the robot's centre (protocol.md 4.7)."""
BUMPER_HEIGHT: Final = 0.09
"""Height of a bumper's middle above the floor [m]."""
SCAN_HEIGHT: Final = 0.116
"""Height of a laser's plane above its base: that of a SICK LMS 200 [m]."""
LASER_TOP: Final = 0.076
"""Height of a SICK LMS 200 above its plane [m]."""
LENS_HEIGHT: Final = 0.05
"""Height of a camera's lens above what the camera stands on [m]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Frames:
    """Names of the frames, without a leading slash.

    Attributes:
        odom: Fixed where the robot began.
        base: The robot: on the floor, in the centre of its rotation.
        footprint: The same under its other name, between `odom` and `base` (REP 120); empty for
            none.
        bumpers: The robot's own pose.
        sonar: All sonars together; the robot's own pose: their points are in robot coordinates.
        sonar_prefix: Before the number of a transducer, which looks along its frame's x axis.
        laser: The first laser range finder; of others their number follows.
        camera: x forward, z up. Its pictures' own frame has another name.
    """

    odom: str = "odom"
    base: str = "base_link"
    footprint: str = "base_footprint"
    bumpers: str = "bumpers"
    sonar: str = "sonar"
    sonar_prefix: str = "sonar_"
    laser: str = "laser"
    imu: str = "imu_link"
    camera: str = "camera_link"

    def transducer(self, number: int) -> str:
        """Return the frame of one sonar transducer."""
        return f"{self.sonar_prefix}{number}"

    def laser_frame(self, number: int) -> str:
        """Return the frame of a laser range finder; the first, number 0, has the plain name."""
        return f"{self.laser}{number + 1}" if number else self.laser

    @property
    def root(self) -> str:
        """The frame that moves in `odom`."""
        return self.footprint or self.base

    @property
    def camera_optical(self) -> str:
        """The frame of pictures: z forward, x to the right, y down (REP 103)."""
        return f"{self.camera.removesuffix('_link')}_optical_frame"

    @property
    def bumper_link(self) -> str:
        """The link of the bumpers, also where their messages name the base."""
        return "bumpers" if self.bumpers == self.base else self.bumpers

    def with_prefix(self, prefix: str) -> "Frames":
        """Return the names of one of many robots, such as `robot1/base_link`."""
        names = {each.name: getattr(self, each.name) for each in fields(self)}
        return replace(self, **{key: prefix + name for key, name in names.items() if name})


class Quaternion(NamedTuple):
    """A rotation."""

    x: float
    y: float
    z: float
    w: float

    @classmethod
    def about_z(cls, angle: float) -> "Quaternion":
        """Return the turn of a robot to the left [rad]."""
        return cls(0.0, 0.0, sin(angle / 2), cos(angle / 2))


OPTICAL: Final = Quaternion(-0.5, 0.5, -0.5, 0.5)
"""From x forward, y left, z up to z forward, x right, y down (REP 103)."""


class LinkPose(NamedTuple):
    """The pose of a link that stands upright [m, rad]."""

    x: float
    y: float
    z: float
    yaw: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Joint:
    """The pose of the link `child` in the frame of the link `parent` [m, rad].

    Attributes:
        optical: Whether the child is the optical frame of a camera, with the z axis forward.
        axis: About which it turns without end; empty for a joint that never moves.
    """

    name: str
    parent: str
    child: str
    x: float = 0.0
    y: float = 0.0
    z: float = 0.0
    yaw: float = 0.0
    optical: bool = False
    axis: Literal["", "y", "z"] = ""

    @property
    def rpy(self) -> tuple[float, float, float]:
        """Roll, pitch and yaw [rad]."""
        return (-pi / 2, 0.0, -pi / 2) if self.optical else (0.0, 0.0, self.yaw)

    def rotation(self, turned: float = 0.0) -> Quaternion:
        """Return the rotation of the child; that of a wheel has `turned` about its y axis [rad]."""
        if self.axis == "y":
            return Quaternion(0.0, sin(turned / 2), 0.0, cos(turned / 2))
        if self.optical:
            return OPTICAL
        return Quaternion.about_z(self.yaw)


@dataclass(frozen=True, slots=True, kw_only=True)
class FrameTree:
    """The frames of one robot.

    Attributes:
        root: Name of the frame that all others are below.
        base: Name of the body's frame, in the same place.
        wheels: Joints that motors turn: left before right, front before rear.
        caster: Joints of a caster that moves: its swivel, and its wheel on that.
    """

    root: str
    base: str
    fixed: tuple[Joint, ...]
    wheels: tuple[Joint, ...]
    caster: tuple[Joint, ...] = ()

    @property
    def joints(self) -> tuple[Joint, ...]:
        """All of them."""
        return (*self.fixed, *self.wheels, *self.caster)

    @property
    def moving(self) -> tuple[Joint, ...]:
        """Joints that turn: of wheels and casters."""
        return (*self.wheels, *self.caster)

    def fixed_in_base(self) -> dict[str, LinkPose]:
        """Return the place on the base of every link that never moves; the base's own is all 0.

        Fixed links turn about the z axis only; optical frames, which do not, are left out.
        """
        places = {self.root: LinkPose(0.0, 0.0, 0.0, 0.0)}
        for joint in (joint for joint in self.fixed if not joint.optical):
            x, y, z, yaw = places[joint.parent]
            c, s = cos(yaw), sin(yaw)
            places[joint.child] = LinkPose(
                x + c * joint.x - s * joint.y,
                y + s * joint.x + c * joint.y,
                z + joint.z,
                wrap(yaw + joint.yaw),
            )
        return places


def tree_of(
    model: RobotModel,
    frames: Frames,
    wheel_names: tuple[str, ...] = (),
    sonar_height: float | None = None,
    lasers: Sequence[Pose2] | None = None,
    *,
    camera: bool = False,
) -> FrameTree:
    """Return the tree of a robot of this kind.

    `wheel_names`, of joints, take the place of those of :func:`wheel_joint_names`, `sonar_height`
    above the floor that of the usual one [m], and `lasers`, poses on the robot [m, rad], that of
    the model's.

    Raises:
        ConfigError: two frames have one name, or there are too many or too few names of wheels.
    """
    if lasers is None:
        at = model.laser
        lasers = [Pose2(at.x, at.y, at.theta)] if at else []
    fixed = tuple(_fixed(model, frames, sonar_height, lasers))
    if camera:
        fixed += tuple(_camera(model, frames))
    wheels = tuple(_wheels(model, frames, wheel_names))
    tree = FrameTree(root=frames.root, base=frames.base, fixed=fixed, wheels=wheels)
    names = sorted([frames.root, frames.odom, *(joint.child for joint in tree.joints)])
    twice = [one for one, other in pairwise(names) if one == other]
    if twice:
        raise ConfigError(f"two frames are both called {twice[0]!r}: give one of them another name")
    return tree


def body_tree(model: RobotModel, frames: Frames) -> FrameTree:
    """Return the tree of a robot whose caster moves, for physics.

    The link `caster_swivel` turns about the vertical, and the wheel `caster` trails behind it.
    """
    tree, shape = tree_of(model, frames, camera=True), shape_of(model)
    if shape.caster is None:
        return tree
    high = shape.caster_radius
    swivel, wheel = "caster_swivel", "caster"
    return replace(
        tree,
        fixed=tuple(joint for joint in tree.fixed if joint.child != wheel),
        caster=(
            replace(_joint(frames.base, swivel, (shape.caster, 0.0, high)), axis="z"),
            replace(_joint(swivel, wheel, (-shape.caster_trail, 0.0, 0.0)), axis="y"),
        ),
    )


def wheel_joint_names(model: RobotModel) -> tuple[str, ...]:
    """Return the names of the wheels' joints: left before right, front before rear."""
    return tuple(f"{wheel}_joint" for wheel in _wheel_links(model))


def bumper_segments(model: RobotModel, count: int, *, rear: bool = False) -> tuple[Pose2, ...]:
    """Return the middle of each segment of a bumper on the robot's outline [m], looking outwards.

    In the robot's frame, in the order of :class:`pioneer3.state.Bumpers`.
    """
    middles = (number + 0.5 for number in range(count))
    return tuple(_on_outline(model, share / count, rear=rear) for share in middles)


def bumper_corners(model: RobotModel, count: int, *, rear: bool = False) -> tuple[Pose2, ...]:
    """Return where each segment begins on the robot's outline [m], and where the last one ends."""
    return tuple(
        _on_outline(model, number / count, rear=rear) for number in range(count + 1 if count else 0)
    )


def _on_outline(model: RobotModel, share: float, *, rear: bool) -> Pose2:
    """Return the point at this share of a bumper's arc, from its first end to its last one."""
    bearing = ARC * (0.5 - share) + (pi if rear else 0.0)
    c, s = cos(bearing), sin(bearing)
    ahead = model.length_front if c > 0 else model.length_rear
    reach = min(ahead / max(abs(c), TINY), model.width / 2 / max(abs(s), TINY))
    return Pose2(reach * c, reach * s, wrap(bearing))


def _fixed(
    model: RobotModel, frames: Frames, sonar_height: float | None, lasers: Sequence[Pose2]
) -> Iterator[Joint]:
    shape = shape_of(model)
    if frames.root != frames.base:
        yield _joint(frames.root, frames.base)
    for name in (frames.bumper_link, frames.sonar):
        if name != frames.base:
            yield _joint(frames.base, name)
    yield _joint(frames.base, frames.imu, (0.0, 0.0, (shape.clearance + shape.height) / 2))
    yield _joint(frames.base, "top_plate", (0.0, 0.0, shape.height))
    high = shape.sonar_height if sonar_height is None else sonar_height
    for number, mount in enumerate(model.sonars):
        name = frames.transducer(number)
        yield _joint(frames.base, name, (mount.x, mount.y, high), mount.theta)
    for number, at in enumerate(lasers):
        high = shape.laser_height - shape.height
        yield _joint("top_plate", frames.laser_frame(number), (at.x, at.y, high), at.theta)
    if shape.caster is not None:
        behind = shape.caster - shape.caster_trail
        yield _joint(frames.base, "caster", (behind, 0.0, shape.caster_radius))


def _camera(model: RobotModel, frames: Frames) -> Iterator[Joint]:
    """Yield the place of the camera: on a laser on the top plate, or above the plate's front."""
    shape = shape_of(model)
    if model.laser is not None and shape.laser_height > shape.height:
        at = (model.laser.x, model.laser.y, SCAN_HEIGHT + LASER_TOP + LENS_HEIGHT)
    else:
        front = max((mount.x for mount in model.sonars), default=model.length_front / 2)
        at = (front - 0.05, 0.0, LENS_HEIGHT)
    yield _joint("top_plate", frames.camera, at)
    yield replace(_joint(frames.camera, frames.camera_optical), optical=True)


def _wheels(model: RobotModel, frames: Frames, names: tuple[str, ...]) -> Iterator[Joint]:
    shape, links = shape_of(model), _wheel_links(model)
    names = names or wheel_joint_names(model)
    if len(names) != len(links):
        raise ConfigError(f"a {model.title} has {len(links)} wheels, not {len(names)}")
    for number, (name, link) in enumerate(zip(names, links, strict=True)):
        aside = -shape.track / 2 if number % 2 else shape.track / 2
        at = (shape.axles[number // 2], aside, shape.wheel_radius)
        yield replace(_joint(frames.base, link, at), name=name, axis="y")


def _wheel_links(model: RobotModel) -> list[str]:
    """Return the links of the wheels: left before right, front before rear."""
    places = ("",) if len(shape_of(model).axles) == 1 else ("front_", "rear_")
    return [f"{place}{side}_wheel" for place in places for side in ("left", "right")]


def _joint(
    parent: str, child: str, at: tuple[float, float, float] = HERE, yaw: float = 0.0
) -> Joint:
    x, y, z = at
    return Joint(name=f"{child}_joint", parent=parent, child=child, x=x, y=y, z=z, yaw=yaw)
