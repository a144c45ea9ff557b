"""Drive on."""

from dataclasses import dataclass

from pioneer3.behaviors.desire import Desire
from pioneer3.behaviors.situation import Situation


@dataclass(slots=True)
class ConstantVelocity:
    """Wants straight ahead at `velocity` [m/s], negative is backwards (arcos.md 7.6)."""

    velocity: float = 0.4
    name: str = "constant velocity"

    def decide(self, situation: Situation) -> Desire:
        """Return it."""
        return Desire(v=self.velocity, turn=0.0, reason="onwards")
