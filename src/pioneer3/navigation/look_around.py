"""The mode of a robot that looks around until it knows where it is."""

from collections.abc import Callable
from dataclasses import dataclass, field

from pioneer3.behaviors.action import MODE, Action, Desire, Ranked, Situation, Stack
from pioneer3.behaviors.modes import wander
from pioneer3.limits import Limits
from pioneer3.nav.estimate import Estimate

LOOK_SPEED = 0.2
"""Speed of a robot that does not know where it is [m/s]."""
LOOK_PATIENCE = 120.0
"""Time after which a robot that has looked around in vain gives up [s]."""


@dataclass(slots=True)
class UntilSure(Action):
    """Ends a mode once it is sure where the robot is, or after a while; asks for no motion.

    Attributes:
        estimate: Returns where the robot is.
        done: Whether it is sure.
        failed: The reason to give up, or `None`.
    """

    estimate: Callable[[], Estimate]
    name: str = "look around"
    done: bool = False
    failed: str | None = None
    _began: float | None = field(default=None, init=False)

    def decide(self, situation: Situation) -> Desire | None:
        """Look whether it knows now."""
        estimate = self.estimate()
        self.done = estimate.sure
        if self._began is None:
            self._began = situation.now
        elif situation.now - self._began > LOOK_PATIENCE:
            self.failed = f"not sure where the robot is: {estimate.reason}"
        return None


def look_around(estimate: Callable[[], Estimate], limits: Limits) -> Stack:
    """Return the mode that wanders slowly until it is sure where the robot is."""
    stack = wander(preset="explore", speed=min(LOOK_SPEED, limits.max_speed))
    actions = [Ranked(1000, UntilSure(estimate)), *stack.actions]
    return Stack.of("look around", MODE, actions, "drives about until it knows where it is")
