"""The mode that wanders (facts.md 7.7)."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

from msgspec import Meta

from pioneer3.behaviors.modes.mode import Choice, Choices, Mode, Speed

if TYPE_CHECKING:
    from pioneer3.behaviors.action import Ranked, Stack
    from pioneer3.limits import Limits

Preset = Literal["lab", "aria", "explore"]
PRESETS = Choices(
    (
        Choice("lab", "Lab", "slow, as its robotWander"),
        Choice("aria", "ARIA", "as ARIA's"),
        Choice("explore", "Explore", "seeks new ground"),
    )
)


class Wander(Mode, frozen=True, tag="wander"):
    """Drive about and keep clear of obstacles."""

    title: ClassVar[str] = "Wander"
    doing: ClassVar[str] = "wanders"
    start: ClassVar[str] = "Start wandering"
    example: ClassVar[str] = "--port /dev/ttyUSB0 --speed 0.2 --seconds 60"

    preset: Annotated[Preset, Meta(title="Manner"), PRESETS] = "lab"
    speed: Annotated[
        Speed | None,
        Meta(description="Where nothing is near; 0.15 of lab, 0.4 of aria, 0.3 of explore."),
    ] = None

    def stack(self, limits: "Limits") -> "Stack":
        """Return a fresh stack that wanders, no faster than `limits`."""
        speed = None if self.speed is None else min(self.speed, limits.max_speed)
        return wander(preset=self.preset, speed=speed)


def wander(*, preset: Preset = "lab", speed: float | None = None) -> "Stack":
    """Return the stack that drives about and keeps clear of obstacles.

    Args:
        preset: `lab` as the lab's seed has it, `aria` as ARIA's wander group, both with two actions
            more: a limiter that knows the robot's corners, and a way out where they would turn for
            ever. `explore` seeks new ground, through doors that the others take for walls.
        speed: When nothing is near [m/s]; the preset's own if `None`: 0.15, 0.4 and 0.3.

    Raises:
        ValueError: there is no such preset.
    """
    from pioneer3.behaviors.action import MODE, Stack

    if preset not in _ACTIONS:
        raise ValueError(f"there is no preset {preset!r}; take {' or '.join(_ACTIONS)}")
    own = _ACTIONS[preset]
    actions = own.actions(own.speed if speed is None else speed)
    return Stack.of("wander", MODE, actions, Wander.doing)


def _lab(speed: float) -> "list[Ranked]":
    from pioneer3.behaviors.action import Ranked
    from pioneer3.behaviors.actions.avoid import AvoidFront
    from pioneer3.behaviors.actions.limiters import LimiterForwards, LimiterSweep
    from pioneer3.behaviors.actions.motion import ConstantVelocity
    from pioneer3.behaviors.actions.recover import StallRecover, Unstick

    return [
        Ranked(100, StallRecover()),
        Ranked(95, LimiterForwards(0.3, 0.6, 0.25, name="near limiter")),
        Ranked(90, LimiterForwards(0.3, 1.1, 0.2, name="far limiter")),
        Ranked(85, LimiterSweep()),
        Ranked(55, Unstick()),
        Ranked(50, AvoidFront(0.5, avoid_velocity=0.0, name="avoid near")),
        Ranked(49, AvoidFront(name="avoid far")),
        Ranked(25, ConstantVelocity(speed)),
    ]


def _aria(speed: float) -> "list[Ranked]":
    from pioneer3.behaviors.action import Ranked
    from pioneer3.behaviors.actions.avoid import AvoidFront, Bumpers
    from pioneer3.behaviors.actions.limiters import LimiterSweep
    from pioneer3.behaviors.actions.motion import ConstantVelocity
    from pioneer3.behaviors.actions.recover import StallRecover, Unstick

    return [
        Ranked(100, Bumpers()),
        Ranked(90, StallRecover()),
        Ranked(85, LimiterSweep()),
        Ranked(80, Unstick()),
        Ranked(79, AvoidFront()),
        Ranked(50, ConstantVelocity(speed)),
    ]


def _explore(speed: float) -> "list[Ranked]":
    from pioneer3.behaviors.action import Ranked
    from pioneer3.behaviors.actions.avoid import Bumpers
    from pioneer3.behaviors.actions.explore import Explore
    from pioneer3.behaviors.actions.limiters import LimiterForwards, LimiterSweep
    from pioneer3.behaviors.actions.recover import StallRecover

    return [
        Ranked(110, Bumpers()),
        Ranked(100, StallRecover()),
        Ranked(95, LimiterForwards(0.3, 0.6, 0.25, name="near limiter")),
        Ranked(90, LimiterForwards(0.3, 1.1, 0.4, name="far limiter")),
        Ranked(85, LimiterSweep()),
        Ranked(25, Explore(speed)),
    ]


@dataclass(frozen=True, slots=True)
class _Own:
    """A preset's own speed [m/s], and its actions at a speed."""

    speed: float
    actions: "Callable[[float], list[Ranked]]"


_ACTIONS: Mapping[str, _Own] = MappingProxyType(
    {"lab": _Own(0.15, _lab), "aria": _Own(0.4, _aria), "explore": _Own(0.3, _explore)}
)
