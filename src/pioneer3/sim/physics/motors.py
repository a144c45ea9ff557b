"""The motors of all robots: a wheel-speed loop a side, its torque, its encoder, its stall."""

from collections.abc import Sequence

import numpy as np

from pioneer3.arrays import Bool, Float
from pioneer3.models import RobotModel, physics_of, shape_of, total_mass
from pioneer3.sim.body import Body, Speeds
from pioneer3.sim.kernels import DriveArrays, Kernels
from pioneer3.sim.kernels.drives import (
    ANGULAR,
    BASE,
    BRAKING,
    LEFT_STALLED,
    LINEAR,
    POWERED,
    RIGHT_STALLED,
    STALLED,
    V_OF_V,
    VELOCITY,
    W_OF_V,
    W_OF_W,
)
from pioneer3.sim.physics.scene import Scene

STALL_TIME = 0.3
"""Time after which a side that pushes with nearly all its torque is stalled [s]."""
FULL_SHARE = 0.98
"""Share of its torque that counts as nearly all."""
DRAG = 0.3
"""Torque of a side's gears and motors without power [Nm]; an assumption."""
LEAST_SPEED = 5e-4
"""Slower wheels stand, as far as encoders tell [m/s]."""


class MotorArrays:
    """The motors of N robots, as arrays: left and right sides (2, N)."""

    def __init__(self) -> None:
        self._robots: Sequence[Body] = ()
        self._drives = DriveArrays.at_rest(0)
        self._angles = self._speed = np.zeros((2, 0))
        self._goal = self._pushing = np.zeros((2, 0))
        self._released = self._braking = np.zeros(0, np.bool_)

    def change(self, robots: Sequence[Body], drives: DriveArrays) -> None:
        """Replace the robots, in the order of `drives`; those that stay keep their state."""
        before = {body: number for number, body in enumerate(self._robots)}
        places = [before.get(body, -1) for body in robots]
        self._pushing = np.pad(self._pushing, ((0, 0), (0, 1)))[:, places]
        self._goal = np.pad(self._goal, ((0, 0), (0, 1)))[:, places]
        self._released = np.pad(self._released, (0, 1))[places]
        self._robots, self._drives = robots, drives
        bodies = [physics_of(body.model) for body in robots]
        track = np.array([body.turning_track for body in bodies])
        self._track, self._true_radius = track, np.array([body.rolling_radius for body in bodies])
        drives.wheels[BASE] = track * drives.errors[W_OF_W] / drives.errors[V_OF_V]
        self._torque = np.array([body.side_torque for body in bodies])
        self._gain = np.array([body.loop_gain for body in bodies])
        self._damping = np.array([body.loop_damping for body in bodies])
        self._inertia = np.array([_inertia(body.model) for body in robots])
        self._drag = np.minimum(DRAG, self._torque / 4)

    @property
    def _radius(self) -> Float:
        """Radii that the controllers take the wheels for, by which they count ways, (2, N) [m]."""
        v_of_v, more = self._drives.errors[V_OF_V], self._drives.errors[W_OF_V] * self._track / 2
        radius: Float = self._true_radius / np.stack([v_of_v - more, v_of_v + more])
        return radius

    def rest(self, scene: Scene, number: int) -> None:
        """Let the wheels of one robot, which are at their zero, push nowhere."""
        scene.data.act[scene.motors[:, number]] = 0.0
        self._goal[:, number] = self._pushing[:, number] = 0.0

    def begin(self, scene: Scene, kernels: Kernels, dt: float) -> None:
        """Tell the loops the speeds that the firmware's ramps have within `dt` [s]."""
        begin = self._wanted()
        self._braking = self._drives.flags[BRAKING] != 0
        kernels.ramp(self._drives, dt)
        self._angles = _angles(scene)
        self._drive(scene, begin, self._wanted(), dt)

    def end(self, scene: Scene, kernels: Kernels, dt: float) -> None:
        """Count the ways of the wheels within the last `dt` [s], and feel whether they stall."""
        rolled = (_angles(scene) - self._angles) * self._radius
        left, right = np.ascontiguousarray(rolled)
        kernels.count(self._drives, left, right)
        self.look(scene)
        # an emergency stop lasts until the wheels stand, not the ramps
        flags = self._drives.flags
        flags[BRAKING] = ((flags[BRAKING] != 0) | self._braking) & ~self._stand()
        self._feel_stall(scene, dt)

    def look(self, scene: Scene) -> None:
        """Note the speeds that encoders tell."""
        speed = scene.data.qvel[scene.wheel_speeds].mean(axis=2) * self._radius
        self._speed = np.where(abs(speed) < LEAST_SPEED, 0.0, speed)

    def speeds(self, number: int) -> Speeds:
        """Return speed and turn rate of a robot by its encoders."""
        left, right = (self._speed[side, number] for side in range(2))
        v, w = (left + right) / 2, (right - left) / self._drives.wheels[BASE, number]
        return float(v), float(w)

    def _wanted(self) -> Float:
        """Return the speeds of the wheels that the ramps have now [rad/s], shape (2, N)."""
        v, w = self._drives.axes[VELOCITY, [LINEAR, ANGULAR]]
        half = w * self._drives.wheels[BASE] / 2
        both: Float = np.stack([v - half, v + half]) / self._radius
        return both

    def _drive(self, scene: Scene, begin: Float, end: Float, dt: float) -> None:
        """Tell the loops the angles that the wheels should have, and limit their torque.

        A loop is a spring and a damper between a wheel and where it should be, which goes no
        farther ahead of the wheel than the torque reaches: it does not wind up. MuJoCo's damper
        brakes any speed, and none of its parts knows the ramp: the angle leads by what they need.
        Motors that lose their power brake until the wheels stand.

        `begin` and `end` are the speeds that they should have now and after `dt` [s], (2, N)
        [rad/s].
        """
        drives, angles = self._drives, self._angles
        self._released = (drives.flags[POWERED] == 0) & (self._released | self._stand())
        limit = np.where(self._released, self._drag, self._torque)
        ranges = np.stack([-limit, limit], axis=-1)
        scene.model.actuator_forcerange[scene.motors] = ranges[None]
        reach = limit / self._gain
        goal = self._goal.clip(angles - reach, angles + reach)
        mean = (begin + end) / 2
        lead = (self._damping * mean + self._inertia * (end - begin) / dt) / self._gain
        speed = scene.data.qvel[scene.wheel_speeds].mean(axis=2)
        middle = angles + self._damping * speed / self._gain
        beyond = abs(goal + lead - middle) > FULL_SHARE * reach
        goal = np.where(beyond & (begin == 0.0) & (end == 0.0), angles, goal)
        scene.data.act[scene.motors] = (goal + lead).clip(middle - reach, middle + reach)
        scene.data.ctrl[scene.motors] = mean
        self._goal = goal + mean * dt

    def _stand(self) -> Bool:
        """Return which robots stand, and are not about to move, shape (N,)."""
        ramps = (self._drives.axes[VELOCITY] == 0.0).all(axis=0)
        stand: Bool = ramps & (self._speed == 0.0).all(axis=0)
        return stand

    def _feel_stall(self, scene: Scene, dt: float) -> None:
        drives = self._drives
        force = abs(scene.data.actuator_force[scene.motors])
        pushes = (force > FULL_SHARE * self._torque) & (drives.flags[POWERED] != 0)
        self._pushing = np.where(pushes, self._pushing + dt, 0.0)
        left, right = self._pushing >= STALL_TIME
        drives.flags[STALLED] = LEFT_STALLED * left + RIGHT_STALLED * right
        stalled = left | right
        # ramps begin anew at the speeds of the wheels, so that another command counts at once
        speeds = [self.speeds(number) for number in np.flatnonzero(stalled).tolist()]
        drives.axes[VELOCITY][:, stalled] = np.array(speeds).reshape(-1, 2).T


def _angles(scene: Scene) -> Float:
    """Return how far the wheels of each side have turned [rad], shape (2, N)."""
    angles: Float = scene.data.qpos[scene.wheels].mean(axis=2)
    return angles


def _inertia(model: RobotModel) -> float:
    """Return the inertia that one side moves on a straight drive, at its wheels [kg m2]."""
    physics = physics_of(model)
    motors = physics.armature * len(shape_of(model).axles)
    return motors + total_mass(model) * physics.rolling_radius**2 / 2
