"""One simulated robot: its true pose, its odometry, its drive, its energy.

A body is a view of one robot's numbers; a world keeps those of all its robots side by side.
"""

from collections.abc import Callable

import numpy as np

from pioneer3.geometry import ORIGIN, Pose2, wrap
from pioneer3.models import EncoderNumbers, RobotModel
from pioneer3.sim.kernels import DriveArrays, RobotArrays
from pioneer3.sim.kernels.drives import (
    ACCELERATION,
    ANGULAR,
    BASE,
    CAPACITY,
    DECELERATION,
    DRIVE_POWER,
    ENERGY,
    HEAT,
    LEFT,
    LEFT_STALLED,
    LINEAR,
    ODOM_THETA,
    ODOM_X,
    ODOM_Y,
    RIGHT,
    RIGHT_STALLED,
    STALLED,
    SUPPLY,
    TOP,
    W_OF_W,
)
from pioneer3.sim.motion import WheelDrive
from pioneer3.sim.sensors import in_order
from pioneer3.units import DEGREE

FULL = 13.0
"""Voltage of three charged lead-acid batteries at rest [V]."""
EMPTY = 11.0
"""Below this the firmware shuts down [V] (facts.md 14.2)."""
RESISTANCE = 0.1
"""Resistance of the batteries and their wires [ohm]: driving costs some voltage."""
NOMINAL = 12.0
"""[V]."""
AMBIENT = 22.0
"""In the lab [degC]."""
USUAL_SPEED = 0.75
"""Limit of a robot as delivered (protocol.md 5.1) [m/s]; a host may raise it."""
USUAL_TURN_RATE = 100 * DEGREE
"""Limit of a robot as delivered (protocol.md 5.1) [rad/s]; a host may raise it."""

USUAL_ENCODERS = EncoderNumbers(ticks_mm=128, rev_count=16570)
"""As the manual is quoted for a P3-DX (protocol.md 5.1)."""

Bumpers = tuple[int, int]
"""Pressed segments in front and behind, as bits (protocol.md 4.7)."""
Speeds = tuple[float, float]
"""Speed [m/s] and turn rate [rad/s]."""


class SimulatedBattery:
    """Energy left, and the voltage that goes with it: a straight line from full to empty.

    A test may have set another, which is `fixed` [V].
    """

    def __init__(self, body: "Body") -> None:
        self.fixed: float | None = None
        self._body = body

    @property
    def energy(self) -> float:
        """Energy left [J]."""
        return self._body.wheel(ENERGY)

    @energy.setter
    def energy(self, joules: float) -> None:
        self._body.set_wheel(ENERGY, min(max(joules, 0.0), CAPACITY))

    @property
    def charge(self) -> float:
        """Share of the capacity that is left, 0 to 1."""
        return self.energy / CAPACITY

    def fill(self, share: float) -> None:
        """Leave `share` of the capacity, 0 to 1; a voltage that a test has set is forgotten."""
        self.energy, self.fixed = share * CAPACITY, None

    @property
    def voltage(self) -> float:
        """Terminal voltage, lower while the motors draw current [V]."""
        if self.fixed is not None:
            return self.fixed
        current = DRIVE_POWER * abs(self._body.speeds[0]) / NOMINAL
        return EMPTY + (FULL - EMPTY) * self.charge - RESISTANCE * current


class Body:
    """A robot in the world.

    Attributes:
        home: Where it starts, and :meth:`reset` brings it back [m, rad].
        firing: The transducers that fire, in order; changed by `World.fire`.
        encoders: Numbers by which odometry is made of the encoders.
    """

    def __init__(self, model: RobotModel, home: Pose2 = ORIGIN) -> None:
        self.model = model
        self.home = home
        self.encoders = model.encoders or USUAL_ENCODERS
        self.firing = in_order(len(model.sonars))
        self._stop_button = False
        drives = DriveArrays.at_rest(1)
        drives.wheels[BASE] = model.wheel_base
        self.bind(drives, outline_of(model), 0)
        self.battery = SimulatedBattery(self)
        self.robot_in_world = home
        self._as_delivered()

    def bind(
        self,
        drives: DriveArrays,
        outlines: RobotArrays,
        number: int,
        *,
        bumpers: Callable[[], Bumpers] = lambda: (0, 0),
        speeds: Callable[[], Speeds] | None = None,
    ) -> None:
        """Be a view of these numbers from now on; they describe this robot already.

        `bumpers` returns the pressed segments, `speeds` the speed and the turn rate by the wheels;
        if not given, those of the drive count.
        """
        self.drives, self.outlines, self.number = drives, outlines, number
        self.drive = WheelDrive(drives, number)
        self._bumpers, self._speeds = bumpers, speeds

    @property
    def robot_in_world(self) -> Pose2:
        """The truth [m, rad]."""
        poses, n = self.outlines.state, self.number
        return Pose2(poses.item(0, n), poses.item(1, n), poses.item(2, n))

    @robot_in_world.setter
    def robot_in_world(self, pose: Pose2) -> None:
        self.outlines.poses[:, self.number] = pose.x, pose.y, pose.theta
        self.outlines.stale = True

    @property
    def robot_in_odom(self) -> Pose2:
        """Pose by odometry [m, rad]."""
        return Pose2(self.wheel(ODOM_X), self.wheel(ODOM_Y), self.wheel(ODOM_THETA))

    def reset_odometry(self, pose: Pose2 = ORIGIN) -> None:
        """Set the odometry to `pose`."""
        self.drives.wheels[ODOM_X : ODOM_THETA + 1, self.number] = pose.x, pose.y, pose.theta

    @property
    def speeds(self) -> Speeds:
        """Speed and turn rate by its wheels [m/s, rad/s]."""
        if self._speeds is not None:
            return self._speeds()
        return self.drive.linear.velocity, self.drive.angular.velocity

    @property
    def track(self) -> float:
        """Difference of the wheels' speeds over the turn rate [m], as the firmware has it."""
        return self.wheel(BASE)

    @property
    def wheel_travel(self) -> tuple[float, float]:
        """Way of the left and the right wheel since power-on [m]."""
        return self.wheel(LEFT), self.wheel(RIGHT)

    @property
    def stalled(self) -> bool:
        """Whether the drive pushes and nothing moves."""
        return any(self.stalled_sides)

    @property
    def stalled_sides(self) -> tuple[bool, bool]:
        """Whether the left and the right side push and do not turn."""
        bits = int(self.drives.flags[STALLED, self.number])
        return bool(bits & LEFT_STALLED), bool(bits & RIGHT_STALLED)

    @property
    def front_bumpers(self) -> int:
        """The pressed ones, bit 1 is the left-most segment (protocol.md 4.7)."""
        return self._bumpers()[0]

    @property
    def rear_bumpers(self) -> int:
        """The pressed ones, bit 1 is the right-most segment (protocol.md 4.7)."""
        return self._bumpers()[1]

    @property
    def motor_temperature(self) -> float:
        """[degC]."""
        return AMBIENT + self.wheel(HEAT)

    @property
    def charging(self) -> bool:
        """Whether it stands in a dock."""
        return self.wheel(SUPPLY) > 0

    @property
    def ghost(self) -> bool:
        """Whether it is neither seen nor touched."""
        return bool(self.outlines.hidden[self.number])

    @ghost.setter
    def ghost(self, hidden: bool) -> None:
        self.outlines.hidden[self.number] = hidden
        self.robot_in_world = self.robot_in_world

    @property
    def stop_button(self) -> bool:
        """Whether the red button is pressed; the motors then have no power."""
        return self._stop_button

    @stop_button.setter
    def stop_button(self, pressed: bool) -> None:
        self._stop_button = pressed
        if pressed:
            self.drive.power(on=False)

    def enable_motors(self, *, on: bool) -> None:
        """Switch the motors; with the stop button pressed they stay off."""
        self.drive.power(on=on and not self._stop_button)

    def set_encoders(self, numbers: EncoderNumbers) -> None:
        """Make odometry of the encoders by other numbers; what the wheels do is the same."""
        measured = np.array(numbers.since(self.encoders, self.track)).reshape(2, 2)
        truth = self.drives.errors[: W_OF_W + 1, self.number]
        truth[:] = (truth.reshape(2, 2) @ measured).ravel()
        self.set_wheel(BASE, self.track * numbers.half_turn / self.encoders.half_turn)
        self.encoders = numbers

    def turn_to(self, heading: float) -> None:
        """Turn the short way to `heading` of the odometry [rad]."""
        self.turn_by(wrap(heading - self.robot_in_odom.theta))

    def turn_by(self, angle: float) -> None:
        """Turn by `angle` [rad] on top of what the drive has in its ramp."""
        self.drive.angular.travel(angle)

    def reset(self) -> None:
        """Back to the start, at rest."""
        self.robot_in_world = self.home
        self.reset_odometry()
        self.drive.stop()
        self.drive.halt()

    def session_ended(self) -> None:
        """Forget the settings of the host, as the firmware does when nobody is connected."""
        self._as_delivered()
        self.reset_odometry()

    def wheel(self, row: int) -> float:
        """Return one of the numbers of `Drives.wheels`."""
        return self.drives.wheels.item(row, self.number)

    def set_wheel(self, row: int, value: float) -> None:
        """Set one of the numbers of `Drives.wheels`."""
        self.drives.wheels[row, self.number] = value

    def _as_delivered(self) -> None:
        """Motors off, nothing wanted, limits of the factory; the wheels roll on as they do."""
        model, axes, n = self.model, self.drives.axes, self.number
        axes[ACCELERATION, :, n] = model.acceleration, model.turn_acceleration
        axes[DECELERATION, :, n] = model.deceleration, model.turn_deceleration
        axes[TOP, LINEAR, n] = min(model.max_speed, USUAL_SPEED)
        axes[TOP, ANGULAR, n] = min(model.max_turn_rate, USUAL_TURN_RATE)
        self.drive.power(on=False)
        self.drive.held = False


def outline_of(*models: RobotModel) -> RobotArrays:
    """Return the outlines of robots, all at the origin."""
    return RobotArrays(
        np.array([model.length_front for model in models]),
        np.array([model.length_rear for model in models]),
        np.array([model.width / 2 for model in models]),
    )
