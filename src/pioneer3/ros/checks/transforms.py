"""Checks the tree of transforms, and that every frame is in it. Pure."""

from collections.abc import Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, field
from typing import Final
from xml.etree import ElementTree as ET

from pioneer3.models.description.tree import Frames
from pioneer3.ros.checks.facts import CheckFault, RobotFacts, fail, warn
from pioneer3.ros.checks.timing import FUTURE, StampedMessage, stamp_faults

AHEAD: Final = 1.0
"""`map` to `odom` is stamped this far into the future [s] at most, as AMCL does it."""
SHOWN: Final = 4
"""Names in a sentence."""


@dataclass(slots=True)
class TransformEdge:
    """A transform: identities of its publishers on `tf` and `tf_static`, and stamps on `tf`."""

    moving: set[bytes] = field(default_factory=set)
    fixed: set[bytes] = field(default_factory=set)
    stamps: list[StampedMessage] = field(default_factory=list)


@dataclass(frozen=True, slots=True, kw_only=True)
class TransformTree:
    """All transforms that came, by child, then by parent.

    Names of the robot's frames begin with `prefix`, such as `robot1/`. `base` is empty if odometry
    does not tell it.
    """

    edges: Mapping[str, Mapping[str, TransformEdge]]
    prefix: str = ""
    odom: str = "odom"
    base: str = ""

    @property
    def frames(self) -> Frames:
        """The names in the table, with the prefix."""
        return Frames().with_prefix(self.prefix)

    @property
    def bases(self) -> tuple[str, ...]:
        """Frames that may be the robot's."""
        frames = self.frames
        return tuple(dict.fromkeys(filter(None, (self.base, frames.base, frames.footprint))))

    @property
    def body(self) -> str:
        """The frame that odometry names, or the one below it if that is the footprint."""
        below = [child for child, parents in self.edges.items() if self.base in parents]
        is_footprint = self.base == self.frames.footprint and len(below) == 1
        return below[0] if is_footprint else self.base

    def connected(self) -> Set[str]:
        """Return the frames with a way to the robot's; empty where nothing came."""
        neighbours: dict[str, set[str]] = {}
        for child, parents in self.edges.items():
            for parent in parents:
                neighbours.setdefault(child, set()).add(parent)
                neighbours.setdefault(parent, set()).add(child)
        reached: set[str] = set()
        new = {base for base in self.bases if base in neighbours}
        while new:
            reached |= new
            new = {each for name in new for each in neighbours[name]} - reached
        return reached


def tree_of(facts: RobotFacts, tf: str, tf_static: str, odom: str) -> TransformTree:
    """Return the transforms that came on topics of these full names; `odom` names the frames."""
    edges: dict[str, dict[str, TransformEdge]] = {}
    for name, moves in ((tf, True), (tf_static, False)):
        for sample in facts.samples(name):
            for each in sample.transforms:
                edge = edges.setdefault(each.child, {}).setdefault(each.parent, TransformEdge())
                (edge.moving if moves else edge.fixed).add(sample.sender)
                if moves:
                    edge.stamps.append(StampedMessage(each.stamp, sample.now))
    last = next((each for each in reversed(facts.samples(odom)) if each.child), None)
    if last is None:
        return TransformTree(edges=edges)
    base, parent = last.child, last.frame or ""
    start = base.rpartition("/")[0]
    return TransformTree(edges=edges, prefix=f"{start}/" if start else "", odom=parent, base=base)


def moving_faults(tree: TransformTree, facts: RobotFacts) -> Iterator[CheckFault]:
    """Yield the faults of the transforms that move."""
    yield from _odometry_faults(tree)
    connected = tree.connected()
    for child, parents in tree.edges.items():
        if connected and child not in connected:  # of another robot
            continue
        if len(parents) > 1:
            told = "; ".join(
                f"{parent} by {_names(edge.moving | edge.fixed, facts)}"
                for parent, edge in parents.items()
            )
            yield fail(f"{child} has several parents: {told}", advice="tf2 takes one, then another")
        for parent, edge in parents.items():
            yield from _edge_faults(f"{parent} → {child}", edge, facts)
            ahead = FUTURE if child in tree.bases else AHEAD
            for fault in stamp_faults(edge.stamps, future=ahead) if len(edge.moving) == 1 else ():
                yield fail(f"{parent} → {child}: {fault.reason}", example=fault.example)
    yield from _loops(tree)


def fixed_faults(tree: TransformTree) -> Iterator[CheckFault]:
    """Yield the faults of the static transforms."""
    for child in tree.bases:
        for parent, edge in tree.edges.get(child, {}).items():
            if edge.fixed and parent == tree.odom:
                yield fail(
                    f"{parent} → {child} is static, though it moves", advice="publish it on tf"
                )


def frame_faults(
    tree: TransformTree, used: str, usual: Sequence[str], *, reachable: bool = True
) -> Iterator[CheckFault]:
    """Yield the faults of a frame that messages name, with its `usual` names, if there are any."""
    if not used:
        if usual:
            yield fail("frame_id is empty", advice=f"such as {usual[0]}")
        return
    if used.startswith("/"):
        yield fail(f"frame_id {used} begins with a slash", advice="tf2 has none")
        return
    connected = tree.connected()
    if reachable and connected and used not in connected:
        yield fail(
            f"no transform leads from {tree.bases[0]} to {used}", advice="publish it on tf_static"
        )
    elif usual and used not in usual:
        yield warn(f"frame_id is {used}", example=f"{usual[0]} is usual")


def child_faults(tree: TransformTree, used: str) -> Iterator[CheckFault]:
    """Yield the faults of the frame of the robot in odometry."""
    frames = tree.frames
    if not used or used.startswith("/"):
        yield fail(f"child_frame_id is {used!r}", advice=f"such as {frames.base}")
    elif used not in {frames.base, frames.footprint}:
        yield warn(f"child_frame_id is {used}", example=f"{frames.base} is usual")


def description_faults(tree: TransformTree, urdf: str) -> Iterator[CheckFault]:
    """Yield the faults of a description of the robot."""
    try:
        root = ET.fromstring(urdf)
    except ET.ParseError as error:
        yield fail("it is no XML", example=str(error))
        return
    if root.tag != "robot":
        yield fail(f"it is no URDF: its root is <{root.tag}>")
        return
    connected = tree.connected()
    links = [f"{tree.prefix}{link.get('name', '')}" for link in root.findall("link")]
    missing = [link for link in links if connected and link not in connected]
    if missing:
        yield warn(
            f"no transform for {_some(missing)}",
            advice="RViz draws them not at all: run robot_state_publisher",
        )


def _odometry_faults(tree: TransformTree) -> Iterator[CheckFault]:
    found = [child for child in tree.bases if tree.odom in tree.edges.get(child, {})]
    if not found:
        bases = " or ".join(tree.bases)
        yield fail(
            f"there is no {tree.odom} → {bases}",
            advice="the driver publishes it, or a filter such as robot_localization",
        )


def _edge_faults(name: str, edge: TransformEdge, facts: RobotFacts) -> Iterator[CheckFault]:
    for gids in (edge.moving, edge.fixed):
        if len(gids) > 1:
            yield fail(
                f"{name} has several publishers: {_names(gids, facts)}",
                advice="only one may publish a transform: set publish_tf to false in the others",
            )
    if edge.moving and edge.fixed:
        told = f"{_names(edge.moving, facts)} moves it, {_names(edge.fixed, facts)} says it stays"
        yield fail(f"{name} is static and moves, too: {told}")


def _loops(tree: TransformTree) -> Iterator[CheckFault]:
    told: set[str] = set()
    for start in tree.edges:
        way: list[str] = []
        name: str | None = start
        while name is not None and name not in way:
            way.append(name)
            name = next(iter(tree.edges.get(name, {})), None)
        if name is not None and name not in told:
            loop = way[way.index(name) :]
            told.update(loop)
            if len(loop) > 1:
                yield fail(f"transforms go in a circle: {' → '.join(reversed((*loop, name)))}")


def _names(gids: Set[bytes], facts: RobotFacts) -> str:
    return " and ".join(sorted(map(facts.sender, gids)))


def _some(names: list[str]) -> str:
    more = len(names) - SHOWN
    return ", ".join(names[:SHOWN]) + (f" and {more} more" if more > 0 else "")
