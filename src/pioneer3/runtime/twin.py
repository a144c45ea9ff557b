"""The twin of a robot: a simulated one without errors that obeys the bytes of a host."""

from pioneer3.arcos.device import Commanded, Device, SessionClosed, WatchdogExpired, WatchdogFed
from pioneer3.models import RobotModel
from pioneer3.sim.body import Body
from pioneer3.sim.firmware.steering import steer
from pioneer3.sim.world import World
from pioneer3.state import Identity


class Twin:
    """A robot of a model without errors on an empty plane, which obeys the bytes of a host."""

    def __init__(self, model: RobotModel, now: float) -> None:
        self.body = Body(model)
        self._world = World(robots=[self.body])
        self._device = Device(Identity(name="", family=model.family, model=model.name))
        self._now = now

    def receive(self, data: bytes, now: float) -> None:
        """Obey what the host sends at `now` [s]."""
        self.go_on(now)
        for event in self._device.receive(data, now):
            self._obey(event)
        self._device.outgoing()

    def go_on(self, now: float) -> None:
        """Move until `now` [s]."""
        if now <= self._now:
            return
        for event in self._device.tick(now):
            self._obey(event)
        self._world.step(now - self._now)
        self._now = now

    def _obey(self, event: object) -> None:
        match event:
            case Commanded(command):
                steer(self.body, command)
            case WatchdogExpired():
                self.body.drive.held = True
            case WatchdogFed():
                self.body.drive.held = False
            case SessionClosed():
                self.body.session_ended()
