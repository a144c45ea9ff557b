"""The mode that wanders (facts.md 7.7)."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

from msgspec import Meta

from pioneer3.behaviors.modes.mode import Choice, Choices, Mode, Speed

if TYPE_CHECKING:
    from pioneer3.behaviors.action import Stack
    from pioneer3.limits import Limits

Preset = Literal["lab", "aria", "explore"]
"""A way to wander: choices of the mode, described there."""
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


SPEEDS: Mapping[Preset, float] = MappingProxyType({"lab": 0.15, "aria": 0.4, "explore": 0.3})
"""Each preset's own speed [m/s]."""


def wander(*, preset: Preset = "lab", speed: float | None = None) -> "Stack":
    """Return the stack that drives about and keeps clear of obstacles.

    Args:
        preset: `lab` as the lab's seed has it, `aria` as ARIA's wander group, both with two actions
            more: a limiter that knows the robot's corners, and a way out where they would turn for
            ever. `explore` seeks new ground, through doors that the others take for walls.
        speed: When nothing is near [m/s]; the preset's own if `None`.

    Raises:
        ValueError: there is no such preset.
    """
    from pioneer3.behaviors.action import MODE, Ranked, Stack
    from pioneer3.behaviors.actions.avoid import AvoidFront, Bumpers
    from pioneer3.behaviors.actions.explore import Explore
    from pioneer3.behaviors.actions.limiters import LimiterForwards, LimiterSweep
    from pioneer3.behaviors.actions.motion import ConstantVelocity
    from pioneer3.behaviors.actions.recover import StallRecover, Unstick

    if preset not in SPEEDS:
        raise ValueError(f"there is no preset {preset!r}; take {' or '.join(SPEEDS)}")
    onwards = SPEEDS[preset] if speed is None else speed
    actions = {
        "lab": [
            Ranked(100, StallRecover()),
            Ranked(95, LimiterForwards(0.3, 0.6, 0.25, name="near limiter")),
            Ranked(90, LimiterForwards(0.3, 1.1, 0.2, name="far limiter")),
            Ranked(85, LimiterSweep()),
            Ranked(55, Unstick()),
            Ranked(50, AvoidFront(0.5, avoid_velocity=0.0, name="avoid near")),
            Ranked(49, AvoidFront(name="avoid far")),
            Ranked(25, ConstantVelocity(onwards)),
        ],
        "aria": [
            Ranked(100, Bumpers()),
            Ranked(90, StallRecover()),
            Ranked(85, LimiterSweep()),
            Ranked(80, Unstick()),
            Ranked(79, AvoidFront()),
            Ranked(50, ConstantVelocity(onwards)),
        ],
        "explore": [
            Ranked(110, Bumpers()),
            Ranked(100, StallRecover()),
            Ranked(95, LimiterForwards(0.3, 0.6, 0.25, name="near limiter")),
            Ranked(90, LimiterForwards(0.3, 1.1, 0.4, name="far limiter")),
            Ranked(85, LimiterSweep()),
            Ranked(25, Explore(onwards)),
        ],
    }
    return Stack.of("wander", MODE, actions[preset], Wander.doing)
