"""One simulated robot: its drive, where it is, where it believes it is, its energy."""

from dataclasses import dataclass
from math import copysign, hypot

from pioneer3.geometry import ORIGIN, Pose2, wrap
from pioneer3.models import RobotModel
from pioneer3.sim.motion import Axis, Drive
from pioneer3.units import DEGREE

FULL = 13.0
"""Voltage of three charged lead-acid batteries at rest [V]."""
EMPTY = 11.0
"""Where the firmware shuts down [V] (user-needs 1.9)."""
CAPACITY = 252.0 * 3600
"""Three batteries of 12 V and 7 Ah [J]."""
IDLE_POWER = 15.0
"""Controller and sonar [W]."""
DRIVE_POWER = 40.0
"""Motors at 1 m/s [W]."""


@dataclass(slots=True)
class Battery:
    """Energy left, and the voltage that goes with it: a straight line from full to empty.

    Attributes:
        energy: [J].
        fixed: Voltage set by a test, or `None` [V].
    """

    energy: float = CAPACITY
    fixed: float | None = None

    def drain(self, speed: float, dt: float) -> None:
        """Use what `dt` [s] of driving at `speed` [m/s] takes."""
        self.energy = max(0.0, self.energy - (IDLE_POWER + DRIVE_POWER * abs(speed)) * dt)

    @property
    def charge(self) -> float:
        """Share of the capacity that is left, 0 to 1."""
        return self.energy / CAPACITY

    @property
    def voltage(self) -> float:
        """Terminal voltage [V]."""
        if self.fixed is not None:
            return self.fixed
        return EMPTY + (FULL - EMPTY) * self.energy / CAPACITY


AMBIENT = 22.0
"""In the lab [degC]."""
USUAL_SPEED, USUAL_TURN_RATE = 0.75, 100 * DEGREE
"""Current limits of a robot as delivered (arcos.md 5.1) [m/s, rad/s]; a host may raise them."""


class Body:
    """A robot in the world.

    Attributes:
        model: Its sizes and limits.
        home: Where it starts, and :meth:`reset` brings it back [m, rad].
        robot_in_world: The truth [m, rad].
        robot_in_odom: What its wheels say [m, rad].
        stalled: The drive pushes and nothing moves.
        stop_button: The red button is pressed; the motors have no power.
        sonar_on: The transducers fire.
        front_bumpers: The pressed ones, bit 1 is the left-most segment (arcos.md 4.7).
        rear_bumpers: The same behind, bit 1 is the right-most.
        wheel_travel: What left and right wheel have rolled since power-on [m].
        motor_temperature: [degC].
        charging: It stands in a dock.
    """

    def __init__(self, model: RobotModel, home: Pose2 = ORIGIN) -> None:
        self.model = model
        self.home = self.robot_in_world = home
        self.robot_in_odom = ORIGIN
        self.stalled = False
        self.sonar_on = True
        self.front_bumpers = self.rear_bumpers = 0
        self.wheel_travel = 0.0, 0.0
        self.motor_temperature = AMBIENT
        self.charging = False
        self.battery = Battery()
        self._stop_button = False
        self.drive = self._delivered_drive()

    @property
    def stop_button(self) -> bool:
        """Whether the red button is pressed."""
        return self._stop_button

    @stop_button.setter
    def stop_button(self, pressed: bool) -> None:
        self._stop_button = pressed
        if pressed:
            self.drive.power(on=False)

    def enable_motors(self, *, on: bool) -> None:
        """Switch the motors; with the stop button pressed they stay off."""
        self.drive.power(on=on and not self._stop_button)

    def turn_to(self, heading: float) -> None:
        """Turn the short way to `heading` of the odometry [rad]."""
        self.turn_by(wrap(heading - self.robot_in_odom.theta))

    def turn_by(self, angle: float) -> None:
        """Turn by `angle` [rad] on top of what the drive has in its ramp."""
        self.drive.angular.travel(angle)

    def advance(self, motion: Pose2) -> None:
        """Move by `motion`, given in the robot's frame; the wheels roll along."""
        self.robot_in_world = self.robot_in_world @ motion
        self.robot_in_odom = self.robot_in_odom @ motion
        way = copysign(hypot(motion.x, motion.y), motion.x)
        half = motion.theta * self.model.wheel_base / 2
        left, right = self.wheel_travel
        self.wheel_travel = left + way - half, right + way + half

    def reset_odometry(self, pose: Pose2 = ORIGIN) -> None:
        """Make the wheels believe in `pose`."""
        self.robot_in_odom = pose

    def reset(self) -> None:
        """Back to the start, at rest."""
        self.robot_in_world, self.robot_in_odom = self.home, ORIGIN
        self.drive.stop()
        self.drive.halt()

    def session_ended(self) -> None:
        """What the firmware does when nobody is connected: it forgets what the host has set."""
        velocities = self.drive.linear.velocity, self.drive.angular.velocity
        self.drive = self._delivered_drive()
        self.drive.linear.velocity, self.drive.angular.velocity = velocities
        self.reset_odometry()

    def _delivered_drive(self) -> Drive:
        model = self.model
        return Drive(
            linear=Axis(model.acceleration, model.deceleration, min(model.max_speed, USUAL_SPEED)),
            angular=Axis(
                model.turn_acceleration,
                model.turn_deceleration,
                min(model.max_turn_rate, USUAL_TURN_RATE),
            ),
        )
