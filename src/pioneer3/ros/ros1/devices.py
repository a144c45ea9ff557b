"""Scans and the gyro's rates as ROS 1 topics, asked for while anybody listens."""

import asyncio
from collections.abc import AsyncGenerator, Callable
from contextlib import aclosing
from typing import Any, Final, TypeVar

from pioneer3.errors import DeviceError
from pioneer3.robot.devices.gyro import GyroReading
from pioneer3.ros.description.frames import Frames
from pioneer3.ros.messages import ranges
from pioneer3.ros.ros1.audience import Audience
from pioneer3.ros.ros1.messages import make, publisher
from pioneer3.runtime.robot import Robot
from pioneer3.state import Scan
from pioneer3.tasks import running

PAUSE: Final = 0.5
"""After a device turned out not to be there [s]."""
V = TypeVar("V", Scan, GyroReading)


class Devices:
    """Publishes `scan` and `imu/data_raw`, if the robot has a laser and a gyro that can be read.

    Args:
        robot: Connected.
        frames: Names, with the prefix.
        ros_time: Returns the ROS time of a moment [s, monotonic].
    """

    def __init__(self, robot: Robot, frames: Frames, ros_time: Callable[[float], Any]) -> None:
        self._laser, self._gyro = robot.devices.laser, robot.devices.gyro
        self._frames = frames
        self._ros_time = ros_time
        loop = asyncio.get_running_loop()
        self._scan: Any = None
        self._imu: Any = None
        self._to_scans, self._to_imu = Audience(loop), Audience(loop)
        self._scanned_at = float("-inf")

    def advertise(self) -> None:
        """Tell the master, in a thread."""
        if self._laser.presence.there:
            self._scan = publisher("scan", "sensor_msgs/LaserScan", listener=self._to_scans)
        if self._gyro.presence.there:
            self._imu = publisher("imu/data_raw", "sensor_msgs/Imu", listener=self._to_imu)

    async def serve(self) -> None:
        """Publish while somebody listens; ends by cancellation."""
        async with running(
            _while_heard(self._to_scans, self._laser.values, self._publish_scan),
            _while_heard(self._to_imu, self._gyro.values, self._publish_imu),
        ):
            await asyncio.get_running_loop().create_future()

    def _publish_scan(self, sweep: Scan) -> None:
        message = make("sensor_msgs/LaserScan")
        pause, self._scanned_at = sweep.stamp - self._scanned_at, sweep.stamp
        ranges.scan(
            message,
            sweep,
            stamp=self._ros_time(sweep.stamp),
            frame=self._frames.laser,
            period=pause if pause < 1.0 else 0.0,
        )
        self._scan.publish(message)

    def _publish_imu(self, reading: GyroReading) -> None:
        message = make("sensor_msgs/Imu")
        stamp = self._ros_time(reading.stamp)
        ranges.imu(message, reading, stamp=stamp, frame=self._frames.imu)
        self._imu.publish(message)


async def _while_heard(
    audience: Audience, values: Callable[[], AsyncGenerator[V, None]], publish: Callable[[V], None]
) -> None:
    """Read the device while somebody listens."""
    while True:
        await audience.there.wait()
        try:
            async with aclosing(values()) as readings:
                async for reading in readings:
                    if not audience.there.is_set():
                        break
                    publish(reading)
                else:
                    return
        except DeviceError:  # another robot is at the other end now
            await asyncio.sleep(PAUSE)
