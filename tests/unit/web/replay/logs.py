"""Logs of robots that were never there."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from pioneer3.behaviors.action import Contribution
from pioneer3.behaviors.engine import Decision
from pioneer3.geometry import Pose2, Twist2
from pioneer3.log.folder import create
from pioneer3.log.mcap import McapFile
from pioneer3.log.topics import EVENT, LogEvent, LogTopic
from pioneer3.maps import LineMap
from pioneer3.maps.write import aria_text
from pioneer3.nav.places import Destination
from pioneer3.navigation.goals import GoalChanged
from pioneer3.navigation.recording import EstimateMade, MapUsed, WayPlanned
from pioneer3.runtime.recording import CommandGiven, DecisionMade, TruePoseTold
from pioneer3.state import Battery, Motors, Odometry, Scan, Snapshot

SECOND = 1_000_000_000
BEGAN = 1_772_357_400 * SECOND
"""Of the logs [ns since 1970]."""
SPEED = 0.2
"""The robots drive along the x axis [m/s]."""
ROBOT = {"name": "MobileSim", "model": "p3dx-sh", "kind": "simulator", "url": "tcp://host:8101"}


def snapshot(second: float, *, stalled: bool = False) -> Snapshot:
    """Return the snapshot of a robot that has driven for so long [s]."""
    return Snapshot(
        stamp=second,
        sequence=round(second * 10),
        odometry=Odometry(
            robot_in_odom=Pose2(SPEED * second, 0.0, 0.0),
            twist=Twist2(0.0 if stalled else SPEED, 0.0),
            left_speed=SPEED,
            right_speed=SPEED,
        ),
        battery=Battery(voltage=12.5),
        motors=Motors(enabled=True, left_stalled=stalled),
    )


def decision(second: float, mode: str) -> DecisionMade:
    """Return the decision to drive, by a mode."""
    part = Contribution(mode or "keyboard", "v", SPEED, 1.0, "", lacks=False)
    twist = Twist2(SPEED, 0.0)
    return DecisionMade(mode, Decision(twist, second + 2.0, (part,)), (f"{SPEED} m/s: {mode}",))


class LogFile:
    """A log in chunks of a second, as the writer makes them."""

    def __init__(self, path: Path, prefix: str = "", **robot: str) -> None:
        self.path, self._prefix = path, prefix
        self._file = McapFile(create(path))
        self._file.add_metadata(f"{prefix}robot", ROBOT | robot)

    def add(self, name: str, messages: Iterable[tuple[float, Any]], steady: str = "") -> None:
        """Add messages of a topic, each of a time since the begin [s]."""
        timed = [(BEGAN + round(second * SECOND), message) for second, message in messages]
        if timed:
            self._file.add(LogTopic(self._prefix + name, type(timed[0][1]), steady), timed)

    def event(self, second: float, kind: str, text: str) -> None:
        """Add an event about the robot."""
        at = BEGAN + round(second * SECOND)
        self._file.add(EVENT, [(at, LogEvent(kind, self._prefix + text))])

    def flush(self) -> None:
        """End a chunk."""
        self._file.flush()

    def close(self) -> None:
        """Write the end."""
        self._file.finish()


def drive(
    path: Path,
    *,
    prefix: str = "",
    begin: int = 0,
    seconds: int = 20,
    line_map: LineMap | None = None,
) -> Path:
    """Write the log of a drive.

    It wanders from 2 s to 8 s, is on its way to a place until the emergency stop at 12 s, which is
    reset at 14 s; it stalls at 16 s, and the link is lost at 18 s. With a map it knows its place:
    10 m further on than odometry says; and it has a laser.
    """
    log = LogFile(path, prefix)
    log.event(begin, "link", "robot: connected: MobileSim")
    place = Destination(x=15.0, y=0.0, name="Kitchen")
    if line_map is not None:
        used = MapUsed(name="hall", file="", sha256="", text=aria_text(line_map))
        log.add("map", [(begin, used)])
    for second in range(seconds):
        at = begin + second
        tenths = [second + n / 10 for n in range(10)]
        log.add("snapshot", [(begin + t, snapshot(t, stalled=16 <= t < 17)) for t in tenths])
        mode = "wander" if 2 <= second < 8 else "goto" if 9 <= second < 12 else ""
        if second < 12:
            log.add("decision", [(at, decision(second, mode))])
        if line_map is not None:
            log.add("estimate", [(at, estimate(SPEED * second))])
            log.add("scan/laser", [(at + 0.5, scan(second + 0.5))], steady="angles")
        if second == 9:
            log.add("goal", [(at, goal("accepted", place)), (at + 0.1, goal("executing", place))])
            log.add(
                "way", [(at, WayPlanned("hall", place, ((11.0, 0.0), (13.0, 0.0), (15.0, 0.0))))]
            )
        if second == 12:
            log.add("command", [(at, CommandGiven("ann", "emergency stop"))])
            log.add("goal", [(at, goal("aborted", place, "the emergency stop was pressed"))])
            log.add("way", [(at, WayPlanned("hall", None, ()))])
        if second == 13:
            log.add("command", [(at, CommandGiven("ann", "drive", refused="it is latched"))])
        if second == 14:
            log.add("command", [(at, CommandGiven("ann", "reset the emergency stop"))])
        if second == 18:
            log.event(at, "link", "robot: lost: no report for 2 s")
        log.flush()
    log.close()
    return path


def estimate(x: float) -> EstimateMade:
    """Return where a robot of odometry's x is: ten metres further on."""
    return EstimateMade(
        map="hall",
        robot_in_map=Pose2(10.0 + x, 0.0, 0.0),
        odom_in_map=Pose2(10.0, 0.0, 0.0),
        sure=True,
        spread=0.02,
        agreement=0.9,
    )


def goal(status: str, place: Destination, reason: str = "") -> GoalChanged:
    """Return a change of the only goal."""
    return GoalChanged(
        number=1, by="ann", places=(place,), status=status, reason=reason, speed=0.3, rounds=1
    )


def scan(second: float) -> Scan:
    """Return a scan of three readings."""
    return Scan(
        stamp=second,
        sequence=round(second),
        robot_in_odom=Pose2(SPEED * second, 0.0, 0.0),
        sensor_in_robot=Pose2(0.1, 0.0, 0.0),
        angles=(-0.5, 0.0, 0.5),
        ranges=(1.0, 2.0, 1.0),
    )


def truth(x: float) -> TruePoseTold:
    """Return a true pose."""
    return TruePoseTold(Pose2(x, 5.0, 0.0))
