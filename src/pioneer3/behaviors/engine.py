"""Resolves prioritised actions. Pure: situation in, decision out; no link, no logging."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from itertools import groupby
from math import copysign, inf, radians, sqrt
from operator import attrgetter

from pioneer3.behaviors.action import (
    HIGHEST,
    LOWEST,
    MOTION,
    NO_STRENGTH,
    Action,
    Combined,
    Contribution,
    Desire,
    Situation,
    Stack,
    Weighted,
    as_weighted,
)
from pioneer3.geometry import STILL, Twist2, wrap
from pioneer3.limits import Limits

SETTLE = 0.35
"""Time constant of the last stretch [s]: three report cycles, so that it does not overshoot."""
MARGIN = 0.7
"""Share of the deceleration planned with; the rest covers the delay of a report cycle."""


def approach(remaining: float, top: float, deceleration: float) -> float:
    """Return the speed towards a point `remaining` away, signed like it.

    Square root far away (constant deceleration), proportional near. Metres or radians alike.
    """
    distance = abs(remaining)
    speed = min(top, sqrt(2 * MARGIN * deceleration * distance), distance / SETTLE)
    return copysign(speed, remaining)


@dataclass(frozen=True, slots=True)
class Proposal:
    """The desire of one action, with its name."""

    action: str
    desire: Desire


def combine(above: Combined, group: Iterable[Proposal], theta: float) -> Combined:
    """Return `above` with the desires of a group of equal priority added below it.

    They come in any order; the result is the same up to rounding. From the robot's heading, `theta`
    [rad], headings become turns.
    """
    motion, limits, parts = dict(above.motion), dict(above.limits), list(above.contributions)
    until, answers_stall = above.until, above.answers_stall
    group = sorted(group, key=lambda proposal: proposal.action)
    for channel in MOTION:
        room = 1.0 - above.strength(channel)
        found = _wanted(channel, group, theta)
        if not found or room <= NO_STRENGTH or _decided_otherwise(above, channel):
            continue
        scale = min(1.0, room / sum(weighted.strength for _, weighted in found))
        for proposal, weighted in found:
            counted = Weighted(weighted.value, weighted.strength * scale)
            parts.append(_contribution(proposal, channel, counted))
            _add(motion, limits, parts[-1])
            until = min(until, proposal.desire.until)
            answers_stall = answers_stall or proposal.desire.answers_stall
    limiting = [each for each in group if _limits_of(each.desire) != NO_LIMITS]
    for channel in (*LOWEST, *HIGHEST):
        for proposal in limiting:
            limit = as_weighted(getattr(proposal.desire, channel))
            if limit is not None:
                parts.append(_contribution(proposal, channel, Weighted(limit.value)))
                _add(motion, limits, parts[-1])
    return Combined(motion, limits, until, answers_stall, tuple(parts))


def _add(motion: dict[str, Weighted], limits: dict[str, float], part: Contribution) -> None:
    """Add the part of an action to the motion or the limits."""
    channel = part.channel
    if channel in MOTION:
        motion[channel] = _mean(motion.get(channel), Weighted(part.value, part.strength))
    else:
        limits[channel] = _safest(channel, limits.get(channel), part.value)


_limits_of = attrgetter(*LOWEST, *HIGHEST)
NO_LIMITS = _limits_of(Desire())


def _contribution(proposal: Proposal, channel: str, counted: Weighted) -> Contribution:
    desire = proposal.desire
    return Contribution(
        proposal.action, channel, counted.value, counted.strength, desire.reason, desire.lacks
    )


def _decided_otherwise(above: Combined, channel: str) -> bool:
    """Return whether higher priorities have chosen the other way to turn (facts.md 7.4, rule 4)."""
    other = {"turn": "w", "w": "turn"}.get(channel)
    return other in above.motion and channel not in above.motion


def _wanted(channel: str, group: list[Proposal], theta: float) -> list[tuple[Proposal, Weighted]]:
    """Return the proposals for `channel`, each with its value and strength."""
    found = []
    for proposal in group:
        asked = as_weighted(getattr(proposal.desire, channel))
        if channel == "turn" and (heading := as_weighted(proposal.desire.heading)):
            asked = Weighted(wrap(heading.value - theta), heading.strength)
        if asked is not None:
            found.append((proposal, asked))
    return found


def _mean(above: Weighted | None, below: Weighted) -> Weighted:
    """Return the mean by strength."""
    if above is None:
        return below
    strength = above.strength + below.strength
    value = (above.value * above.strength + below.value * below.strength) / strength
    return Weighted(value, min(1.0, strength))


def _safest(channel: str, known: float | None, value: float) -> float:
    if known is None:
        return value
    return max(known, value) if channel in HIGHEST else min(known, value)


TURNED = radians(0.5)
"""A turn smaller than this is done (facts.md 7.5: it rounds to no degree)."""


class ActionError(Exception):
    """An action, of the stack of this name, failed; the robot must stop."""

    def __init__(self, stack: str, action: str, error: Exception) -> None:
        super().__init__(f"the action {action!r} failed: {type(error).__name__}: {error}")
        self.stack = stack


@dataclass(frozen=True, slots=True)
class Decision:
    """The motion of the robot, its end, and the actions that decided it.

    Attributes:
        twist: Within all limits of actions [m/s, rad/s].
        contributions: The parts of the actions in it, highest priority first.
        limits: Set by actions, by channel of `Desire`.
    """

    twist: Twist2 = STILL
    until: float = inf
    contributions: tuple[Contribution, ...] = ()
    limits: Mapping[str, float] = field(default_factory=dict)
    answers_stall: bool = False

    @property
    def v_by(self) -> str | None:
        """The first action that decided the speed, or `None`."""
        return self._first("v")

    @property
    def w_by(self) -> str | None:
        """The first action that decided the turn, or `None`."""
        return self._first("turn", "w")

    @property
    def wanted(self) -> bool:
        """Whether an action asked for motion, standing still included."""
        return self.v_by is not None or self.w_by is not None

    @property
    def lacking(self) -> str | None:
        """The missing knowledge that holds the robot up, in words; `None` if none does."""
        if self.twist.v:
            return None
        asked = any(part.channel == "v" and part.value for part in self.contributions)
        lacks = (p for p in self.contributions if p.lacks and (asked or p.channel in MOTION))
        return next((part.reason for part in lacks), None)

    def _first(self, *channels: str) -> str | None:
        for part in self.contributions:  # called too often for a generator
            if part.channel in channels:
                return part.action
        return None


def resolve(stacks: Iterable[Stack], situation: Situation) -> Decision:
    """Ask all actions, from the highest priority down; each sees the desires above it.

    The desires that `situation` has already are above all.

    Raises:
        ActionError: an action failed, or asked for a value that is no number.
    """
    theta, seen, combined = situation.pose.theta, situation, situation.higher
    ranked = sorted(
        (
            (-stack.priority, -ranked.priority, stack.name, ranked.action)
            for stack in stacks
            for ranked in stack.actions
        ),
        key=lambda entry: entry[:2],
    )
    for _, group in groupby(ranked, key=lambda entry: entry[:2]):
        if seen.higher is not combined:
            seen = replace(situation, higher=combined)
        asked = [_ask(stack, action, seen) for _, _, stack, action in group]
        if entries := [entry for entry in asked if entry is not None]:
            combined = combine(combined, entries, theta)
    return _decision(combined, situation.limits)


def _ask(stack: str, action: Action, situation: Situation) -> Proposal | None:
    try:
        desire = action.decide(situation)
    except Exception as error:
        raise ActionError(stack, action.name, error) from error
    return None if desire is None else Proposal(action.name, desire)


def _decision(combined: Combined, limits: Limits) -> Decision:
    return Decision(
        decided(combined, limits),
        combined.until,
        combined.contributions,
        combined.limits,
        combined.answers_stall,
    )


def decided_again(decision: Decision, limits: Limits) -> Decision:
    """Return the decision that the contributions to another one come to."""
    motion: dict[str, Weighted] = {}
    known: dict[str, float] = {}
    for part in decision.contributions:
        _add(motion, known, part)
    twist = decided(Combined(motion, known), limits)
    return replace(decision, twist=twist, limits=known)


def decided(combined: Combined, limits: Limits) -> Twist2:
    """Return the motion that desires come to, within their limits."""
    known = combined.limits
    motion = {channel: taken.value for channel, taken in combined.motion.items()}
    w = motion.get("w", 0.0)
    if "turn" in motion:
        turn = motion["turn"]
        top = min(known.get("left_max" if turn > 0 else "right_max", inf), limits.max_turn_rate)
        deceleration = max(known.get("turn_deceleration", 0.0), limits.turn_deceleration)
        w = approach(turn, top, deceleration) if abs(turn) >= TURNED else 0.0
    return Twist2(
        _clip(motion.get("v", 0.0), known.get("v_max", inf), known.get("back_max", inf)),
        _clip(w, known.get("left_max", inf), known.get("right_max", inf)),
    )


def _clip(value: float, top: float, bottom: float) -> float:
    return max(-bottom, min(top, value))
