"""Stacks for the demo, which people or a camera steer: they are no modes to start by name."""

from pioneer3.behaviors.action import MODE, Ranked, Stack
from pioneer3.behaviors.actions import ColorFollow, DeceleratingLimiter, RatioInput
from pioneer3.behaviors.actions.limiters import LimiterSweep
from pioneer3.behaviors.modes.goto import guards


def teleop(ratios: RatioInput) -> Stack:
    """Return the stack that drives by `ratios` and stops before obstacles.

    Beside them it turns slowly, which ARIA's does not: 4 of 4 runs of 3 minutes among tables hit a
    leg with a corner, at up to 0.35 m/s.
    """
    actions = [
        Ranked(50, ratios),
        Ranked(40, DeceleratingLimiter()),
        Ranked(39, DeceleratingLimiter(backwards=True)),
        Ranked(38, LimiterSweep()),
    ]
    return Stack.of("teleop", MODE, actions, "drives by keys or stick, stops before obstacles")


def unguarded(ratios: RatioInput) -> Stack:
    """Return the stack that drives by `ratios`, into obstacles too."""
    hint = "drives by keys or stick; NOTHING keeps it from obstacles"
    return Stack.of("unguarded", MODE, [Ranked(50, ratios)], hint)


def color_follow(follow: ColorFollow) -> Stack:
    """Return the stack that drives after a colour and stops before obstacles."""
    actions = [*guards(), Ranked(70, follow)]
    return Stack.of("color follow", MODE, actions, "drives after a colour that a camera sees")
