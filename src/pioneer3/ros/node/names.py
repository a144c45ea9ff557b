"""The names in all profiles, and the names that the lab's ROS programs have built in."""

import re
from dataclasses import dataclass
from enum import StrEnum
from typing import Final

from pioneer3.errors import ConfigError

NODE: Final = "RosAria"
ALL_ROBOTS: Final = f"/{NODE}/cmd_vel"
"""Every robot of the lab listens to it."""
AS_STANDARD: Final = ""
"""The name in ROS 2 and in p2os of most things: that of today's packages."""
SHAPE: Final = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
NUMBERED: Final = re.compile(r"p3[a-z]+_(\d.*)")
"""Such as p3at_1_113, which the lab's topics call p1_113."""


class Profile(StrEnum):
    """The names in use: in ROS 1 RosAria's, today's, both at once, or those of p2os; ROS 2's."""

    COMPATIBILITY = "compatibility"
    STANDARD = "standard"
    BOTH = "both"
    P2OS = "p2os"
    ROS2 = "ros2"

    def choose(
        self,
        compatibility: str | None,
        standard: str | None,
        ros2: str | None = AS_STANDARD,
        p2os: str | None = AS_STANDARD,
    ) -> tuple[str, ...]:
        """Return the names that count of one in RosAria, of today, in ROS 2 and p2os, each once."""
        by_profile = {
            Profile.COMPATIBILITY: [compatibility],
            Profile.STANDARD: [standard],
            Profile.BOTH: [compatibility, standard],
            Profile.P2OS: [standard if p2os == AS_STANDARD else p2os],
            Profile.ROS2: [standard if ros2 == AS_STANDARD else ros2],
        }
        return tuple(dict.fromkeys(name for name in by_profile[self] if name is not None))


@dataclass(frozen=True, slots=True)
class CommandName:
    """Name of a topic of velocity commands of Twist or, `stamped`, TwistStamped.

    `~` stands for below the node's own; to one that is `shared` all robots listen.
    """

    name: str
    shared: bool = False
    stamped: bool = False


def lab_node(lab_name: object) -> str:
    """Return the node of a robot in the lab: `RosAria_p3at_1_113`; ConfigError if ROS has none."""
    if not isinstance(lab_name, str) or not SHAPE.fullmatch(lab_name):
        raise ConfigError(f"~lab_name must be a name such as p3at_1_113, not {lab_name!r}")
    return f"{NODE}_{lab_name}"


def lab_commands(lab_name: str) -> tuple[CommandName, CommandName]:
    """Return the topics with commands for all robots, and for this one: `cmd_vel_p1_113`."""
    numbered = NUMBERED.fullmatch(lab_name)
    short = f"p{numbered[1]}" if numbered else lab_name
    return CommandName(ALL_ROBOTS, shared=True), CommandName(f"{ALL_ROBOTS}_{short}")
