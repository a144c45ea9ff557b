"""The laser range finder of simulators, in the robot's own stream (protocol.md 5.13)."""

from collections.abc import AsyncGenerator, Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from math import inf, isfinite, radians
from typing import Protocol

from pioneer3.arcos import commands
from pioneer3.arcos.commands import SimLaserMode
from pioneer3.arcos.reports import Report, SimLaser, SimLaserExtended
from pioneer3.errors import CommandError, DeviceError
from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.robot.devices.presence import Presence
from pioneer3.robot.devices.sensor import Sensor, SensorKind
from pioneer3.robot.report_requests import ReportRequest
from pioneer3.robot.supervisor import Supervisor, is_simulator
from pioneer3.state import Scan
from pioneer3.units import MM

NOTHING_MM = 0x7FFF
"""From here on a range means no echo."""


class SweepCollector:
    """Collects packets into a whole sweep; drops a sweep with a gap, and counts it as `broken`.

    The first reading is at the angle `start` in the laser's frame, the last one at `end` [rad].
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
        self._angles: tuple[float, ...] = ()

    def add(
        self, packet: SimLaser | SimLaserExtended, stamp: float, robot_in_odom: Callable[[], Pose2]
    ) -> Scan | None:
        """Take a packet received at `stamp` [s]; return the sweep that it completes, or `None`.

        `robot_in_odom` is called for the robot's pose at the first packet of a sweep.
        """
        if packet.first != len(self._ranges):
            self.broken += bool(self._ranges)
            self._forget()
        if packet.first == 0:
            self._stamp, self._pose = stamp, robot_in_odom()
        if self._pose is None:
            return None
        if isinstance(packet, SimLaser):
            self._ranges += packet.ranges_mm
        elif packet.readings:
            ranges, reflectances, _ = zip(*packet.readings, strict=True)
            self._ranges += ranges
            self._reflectances += reflectances
        return self._scan() if len(self._ranges) >= packet.total else None

    def _scan(self) -> Scan | None:
        ranges, count, pose = self._ranges, len(self._ranges), self._pose
        if not count or pose is None:
            return None
        if count != len(self._angles):
            self._angles = _angles(self._start, self._end, count)
        self._sequence += 1
        scan = Scan(
            stamp=self._stamp,
            sequence=self._sequence,
            robot_in_odom=pose,
            sensor_in_robot=self._mount,
            angles=self._angles,
            ranges=tuple([mm * MM if mm < NOTHING_MM else inf for mm in ranges]),
            reflectances=tuple(self._reflectances),
        )
        self._forget()
        return scan

    def _forget(self) -> None:
        self._pose = None
        self._ranges, self._reflectances = [], []


def _angles(start: float, end: float, count: int) -> tuple[float, ...]:
    """Return the angles of `count` readings [rad].

    From the count: simulators differ in rounding the field of view and the step.
    """
    step = (end - start) / (count - 1) if count > 1 else 0.0
    return tuple(start + i * step for i in range(count))


FIRST = radians(-90)
"""First direction of ARIA's lms2xx, the laser of a Pioneer 3 [rad]."""
LAST = radians(90)
STEP = radians(1)
FINEST = radians(0.1)
REAL = (
    "Lasers of real robots are connected to a serial port or the network of the computer, not to"
    " the robot: name that port with --laser, or let it be found with --laser auto."
)


class LaserSource(Protocol):
    """A laser range finder, read from the robot's own stream or by a driver."""

    @property
    def name(self) -> str:
        """Its name in scans, frames and messages: `laser`, that of a second one `laser2`."""

    @property
    def sensor_in_robot(self) -> Pose2:
        """Its pose on the robot [m, rad]."""

    @property
    def presence(self) -> Presence:
        """Whether there is one to read."""

    @property
    def lost(self) -> str | None:
        """While it should scan and does not, a few words; else `None`."""

    @property
    def latest(self) -> Scan | None:
        """The last scan; look at its stamp."""

    @property
    def rate(self) -> float:
        """Scans in the last second [1/s]."""

    def wanted(self) -> AbstractContextManager[None]:
        """Keep :attr:`latest` new during the block."""

    def values(self) -> AsyncGenerator[Scan, None]:
        """Yield each scan; the newest when the reader is slow."""

    async def reading(self) -> Scan:
        """Return the next scan."""


def _kind(first: float, last: float, step: float) -> SensorKind:
    """Return the sensor kind for scans from `first` to `last` in steps of `step` [rad]."""
    request = ReportRequest(
        begin=(
            commands.SimLrfSetFovStart(first),
            commands.SimLrfSetFovEnd(last),
            commands.SimLrfSetRes(step),
            commands.SimLrfEnable(SimLaserMode.EXTENDED),
        ),
        end=(commands.SimLrfEnable(SimLaserMode.OFF),),
        answers=(SimLaser, SimLaserExtended),
    )
    packets = (SimLaser, SimLaserExtended)
    return SensorKind(name="laser", title="the laser", request=request, reports=packets)


class Laser(Sensor[Scan]):
    """The scans of a simulator's laser.

    Commands 230 to 233 configure it; robots have no other use for them. Without such a laser,
    :meth:`wanted`, :meth:`values` and :meth:`reading` raise `DeviceError`.
    """

    def __init__(self, supervisor: Supervisor) -> None:
        super().__init__(supervisor, _kind(FIRST, LAST, STEP), self._add)
        self._sweep = self._sweep_of(FIRST, LAST)

    name = "laser"
    lost: str | None = None  # it is a part of the robot's own stream, and comes and goes with it

    @property
    def sensor_in_robot(self) -> Pose2:
        """Its pose on the robot [m, rad]."""
        mount = self._supervisor.info.model.laser if self._supervisor.info else None
        return Pose2(mount.x, mount.y, mount.theta) if mount else ORIGIN

    @property
    def presence(self) -> Presence:
        """Whether there is one: simulators have it, in the robot's own stream."""
        if self._supervisor.info is None:
            return Presence(None, "Nobody knows of a laser: no robot is connected.")
        if is_simulator(self._supervisor.info):
            return Presence(True, "This is a simulator: it has a laser.")
        return Presence(False, REAL)

    def set_up(self, first: float = FIRST, last: float = LAST, step: float = STEP) -> None:
        """Choose the scans that come from now on, by the angles of their readings [rad].

        They are counter-clockwise in the laser's frame, the `first` one in whole degrees.

        Raises:
            CommandError: the angles are not a scan, or the laser is on.
        """
        if self.is_wanted:
            raise CommandError("the laser is on: set it up when nobody wants scans")
        if not (isfinite(first) and isfinite(last) and -7 < first < last < 7 and step >= FINEST):
            raise CommandError("a scan goes from first to last, at steps of 0.1 degrees or more")
        self.kind, self._sweep = _kind(first, last, step), self._sweep_of(first, last)
        self.latest = None

    @contextmanager
    def wanted(self) -> Iterator[None]:
        """Keep the laser on and :attr:`latest` new during the block."""
        self._require()
        with super().wanted():
            yield

    def values(self) -> AsyncGenerator[Scan, None]:
        """Yield each scan; the newest when the reader is slow."""
        self._require()
        return super().values()

    def _require(self) -> None:
        if not self.presence.there:
            raise DeviceError(str(self.presence))

    def _sweep_of(self, first: float, last: float) -> SweepCollector:
        return SweepCollector(self.sensor_in_robot, first, last)

    def _add(self, report: Report, stamp: float) -> Scan | None:
        assert isinstance(report, SimLaser | SimLaserExtended)
        return self._sweep.add(report, stamp, self._robot_in_odom)

    def _robot_in_odom(self) -> Pose2:
        snapshot = self._supervisor.snapshot
        return snapshot.odometry.robot_in_odom if snapshot else ORIGIN
