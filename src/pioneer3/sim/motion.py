"""A robot's drive as the firmware sees it: two axes and the motors' power.

What it does with what it is told is computed by the kernels (`kernels/drives.py`).
"""

from math import isnan, nan

from pioneer3.sim.kernels.drives import (
    ACCELERATION,
    ANGULAR,
    BRAKING,
    DECELERATION,
    HELD,
    LINEAR,
    POWERED,
    REMAINING,
    TARGET,
    TOP,
    VELOCITY,
    DriveArrays,
)


class _Row:
    """An attribute that is one row of `Drives.axes`."""

    def __init__(self, row: int) -> None:
        self._row = row

    def __get__(self, axis: "Axis", owner: type["Axis"]) -> float:
        return axis.get(self._row)

    def __set__(self, axis: "Axis", value: float) -> None:
        axis.set(self._row, value)


class Axis:
    """One velocity with its ramp, metres or radians alike: a view of one robot's numbers."""

    velocity = _Row(VELOCITY)
    """Now [1/s]."""
    acceleration = _Row(ACCELERATION)
    """Away from zero [1/s^2], positive; 0 means at once."""
    deceleration = _Row(DECELERATION)
    """Towards zero [1/s^2], positive; 0 means at once."""
    top = _Row(TOP)
    """Highest speed [1/s]."""
    target = _Row(TARGET)
    """Velocity wanted [1/s]."""

    def __init__(self, drives: DriveArrays, axis: int, number: int) -> None:
        self._axes, self._axis, self._number = drives.axes, axis, number

    @property
    def remaining(self) -> float | None:
        """Way left of a commanded distance, or `None` where a velocity is wanted."""
        left = self.get(REMAINING)
        return None if isnan(left) else left

    def go(self, velocity: float) -> None:
        """Hold `velocity`, at most :attr:`top`."""
        self.target = velocity
        self.set(REMAINING, nan)

    def travel(self, distance: float) -> None:
        """Cover `distance` and stand: a trapezoid."""
        self.target = 0.0
        self.set(REMAINING, distance)

    def get(self, row: int) -> float:
        """Return a row of `Drives.axes`."""
        return self._axes.item(row, self._axis, self._number)

    def set(self, row: int, value: float) -> None:
        """Set a row of `Drives.axes`."""
        self._axes[row, self._axis, self._number] = value


class WheelDrive:
    """Two axes and the motors' power: a view of one robot's numbers."""

    def __init__(self, drives: DriveArrays, number: int) -> None:
        self.linear, self.angular = Axis(drives, LINEAR, number), Axis(drives, ANGULAR, number)
        self._flags, self._number = drives.flags, number

    @property
    def powered(self) -> bool:
        """Motors on. Without power commands are ignored, and the wheels brake."""
        return bool(self._flags.item(POWERED, self._number))

    @property
    def held(self) -> bool:
        """The watchdog holds the robot; the commands are kept."""
        return bool(self._flags.item(HELD, self._number))

    @held.setter
    def held(self, value: bool) -> None:
        self._flags[HELD, self._number] = value

    @property
    def braking(self) -> bool:
        """An emergency stop is under way; commands are ignored until the robot stands."""
        return bool(self._flags.item(BRAKING, self._number))

    @property
    def obeys(self) -> bool:
        """Whether motion commands have an effect."""
        return self.powered and not self.braking

    def stop(self) -> None:
        """Decelerate both axes to a stand; forget what was commanded."""
        self.linear.go(0.0)
        self.angular.go(0.0)

    def emergency_stop(self) -> None:
        """Brake as hard as the wheels can."""
        self.stop()
        moving = any((self.linear.velocity, self.angular.velocity))
        self._flags[BRAKING, self._number] = moving

    def power(self, *, on: bool) -> None:
        """Switch the motors."""
        self._flags[POWERED, self._number] = on
        if not on:
            self.stop()

    def halt(self) -> None:
        """Stand at once: something is in the way."""
        for axis in (self.linear, self.angular):
            axis.velocity = 0.0
