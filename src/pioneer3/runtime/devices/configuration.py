"""CONFIG, asked for again (arcos.md 5.1, 8.15)."""

from pioneer3.arcos.commands import RequestConfig
from pioneer3.arcos.reports import Config
from pioneer3.robot.supervisor import Supervisor
from pioneer3.runtime.devices.stream import ask


async def ask_configuration(supervisor: Supervisor) -> Config:
    """Return what the firmware is set to at this moment; `supervisor.info` has it from then on.

    Raises:
        DeviceError: the robot does not answer; its model's values are in use then.
        CommandError: no robot is connected.
    """
    return await ask(supervisor, "CONFIG", RequestConfig(), Config)
