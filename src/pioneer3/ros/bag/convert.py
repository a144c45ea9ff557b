"""Writes the robots of a log to a bag."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum
from functools import partial
from operator import attrgetter
from pathlib import Path
from typing import Any, Final

from pioneer3.log.chunks import DAMAGED
from pioneer3.log.output import new_output
from pioneer3.log.progress import Tell, followed
from pioneer3.log.reader import LogInfo, RunLog
from pioneer3.log.topics import EVENT, SNAPSHOT, LogTopic
from pioneer3.models import GivenModel
from pioneer3.navigation.recording import kind_of
from pioneer3.ros.bag.bags import ros1_bag, ros2_bag
from pioneer3.ros.bag.player import Player
from pioneer3.ros.bag.robots import LoggedRobot, robots_of
from pioneer3.ros.messages.update import NANO
from pioneer3.ros.node.names import Profile
from pioneer3.runtime.recording import MODEL
from pioneer3.text import one_line, wrong

WRONG: Final = (*DAMAGED, LookupError, ArithmeticError)
"""Errors of conversions about numbers that no robot sends."""


class BagKind(StrEnum):
    """Kinds of bags."""

    ROS1 = "rosbag1"
    ROS2 = "rosbag2"


OPEN: Final = {BagKind.ROS1: ros1_bag, BagKind.ROS2: ros2_bag}
"""Opens a new bag."""


@dataclass(frozen=True, slots=True)
class BagWritten:
    """A bag that was written: its messages by topic, and sentences about what is not as it was."""

    counts: Mapping[str, int]
    warnings: Sequence[str] = ()


Taker = tuple[LogTopic[Any], Player, Callable[[Any], None]]
"""A topic, and who takes its messages."""


def write_bag(
    log: RunLog,
    path: Path,
    kind: BagKind,
    profile: Profile,
    *,
    model: GivenModel = None,
    tell: Tell = lambda share: None,
) -> BagWritten:
    """Write what the nodes of the robots of a log would have published to a new bag.

    Raises:
        ConfigError: The log is damaged or has no robot, rosbags is missing, or the bag cannot be
            written.
    """
    known, robots = log.info(), robots_of(log, model)
    if not robots:
        raise wrong(log.path, " has no robot in it that sent readings: there is nothing to convert")
    with new_output(path) as made, OPEN[kind](made) as bag:
        players = [Player(robot, bag, profile, _wall_clock(known)) for robot in robots]
        takers = {EVENT.name: [(EVENT, player, player.event) for player in players]}
        for robot, player in zip(robots, players, strict=True):
            takers |= _takers(robot, player, given=model is not None)
        for message in followed(log.messages(takers.__contains__), known, tell):
            topic, *_ = takers[message.topic][0]
            decoded = log.decoded(message, topic)
            try:
                while (first := min(players, key=attrgetter("due"))).due <= message.time:
                    first.diagnose(message.time)
                for _, player, take in takers[message.topic]:
                    player.outlet.now = message.time
                    take(decoded)
            except WRONG as error:
                problem = f" has a message of {message.topic} that is none: {one_line(error)}"
                raise wrong(log.path, problem) from error
        counts = dict(bag.counts)
    return BagWritten(counts, [_guess(robot) for robot in robots if robot.is_guessed])


def _guess(robot: LoggedRobot) -> str:
    return (
        f"{robot.prefix}robot is of the type {robot.info.model.name!r}, which nobody knows here:"
        " its sizes are guessed; --model gives them"
    )


def _takers(robot: LoggedRobot, player: Player, *, given: bool) -> dict[str, list[Taker]]:
    """Return the receivers of a robot's messages, by their topics; its model may be `given`."""
    takes: dict[str, Callable[[Any], None]] = {
        **({} if given else {MODEL: player.use_model}),
        SNAPSHOT: player.snapshot,
        "command": player.command,
        "decision": player.decision,
        "standing": player.standing,
        "estimate": player.navigation.estimate,
        "way": player.navigation.way,
        "goal": player.navigation.goal,
        "map": player.navigation.use_map,
        **{f"scan/{laser}": partial(player.scan, laser) for laser in robot.lasers},
    }
    takers: dict[str, list[Taker]] = {}
    for name, take in takes.items():
        topic, kind = robot.prefix + name, kind_of(name)
        assert kind is not None
        takers[topic] = [(LogTopic(topic, kind), player, take)]
    return takers


def _wall_clock(known: LogInfo) -> Callable[[float], int]:
    """Return the function that makes times since 1970 [ns] of moments of the program [s].

    Raises:
        ConfigError: The log does not tell when its program began.
    """
    texts = known.texts.get("program", {})
    try:
        began = datetime.fromisoformat(texts["began"]).timestamp()
        clock = float(texts["clock"])
    except (KeyError, ValueError, OverflowError):
        problem = " does not tell when its program began: it is none of pioneer3's"
        raise wrong(known.path, problem) from None
    began_ns = round(began * NANO)
    return lambda moment: began_ns + round((moment - clock) * NANO)
