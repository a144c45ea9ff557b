"""Figures of a run: the way, the time under way, stops by their reasons, latencies, the battery."""

from collections import Counter
from dataclasses import dataclass, field
from math import hypot
from typing import Any, Final

from pioneer3.analysis.open_log import OpenLog
from pioneer3.geometry import wrap
from pioneer3.log.topics import LogTopic
from pioneer3.robot.pilot import stands
from pioneer3.runtime.recording import (
    EMERGENCY_STOP,
    CommandGiven,
    DecisionMade,
    StandsBecause,
)
from pioneer3.state import Snapshot

LEAP: Final = 5.0
"""Way between two reports above which odometry has begun anew, or is damaged [m]."""
PAUSE: Final = 2.0
"""After a longer time without a report nobody knows what the robot did [s]."""
SAME_ROUND: Final = 0.05
"""A decision that comes so soon after a report was made upon it [s]."""
MOST_REASONS: Final = 1000
"""Reasons that are told apart."""

OTHERS: Final = "other reasons"
"""Stands for those beyond."""
NOT_TOLD: Final = "not logged"
"""Reason of a stop in an older log."""


@dataclass(slots=True, kw_only=True)
class RobotStats:
    """Figures of one robot in one log.

    Attributes:
        reports: Snapshots of it.
        distance: Way by odometry [m], and all turns added up, left and right alike [rad].
        under_way: Time in which it moved [s].
        stops: How often it came to stand, by the reason that people were told.
        emergency_stops: That were asked for, and presses of the button on the robot.
        stalls: How often wheels were blocked; `bumps`: how often a bumper touched something.
        link_losses: Connections after the first.
        voltage: First and last one [V]; `None` without a report.
        report_to_decision: Longest time from the first byte of a report to the decision that was
            made upon it [s], and to the next bytes for the robot; `None` where none was logged.
    """

    robot: str
    reports: int = 0
    distance: float = 0.0
    turned: float = 0.0
    under_way: float = 0.0
    fastest: float = 0.0
    stops: Counter[str] = field(default_factory=Counter)
    emergency_stops: int = 0
    stalls: int = 0
    bumps: int = 0
    link_losses: int = 0
    voltage: tuple[float, float] | None = None
    report_to_decision: float | None = None
    report_to_wire: float | None = None


@dataclass(slots=True)
class _Reader:
    """Adds up the messages of one robot, in their order."""

    log: OpenLog
    stats: RobotStats
    last: Snapshot | None = None
    moved: bool = False
    told: StandsBecause | None = None
    arrived: float | None = None
    taken: float = 0.0
    decided: bool = False

    def snapshot(self, time: float, now: Snapshot) -> None:
        """Take a report of a time [s]."""
        stats, last = self.stats, self.last
        self.arrived, self.taken, self.last = self.log.measured(now.stamp, time), time, now
        stats.reports += 1
        stats.fastest = max(stats.fastest, abs(now.odometry.twist.v))
        volts = now.battery.voltage
        stats.voltage = (stats.voltage[0] if stats.voltage else volts), volts
        moves = not stands(now)
        if self.moved and not moves and self.told is None:
            stats.stops[NOT_TOLD] += 1
        self.moved = moves
        if last is None:
            stats.stalls, stats.bumps = int(now.motors.stalled), int(_touches(now))
            stats.emergency_stops += now.motors.stop_button
            return
        stats.stalls += now.motors.stalled and not last.motors.stalled
        stats.bumps += _touches(now) and not _touches(last)
        stats.emergency_stops += now.motors.stop_button and not last.motors.stop_button
        stats.link_losses += max(0, now.link.sessions - last.link.sessions)
        here, before = now.odometry.robot_in_odom, last.odometry.robot_in_odom
        way, passed = hypot(here.x - before.x, here.y - before.y), now.stamp - last.stamp
        if way < LEAP:
            stats.distance += way
            stats.turned += abs(wrap(here.theta - before.theta))
        if moves and 0 < passed < PAUSE:
            stats.under_way += passed

    def standing(self, told: StandsBecause) -> None:
        """Take the reason to stand from now on; a robot that moved before has come to stand."""
        if self.told is None:
            self.stats.stops.clear()
        elif self.told.reason is None and told.reason is not None:
            stops = self.stats.stops
            name = told.reason.text if len(stops) < MOST_REASONS else OTHERS
            stops[name] += 1
        self.told = told

    def command(self, given: CommandGiven) -> None:
        """Take a command."""
        self.stats.emergency_stops += given.command == EMERGENCY_STOP and not given.refused

    def decision(self, time: float) -> None:
        """Take the time of a decision [s]."""
        if self.arrived is None or time - self.taken > SAME_ROUND:
            return
        stats, self.decided = self.stats, True
        stats.report_to_decision = max(stats.report_to_decision or 0.0, time - self.arrived)

    def written(self, time: float) -> None:
        """Take the time of bytes for the robot [s]."""
        if self.decided and self.arrived is not None:
            stats = self.stats
            stats.report_to_wire = max(stats.report_to_wire or 0.0, time - self.arrived)
        self.decided = False


def stats_of(log: OpenLog) -> list[RobotStats]:
    """Return the figures of each robot in a log.

    Raises:
        ConfigError: It is damaged.
    """
    readers = {
        prefix: _Reader(log, RobotStats(robot=name)) for name, prefix in log.prefixes.items()
    }
    began = log.info().began
    kinds: dict[str, tuple[_Reader, type | None]] = {}
    for prefix, reader in readers.items():
        kinds[f"{prefix}snapshot"] = reader, Snapshot
        kinds[f"{prefix}standing"] = reader, StandsBecause
        kinds[f"{prefix}command"] = reader, CommandGiven
        kinds[f"{prefix}decision"] = reader, DecisionMade
        kinds[f"wire/{prefix}robot/out"] = reader, None
    for message in log.source.messages(kinds.__contains__):
        reader, kind = kinds[message.topic]
        time = (message.time - began) / 1e9
        if kind is DecisionMade:
            reader.decision(time)
        elif kind is None:
            reader.written(time)
        else:
            _take(reader, time, log.source.decoded(message, LogTopic(message.topic, kind)))
    return [reader.stats for reader in readers.values()]


def _take(reader: _Reader, time: float, told: Any) -> None:
    match told:
        case Snapshot():
            reader.snapshot(time, told)
        case StandsBecause():
            reader.standing(told)
        case CommandGiven():
            reader.command(told)


def _touches(snapshot: Snapshot) -> bool:
    return any((*snapshot.bumpers.front, *snapshot.bumpers.rear))
