"""A laser range finder as a ROS node, without a robot, in the place of hokuyo_node or urg_node."""

import asyncio
from collections.abc import Callable
from functools import partial
from typing import Final

from pioneer3.robot.lasers.driver import LaserDriver
from pioneer3.robot.supervisor import Connection
from pioneer3.ros.messages.diagnostics import device_id, laser_status
from pioneer3.ros.messages.update import ScanUpdate
from pioneer3.ros.node.middleware import Middleware
from pioneer3.ros.node.names import Profile
from pioneer3.ros.node.publishing import Publishing
from pioneer3.ros.node.topics import DIAGNOSTICS, laser_topic
from pioneer3.state import Scan
from pioneer3.tasks import hand_over, running

FRAME: Final = "laser"
"""Frame of scans, unless a parameter names another; as in hokuyo_node and urg_node."""


class LaserNode:
    """Runs the driver of a laser; publishes its scans in `frame`, and its state.

    The node has its name in the middleware already.
    """

    def __init__(self, laser: LaserDriver, frame: str, middleware: Middleware) -> None:
        self._laser = laser
        self._frame = frame
        self._middleware = middleware
        self._loop = asyncio.get_running_loop()
        topics = [laser_topic(laser.name), DIAGNOSTICS]
        self._publishing = Publishing(topics, Profile.STANDARD, middleware)
        self._ended = asyncio.Event()

    async def run(self, ready: Callable[[], None]) -> None:
        """Serve until somebody shuts the node down, or until cancelled.

        `ready` is called when everything is advertised.
        """
        self._middleware.on_shutdown(partial(hand_over, self._loop, self._ended.set))
        await asyncio.to_thread(self._publishing.advertise, lambda topic: True)
        ready()
        scans = self._publishing.publish_device(
            ScanUpdate, self._laser.values, self._update, self._laser.name
        )
        diagnostics = self._publishing.publish_diagnostics(
            lambda: (laser_status(self._laser),),
            lambda: device_id(self._laser.identity) if self._laser.identity else "",
        )
        try:
            looking = self._publishing.keep_looking()
            async with running(self._laser.run(), scans, looking, diagnostics, self._follow_link()):
                await self._ended.wait()
        finally:
            await asyncio.to_thread(self._middleware.forget)

    def _update(self, scan: Scan) -> ScanUpdate:
        stamp = self._middleware.stamp(self._loop.time() - scan.stamp)
        return ScanUpdate(
            scan=scan,
            frame=self._frame,
            stamp=stamp,
            period=scan.period,
            make=self._middleware.make,
        )

    async def _follow_link(self) -> None:
        """Log changes of the connection to the laser."""
        logged = None
        async for status in self._laser.status.values(latest_first=True):
            news = status.connection in {Connection.LOST, Connection.CONNECTED}
            if news and status != logged:
                self._middleware.warn(f"laser {status.connection.value}: {status.message}")
                logged = status
