"""How readings are put into messages, where that is a matter of choice."""

from dataclasses import dataclass, field
from enum import StrEnum
from typing import Final

from pioneer3.robot.assemble import SONAR_MAX
from pioneer3.ros.description.frames import Frames

UNMEASURED: Final = 1e6
"""Variance of what a robot on wheels does not measure: z, roll and pitch."""
DRIVING: Final = (1e-3, 1e-3, UNMEASURED, UNMEASURED, UNMEASURED, 0.03)
"""Variances x, y, z [m^2], roll, pitch, yaw [rad^2] while the wheels turn."""
STANDING: Final = (1e-9, 1e-9, UNMEASURED, UNMEASURED, UNMEASURED, 1e-9)
"""The same while they stand still: nothing is added to the error there already is."""


class NoEcho(StrEnum):
    """What a Range says when nothing was heard."""

    MAX_RANGE = "max_range"
    INF = "inf"


@dataclass(frozen=True, slots=True, kw_only=True)
class Beam:
    """What a sonar transducer can hear.

    Attributes:
        field_of_view: Width of the cone [rad].
        nearest: Shortest range it can tell [m].
        farthest: Longest one [m].
        no_echo: What is said without an echo: ROS's range layers throw infinity away, REP 117
            wants it.
    """

    field_of_view: float = 0.5236
    nearest: float = 0.15
    farthest: float = SONAR_MAX
    no_echo: NoEcho = NoEcho.MAX_RANGE


@dataclass(frozen=True, slots=True, kw_only=True)
class Conventions:
    """How messages are to be.

    Attributes:
        frames: Names of the frames, without the prefix.
        prefix: Before every name of a frame, such as `robot1/`.
        odometry_in_tree: Whether the robot's pose goes to the tree of frames.
        description: Whether the robot is described: fixed frames and `robot_description`.
        wheels_in_tree: Whether turning wheels go to the tree of frames; else they are fixed there.
        pose_variances: While the wheels turn; x, y, z [m^2], roll, pitch, yaw [rad^2].
        twist_variances: The same of the velocities.
        beam: Of the sonars.
        sonar_height: Above the floor [m]; `None` for what is usual.
        wheel_joints: Names of joints: left before right, front before rear; none for the usual.
    """

    frames: Frames = field(default_factory=Frames)
    prefix: str = ""
    odometry_in_tree: bool = True
    description: bool = True
    wheels_in_tree: bool = False
    pose_variances: tuple[float, ...] = DRIVING
    twist_variances: tuple[float, ...] = DRIVING
    beam: Beam = field(default_factory=Beam)
    sonar_height: float | None = None
    wheel_joints: tuple[str, ...] = ()
