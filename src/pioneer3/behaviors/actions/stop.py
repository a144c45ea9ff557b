"""Stand still."""

from dataclasses import dataclass

from pioneer3.behaviors.desire import Desire
from pioneer3.behaviors.situation import Situation


@dataclass(slots=True)
class Stop:
    """Wants to stand still, whatever lower priorities want (arcos.md 7.6)."""

    name: str = "stop"

    def decide(self, situation: Situation) -> Desire:
        """Return no speed and no turn."""
        return Desire(v=0.0, turn=0.0, reason="standing still")
