"""The topics of a log about a robot on a map: where it is, its goals, its ways, its map."""

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from hashlib import sha256
from math import inf, isfinite, nan, sqrt
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from pioneer3.geometry import Pose2
from pioneer3.limits import Limits
from pioneer3.log.topics import LogEvent, is_scan, is_wire
from pioneer3.maps import LineMap
from pioneer3.maps.aria import parse_aria
from pioneer3.maps.write import aria_text
from pioneer3.models import RobotModel
from pioneer3.nav.places import Destination
from pioneer3.navigation.goals import GoalChanged
from pioneer3.runtime.recording import (
    MODEL,
    CommandGiven,
    DecisionMade,
    RobotLog,
    StandsBecause,
    TruePoseTold,
)
from pioneer3.state import Scan, Snapshot

if TYPE_CHECKING:
    from pioneer3.nav.estimate import Estimate
    from pioneer3.nav.planner import Way

ESTIMATE_PERIOD: Final = 0.5
"""Shortest time between two estimates in a log [s]."""
PROBLEM_PERIOD: Final = 2.0
"""Shortest time between two problems on the way in a log [s]: some come and go."""
WAY_CHANGE: Final = 0.3
"""A way that leads past the one before by more than this is another one [m]."""
MOST_COMPARED: Final = 100
"""Points of a way that are compared with the way before at most."""
DIGITS: Final = 4
"""Decimals of estimates in a log [m, rad]: they are good to centimetres."""
WAY_STEP: Final = 5
"""Step between the points of a way that are told."""


@dataclass(frozen=True, slots=True, kw_only=True)
class EstimateMade:
    """Where a robot is on the map of a name.

    Attributes:
        robot_in_map: Most likely pose [m, rad]; `None` where nothing is known.
        odom_in_map: The same as the pose of odometry's frame.
        sure: Whether the robot may act upon it; else the `reason` is told.
        spread: Standard deviation of the position in its worst direction [m], `nan` on a map that
            grows around the robot.
        turn_spread: Standard deviation of the heading [rad], or `nan`.
        agreement: Share of the readings that agree with the map there, 0 to 1, or `nan`.
    """

    map: str
    robot_in_map: Pose2 | None
    odom_in_map: Pose2 | None
    sure: bool
    reason: str = ""
    spread: float = nan
    turn_spread: float = nan
    agreement: float = nan


@dataclass(frozen=True, slots=True)
class WayPlanned:
    """The way that a robot takes from now on: points of the map [m]; none where it takes none.

    The place is where it leads, on the map of a name.
    """

    map: str
    place: Destination | None
    points: tuple[tuple[float, float], ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class MapUsed:
    """The map that a robot drives on.

    Attributes:
        file: It was read from; empty if it ships, or has none.
        sha256: Of the bytes of that file, or empty.
        text: The map itself, as an ARIA map: whole millimetres, without the free cells of grids.
    """

    name: str
    file: str
    sha256: str
    text: str

    @property
    def line_map(self) -> LineMap:
        """The map.

        Raises:
            ConfigError: The text is none.
        """
        return parse_aria(Path(f"{self.name}.map"), self.text).line_map()


KINDS: Final[Mapping[str, type]] = {
    "snapshot": Snapshot,
    "scan": Scan,
    "command": CommandGiven,
    "decision": DecisionMade,
    "limits": Limits,
    MODEL: RobotModel,
    "standing": StandsBecause,
    "estimate": EstimateMade,
    "goal": GoalChanged,
    "way": WayPlanned,
    "map": MapUsed,
    "truth": TruePoseTold,
    "event": LogEvent,
}
"""Classes of the messages of a log by their topics; `wire/...` has bytes."""


def kind_of(topic: str) -> type | None:
    """Return the class of the messages of a topic such as `bob/scan/laser`; `None` if unknown."""
    if is_wire(topic):
        return bytes
    last = topic.rpartition("/")[2]
    return Scan if is_scan(topic) else KINDS.get(last)


def points_of(way: "Way") -> tuple[tuple[float, float], ...]:
    """Return some of the points of a way [m], the last one among them."""
    points = [*way.points[:-1:WAY_STEP].tolist(), way.points[-1].tolist()]
    return tuple((round(x, 2), round(y, 2)) for x, y in points)


class NavigationLog:
    """Tells a log what a robot knows about its place on one map, and how it gets on."""

    def __init__(self, robot_log: RobotLog, map_name: str) -> None:
        self._log, self._map = robot_log, map_name
        self._estimates = robot_log.topic("estimate", EstimateMade, repeated=True)
        self._ways = robot_log.topic("way", WayPlanned, repeated=True)
        self._estimate: EstimateMade | None = None
        self._estimated_at = self._problem_at = -inf
        self._way: Way | None = None
        self._place: Destination | None = None
        self._problem = ""

    def estimate(self, estimate: "Estimate") -> None:
        """Take an estimate, which is told now and then."""
        if self._is_due():
            variance = float(estimate.covariance[2, 2])
            self._tell(
                EstimateMade(
                    map=self._map,
                    robot_in_map=_rounded(estimate.robot_in_map),
                    odom_in_map=_rounded(estimate.odom_in_map),
                    sure=estimate.sure,
                    reason=estimate.reason,
                    spread=round(estimate.deviation, DIGITS),
                    turn_spread=round(sqrt(variance), DIGITS) if isfinite(variance) else inf,
                    agreement=round(estimate.agreement, DIGITS),
                )
            )

    def on_growing_map(self, robot_in_map: Pose2, odom_in_map: Pose2, unsure: str | None) -> None:
        """Take the place of a robot on a map that it makes, which is told now and then."""
        if self._is_due():
            self._tell(
                EstimateMade(
                    map=self._map,
                    robot_in_map=_rounded(robot_in_map),
                    odom_in_map=_rounded(odom_in_map),
                    sure=unsure is None,
                    reason=unsure or "",
                )
            )

    def way(self, place: Destination | None, way: "Way | None") -> None:
        """Take the present way, which is told where it leads elsewhere than before."""
        before, self._way = self._way, way
        if way is before and place == self._place:
            return
        moved = place != self._place or (way is None) != (before is None)
        self._place = place
        if moved or (way is not None and before is not None and _leads_past(way, before)):
            self._log.put(self._ways, WayPlanned(self._map, place, points_of(way) if way else ()))
        elif before is not None:
            self._way = before  # many small changes are a large one

    def problem(self, problem: str) -> None:
        """Take the reason that the robot does not come on, or nothing."""
        now = self._log.log.clock()
        if problem != self._problem and now - self._problem_at >= PROBLEM_PERIOD:
            self._problem, self._problem_at = problem, now
            self._log.event("notice", f"on its way: {problem or 'comes on again'}")

    def _is_due(self) -> bool:
        return self._log.log.clock() - self._estimated_at >= ESTIMATE_PERIOD

    def _tell(self, estimate: EstimateMade) -> None:
        if estimate != self._estimate:
            self._estimate, self._estimated_at = estimate, self._log.log.clock()
            self._log.put(self._estimates, estimate)


def use_map(robot_log: RobotLog, line_map: LineMap) -> None:
    """Tell the log of a robot the map that it drives on, unless it knows."""
    robot_log.put(robot_log.topic("map", MapUsed, _map_used, repeated=True), line_map)


def _map_used(line_map: LineMap) -> MapUsed:
    digest = ""
    if line_map.file is not None:
        with suppress(OSError):
            digest = sha256(line_map.file.read_bytes()).hexdigest()
    file = str(line_map.file or "")
    return MapUsed(name=line_map.name, file=file, sha256=digest, text=aria_text(line_map))


def _rounded(pose: Pose2 | None) -> Pose2 | None:
    if pose is None:
        return None
    return Pose2(round(pose.x, DIGITS), round(pose.y, DIGITS), round(pose.theta, DIGITS))


def _leads_past(way: "Way", before: "Way") -> bool:
    """Whether a way leaves the one before."""
    step = -(-len(way.points) // MOST_COMPARED)
    some: Any = way.points[::step, None]
    known = before.points[None, ::WAY_STEP]
    apart = np.hypot(some[..., 0] - known[..., 0], some[..., 1] - known[..., 1])
    return bool(apart.min(axis=1).max() > WAY_CHANGE)
