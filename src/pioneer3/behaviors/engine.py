"""Prioritised actions. Pure: snapshot and time in, decision out; no link, no logging."""

from collections.abc import Iterable
from dataclasses import dataclass
from math import inf
from typing import Protocol

from pioneer3.geometry import Twist2
from pioneer3.state import Snapshot


@dataclass(frozen=True, slots=True)
class Desire:
    """What one action wants; `None` leaves that channel to lower priorities.

    Attributes:
        v: Speed [m/s].
        w: Turn rate [rad/s].
        v_max: Limit of the speed forwards [m/s]; the lowest of all actions holds.
        until: When this stops being wanted [s, monotonic].
        reason: Shown to people.
    """

    v: float | None = None
    w: float | None = None
    v_max: float = inf
    until: float = inf
    reason: str = ""


class Action(Protocol):
    """Anything with a name and a priority that turns a snapshot into a desire."""

    @property
    def name(self) -> str:
        """Shown to people."""

    @property
    def priority(self) -> int:
        """The higher one decides first."""

    def decide(self, snapshot: Snapshot, now: float) -> Desire | None:
        """Return what this action wants at `now` [s, monotonic], or `None`."""


@dataclass(frozen=True, slots=True)
class Decision:
    """The resolved twist, until when it holds, and who decided each channel.

    `v_by` and `w_by` are `None` where nobody asked.
    """

    twist: Twist2
    until: float = inf
    v_by: str | None = None
    w_by: str | None = None

    @property
    def wanted(self) -> bool:
        """Whether anybody asked for anything."""
        return self.v_by is not None or self.w_by is not None


def resolve(actions: Iterable[Action], snapshot: Snapshot, now: float) -> Decision:
    """Ask the actions from the highest priority down; the first to speak owns a channel."""
    v: float | None = None
    w: float | None = None
    v_by = w_by = None
    v_max = until = inf
    for action in sorted(actions, key=lambda action: -action.priority):
        if (desire := action.decide(snapshot, now)) is None:
            continue
        if v is None and desire.v is not None:
            v, v_by, until = desire.v, action.name, min(until, desire.until)
        if w is None and desire.w is not None:
            w, w_by, until = desire.w, action.name, min(until, desire.until)
        v_max = min(v_max, desire.v_max)
    return Decision(Twist2(min(v or 0.0, v_max), w or 0.0), until, v_by, w_by)
