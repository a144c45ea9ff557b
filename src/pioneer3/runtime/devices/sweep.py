"""Puts the packets of a simulator's laser together; pure (arcos.md 5.13)."""

from collections.abc import Callable
from math import inf

from pioneer3.arcos.reports import SimLaser, SimLaserExtended
from pioneer3.geometry import Pose2
from pioneer3.state import Scan
from pioneer3.units import MM

NOTHING_MM = 0x7FFF
"""This and more is no echo."""


class Sweep:
    """Collects packets until they are a whole sweep; a sweep with a gap is thrown away.

    Args:
        sensor_in_robot: Where the laser sits and looks [m, rad].
        start: Angle of the first reading, from where it looks [rad].
        end: Angle of the last one [rad].

    Attributes:
        broken: Sweeps thrown away.
    """

    def __init__(self, sensor_in_robot: Pose2, start: float, end: float) -> None:
        self.broken = 0
        self._mount = sensor_in_robot
        self._start, self._end = start, end
        self._sequence = 0
        self._stamp = 0.0
        self._pose: Pose2 | None = None
        self._ranges: list[int] = []
        self._reflectances: list[int] = []

    def add(
        self, packet: SimLaser | SimLaserExtended, stamp: float, robot_in_odom: Callable[[], Pose2]
    ) -> Scan | None:
        """Take a packet received at `stamp` [s]; return the sweep that it completes, or `None`.

        The first packet of a sweep asks `robot_in_odom` where the robot is.
        """
        if packet.first != len(self._ranges):
            self.broken += bool(self._ranges)
            self._forget()
        if packet.first == 0:
            self._stamp, self._pose = stamp, robot_in_odom()
        if self._pose is None:
            return None
        if isinstance(packet, SimLaserExtended):
            self._ranges += (reading.range_mm for reading in packet.readings)
            self._reflectances += (reading.reflectance for reading in packet.readings)
        else:
            self._ranges += packet.ranges_mm
        return self._scan() if len(self._ranges) >= packet.total else None

    def _scan(self) -> Scan | None:
        ranges, count, pose = self._ranges, len(self._ranges), self._pose
        if not count or pose is None:
            return None
        # from the count: some simulators round the field of view and the step in their own way
        step = (self._end - self._start) / (count - 1) if count > 1 else 0.0
        self._sequence += 1
        scan = Scan(
            stamp=self._stamp,
            sequence=self._sequence,
            robot_in_odom=pose,
            sensor_in_robot=self._mount,
            angles=tuple(self._start + i * step for i in range(count)),
            ranges=tuple(mm * MM if mm < NOTHING_MM else inf for mm in ranges),
            reflectances=tuple(self._reflectances),
        )
        self._forget()
        return scan

    def _forget(self) -> None:
        self._pose = None
        self._ranges, self._reflectances = [], []
