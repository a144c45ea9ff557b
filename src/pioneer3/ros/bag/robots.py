"""The robots of a log: their names, models and lasers."""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Final

import msgspec

from pioneer3.geometry import Pose2
from pioneer3.links.tap import ROBOT
from pioneer3.log.reader import RunLog
from pioneer3.log.topics import LogTopic, robots_in
from pioneer3.models import GivenModel, RobotModel, loaded_model
from pioneer3.models.model import UnknownModel
from pioneer3.names import free_name
from pioneer3.robot.supervisor import RobotInfo
from pioneer3.runtime.recording import MODEL, described
from pioneer3.state import Scan
from pioneer3.text import wrong

MOST_ROBOTS: Final = 256
"""Robots of one bag at most: each has some twenty topics."""
LASER: Final = re.compile(r"laser(\d?\d?)", re.ASCII)
"""Name of a laser; the first one has no number."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LoggedRobot:
    """A robot of a log.

    Attributes:
        prefix: Before the names of its topics: `bob/` of one of several robots, else empty.
        namespace: Of its node in ROS, `/bob`; empty of the only robot.
        lasers: Where they sit on the robot [m, rad], by the names of their topics' last part.
    """

    prefix: str
    namespace: str
    info: RobotInfo
    lasers: Mapping[str, Pose2]

    @property
    def is_guessed(self) -> bool:
        """Whether nobody knows a model of this type."""
        return isinstance(self.info.model, UnknownModel)


def robots_of(log: RunLog, given: GivenModel = None) -> list[LoggedRobot]:
    """Return the robots of a log that have snapshots, by their names; all of a model if `given`.

    Raises:
        ConfigError: The log is damaged or has too many, or there is no such model.
    """
    topics = log.topics()
    prefixes = robots_in(topics)
    if len(prefixes) > MOST_ROBOTS:
        raise wrong(log.path, f" has more than {MOST_ROBOTS} robots, too many for one bag")
    texts, mounted = log.info().texts, _mounted(log, topics)
    given, robots, taken = loaded_model(given), [], set[str]()
    for prefix in prefixes:
        before = prefix.rstrip("/")
        name = free_name(ros_name(before), taken, "_") if before else ""
        taken.add(name)
        told, models = texts.get(f"{prefix}{ROBOT}", {}), LogTopic(prefix + MODEL, RobotModel)
        if models.name in topics and (first := next(log.of(models), None)) is not None:
            told = {**told, "parameters": msgspec.json.encode(first[1]).decode()}
        robots.append(
            LoggedRobot(
                prefix=prefix,
                namespace=f"/{name}" if name else "",
                info=described(told, given=given),
                lasers={
                    scans.rpartition("/")[2]: pose
                    for scans, pose in mounted.items()
                    if scans.rpartition("scan/")[0] == prefix
                },
            )
        )
    return robots


def laser_number(name: str) -> int | None:
    """Return the number of a laser, from 0, by its name; `None` if that is none of a laser."""
    match = LASER.fullmatch(name)
    return max(0, int(match[1] or 1) - 1) if match else None


def ros_name(text: str) -> str:
    """Return a text as a name in ROS: letters, digits and underscores, a letter first."""
    name = re.sub(r"\W+", "_", text, flags=re.ASCII).strip("_")
    return name if name[:1].isalpha() else f"robot_{name}".rstrip("_")


def _mounted(log: RunLog, topics: Iterable[str]) -> dict[str, Pose2]:
    """Return where lasers sit, by the topics of their scans; reads to the last one's first scan."""
    scans = {
        topic: LogTopic(topic, Scan)
        for topic in topics
        if topic.rpartition("/")[0].rpartition("/")[2] == "scan"
        and laser_number(topic.rpartition("/")[2]) is not None
    }
    mounted: dict[str, Pose2] = {}
    if scans:
        for message in log.messages(lambda topic: topic in scans.keys() - mounted.keys()):
            if message.topic not in mounted:
                mounted[message.topic] = log.decoded(message, scans[message.topic]).sensor_in_robot
            if len(mounted) == len(scans):
                break
    return mounted
