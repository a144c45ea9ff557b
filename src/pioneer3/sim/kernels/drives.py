"""The drives of many robots as arrays, and the numbers that their motion goes by."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from pioneer3.arrays import Float, Int, UInt8

Flags = UInt8

LONGEST = 0.1
"""The longest step [s]: no robot goes so far in it that it could pass a wall unnoticed."""
SUBSTEP = 0.02
"""How often the speed of a robot that covers a distance is worked out [s]."""
ARRIVED = 1e-4
"""A distance with less than this left to go is done [m or rad]."""
HARDEST = 4.0
"""Deceleration of wheels that brake with all they have [m/s^2]."""
HARDEST_TURN = 16.0
"""Deceleration of a turn whose wheels brake with all they have [rad/s^2]."""
FINER = 32
"""Times finer each time that the free part of a blocked motion is sought: to 1/1024 of it."""
NEGLIGIBLE = 1e-4
"""A blocked motion shorter than this [m and rad] is not taken at all."""

CAPACITY = 252.0 * 3600
"""Three batteries of 12 V and 7 Ah [J]."""
IDLE_POWER = 15.0
"""Controller and sonar [W]."""
DRIVE_POWER = 40.0
"""Motors at 1 m/s [W]."""

DRIVE_HEAT = 25.0
"""Warming of motors in the long run at 1 m/s [K]."""
TURN_HEAT = 10.0
"""Warming of motors in the long run at 1 rad/s [K]."""
STALL_HEAT = 60.0
"""Warming of motors that push in the long run [K]."""
HEAT_TIME = 600.0
"""In which 63 % of that is reached [s]."""

# rows of Drives.axes
ACCELERATION, DECELERATION, TOP, VELOCITY, TARGET, REMAINING = range(6)
LINEAR, ANGULAR = range(2)
# rows of Drives.flags
POWERED, HELD, BRAKING, STALLED, TOUCHED = range(5)
LEFT_STALLED = 1
"""Bit of the flag `STALLED` of a robot whose left side pushes and does not turn."""
RIGHT_STALLED = 2
"""Likewise for the right side."""
BOTH_STALLED = LEFT_STALLED | RIGHT_STALLED
# rows of Drives.wheels
ODOM_X, ODOM_Y, ODOM_THETA, LEFT, RIGHT, BASE, ENERGY, SUPPLY, HEAT = range(9)
# rows of Drives.errors
V_OF_V, V_OF_W, W_OF_V, W_OF_W, WAY_NOISE, TURN_NOISE, DRIFT_NOISE = range(7)


@dataclass(slots=True, eq=False)
class DriveArrays:
    """N drives. Velocities and ways of the wheels are what the firmware sees: odometry.

    Attributes:
        axes: Of the linear and the angular velocity acceleration, deceleration [1/s^2], top,
            velocity now, velocity wanted [1/s], and the way left of a commanded distance or NaN
            where a velocity is wanted [m, rad]; shape (6, 2, N).
        flags: Motors on; held by the watchdog; an emergency stop under way; pushing against
            something; something stopped its latest motion; 0 or 1, shape (5, N).
        wheels: Odometry x, y [m], theta [rad]; rolled by the left and the right wheel, wheel base
            [m]; energy left [J]; power supplied from outside [W]; motors above ambient [K];
            shape (9, N).
        errors: What the wheels do not see. True speed per speed and per turn rate, true turn rate
            per speed and per turn rate; then standard deviations of the way per root of way
            [m^0.5], of the turn per root of turn [rad^0.5] and per root of way [rad/m^0.5];
            shape (7, N).
    """

    axes: Float
    flags: Flags
    wheels: Float
    errors: Float

    def __len__(self) -> int:
        return len(self.axes[0, 0])

    @classmethod
    def at_rest(cls, count: int) -> "DriveArrays":
        """Return drives without errors, limits still to be set."""
        axes = np.zeros((6, 2, count))
        axes[REMAINING] = np.nan
        wheels = np.zeros((9, count))
        wheels[ENERGY] = CAPACITY
        errors = np.zeros((7, count))
        errors[[V_OF_V, W_OF_W]] = 1.0
        return cls(axes, np.zeros((5, count), np.uint8), wheels, errors)

    def go(self, speeds: Float, rates: Float) -> None:
        """Let all powered robots hold speeds [m/s] and turn rates [rad/s], both (N,) or one."""
        self.axes[TARGET, LINEAR], self.axes[TARGET, ANGULAR] = speeds, rates
        self.axes[REMAINING] = np.nan

    def joined(self, other: "DriveArrays") -> "DriveArrays":
        """Return these and the others, in this order."""
        pairs: Any = zip(self.arrays, other.arrays, strict=True)
        return DriveArrays(*(np.concatenate(pair, axis=-1) for pair in pairs))

    def only(self, which: slice | Int) -> "DriveArrays":
        """Return copies of some."""
        parts: Any = self.arrays
        return DriveArrays(*(part[..., which].copy() for part in parts))

    @property
    def arrays(self) -> tuple[Float, Flags, Float, Float]:
        """Arguments of kernels: axes, flags, wheels, errors."""
        return self.axes, self.flags, self.wheels, self.errors

    @property
    def noisy(self) -> bool:
        """Whether any drive has random errors."""
        return bool(self.errors[WAY_NOISE:].any())
