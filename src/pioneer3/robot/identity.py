"""Distinguishes simulators from robots."""

from typing import Literal

from pioneer3.robot.supervisor import RobotInfo

SIMULATOR_NAMES = {"mobilesim", "amrisim", "arsim"}
SIMULATOR_SERIAL = "SIM"
SIMULATOR_SERIALS = {SIMULATOR_SERIAL, "SIMULATED"}
"""The second one is that of our simulator where ARIA shall take it for a robot."""


def is_simulator(info: RobotInfo | None) -> bool:
    """Return whether the robot says that it is simulated (protocol.md 2.6; facts.md 13, row 12)."""
    if info is None:
        return False
    serial = info.config.serial_number if info.config else ""
    return info.identity.name.lower() in SIMULATOR_NAMES or serial in SIMULATOR_SERIALS


def kind(info: RobotInfo) -> Literal["SIMULATOR", "ROBOT"]:
    """Return `SIMULATOR` or `ROBOT`, in capitals."""
    return "SIMULATOR" if is_simulator(info) else "ROBOT"
