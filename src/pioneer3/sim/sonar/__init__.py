"""When transducers fire, what they hear, and what a robot has not been told yet."""

from pioneer3.sim.sonar.base import Cast, Sonars
from pioneer3.sim.sonar.in_turn import InTurn
from pioneer3.sim.sonar.together import Together

__all__ = ["Cast", "InTurn", "Sonars", "Together"]
