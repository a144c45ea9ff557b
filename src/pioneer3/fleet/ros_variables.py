"""The variables of ROS 1 that follow from a fleet file: no terminal needs to export them."""

from collections.abc import Mapping
from typing import Final

from pioneer3.fleet.reach import address_towards
from pioneer3.fleet.ros_graph import MASTER_PORT
from pioneer3.fleet.spec import Fleet

MASTER: Final = "ROS_MASTER_URI"
OWN_ADDRESS: Final = ("ROS_IP", "ROS_HOSTNAME")


def master_of(fleet: Fleet) -> str:
    """Return the URI of the fleet's master, which runs at the operator's computer."""
    host = fleet.operator.address or "localhost"
    return f"http://[{host}]:{MASTER_PORT}" if ":" in host else f"http://{host}:{MASTER_PORT}"


def missing_variables(fleet: Fleet, environment: Mapping[str, str]) -> dict[str, str]:
    """Return the variables that programs on this computer need, and `environment` lacks.

    Robots reach a program at the address that it tells the master. This is the one from which this
    computer reaches the robots; its host name may mean another one, or be unknown to them.
    """
    found: dict[str, str] = {}
    robots = [robot for robot in fleet.robots if robot.ros == "1"]
    if not robots:
        return found
    if not environment.get(MASTER):
        found[MASTER] = master_of(fleet)
    if not any(environment.get(name) for name in OWN_ADDRESS):
        address = address_towards(robots[0].address)
        if address:
            found[OWN_ADDRESS[0]] = address
    return found
