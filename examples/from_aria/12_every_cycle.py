"""Do something in every cycle, and decide in it: user tasks and actions of one's own.

ARIA: addUserTask, addSensorInterpTask and ArFunctor (ArFunctorC, PyFunctor): code at each snapshot.
A class of ArAction with fire and ArActionDesired: an Action with decide and Desire.
"""

import sys

from pioneer3 import connect
from pioneer3.behaviors import Action, Desire, Ranked, Situation, Stack
from pioneer3.behaviors.actions import ConstantVelocity, LimiterForwards


class Weave(Action):
    """Turns to the left and to the right in turn."""

    name = "weave"
    cycles = 0

    def decide(self, situation: Situation) -> Desire:  # fire
        """Return the turn rate of this cycle."""
        self.cycles += 1
        left = self.cycles % 20 < 10
        return Desire(w=0.4 if left else -0.4, reason="weaving")  # setRotVel of ArActionDesired


weave = Weave()
with connect(sys.argv[1] if len(sys.argv) > 1 else "tcp://localhost:8101") as robot:
    for snapshot in robot.snapshots(seconds=1):  # a user task, ten times a second
        print(f"{snapshot.sequence}: {snapshot.battery.voltage:.1f} V")
    actions = [Ranked(90, LimiterForwards()), Ranked(50, weave), Ranked(20, ConstantVelocity(0.15))]
    robot.run(Stack.of("weaving", 20, actions), seconds=2)
    print(f"{weave.cycles} cycles")
