"""Logs that tests write: of robots that drive in a circle, and what somebody puts in besides."""

from collections.abc import Iterable, Mapping, Sequence
from datetime import UTC, datetime
from heapq import merge
from math import cos, inf, nan, sin
from operator import itemgetter
from pathlib import Path
from typing import Any, Final

from pioneer3.behaviors.engine import Decision
from pioneer3.geometry import Pose2, Twist2, wrap
from pioneer3.log.folder import create
from pioneer3.log.mcap import McapFile
from pioneer3.log.topics import LogTopic
from pioneer3.nav.places import Destination
from pioneer3.navigation.goals import GoalChanged
from pioneer3.navigation.recording import EstimateMade, WayPlanned, kind_of
from pioneer3.runtime.recording import CommandGiven, DecisionMade
from pioneer3.state import Battery, Charging, Motors, Odometry, Scan, Snapshot, Sonar

SECOND: Final = 10**9
BEGAN: Final = 1_772_357_400 * SECOND
"""When logs of tests begin [ns since 1970]."""
CLOCK: Final = 5000.0
"""Clock of the program at that moment [s]."""
PROGRAM: Final = {
    "command": "pioneer3 drive",
    "began": datetime.fromtimestamp(BEGAN / SECOND, UTC).isoformat(),
    "clock": repr(CLOCK),
}
LASER: Final = Pose2(0.16, 0.0, 0.1)
"""Where the first laser sits."""
ANGLES: Final = (-0.5, -0.25, 0.0, 0.25, 0.5)
READINGS: Final = (1.25, inf, -inf, nan, 7.5)
"""Ranges of all scans [m]."""
Message = tuple[float, str, Any]
"""Seconds since the beginning, topic, message."""


def snapshot(second: float) -> Snapshot:
    """Return the readings of a robot that drives in a circle of 1 m."""
    angle = 0.3 * second
    return Snapshot(
        stamp=CLOCK + second - 0.002,
        sequence=round(10 * second),
        odometry=Odometry(
            robot_in_odom=Pose2(sin(angle), 1 - cos(angle), wrap(angle)),
            twist=Twist2(0.3, 0.3),
            left_speed=0.25,
            right_speed=0.35,
        ),
        battery=Battery(voltage=12.3, charge=0.75, charging=Charging.NONE),
        motors=Motors(enabled=True),
        sonar=Sonar(ranges=(0.5, inf, nan, *[2.25] * 13), fresh=(0, 1, 3), enabled=True),
    )


def scan(second: float, laser: str = "laser") -> Scan:
    """Return a scan of a laser."""
    return Scan(
        stamp=CLOCK + second - 0.02,
        sequence=round(10 * second),
        robot_in_odom=Pose2(),
        sensor_in_robot=LASER,
        angles=ANGLES,
        ranges=READINGS,
        reflectances=(1, 2, 3, 4, 5),
        laser=laser,
        beam_time=1e-4,
        period=0.1,
        near=0.02,
        far=8.0,
    )


def drive(seconds: int = 3, robot: str = "", lasers: Sequence[str] = ()) -> Iterable[Message]:
    """Yield what the log of a robot has in these seconds."""
    before = f"{robot}/" if robot else ""
    estimate = EstimateMade(
        map="office",
        robot_in_map=Pose2(5.0, 6.0, 0.5),
        odom_in_map=Pose2(5.0, 6.0, 0.5),
        sure=True,
        spread=0.1,
        turn_spread=0.02,
        agreement=0.9,
    )
    yield 0.01, f"{before}estimate", estimate
    yield 0.01, f"{before}way", WayPlanned("office", None, ((5.0, 6.0), (6.0, 7.0)))
    for number in range(10 * seconds + 1):
        at = 0.02 + number / 10
        for laser in lasers:
            yield at - 0.005, f"{before}scan/{laser}", scan(at, laser)
        yield at, f"{before}snapshot", snapshot(at)
        if number % 10 == 0:
            command = CommandGiven("keyboard", "drive", Twist2(0.3, 0.25), 0.5)
            yield at + 0.01, f"{before}command", command
            made = Decision(twist=Twist2(0.3, 0.25), limits={"v_max": 0.4})
            yield at + 0.01, f"{before}decision", DecisionMade("", made, ("0.30 m/s: keyboard",))


def with_goal(messages: Iterable[Message]) -> Iterable[Message]:
    """Return the messages of a log, and what it has of a robot that drives to a dock meanwhile."""
    dock = Destination(x=6.0, y=7.0, heading=0.5, name="dock")
    told: list[Message] = [(0.5, "way", WayPlanned("office", dock, ((5.0, 6.0), (6.0, 7.0))))]
    for at, status, why in ((0.5, "executing", ""), (9.0, "succeeded", "arrived")):
        changed = GoalChanged(
            number=1, by="ann", places=(dock,), status=status, reason=why, speed=None, rounds=1
        )
        told.append((at, "goal", changed))
    return merge(messages, told, key=itemgetter(0))


def write_log(
    path: Path,
    messages: Iterable[Message],
    robots: Mapping[str, str] | None = None,
    *,
    ended: bool = True,
) -> Path:
    """Write messages to a log; `robots` have models by their names, `""` is the only one."""
    file = McapFile(create(path))
    file.add_metadata("program", PROGRAM)
    for robot, model in (robots or {"": "p3at-sh"}).items():
        name = f"{robot}/robot" if robot else "robot"
        file.add_metadata(name, {"name": robot or "bob", "model": model})
    for second, topic, message in messages:
        kind = kind_of(topic) or type(message)
        logged: LogTopic[Any] = LogTopic(topic, kind, steady="angles" if kind is Scan else "")
        file.add(logged, [(BEGAN + round(second * SECOND), message)])
    file.flush()
    if ended:
        file.add_metadata("end", {"why": "left as usual"})
        file.finish()
    else:
        file.abandon()
    return path
