"""A decision in words: who decided what, and why."""

from math import degrees

from pioneer3.behaviors.engine import Decision
from pioneer3.behaviors.merge import Share

HARDLY = 1e-3
"""Differences that nobody sees [m/s, rad/s]."""


def told(decision: Decision) -> tuple[str, ...]:
    """Return a sentence about the speed, one about the turn and one for each limit that bites."""
    sentences = [_about_speed(decision), *_about_limits(decision), _about_turn(decision)]
    return tuple(sentence for sentence in sentences if sentence)


def why_standing(decision: Decision) -> str | None:
    """Return why a decision asks for no motion at all, or `None` if it asks for some."""
    if not decision.wanted or not decision.twist.is_zero:
        return None
    wanted = abs(_mean(decision, "v")) > HARDLY
    channel = ("v_max" if _mean(decision, "v") > 0 else "back_max") if wanted else "v"
    shares = [share for share in decision.shares if share.channel == channel]
    return _names(_strictest(shares) if wanted else shares[:1]) or None


def _about_speed(decision: Decision) -> str | None:
    shares = [share for share in decision.shares if share.channel == "v"]
    return f"{decision.twist.v:z.2f} m/s: {_names(shares)}" if shares else None


def _about_turn(decision: Decision) -> str | None:
    turns = [share for share in decision.shares if share.channel == "turn"]
    shares = turns or [share for share in decision.shares if share.channel == "w"]
    if not shares or abs(decision.twist.w) < HARDLY:
        return None
    side = "left" if decision.twist.w > 0 else "right"
    return f"turns {side} at {abs(degrees(decision.twist.w)):.0f}°/s: {_names(shares)}"


def _about_limits(decision: Decision) -> list[str]:
    """Return what holds the robot back."""
    wanted = _mean(decision, "v")
    channel = "v_max" if wanted > 0 else "back_max"
    top = decision.limits.get(channel)
    if top is None or abs(wanted) <= top + HARDLY:
        return []
    held = f"held to {top:.2f} m/s" if top > HARDLY else "held back"
    limits = [share for share in decision.shares if share.channel == channel]
    return [f"{held}: {_names(_strictest(limits))}"]


def _strictest(limits: list[Share]) -> list[Share]:
    return [min(limits, key=lambda share: share.value)]


def _mean(decision: Decision, channel: str) -> float:
    shares = [share for share in decision.shares if share.channel == channel]
    total = sum(share.strength for share in shares)
    return sum(share.value * share.strength for share in shares) / total if total else 0.0


def _names(shares: list[Share]) -> str:
    return " and ".join(
        share.action
        + (f" ({100 * share.strength:.0f} %)" if len(shares) > 1 else "")
        + (f", {share.reason}" if share.reason else "")
        for share in shares
    )
