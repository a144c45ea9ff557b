"""What an action decides on: one instant, as the robot knows it."""

from dataclasses import dataclass, field

from pioneer3.behaviors.merge import Merge
from pioneer3.behaviors.surroundings import NOTHING_SENSED, Surroundings
from pioneer3.geometry import Pose2, Twist2
from pioneer3.limits import Limits
from pioneer3.models import RobotModel
from pioneer3.state import Snapshot
from pioneer3.stops import NO_STOP, Stop


@dataclass(frozen=True, slots=True, kw_only=True)
class Situation:
    """One instant.

    Attributes:
        now: [s, monotonic].
        snapshot: What the robot last said.
        model: Its sizes and equipment.
        limits: What it may be asked to do.
        around: What its sensors see and have seen.
        last_stop: What a command by hand must have begun after.
        higher: What actions of higher priority want already.
    """

    now: float
    snapshot: Snapshot
    model: RobotModel
    limits: Limits
    around: Surroundings = NOTHING_SENSED
    last_stop: Stop = NO_STOP
    higher: Merge = field(default_factory=Merge)

    @property
    def pose(self) -> Pose2:
        """Where the robot is, in odometry's frame [m, rad]."""
        return self.snapshot.odometry.robot_in_odom

    @property
    def twist(self) -> Twist2:
        """How it moves, as measured [m/s, rad/s]."""
        return self.snapshot.odometry.twist
