"""From ROS messages of one robot back to readings: the other way round than `convert`. Pure."""

from math import atan2, hypot, inf, isfinite, nan, pi
from typing import Any, Final

from pioneer3.geometry import Pose2, Twist2
from pioneer3.models import RobotModel
from pioneer3.robot.assemble import SONAR_MAX
from pioneer3.state import Battery, Bumpers, Motors, Odometry, Snapshot, Sonar

ROUNDED: Final = 1e-3
"""Points are in 32 bits: an echo this near to the farthest there is [m] is none."""
RING: Final = 0.32
"""Each transducer fires once in this time [s]: the same distance again is a new one then."""


class Gatherer:
    """Keeps the newest message of each kind; makes a snapshot of them.

    Args:
        model: Of the robot.
        motors_on: Whether the motors are taken to be on until somebody tells.
    """

    def __init__(self, model: RobotModel, *, motors_on: bool = True) -> None:
        self._model = model
        self._odometry: Odometry | None = None
        self._battery = Battery(voltage=nan)
        self._motors = Motors(enabled=motors_on)
        self._bumpers = Bumpers()
        self._ranges = [nan] * len(model.sonars)
        self._heard_at = [-inf] * len(model.sonars)
        self._fresh: set[int] = set()
        self._sequence = 0

    def pose(self, message: Any) -> None:
        """Take a nav_msgs/Odometry; what has no numbers in it is left out."""
        place, turned = message.pose.pose.position, message.pose.pose.orientation
        twist = message.twist.twist
        v, w, half = twist.linear.x, twist.angular.z, self._model.wheel_base / 2
        here = Pose2(place.x, place.y, _heading(turned))
        if all(map(isfinite, (here.x, here.y, here.theta, v, w))):
            self._odometry = Odometry(
                robot_in_odom=here,
                twist=Twist2(v, w),
                left_speed=v - w * half,
                right_speed=v + w * half,
            )

    def sonar_cloud(self, message: Any, now: float) -> None:
        """Take a sensor_msgs/PointCloud with a point for each transducer, as RosAria's."""
        for number, (point, mount) in enumerate(
            zip(message.points, self._model.sonars, strict=False)
        ):
            self.sonar_range(number, hypot(point.x - mount.x, point.y - mount.y), now)

    def sonar_range(self, number: int, metres: float, now: float) -> None:
        """Take the distance that one transducer measured at `now` [m, s]; more than 5 m is none."""
        if number >= len(self._ranges):
            return
        measured = metres if metres < SONAR_MAX - ROUNDED else inf
        if measured != self._ranges[number] or now - self._heard_at[number] >= RING:
            self._fresh.add(number)
            self._ranges[number], self._heard_at[number] = measured, now

    def bumpers(self, message: Any) -> None:
        """Take a rosaria/BumperState."""
        front, rear = map(bool, message.front_bumpers), map(bool, message.rear_bumpers)
        self._bumpers = Bumpers(front=tuple(front), rear=tuple(rear)[::-1])

    def motors(self, message: Any) -> None:
        """Take a std_msgs/Bool."""
        self._motors = Motors(enabled=bool(message.data))

    def voltage(self, volts: float) -> None:
        """Take the battery's voltage [V]."""
        self._battery = Battery(voltage=volts)

    def snapshot(self, now: float) -> Snapshot | None:
        """Return what is known at `now` [s, monotonic]; `None` before the first pose."""
        if self._odometry is None:
            return None
        fresh, self._fresh = sorted(self._fresh), set()
        self._sequence += 1
        return Snapshot(
            stamp=now,
            sequence=self._sequence,
            odometry=self._odometry,
            battery=self._battery,
            motors=self._motors,
            sonar=Sonar(ranges=tuple(self._ranges), fresh=tuple(fresh), enabled=bool(fresh)),
            bumpers=self._bumpers,
        )


def _heading(turned: Any) -> float:
    """Return the yaw of a quaternion [rad], in (-pi, pi]."""
    theta = 2 * atan2(turned.z, turned.w)
    if theta > pi:
        return theta - 2 * pi
    return theta + 2 * pi if theta <= -pi else theta
