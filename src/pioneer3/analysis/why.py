"""The reason that a robot stood or moved at a time: what was told, wanted and decided."""

from dataclasses import dataclass
from typing import Final

import msgspec

from pioneer3.analysis.open_log import OpenLog
from pioneer3.behaviors.engine import Decision
from pioneer3.behaviors.explanations import PartTold, explain_parts, explain_standstill
from pioneer3.log.topics import LogEvent
from pioneer3.robot.explain import (
    DECIDED,
    DISCONNECTED,
    IDLE,
    PRESSED,
    SILENT,
    STALLED,
    SWITCHED_OFF,
    Reason,
    ReasonKind,
)
from pioneer3.robot.pilot import REPORT_TIMEOUT, stands
from pioneer3.runtime.recording import CommandGiven, DecisionMade, StandsBecause
from pioneer3.state import Snapshot

GONE: Final = Reason(ReasonKind.NORMAL, "The log does not tell: its file with this time has gone.")
"""In place of a reason, where there is none to be had."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MomentTold:
    """All that a log tells of a robot at a time.

    Attributes:
        time: [s] since the log began; the times of messages likewise.
        stands: The reason that it stood still; `None` where it moved.
        was_told: Whether the reason was logged; else it was made of the readings afterwards.
        snapshot: The newest; `None` before the first. `decision`, `command`, `event` likewise.
        mode_since: When the mode of the decision began [s]; `None` where that is hours ago.
        parts: What each action wanted, and what limits took away.
    """

    time: float
    stands: Reason | None
    was_told: bool
    snapshot: tuple[float, Snapshot] | None
    decision: tuple[float, DecisionMade] | None
    mode_since: float | None
    parts: tuple[PartTold, ...]
    command: tuple[float, CommandGiven] | None
    event: tuple[float, LogEvent] | None


def told_at(log: OpenLog, time: float) -> MomentTold:
    """Return the state of a robot at a time of its log [s since it began].

    Raises:
        ConfigError: It is damaged, or has several robots.
    """
    before = log.between(end=time)
    snapshot, reason = before.newest("snapshot"), before.newest("standing")
    decision, event = before.newest("decision"), before.newest("event")
    stands_because, was_told = (
        (GONE, False) if log.is_gap(time) else _reason(time, snapshot, reason, decision, event)
    )
    return MomentTold(
        time=time,
        stands=stands_because,
        was_told=was_told,
        snapshot=snapshot,
        decision=decision,
        mode_since=_mode_since(before, decision[1].mode) if decision else None,
        parts=explain_parts(decision[1].decision) if decision else (),
        command=before.newest("command"),
        event=event,
    )


def _mode_since(log: OpenLog, mode: str) -> float | None:
    """Return when the mode of the last decision began [s]."""
    begin = b'{"mode":%s' % msgspec.json.encode(mode)
    return log.since("decision", lambda data: data.startswith(begin))


def _reason(
    now: float,
    snapshot: tuple[float, Snapshot] | None,
    told: tuple[float, StandsBecause] | None,
    decision: tuple[float, DecisionMade] | None,
    event: tuple[float, LogEvent] | None,
) -> tuple[Reason | None, bool]:
    """Return the reason to stand still, and whether it was logged."""
    if snapshot is None:
        return DISCONNECTED.about(_after(0.0, event)), False
    silent = now - snapshot[0]
    if silent > REPORT_TIMEOUT:
        lost = _after(snapshot[0], event)
        return (DISCONNECTED.about(lost) if lost else SILENT.about(silent)), False
    if told is not None:
        return told[1].reason, True
    made = decision[1].decision if decision else Decision()
    return reason_by_readings(snapshot[1], made), False


def _after(time: float, event: tuple[float, LogEvent] | None) -> str:
    """Return the words of an event about a link after a time; empty if there was none."""
    return f": {event[1].text}" if event and event[0] >= time and event[1].kind == "link" else ""


def reason_by_readings(snapshot: Snapshot, made: Decision) -> Reason | None:
    """Return the reason that readings and a decision show, where none was logged."""
    if not stands(snapshot):
        return None
    motors = snapshot.motors
    off = SWITCHED_OFF if made.wanted else IDLE.about(", and the motors are off")
    decided = explain_standstill(made)
    reasons = (
        (motors.stop_button, PRESSED),
        (motors.stalled, STALLED),
        (decided, DECIDED.about(decided)),
        (not motors.enabled, off),
    )
    return next((reason for holds, reason in reasons if holds), IDLE.about(""))
