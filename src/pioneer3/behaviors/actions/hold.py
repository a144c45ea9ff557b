"""A velocity that somebody holds: a key, a stick, a finger, a program."""

from dataclasses import dataclass, field

from pioneer3.behaviors.desire import Desire
from pioneer3.behaviors.situation import Situation
from pioneer3.geometry import STILL, Twist2

NEVER = float("-inf")
LETTING_GO = 0.6
"""What is muted and not renewed for this long [s] has been let go, however long it was to last."""


@dataclass(slots=True)
class Hold:
    """Wants the last twist set, for as long as that lasts.

    Attributes:
        muted: Somebody stopped the robot while this was held. It wants nothing until it has been
            let go: released, set to zero, or not renewed in time.
    """

    name: str
    muted: bool = field(default=False, init=False)
    _twist: Twist2 = field(default=STILL, init=False)
    _until: float = field(default=NEVER, init=False)

    def set(self, twist: Twist2, now: float, seconds: float) -> None:
        """Want `twist` for `seconds` from `now` [s, monotonic]."""
        self.muted = self.muted and now < self._until and not twist.is_zero
        self._twist = twist
        self._until = now + (min(seconds, LETTING_GO) if self.muted else seconds)

    def release(self) -> None:
        """Want nothing."""
        self.muted, self._until = False, NEVER

    def mute(self, now: float) -> None:
        """Want nothing until what is held at `now` has been let go."""
        self.muted = now < self._until and not self._twist.is_zero
        self._until = min(self._until, now + LETTING_GO)

    def holds(self, now: float) -> bool:
        """Return whether this wants something at `now`."""
        return not self.muted and now < self._until

    def decide(self, situation: Situation) -> Desire | None:
        """Return the twist while it lasts."""
        if not self.holds(situation.now):
            return None
        return Desire(v=self._twist.v, w=self._twist.w, until=self._until, reason="held")
