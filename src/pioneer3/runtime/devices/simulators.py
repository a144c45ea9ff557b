"""How one knows a simulator (arcos.md 2.6, 13 row 12)."""

from pioneer3.robot.supervisor import Supervisor

NAME, SERIAL = "MobileSim", "SIM"


def is_simulator(supervisor: Supervisor) -> bool:
    """Whether the robot is simulated: by its name, as ARIA knows it, or by its serial number."""
    info = supervisor.info
    if info is None:
        return False
    serial = info.config.serial_number if info.config else ""
    return info.identity.name == NAME or serial == SERIAL
