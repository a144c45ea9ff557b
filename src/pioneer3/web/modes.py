"""The modes that pages and scripts ask for, and the stacks they are."""

from typing import Annotated, Literal

import msgspec
from msgspec import Meta

from pioneer3.behaviors import modes
from pioneer3.behaviors.action import MODE, Stack
from pioneer3.behaviors.actions import Turn as TurnAction
from pioneer3.behaviors.follow import follow
from pioneer3.limits import Limits

Coordinate = Annotated[float, Meta(ge=-1e4, le=1e4)]
Angle = Annotated[float, Meta(ge=-100.0, le=100.0)]
Speed = Annotated[float, Meta(gt=0.0, le=5.0)]
Distance = Annotated[float, Meta(ge=0.1, le=3.0)]
Seconds = Annotated[float, Meta(gt=0.0, le=3600.0)]


class _Wish(msgspec.Struct, forbid_unknown_fields=True, tag_field="mode"):
    """A mode, told apart by `mode`."""


class Wander(_Wish, tag="wander"):
    """Drive about and keep clear of what is in the way, for some seconds at most."""

    preset: Literal["lab", "aria", "explore"] = "lab"
    speed: Speed | None = None
    seconds: Seconds = 60.0


class Follow(_Wish, tag="follow"):
    """Follow the person in front at a distance [m], as the rule's own if null."""

    rule: Literal["tracking", "lab"] = "tracking"
    keep: Distance | None = None
    seconds: Seconds = 60.0


class Goto(_Wish, tag="goto"):
    """Drive to a point of odometry's frame [m], and turn to a heading if that is given [rad]."""

    x: Coordinate
    y: Coordinate
    heading: Angle | None = None
    speed: Speed = 0.3
    seconds: Seconds = 60.0


class Turn(_Wish, tag="turn"):
    """Turn on the spot by an angle [rad], at a rate of so much at most [rad/s]."""

    angle: Angle
    rate: Speed = 0.5
    seconds: Seconds = 60.0


Mode = Wander | Follow | Goto | Turn


def make(wish: Mode, limits: Limits) -> Stack:
    """Return a fresh stack that does what `wish` says, no faster than the robot may."""
    match wish:
        case Wander(preset, speed):
            return modes.wander(preset=preset, speed=speed and min(speed, limits.max_speed))
        case Follow(rule, keep):
            return follow(rule, keep=keep)
        case Goto(x, y, heading, speed):
            return modes.goto(x, y, heading, speed=min(speed, limits.max_speed))
        case Turn(angle, rate):
            turn = TurnAction(
                angle=angle,
                rate=min(rate, limits.max_turn_rate),
                deceleration=limits.turn_deceleration,
            )
            return Stack.alone(turn, MODE)
