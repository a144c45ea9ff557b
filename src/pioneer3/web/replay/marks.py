"""The events of a log, in words: stops, stalls, lost links, modes, goals.

Most messages are told by their bytes, and few are decoded: a log of a day has a million.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Final, TypeVar

import msgspec

from pioneer3.links.tap import ROBOT
from pioneer3.log.chunks import DAMAGED
from pioneer3.log.reader import LogMessage
from pioneer3.log.topics import SNAPSHOT, LogEvent
from pioneer3.names import printable
from pioneer3.navigation.goals import GoalChanged
from pioneer3.robot.supervisor import Connection
from pioneer3.runtime.recording import EMERGENCY_STOP, RESET, CommandGiven, link_status
from pioneer3.web.messages import MarkKind, ReplayMark
from pioneer3.web.replay.recorded import SECOND, RecordedRobot

T = TypeVar("T")

MOST_MARKS: Final = 2000
"""No more marks are told of one replay."""
LONGEST_TEXT: Final = 200
"""Letters of a mark at most."""
STALLED: Final = (b'"left_stalled":true', b'"right_stalled":true')
"""In a snapshot whose wheels are blocked."""
PRESSED: Final = b'"stop_button":true'
"""In a snapshot whose red button is pressed."""
LATCH: Final = tuple(f'"command":"{each}"'.encode() for each in (EMERGENCY_STOP, RESET))
"""Commands that are told."""
MODE: Final = b'{"mode":"'
"""Begin of a decision."""
ENDS: Final = {"succeeded": "reached", "aborted": "given up", "canceled": "called off"}
"""Ends of goals in words."""
CHANGES: Final = {"dropped": "Messages were lost", "clock": "The clock was set"}
"""Events that are told, beside those of links."""


@dataclass(slots=True)
class _Known:
    """The last known state of a robot."""

    stalled: bool = False
    pressed: bool = False
    mode: bytes = b""
    link: str = ""
    goals: dict[int, str] = field(default_factory=dict)


class MarkFinder:
    """Finds the marks of the robots of one log, whose messages are given in their order."""

    def __init__(self, robots: Iterable[RecordedRobot]) -> None:
        self._robots = {robot.prefix: robot.number for robot in robots}
        self._known = {prefix: _Known() for prefix in self._robots}
        kinds = (SNAPSHOT, "decision", "command", "goal")
        self.topics = {prefix + kind for prefix in self._robots for kind in kinds} | {"event"}

    def look(self, messages: Iterable[LogMessage]) -> list[ReplayMark]:
        """Return the marks in the next messages."""
        found: list[ReplayMark] = []
        for message in messages:
            if message.topic == "event":
                told = self._about_event(message)
            else:
                prefix, slash, kind = message.topic.rpartition("/")
                told = self._about(prefix + slash, kind, message)
            if told is not None:
                found.append(told)
        return found

    def _about(self, prefix: str, kind: str, message: LogMessage) -> ReplayMark | None:
        known, data = self._known[prefix], message.data
        if kind == SNAPSHOT:
            return self._about_snapshot(prefix, known, message)
        if kind == "decision":
            end = data.find(b'"', len(MODE))
            mode = data[len(MODE) : end] if data.startswith(MODE) else known.mode
            before, known.mode = known.mode, mode
            if mode == before:
                return None
            words = _text(mode) + " began" if mode else _text(before) + " ended"
            return self._mark(message, prefix, "mode", words)
        if kind == "command" and any(each in data for each in LATCH):
            command = _decoded(message, CommandGiven)
            if command is None or command.refused:
                return None
            by = f" by {command.by}" if command.by else ""
            return self._mark(message, prefix, "emergency", command.command + by)
        return self._about_goal(prefix, known, message) if kind == "goal" else None

    def _about_snapshot(self, prefix: str, known: _Known, message: LogMessage) -> ReplayMark | None:
        stalled, pressed = any(each in message.data for each in STALLED), PRESSED in message.data
        was_stalled, known.stalled = known.stalled, stalled
        was_pressed, known.pressed = known.pressed, pressed
        if pressed and not was_pressed:
            return self._mark(message, prefix, "emergency", "stop button on the robot pressed")
        if stalled and not was_stalled:
            return self._mark(message, prefix, "stall", "the wheels stalled")
        return None

    def _about_goal(self, prefix: str, known: _Known, message: LogMessage) -> ReplayMark | None:
        goal = _decoded(message, GoalChanged)
        if goal is None or known.goals.get(goal.number) == goal.status:
            return None
        known.goals[goal.number] = goal.status
        where = ", ".join(map(str, goal.places[:3])) or "look around"
        if goal.status == "accepted":
            return self._mark(message, prefix, "goal", f"goal {where}, by {goal.by}")
        if goal.status not in ENDS:
            return None
        why = f": {goal.reason}" if goal.reason else ""
        return self._mark(message, prefix, "goal", f"goal {where} {ENDS[goal.status]}{why}")

    def _about_event(self, message: LogMessage) -> ReplayMark | None:
        event = _decoded(message, LogEvent)
        if event is None:
            return None
        if event.kind in CHANGES:
            return _mark(message, None, "note", f"{CHANGES[event.kind]}: {event.text}")
        for prefix in self._robots:
            if (told := link_status(event, f"{prefix}{ROBOT}")) is not None:
                known = self._known[prefix]
                before, known.link = known.link, told.connection
                back = before == Connection.LOST and known.link == Connection.CONNECTED
                if back or (known.link == Connection.LOST != before):
                    words = f"link {told.connection}: {told.message}"
                    return self._mark(message, prefix, "link", words)
        return None

    def _mark(self, message: LogMessage, prefix: str, kind: MarkKind, text: str) -> ReplayMark:
        return _mark(message, self._robots[prefix], kind, text)


def _mark(message: LogMessage, robot: int | None, kind: MarkKind, text: str) -> ReplayMark:
    words = printable(text)[:LONGEST_TEXT]
    return ReplayMark(message.time / SECOND, robot, kind, words[:1].upper() + words[1:])


def _decoded(message: LogMessage, kind: type[T]) -> T | None:
    try:
        return message.decode(kind)
    except DAMAGED:
        return None


def _text(mode: bytes) -> str:
    try:
        return msgspec.json.decode(b'"%s"' % mode, type=str)
    except DAMAGED:
        return ""
