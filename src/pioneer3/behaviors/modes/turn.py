"""The mode that turns on the spot."""

from typing import TYPE_CHECKING, Annotated, ClassVar

from msgspec import Meta

from pioneer3.behaviors.modes.mode import Angle, Mode, TurnRate

if TYPE_CHECKING:
    from pioneer3.behaviors.action import Stack
    from pioneer3.limits import Limits


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
