"""Named stacks of actions (facts.md 7.7). Each factory makes fresh actions: they have memories."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

from pioneer3.behaviors.action import MODE, Ranked, Stack
from pioneer3.behaviors.actions import (
    AvoidFront,
    Bumpers,
    ColorFollow,
    ConstantVelocity,
    DeceleratingLimiter,
    Explore,
    Goto,
    LimiterBackwards,
    LimiterForwards,
    LimiterSweep,
    LimiterTableSensor,
    RatioInput,
    StallRecover,
    Stop,
    Unstick,
)
from pioneer3.behaviors.follow import HINT, follow

Preset = Literal["lab", "aria", "explore"]


@dataclass(frozen=True, slots=True)
class Mode:
    """A stack that can be chosen by name.

    Attributes:
        name: To choose it by.
        hint: What it does, in a sentence.
        make: Returns a fresh stack; its arguments are those of the factory below.
    """

    name: str
    hint: str
    make: Callable[..., Stack]


def wander(*, preset: Preset = "lab", speed: float | None = None, priority: int = MODE) -> Stack:
    """Return the stack that drives about and keeps clear of what is in the way.

    Args:
        preset: `lab` as the lab's seed has it, `aria` as ARIA's wander group, both with two actions
            more: a limiter that knows the robot's corners, and a way out where they would turn for
            ever. `explore` seeks new ground, through doors that the others take for walls.
        speed: When nothing is near [m/s]; the preset's own if `None`: 0.15, 0.4 and 0.3.
        priority: Against other stacks.

    Raises:
        ValueError: there is no such preset.
    """
    if preset not in _WANDERING:
        raise ValueError(f"there is no preset {preset!r}; take {' or '.join(_WANDERING)}")
    usual, actions = _WANDERING[preset]
    return _stack("wander", actions(usual if speed is None else speed), priority)


def teleop(ratios: RatioInput | None = None, *, priority: int = MODE) -> Stack:
    """Return the stack that drives by `ratios` and stops before obstacles."""
    actions = [
        Ranked(50, ratios or RatioInput()),
        Ranked(40, DeceleratingLimiter()),
        Ranked(39, DeceleratingLimiter(backwards=True)),
    ]
    return _stack("teleop", actions, priority)


def unguarded(ratios: RatioInput | None = None, *, priority: int = MODE) -> Stack:
    """Return the stack that drives by `ratios`, into obstacles too."""
    return _stack("unguarded", [Ranked(50, ratios or RatioInput())], priority)


def goto(
    x: float,
    y: float,
    heading: float | None = None,
    *,
    speed: float = 0.4,
    priority: int = MODE,
) -> Stack:
    """Return the stack that drives to a point of odometry's frame; see :class:`Goto`."""
    return _stack("goto", [*_guards(), Ranked(50, Goto(x, y, heading, speed=speed))], priority)


def color_follow(follow: ColorFollow, *, priority: int = MODE) -> Stack:
    """Return the stack that drives after a colour and stops before obstacles."""
    actions = [*_guards(), Ranked(70, follow)]
    return Stack.of("color follow", priority, actions, "drives after a colour that a camera sees")


def stop(*, priority: int = MODE) -> Stack:
    """Return the stack that stands still."""
    return _stack("stop", [Ranked(100, Stop())], priority)


def _stack(name: str, actions: list[Ranked], priority: int) -> Stack:
    return Stack.of(name, priority, actions, MODES[name].hint)


def _guards() -> list[Ranked]:
    """Return what keeps the robot from driving into things, as in ARIA's input group."""
    return [
        Ranked(110, StallRecover()),
        Ranked(100, LimiterTableSensor()),
        Ranked(90, LimiterForwards(0.3, 0.6, 0.25, name="near limiter")),
        Ranked(89, LimiterForwards(0.3, 1.1, 0.4, name="far limiter")),
        Ranked(85, LimiterSweep(creep=0.0, turn_time=1.2)),
        Ranked(80, LimiterBackwards()),
    ]


def _lab(speed: float) -> list[Ranked]:
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


def _aria(speed: float) -> list[Ranked]:
    return [
        Ranked(100, Bumpers()),
        Ranked(90, StallRecover()),
        Ranked(85, LimiterSweep()),
        Ranked(80, Unstick()),
        Ranked(79, AvoidFront()),
        Ranked(50, ConstantVelocity(speed)),
    ]


def _explore(speed: float) -> list[Ranked]:
    return [
        Ranked(110, Bumpers()),
        Ranked(100, StallRecover()),
        Ranked(95, LimiterForwards(0.3, 0.6, 0.25, name="near limiter")),
        Ranked(90, LimiterForwards(0.3, 1.1, 0.4, name="far limiter")),
        Ranked(85, LimiterSweep()),
        Ranked(25, Explore(speed)),
    ]


_WANDERING: Mapping[str, tuple[float, Callable[[float], list[Ranked]]]] = MappingProxyType(
    {"lab": (0.15, _lab), "aria": (0.4, _aria), "explore": (0.3, _explore)}
)

MODES: Mapping[str, Mode] = MappingProxyType(
    {
        mode.name: mode
        for mode in (
            Mode("wander", "drives about and keeps clear of what is in the way", wander),
            Mode("teleop", "drives by keys or stick and stops before obstacles", teleop),
            Mode(
                "unguarded", "drives by keys or stick; NOTHING keeps it from obstacles", unguarded
            ),
            Mode("goto", "drives to a point", goto),
            Mode("follow", HINT, follow),
            Mode("stop", "stands still", stop),
        )
    }
)
