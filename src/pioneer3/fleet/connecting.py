"""How the robots of a fleet are connected to: at their ports, or over ROS."""

from contextlib import AbstractAsyncContextManager

from pioneer3.fleet.members import Connect
from pioneer3.fleet.reach import given_model, port_of
from pioneer3.fleet.spec import Fleet, Robot
from pioneer3.navigation.connect import connect_async
from pioneer3.runtime.driven import Driven


def connects(
    fleet: Fleet, ros1: Connect, ros2: Connect, *, max_speed: float | None = None
) -> Connect:
    """Return the function that connects to a robot: over ROS if its node has it, or at its port.

    Args:
        fleet: Of the robots.
        ros1: Connects over ROS 1.
        ros2: Connects over ROS 2.
        max_speed: Keep below this at ports [m/s].
    """

    def connect(robot: Robot) -> AbstractAsyncContextManager[Driven]:
        match robot.ros:
            case "1":
                return ros1(robot)
            case "2":
                return ros2(robot)
        port = port_of(fleet, robot.name)
        return connect_async(port, model=given_model(fleet, robot), max_speed=max_speed)

    return connect
