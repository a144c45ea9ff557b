"""Remembers where robots were on maps when programs ended: small files in the user's state folder.

A place is remembered once the robot's sensors have confirmed it, and forgotten when they contradict
it. It is a guess: the robot may have been carried since, so its sensors must confirm it again.
"""

import os
from collections.abc import Mapping
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

import msgspec

from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.maps import LineMap
from pioneer3.robot.supervisor import RobotInfo, is_simulator
from pioneer3.text import state_folder


def last_place_file(
    info: RobotInfo, line_map: LineMap, environment: Mapping[str, str] = os.environ
) -> Path:
    """Return the file of a robot's last place on a map.

    Robots are told apart by their names and serial numbers, simulated ones by their addresses; maps
    by their walls.
    """
    serial = info.config.serial_number if info.config else ""
    names = [info.url] if is_simulator(info) else [info.identity.name, serial]
    key = sha256("\n".join(names).encode() + line_map.walls.tobytes()).hexdigest()[:24]
    return state_folder(environment) / "places" / f"{key}.json"


@dataclass(frozen=True, slots=True)
class LastPlace:
    """The pose of odometry's frame on the map, and the robot's pose in that frame [m, rad]."""

    odom_in_map: Pose2
    robot_in_odom: Pose2

    def guesses(self, robot_in_odom: Pose2) -> list[Pose2]:
        """Return where the robot may be on the map, by its odometry now; the likelier first."""
        here, there = self.odom_in_map @ robot_in_odom, self.odom_in_map @ self.robot_in_odom
        # odometry begins anew with each connection to a robot, but not behind a bridge
        return [there] if robot_in_odom in {ORIGIN, self.robot_in_odom} else [here, there]

    def goes_on(self, robot_in_odom: Pose2) -> bool:
        """Whether odometry has gone on since, and tells that the robot has not moved."""
        return robot_in_odom == self.robot_in_odom != ORIGIN


def read_last_place(file: Path) -> LastPlace | None:
    """Return the place in a file; `None` if there is none, or it cannot be read."""
    try:
        return msgspec.json.decode(file.read_bytes(), type=LastPlace)
    except (OSError, msgspec.MsgspecError, UnicodeDecodeError):
        return None


def write_last_place(file: Path, place: LastPlace | None) -> None:
    """Remember a place, or forget it; a folder that cannot be written to is no error."""
    try:
        if place is None:
            file.unlink(missing_ok=True)
            return
        file.parent.mkdir(parents=True, exist_ok=True)
        new = file.with_name(f"{file.stem}.{os.getpid()}.new")
        new.write_bytes(msgspec.json.encode(place))
        new.replace(file)
    except OSError:
        return
