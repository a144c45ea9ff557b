"""Makes what topics are published from: of the snapshots, scans and readings of one robot."""

from collections.abc import Callable, Sequence
from math import inf
from typing import Any, Final

from pioneer3.geometry import Pose2
from pioneer3.models import RobotModel
from pioneer3.models.description.tree import FrameTree, tree_of
from pioneer3.models.description.urdf import describe
from pioneer3.robot.devices.sensor import Stamped
from pioneer3.ros.messages.motion import WheelAngles
from pioneer3.ros.messages.update import (
    DescriptionUpdate,
    MessageOptions,
    ScanUpdate,
    SensorUpdate,
    StateUpdate,
)
from pioneer3.state import Bumpers, Scan, Snapshot

LONGEST_PERIOD: Final = 1.0
"""Scans that are farther apart [s] have no period."""


class Updates:
    """Updates of one robot.

    Args:
        lasers: Returns the poses of its lasers on the robot [m, rad]; `None` for that of the model.
        camera: Returns whether it has a camera.
        stamp: Returns a moment [s, monotonic] as the middleware writes times.
        make: Returns an empty message of the type named.

    Attributes:
        frames: Names of the frames, with the prefix.
    """

    def __init__(
        self,
        model: RobotModel,
        options: MessageOptions,
        *,
        lasers: Callable[[], Sequence[Pose2] | None] = lambda: None,
        camera: Callable[[], bool] = lambda: False,
        stamp: Callable[[float], Any],
        make: Callable[[str], Any],
    ) -> None:
        self.frames = options.frames.with_prefix(options.prefix)
        self._options, self._lasers, self._camera = options, lasers, camera
        self._stamp, self._make = stamp, make
        self._model, self._tree = model, self._tree_of(model)
        self._wheels = WheelAngles()
        self._scanned_at: dict[str, float] = {}

    def pass_over(self, snapshot: Snapshot, model: RobotModel) -> None:
        """Take a snapshot that is not published: its wheels have turned, too."""
        self._wheels.update(snapshot.odometry, model)

    def jumped(self) -> None:
        """Take the next odometry as the present pose: somebody has set it."""
        self._wheels.jumped()

    def state(
        self,
        snapshot: Snapshot,
        model: RobotModel,
        *,
        emergency: bool,
        odom_in_map: tuple[Any, Pose2] | None,
    ) -> StateUpdate:
        """Return the update of a snapshot; the model is another one after another robot came."""
        if model is not self._model:
            self._model, self._tree = model, self._tree_of(model)
        return StateUpdate(
            snapshot=snapshot,
            model=model,
            tree=self._tree,
            frames=self.frames,
            options=self._options,
            turned=self._wheels.update(snapshot.odometry, model),
            emergency=emergency,
            odom_in_map=odom_in_map,
            stamp=self._stamp(snapshot.stamp),
            make=self._make,
        )

    def scan(self, number: int, scan: Scan) -> ScanUpdate:
        """Return the update of a scan of the laser of this number, from 0."""
        pause = scan.stamp - self._scanned_at.get(scan.laser, -inf)
        self._scanned_at[scan.laser] = scan.stamp
        return ScanUpdate(
            scan=scan,
            frame=self.frames.laser_frame(number),
            odom=self.frames.odom,
            stamp=self._stamp(scan.stamp),
            period=scan.period or (pause if pause < LONGEST_PERIOD else 0.0),
            make=self._make,
        )

    def reading(self, reading: Stamped) -> SensorUpdate:
        """Return the update of a reading of a sensor."""
        return SensorUpdate(reading=reading, frames=self.frames, stamp=self._stamp(reading.stamp))

    def description(self, touch: Bumpers, *, laser: bool) -> DescriptionUpdate:
        """Return the description of the robot, with bumpers and laser if it has them."""
        urdf = describe(
            self._model,
            self._tree,
            self._options.frames,
            bumpers=(len(touch.front), len(touch.rear)),
            laser=laser,
        )
        return DescriptionUpdate(urdf=urdf)

    def _tree_of(self, model: RobotModel) -> FrameTree:
        options = self._options
        return tree_of(
            model,
            options.frames,
            options.wheel_joints,
            options.sonar_height,
            self._lasers(),
            camera=self._camera(),
        )
