"""The modes of several robots together: each robot has a stack of its own, made from one mode."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal, Union

from msgspec import Meta

from pioneer3.behaviors.formations import FORMATIONS
from pioneer3.behaviors.modes.follow import guarded
from pioneer3.behaviors.modes.mode import Choice, Choices, Described, Speed
from pioneer3.units import LENGTH

if TYPE_CHECKING:
    from pioneer3.behaviors.action import Action, Stack
    from pioneer3.behaviors.peers import Peers
    from pioneer3.limits import Limits

Spacing = Annotated[float, Meta(ge=0.5, le=10.0), LENGTH]
Shape = Literal["line", "wedge", "column"]
SHAPES = Choices(
    tuple(Choice(one.name, one.name.title(), one.doing) for one in FORMATIONS.values())
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Membership:
    """One robot of a group: the leader's name, empty without one, and its own place, from 1."""

    leader: str
    number: int
    peers: "Peers"


class GroupMode(Described, frozen=True):
    """A behavior of several robots; if it is `led`, one leads, by keys or by a mode of its own."""

    led: ClassVar[bool] = True

    @property
    def nearest(self) -> float:
        """From one robot to the next, from middle to middle [m]."""
        raise NotImplementedError

    def stack(self, membership: Membership, limits: "Limits") -> "Stack":
        """Return a fresh stack for one robot, no faster than `limits`; the leader has none."""
        raise NotImplementedError

    def places(self, followers: int) -> list[tuple[float, float]]:
        """Return the places of so many followers: x ahead of the leader, y to its left [m]."""
        return FORMATIONS["column"].places(followers, self.nearest)


class Form(GroupMode, frozen=True, tag="form"):
    """Keep a formation around a leader.

    The followers drive to their places at once, each to the one that is near, and keep them while
    the leader drives. In a column they keep to its track.
    """

    title: ClassVar[str] = "Formation"
    doing: ClassVar[str] = "keeps its place in a formation"
    start: ClassVar[str] = "Form up"
    example: ClassVar[str] = "wedge --leader p3at-1 --lined-up 1.2"
    arguments: ClassVar[tuple[str, ...]] = ("formation",)

    formation: Annotated[Shape, Meta(title="Formation"), SHAPES] = "wedge"
    spacing: Annotated[Spacing, Meta(description="From one robot to the next.")] = 1.2

    @property
    def nearest(self) -> float:
        return self.spacing

    def places(self, followers: int) -> list[tuple[float, float]]:
        return FORMATIONS[self.formation].places(followers, self.spacing)

    def stack(self, membership: Membership, limits: "Limits") -> "Stack":
        from pioneer3.behaviors.actions.group import KeepFormation

        if self.formation == "column":
            return guarded("form", self.doing, _on_track(membership, self.spacing, limits))
        keep = KeepFormation(
            leader=membership.leader,
            place=self.places(membership.number)[-1],
            peers=membership.peers,
            top_speed=limits.max_speed,
        )
        return guarded("form", self.doing, keep)


class FollowLeader(GroupMode, frozen=True, tag="follow-leader"):
    """Follow the track of a leader, one behind the other.

    The robot that is nearest to the leader follows first. They cut no corners.
    """

    title: ClassVar[str] = "Follow leader"
    doing: ClassVar[str] = "follows the track of its leader"
    start: ClassVar[str] = "Follow"
    example: ClassVar[str] = "--leader p3at-1 --lined-up 1.2"

    distance: Annotated[Spacing, Meta(description="From one robot to the next, on the track.")] = (
        1.2
    )

    @property
    def nearest(self) -> float:
        return self.distance

    def stack(self, membership: Membership, limits: "Limits") -> "Stack":
        return guarded("follow-leader", self.doing, _on_track(membership, self.distance, limits))


class Spread(GroupMode, frozen=True, tag="spread"):
    """Drive apart until all are far enough from each other.

    Each is done once no other robot is nearer. A wall may be in the way: then it stands there.
    """

    title: ClassVar[str] = "Spread out"
    doing: ClassVar[str] = "drives away from the other robots"
    start: ClassVar[str] = "Spread out"
    example: ClassVar[str] = "--apart 2 --lined-up 1.2"
    led: ClassVar[bool] = False

    apart: Annotated[Spacing, Meta(description="From middle to middle.")] = 2.0
    speed: Annotated[Speed, Meta(description="At most.")] = 0.3

    @property
    def nearest(self) -> float:
        return self.apart

    def stack(self, membership: Membership, limits: "Limits") -> "Stack":
        from pioneer3.behaviors.actions.group import SpreadOut

        speed = min(self.speed, limits.max_speed)
        spread = SpreadOut(apart=self.apart, peers=membership.peers, speed=speed)
        return guarded("spread", self.doing, spread)


def _on_track(membership: Membership, spacing: float, limits: "Limits") -> "Action":
    """Return the action that follows the leader's track, as far behind as its place is."""
    from pioneer3.behaviors.actions.group import FollowLeader as FollowAction

    return FollowAction(
        leader=membership.leader,
        distance=membership.number * spacing,
        peers=membership.peers,
        top_speed=limits.max_speed,
    )


GROUP_MODES: tuple[type[GroupMode], ...] = (Form, FollowLeader, Spread)
"""All modes of groups, in the order in which people see them."""

if TYPE_CHECKING:
    AnyGroupMode = GroupMode
else:
    AnyGroupMode = Union[GROUP_MODES]  # noqa: UP007  a tuple of types
"""The type to decode a mode of groups as: a tagged union."""
