"""Decisions explained to people: the actions, their parts and their reasons."""

from math import degrees

from pioneer3.behaviors.action import Contribution
from pioneer3.behaviors.engine import Decision

HARDLY = 1e-3
"""Smaller differences are not visible [m/s, rad/s]."""


def explain(decision: Decision) -> tuple[str, ...]:
    """Return a sentence about the speed, one about the limit that holds it, one about the turn."""
    sentences = [_about_speed(decision), *_about_limits(decision), _about_turn(decision)]
    return tuple(sentence for sentence in sentences if sentence)


def explain_standstill(decision: Decision) -> str | None:
    """Return the reason that a decision asks for no motion, or `None` if it asks for some."""
    if not decision.wanted or not decision.twist.is_zero:
        return None
    wanted = abs(_mean(decision, "v")) > HARDLY
    channel = ("v_max" if _mean(decision, "v") > 0 else "back_max") if wanted else "v"
    parts = [part for part in decision.contributions if part.channel == channel]
    return _names(_strictest(parts) if wanted else parts[:1]) or None


def _about_speed(decision: Decision) -> str | None:
    parts = [part for part in decision.contributions if part.channel == "v"]
    return f"{decision.twist.v:z.2f} m/s: {_names(parts)}" if parts else None


def _about_turn(decision: Decision) -> str | None:
    turns = [part for part in decision.contributions if part.channel == "turn"]
    parts = turns or [part for part in decision.contributions if part.channel == "w"]
    if not parts or abs(decision.twist.w) < HARDLY:
        return None
    side = "left" if decision.twist.w > 0 else "right"
    return f"turns {side} at {abs(degrees(decision.twist.w)):.0f}°/s: {_names(parts)}"


def _about_limits(decision: Decision) -> list[str]:
    """Return a sentence about the limit that holds the robot back, if one does."""
    wanted = _mean(decision, "v")
    channel = "v_max" if wanted > 0 else "back_max"
    top = decision.limits.get(channel)
    if top is None or abs(wanted) <= top + HARDLY:
        return []
    held = f"held to {top:.2f} m/s" if top > HARDLY else "held back"
    limits = [part for part in decision.contributions if part.channel == channel]
    return [f"{held}: {_names(_strictest(limits))}"]


def _strictest(limits: list[Contribution]) -> list[Contribution]:
    return [min(limits, key=lambda part: part.value)]


def _mean(decision: Decision, channel: str) -> float:
    parts = [part for part in decision.contributions if part.channel == channel]
    total = sum(part.strength for part in parts)
    return sum(part.value * part.strength for part in parts) / total if total else 0.0


def _names(parts: list[Contribution]) -> str:
    return " and ".join(
        part.action
        + (f" ({100 * part.strength:.0f} %)" if len(parts) > 1 else "")
        + (f", {part.reason}" if part.reason else "")
        for part in parts
    )
