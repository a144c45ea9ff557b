"""Prioritised actions, resolved. Pure: situation in, decision out; no link, no logging."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from itertools import groupby
from math import inf, radians

from pioneer3.behaviors.merge import Entry, Merge, Share
from pioneer3.behaviors.profile import approach
from pioneer3.behaviors.situation import Situation
from pioneer3.behaviors.stack import Action, Stack
from pioneer3.geometry import STILL, Twist2
from pioneer3.limits import Limits

TURNED = radians(0.5)
"""A turn smaller than this is done (arcos.md 7.5: it rounds to no degree)."""


class ActionError(Exception):
    """An action failed; the robot must stop.

    Attributes:
        stack: Name of the stack it belongs to.
        action: Its name.
    """

    def __init__(self, stack: str, action: str, error: Exception) -> None:
        super().__init__(f"the action {action!r} failed: {type(error).__name__}: {error}")
        self.stack = stack
        self.action = action


@dataclass(frozen=True, slots=True)
class Decision:
    """What the robot shall do, until when, and who decided it.

    Attributes:
        twist: Within all limits of actions [m/s, rad/s].
        until: When it ends [s, monotonic].
        shares: Parts of the actions in it, highest priority first.
        limits: Set by actions, by channel of `Desire`.
        despite_stall: Whether it is the answer to a stall.
    """

    twist: Twist2 = STILL
    until: float = inf
    shares: tuple[Share, ...] = ()
    limits: Mapping[str, float] = field(default_factory=dict)
    despite_stall: bool = False

    @property
    def v_by(self) -> str | None:
        """Who decided the speed first of all, or `None`."""
        return self._first("v")

    @property
    def w_by(self) -> str | None:
        """Who decided the turn first of all, or `None`."""
        return self._first("turn", "w")

    @property
    def wanted(self) -> bool:
        """Whether anybody asked for motion, standing still included."""
        return self.v_by is not None or self.w_by is not None

    def _first(self, *channels: str) -> str | None:
        return next((share.action for share in self.shares if share.channel in channels), None)


def resolve(stacks: Iterable[Stack], situation: Situation) -> Decision:
    """Ask all actions, from the highest priority down; each knows what those above want.

    Raises:
        ActionError: an action failed, or wants what is no number.
    """
    theta, merge = situation.pose.theta, Merge()
    seen = replace(situation, higher=merge)
    ranked = sorted(
        (
            (-stack.priority, -ranked.priority, stack.name, ranked.action)
            for stack in stacks
            for ranked in stack.actions
        ),
        key=lambda entry: entry[:2],
    )
    for _, group in groupby(ranked, key=lambda entry: entry[:2]):
        asked = [_ask(stack, action, seen) for _, _, stack, action in group]
        if entries := [entry for entry in asked if entry is not None]:
            merge = merge.below(entries, theta)
            seen = replace(situation, higher=merge)
    return _decision(merge, situation.limits)


def _ask(stack: str, action: Action, situation: Situation) -> Entry | None:
    try:
        desire = action.decide(situation)
    except Exception as error:
        raise ActionError(stack, action.name, error) from error
    return None if desire is None else Entry(action.name, desire)


def _decision(merge: Merge, limits: Limits) -> Decision:
    known = merge.limits
    motion = {channel: wish.value for channel, wish in merge.motion.items()}
    top_left = min(known.get("left_max", inf), limits.max_turn_rate)
    top_right = min(known.get("right_max", inf), limits.max_turn_rate)
    w = motion.get("w", 0.0)
    if "turn" in motion:
        turn = motion["turn"]
        top = top_left if turn > 0 else top_right
        deceleration = max(known.get("turn_deceleration", 0.0), limits.turn_deceleration)
        w = approach(turn, top, deceleration) if abs(turn) >= TURNED else 0.0
    twist = Twist2(
        _clip(motion.get("v", 0.0), known.get("v_max", inf), known.get("back_max", inf)),
        _clip(w, known.get("left_max", inf), known.get("right_max", inf)),
    )
    return Decision(twist, merge.until, merge.shares, known, merge.despite_stall)


def _clip(value: float, top: float, bottom: float) -> float:
    return max(-bottom, min(top, value))
