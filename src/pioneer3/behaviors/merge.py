"""How wishes of several actions become one (arcos.md 7.4)."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from math import inf

from pioneer3.behaviors.desire import HIGHEST, LOWEST, NO_STRENGTH, Desire, Wish, as_wish
from pioneer3.geometry import wrap


@dataclass(frozen=True, slots=True)
class Share:
    """The part of one action in a decision.

    Attributes:
        action: Its name.
        channel: A channel of :class:`Desire`; headings have become turns.
        value: What it wanted.
        strength: How much of that counted: the rest was taken by higher priorities.
        reason: Its own words.
    """

    action: str
    channel: str
    value: float
    strength: float
    reason: str


@dataclass(frozen=True, slots=True)
class Entry:
    """What one action wants."""

    action: str
    desire: Desire


@dataclass(frozen=True, slots=True)
class Merge:
    """What the actions asked so far want together.

    Attributes:
        motion: By channel (`v`, `turn`, `w`); a strength of 1 is a full owner.
        limits: By channel, where anybody set one.
        until: When the first wish that counts in `motion` ends [s, monotonic].
        despite_stall: Whether one of these answers a stall.
        shares: Who has which part in it, highest priority first.
    """

    motion: dict[str, Wish] = field(default_factory=dict)
    limits: dict[str, float] = field(default_factory=dict)
    until: float = inf
    despite_stall: bool = False
    shares: tuple[Share, ...] = ()

    def strength(self, channel: str) -> float:
        """Return how much of a motion channel is taken, 0 to 1."""
        wish = self.motion.get(channel)
        return wish.strength if wish else 0.0

    @property
    def owned(self) -> bool:
        """Whether any motion channel is fully taken."""
        return any(wish.strength >= 1 - NO_STRENGTH for wish in self.motion.values())

    def below(self, group: Iterable[Entry], theta: float) -> "Merge":
        """Return this with a group of equal priority added below it.

        Args:
            group: In any order; the result is the same up to rounding.
            theta: The robot's heading, from which headings become turns [rad].
        """
        motion, limits, shares = dict(self.motion), dict(self.limits), list(self.shares)
        until, despite_stall = self.until, self.despite_stall
        group = sorted(group, key=lambda entry: entry.action)
        wishes = {channel: _wishes(channel, group, theta) for channel in ("v", "turn", "w")}
        for channel, found in wishes.items():
            room = 1.0 - self.strength(channel)
            if not found or room <= NO_STRENGTH or self._decided_otherwise(channel):
                continue
            total = sum(wish.strength for _, wish in found)
            scale = min(1.0, room / total)
            for entry, wish in found:
                counted = wish.strength * scale
                name, reason = entry.action, entry.desire.reason
                shares.append(Share(name, channel, wish.value, counted, reason))
                motion[channel] = _mixed(motion.get(channel), Wish(wish.value, counted))
                until = min(until, entry.desire.until)
                despite_stall = despite_stall or entry.desire.despite_stall
        for channel in (*LOWEST, *HIGHEST):
            for entry in group:
                limit = as_wish(getattr(entry.desire, channel))
                if limit is None:
                    continue
                shares.append(Share(entry.action, channel, limit.value, 1.0, entry.desire.reason))
                limits[channel] = _safest(channel, limits.get(channel), limit.value)
        return Merge(motion, limits, until, despite_stall, tuple(shares))

    def _decided_otherwise(self, channel: str) -> bool:
        """Whether higher priorities have chosen the other way to turn (arcos.md 7.4, rule 4)."""
        other = {"turn": "w", "w": "turn"}.get(channel)
        return other in self.motion and channel not in self.motion


def _wishes(channel: str, group: list[Entry], theta: float) -> list[tuple[Entry, Wish]]:
    """Return who in `group` wants what of `channel`."""
    found = []
    for entry in group:
        wish = as_wish(getattr(entry.desire, channel))
        if channel == "turn" and (heading := as_wish(entry.desire.heading)):
            wish = Wish(wrap(heading.value - theta), heading.strength)
        if wish is not None:
            found.append((entry, wish))
    return found


def _mixed(above: Wish | None, below: Wish) -> Wish:
    """Return the mean by strength."""
    if above is None:
        return below
    strength = above.strength + below.strength
    value = (above.value * above.strength + below.value * below.strength) / strength
    return Wish(value, min(1.0, strength))


def _safest(channel: str, known: float | None, value: float) -> float:
    if known is None:
        return value
    return max(known, value) if channel in HIGHEST else min(known, value)
