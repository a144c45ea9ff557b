"""One robot of a running simulation."""

from dataclasses import dataclass
from typing import Self

from pioneer3.models import RobotModel
from pioneer3.runtime.simulation.address import url_of
from pioneer3.sim.body import Body
from pioneer3.sim.firmware import Firmware
from pioneer3.sim.server.port import RobotPort


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SimulatedRobot:
    """One robot of a running simulation.

    Attributes:
        name: What people call it; on the wire every simulated robot is `MobileSim`.
        body: The robot in the world.
        firmware: Its controller.
        port: Where its host is, and what is wrong with the cable.
        url: What a host connects to.
        pty: Its serial port, or `None`.
    """

    name: str
    body: Body
    firmware: Firmware
    port: RobotPort
    url: str
    pty: str | None = None

    @classmethod
    def at(cls, port: RobotPort, name: str, pty: str | None = None) -> Self:
        """Return the robot behind `port`, which listens."""
        firmware, address = port.firmware, port.address
        assert address is not None
        return cls(
            name=name,
            body=firmware.body,
            firmware=firmware,
            port=port,
            url=url_of(*address),
            pty=pty,
        )

    @property
    def model(self) -> RobotModel:
        """Its type."""
        return self.body.model
