"""Modes that turn the robot, or drive it to a place."""

from typing import TYPE_CHECKING, Annotated, ClassVar

from msgspec import Meta

from pioneer3.behaviors.modes.mode import Angle, Coordinate, Mode, Speed, TurnRate

if TYPE_CHECKING:
    from pioneer3.behaviors.action import Ranked, Stack
    from pioneer3.limits import Limits


class Goto(Mode, frozen=True, tag="goto"):
    """Drive to a place and stop; slow down and turn aside for obstacles.

    The place counts from where the robot is and looks when the connection opens. It is found by the
    wheels, which drift.
    """

    title: ClassVar[str] = "Go to"
    doing: ClassVar[str] = "drives to a place"
    start: ClassVar[str] = "Drive there"
    example: ClassVar[str] = "2 -0.5 90"
    finishes: ClassVar[bool] = True
    arguments: ClassVar[tuple[str, ...]] = ("x", "y", "heading")
    goes_to_place: ClassVar[bool] = True

    x: Annotated[Coordinate, Meta(title="x", description="Ahead of where it starts.")]
    y: Annotated[Coordinate, Meta(title="y", description="To the left of where it starts.")]
    heading: Annotated[
        Angle | None, Meta(description="To turn to in the end; without it, as it arrives.")
    ] = None
    speed: Annotated[Speed, Meta(description="At most.")] = 0.3

    def stack(self, limits: "Limits") -> "Stack":
        """Return a fresh stack that goes there, no faster than `limits`."""
        return goto(self.x, self.y, self.heading, speed=min(self.speed, limits.max_speed))


def goto(x: float, y: float, heading: float | None = None, *, speed: float = 0.4) -> "Stack":
    """Return the stack that drives to a point of odometry's frame."""
    from pioneer3.behaviors.action import MODE, Ranked, Stack
    from pioneer3.behaviors.actions.motion import Goto as GotoAction

    actions = [*guards(), Ranked(50, GotoAction(x, y, heading, speed=speed))]
    return Stack.of("goto", MODE, actions, Goto.doing)


def guards() -> "list[Ranked]":
    """Return the actions that keep the robot clear of obstacles, as in ARIA's input group."""
    from pioneer3.behaviors.action import Ranked
    from pioneer3.behaviors.actions.limiters import (
        LimiterBackwards,
        LimiterForwards,
        LimiterSweep,
        LimiterTableSensor,
    )
    from pioneer3.behaviors.actions.recover import StallRecover

    return [
        Ranked(110, StallRecover()),
        Ranked(100, LimiterTableSensor()),
        Ranked(90, LimiterForwards(0.3, 0.6, 0.25, name="near limiter")),
        Ranked(89, LimiterForwards(0.3, 1.1, 0.4, name="far limiter")),
        Ranked(85, LimiterSweep(creep=0.0, turn_time=1.2)),
        Ranked(80, LimiterBackwards()),
    ]


class Turn(Mode, frozen=True, tag="turn"):
    """Turn on the spot and stop.

    See that its corners are free: nothing looks out for obstacles.
    """

    title: ClassVar[str] = "Turn"
    doing: ClassVar[str] = "turns"
    start: ClassVar[str] = "Turn"
    example: ClassVar[str] = "-90"
    finishes: ClassVar[bool] = True
    arguments: ClassVar[tuple[str, ...]] = ("angle",)

    angle: Annotated[Angle, Meta(description="Positive is to the left.")]
    rate: Annotated[TurnRate, Meta(title="Turn rate", description="At most.")] = 0.5

    def stack(self, limits: "Limits") -> "Stack":
        """Return a fresh stack that turns, no faster than `limits`."""
        from pioneer3.behaviors.action import MODE, Ranked, Stack
        from pioneer3.behaviors.actions.motion import Turn as TurnAction

        action = TurnAction(
            angle=self.angle,
            rate=min(self.rate, limits.max_turn_rate),
            deceleration=limits.turn_deceleration,
        )
        return Stack.of("turn", MODE, [Ranked(0, action)], self.doing)
