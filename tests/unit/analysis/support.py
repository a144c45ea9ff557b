"""Logs of a few seconds, whose numbers tests know."""

from collections.abc import Iterable, Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from pioneer3.behaviors.action import Contribution
from pioneer3.behaviors.engine import Decision
from pioneer3.geometry import Pose2, Twist2
from pioneer3.log.folder import create
from pioneer3.log.mcap import McapFile
from pioneer3.log.topics import EVENT, GOES_ON, LogEvent, LogTopic
from pioneer3.runtime.recording import CommandGiven, DecisionMade
from pioneer3.state import Battery, Motors, Odometry, Scan, Snapshot, Sonar

SECOND = 10**9
"""[ns]."""
BEGAN = 1_772_357_400 * SECOND
"""When these logs began [ns since 1970]."""
CLOCK = 5000.0
"""The clock of their program then [s]."""
LAG = 0.01
"""From a report to its message [s]."""
PERIOD = 0.1
"""From one report to the next [s]."""
Message = tuple[float, LogTopic[Any], Any]
"""Time [s since the log began], topic, and message."""


def topic(name: str, kind: type, **options: Any) -> LogTopic[Any]:
    return LogTopic(name, kind, **options)


def snapshot(seconds: float, *, x: float = 0.0, v: float = 0.0, **parts: Any) -> Snapshot:
    """Return what a robot reports at a time, `x` m ahead, at `v` m/s."""
    odometry = Odometry(
        robot_in_odom=Pose2(x, 0.0, 0.0), twist=Twist2(v, 0.0), left_speed=v, right_speed=v
    )
    usual: dict[str, Any] = {"battery": Battery(voltage=12.5), "motors": Motors(enabled=True)}
    return Snapshot(
        stamp=CLOCK + seconds,
        sequence=round(seconds / PERIOD),
        odometry=odometry,
        **(usual | parts),
    )


def driven(seconds: float, prefix: str = "", v: float = 0.5, begin: float = 0.0) -> list[Message]:
    """Return the snapshots of a robot that drives ahead for a time."""
    where = topic(f"{prefix}snapshot", Snapshot)
    times = [begin + number * PERIOD for number in range(round(seconds / PERIOD) + 1)]
    sonar = Sonar(ranges=(1.0, 2.0))
    return [
        (time + LAG, where, snapshot(time, x=v * (time - begin), v=v, sonar=sonar))
        for time in times
    ]


def decided(mode: str, v: float, *parts: Contribution) -> DecisionMade:
    told = tuple(f"{part.action}, {part.reason}" for part in parts)
    return DecisionMade(mode, Decision(Twist2(v, 0.0), contributions=parts), told)


def given(by: str, command: str, v: float = 0.0, refused: str = "") -> CommandGiven:
    return CommandGiven(by, command, Twist2(v, 0.0), 0.5, refused)


def scan(seconds: float, **parts: Any) -> Scan:
    """Return a scan of three readings: ahead, without an echo, to the left."""
    usual: dict[str, Any] = {
        "robot_in_odom": Pose2(1.0, 0.0, 0.0),
        "sensor_in_robot": Pose2(0.2, 0.0, 0.0),
        "angles": (0.0, 1.0, 1.5),
        "ranges": (1.0, float("inf"), 2.0),
    }
    return Scan(stamp=CLOCK + seconds, sequence=1, **(usual | parts))


def write_log(
    path: Path,
    messages: Iterable[Message],
    *,
    robots: Mapping[str, str] = {"": "bob"},
    texts: Mapping[str, Mapping[str, str]] = {},
    ended: bool = True,
    connected: bool = True,
) -> Path:
    """Write a log, with an event at its begin unless that is left out.

    `robots` are their own names by their prefixes.
    """
    file = McapFile(create(path))
    began = datetime.fromtimestamp(BEGAN / SECOND, UTC).isoformat()
    file.add_metadata("program", {"command": "pioneer3 run", "clock": repr(CLOCK), "began": began})
    for prefix, name in robots.items():
        file.add_metadata(f"{prefix}robot", {"name": name, "model": "p3at-sh"})
    for name, told in texts.items():
        file.add_metadata(name, told)
    if connected:
        file.add(EVENT, [(BEGAN, LogEvent("link", "robot: connected"))])
    for number, (time, of, message) in enumerate(sorted(messages, key=lambda each: each[0])):
        file.add(of, [(BEGAN + round(time * SECOND), message)])
        if number % 10 == 9:
            file.flush()
    file.flush()
    if ended:
        file.add_metadata("end", texts.get("end", {"why": "left as usual"}))
        file.finish()
    return path


def write_parts(folder: Path, seconds: float = 4.0, gone: int = 0) -> tuple[Path, Path]:
    """Write a log of 4 s and 2 m that goes on in a second file, without what has gone between."""
    told = {"command": "pioneer3 run", "clock": repr(CLOCK), "began_ns": str(BEGAN)}
    program = {"program": told | {"began": datetime.fromtimestamp(BEGAN / SECOND, UTC).isoformat()}}
    messages = driven(seconds)
    first = write_log(
        folder / "a.mcap",
        messages[:21],
        texts=program | {"end": {"why": GOES_ON}},
        ended=False,
    )
    return first, write_log(
        folder / "a.2.mcap", messages[21 + gone :], texts=program, connected=False
    )
