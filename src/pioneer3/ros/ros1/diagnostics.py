"""`/diagnostics`: how it stands with the robot, once a second."""

import asyncio
from typing import Any, Final

from pioneer3.robot.supervisor import Connection
from pioneer3.ros.messages.diagnostics import Condition, Health, conditions, fill, hardware_id
from pioneer3.ros.ros1.audience import Audience
from pioneer3.ros.ros1.messages import make, publisher
from pioneer3.runtime.robot import Robot

PERIOD: Final = 1.0
"""Between two messages [s] (REP 107)."""


class Diagnostics:
    """Tells monitors about `robot`, also while it is lost."""

    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        self._publisher: Any = None
        self._audience = Audience(asyncio.get_running_loop())

    def advertise(self) -> None:
        """Tell the master, in a thread."""
        kind = "diagnostic_msgs/DiagnosticArray"
        self._publisher = publisher("/diagnostics", kind, listener=self._audience)

    def conditions(self) -> tuple[Condition, ...]:
        """Return how each part is now."""
        robot, status = self._robot, self._robot.supervisor.status.latest
        lost = status is not None and status.connection is not Connection.CONNECTED
        return conditions(
            Health(
                info=robot.info,
                snapshot=robot.snapshot,
                lost=status.message if status is not None and lost else "",
                emergency=robot.supervisor.pilot.emergency,
                driver=robot.arbiter.driver,
                why_not_moving=robot.why_not_moving(),
                refused=robot.supervisor.pilot.blocked,
            )
        )

    async def serve(self) -> None:
        """Publish while somebody listens; ends by cancellation."""
        while True:
            await self._audience.there.wait()
            self._publish(self.conditions())
            await asyncio.sleep(PERIOD)

    def _publish(self, found: tuple[Condition, ...]) -> None:
        import rospy  # noqa: PLC0415

        message = make("diagnostic_msgs/DiagnosticArray")
        fill(
            message,
            found,
            stamp=rospy.get_rostime(),
            node=rospy.get_name(),
            hardware=hardware_id(self._robot.info),
            make=make,
        )
        self._publisher.publish(message)
