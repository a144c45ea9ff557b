"""Decisions explained to people: the actions, their parts and their reasons."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import degrees
from typing import Final

from pioneer3.behaviors.action import Contribution
from pioneer3.behaviors.engine import Decision

HARDLY = 1e-3
"""Smaller differences are not visible [m/s, rad/s]."""
NO_TURN: Final = "no turn"
"""Words for a turn of zero."""
WANTED: Final[Mapping[str, Callable[[float], str]]] = {
    "v": lambda value: f"{value:z.2f} m/s",
    "turn": lambda value: f"{_to_side(value)} by {abs(degrees(value)):.0f}°" if value else NO_TURN,
    "w": lambda value: f"{_to_side(value)} at {abs(degrees(value)):.0f}°/s" if value else NO_TURN,
    "v_max": lambda value: f"at most {value:.2f} m/s ahead",
    "back_max": lambda value: f"at most {value:.2f} m/s back",
    "left_max": lambda value: f"at most {degrees(value):.0f}°/s to the left",
    "right_max": lambda value: f"at most {degrees(value):.0f}°/s to the right",
    "acceleration": lambda value: f"accelerates by {value:.2f} m/s² at most",
    "turn_acceleration": lambda value: f"by {degrees(value):.0f}°/s² at most",
    "deceleration": lambda value: f"brakes by {value:.2f} m/s² at least",
    "turn_deceleration": lambda value: f"by {degrees(value):.0f}°/s² at least",
}
"""Words for what an action wants, by channel."""


@dataclass(frozen=True, slots=True)
class PartTold:
    """The part of one action in a decision, in words.

    Attributes:
        wanted: Such as `0.30 m/s`, or a limit.
        reason: As the action gives it; empty if it gives none.
        took: What its limit took of the motion that others wanted; empty if it took nothing.
    """

    action: str
    wanted: str
    reason: str
    took: str


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


def explain_parts(decision: Decision) -> tuple[PartTold, ...]:
    """Return the wishes of actions, the highest priority first, and the parts that limits take."""
    taken = dict(_taken(decision, "v", "v_max", "back_max"))
    taken |= dict(_taken(decision, "w", "left_max", "right_max"))
    return tuple(
        PartTold(
            part.action,
            WANTED[part.channel](part.value)
            + (f", {100 * part.strength:.0f} %" if part.strength < 1 else ""),
            part.reason,
            taken.get(number, ""),
        )
        for number, part in enumerate(decision.contributions)
        if part.channel in WANTED
    )


def _taken(decision: Decision, channel: str, above: str, below: str) -> list[tuple[int, str]]:
    """Return the place of the part whose limit holds a motion, with what it takes away."""
    wanted = _mean(decision, channel)
    side = above if wanted > 0 else below
    limits = [each for each in enumerate(decision.contributions) if each[1].channel == side]
    if not limits:
        return []
    place, strictest = min(limits, key=lambda each: each[1].value)
    lost = abs(wanted) - strictest.value
    if lost <= HARDLY:
        return []
    return [(place, f"{lost:.2f} m/s" if channel == "v" else f"{degrees(lost):.0f}°/s")]


def _to_side(turn: float) -> str:
    return "left" if turn > 0 else "right"


def _about_speed(decision: Decision) -> str | None:
    parts = [part for part in decision.contributions if part.channel == "v"]
    return f"{decision.twist.v:z.2f} m/s: {_names(parts)}" if parts else None


def _about_turn(decision: Decision) -> str | None:
    turns = [part for part in decision.contributions if part.channel == "turn"]
    parts = turns or [part for part in decision.contributions if part.channel == "w"]
    if not parts or abs(decision.twist.w) < HARDLY:
        return None
    turn = f"turns {_to_side(decision.twist.w)} at {abs(degrees(decision.twist.w)):.0f}°/s"
    return f"{turn}: {_names(parts)}"


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
