"""A velocity that somebody holds: a key, a stick, a finger, a program."""

from dataclasses import dataclass

from pioneer3.behaviors.engine import Desire
from pioneer3.geometry import STILL, Twist2
from pioneer3.state import Snapshot


@dataclass(slots=True)
class Hold:
    """Wants the last twist set, for as long as that lasts."""

    name: str
    priority: int
    twist: Twist2 = STILL
    until: float = float("-inf")

    def set(self, twist: Twist2, until: float) -> None:
        """Want `twist` until then [s, monotonic]."""
        self.twist, self.until = twist, until

    def release(self) -> None:
        """Want nothing."""
        self.until = float("-inf")

    def decide(self, snapshot: Snapshot, now: float) -> Desire | None:
        """Return the twist while it lasts."""
        if now >= self.until:
            return None
        return Desire(v=self.twist.v, w=self.twist.w, until=self.until)
