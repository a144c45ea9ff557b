"""Holds a velocity that a key, a stick, a finger or a program has set."""

from dataclasses import dataclass, field
from typing import Final

from pioneer3.behaviors.action import Action, Desire, Situation
from pioneer3.errors import Refusal
from pioneer3.geometry import STILL, Twist2
from pioneer3.stops import Freshness, Stop, leads_away

NEVER: Final = float("-inf")
LETTING_GO: Final = 0.6
"""A command that is not renewed for this long [s] has been let go of, however long it lasts."""


@dataclass(slots=True)
class Hold(Action):
    """Wants the last `twist` set, for as long as that lasts.

    A command begins when the one before was let go of: released, set to zero, or not renewed in
    time. A stream says when it lets go; one that falls silent instead has failed.

    It `streams` if commands come as a stream, from a page or a topic. From `until` on it wants
    nothing [s, monotonic].
    """

    name: str
    streams: bool = False
    twist: Twist2 = field(default=STILL, init=False)
    until: float = field(default=NEVER, init=False)
    _set_at: float = field(default=NEVER, init=False)
    _renewed: bool = field(default=False, init=False)
    freshness: Freshness = field(default_factory=Freshness, init=False)

    def set(self, twist: Twist2, now: float, seconds: float, last: Stop) -> None:
        """Want `twist` for `seconds` from `now` [s, monotonic]; `last` is the stop before that."""
        if self._begins(twist, now):
            self.freshness, self._renewed = Freshness.new(last), False
        else:
            self._renewed = True
            if now >= self.until:
                self.freshness.silent = f"{self.name} fell silent while it drove"
            if leads_away(twist, self.twist):
                self.freshness.answer(last)
        self.twist, self._set_at, self.until = twist, now, now + seconds

    def release(self) -> None:
        """Want nothing."""
        self.twist, self.until = STILL, NEVER

    def overrule(self, why: str, now: float) -> None:
        """Want nothing until what is held at `now`, if anything, has been let go of."""
        if now < self.until and not self.twist.is_zero:
            self.freshness.overruled = why

    def ignored(self, last: Stop) -> Refusal | None:
        """Return the refusal of this after the stop `last`, or `None`."""
        return None if self.twist.is_zero else self.freshness.ignored(last)

    def fell_silent(self, now: float) -> bool:
        """Return whether this is a stream that has just stopped coming without letting go."""
        is_late = now >= self.until and not self.freshness.silent
        return self.streams and self._renewed and is_late and not self.twist.is_zero

    def holds(self, now: float, last: Stop) -> bool:
        """Return whether this wants something at `now`."""
        return now < self.until and self.ignored(last) is None

    def decide(self, situation: Situation) -> Desire | None:
        """Return the twist while it lasts."""
        if not self.holds(situation.now, situation.last_stop):
            return None
        return Desire(v=self.twist.v, w=self.twist.w, until=self.until, reason="held")

    def _begins(self, twist: Twist2, now: float) -> bool:
        """Return whether the command before was let go of."""
        if twist.is_zero or self.twist.is_zero:
            return True
        if self.streams and self._renewed:
            return False
        return now >= min(self.until, self._set_at + LETTING_GO)
