"""A velocity that somebody holds: a key, a stick, a finger, a program."""

from dataclasses import dataclass, field

from pioneer3.behaviors.desire import Desire
from pioneer3.behaviors.situation import Situation
from pioneer3.geometry import STILL, Twist2

NEVER = float("-inf")


@dataclass(slots=True)
class Hold:
    """Wants the last twist set, for as long as that lasts.

    Attributes:
        muted: Somebody stopped the robot while this was held. It wants nothing until it has been
            let go: released, or not renewed in time.
    """

    name: str
    muted: bool = field(default=False, init=False)
    _twist: Twist2 = field(default=STILL, init=False)
    _until: float = field(default=NEVER, init=False)

    def set(self, twist: Twist2, now: float, seconds: float) -> None:
        """Want `twist` for `seconds` from `now` [s, monotonic]."""
        self.muted = self.muted and now < self._until
        self._twist, self._until = twist, now + seconds

    def release(self) -> None:
        """Want nothing."""
        self.muted, self._until = False, NEVER

    def mute(self, now: float) -> None:
        """Want nothing until what is held at `now` has been let go."""
        self.muted = now < self._until

    def holds(self, now: float) -> bool:
        """Return whether this wants something at `now`."""
        return not self.muted and now < self._until

    def decide(self, situation: Situation) -> Desire | None:
        """Return the twist while it lasts."""
        if not self.holds(situation.now):
            return None
        return Desire(v=self._twist.v, w=self._twist.w, until=self._until, reason="held")
