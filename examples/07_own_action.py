"""Wander, and wait for people who come near: an action of your own in ten lines."""

import sys
from math import radians

from pioneer3 import connect
from pioneer3.behaviors import Action, Desire, Situation
from pioneer3.behaviors.modes import wander


class Polite(Action):
    """Stands still while something is right in front."""

    name = "polite"

    def decide(self, situation: Situation) -> Desire | None:
        echo = situation.around.nearest(radians(-20), radians(20))
        if echo.distance > 0.8:
            return None  # nothing to say: lower priorities decide
        return Desire(v=0.0, w=0.0, reason=f"after you, at {echo.distance:.1f} m")


with connect(sys.argv[1] if len(sys.argv) > 1 else "tcp://localhost:8101") as robot:
    robot.run(wander().adding(Polite(), priority=60), seconds=10)
