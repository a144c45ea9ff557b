"""A simulated robot whose host speaks and listens step by step."""

from pioneer3.arcos import commands, reports
from pioneer3.arcos.commands import Command
from pioneer3.arcos.packet import PacketReader, encode
from pioneer3.arcos.reports import Report, Sip
from pioneer3.maps import LineMap
from pioneer3.models import load_model
from pioneer3.sim.body import Body
from pioneer3.sim.equipment import Equipment
from pioneer3.sim.firmware import Firmware
from pioneer3.sim.realism import Realism
from pioneer3.sim.world import World
from pioneer3.sim.worldfile import ClientMaps
from tests.support import frame

SYNCS = b"".join(encode(bytes([number])) for number in (0, 1, 2))
ON = commands.Enable(on=True)


class Touchy(Body):
    """A robot whose bumpers are pressed by hand.

    Attributes:
        pressed: In front and behind, as bits; `None` leaves it to the world.
    """

    pressed: tuple[int, int] | None = None

    @property
    def front_bumpers(self) -> int:
        return self.pressed[0] if self.pressed else super().front_bumpers

    @property
    def rear_bumpers(self) -> int:
        return self.pressed[1] if self.pressed else super().rear_bumpers


class Bench:
    """A robot whose host speaks and listens step by step."""

    def __init__(
        self,
        line_map: LineMap | None = None,
        model: str = "p3at-sh",
        equipment: Equipment | None = None,
        client_maps: ClientMaps | None = None,
        realism: Realism | None = None,
    ) -> None:
        self.body = Touchy(load_model(model))
        self.world = World(line_map, [self.body], realism=realism)
        self.firmware = Firmware(
            self.world, self.body, equipment=equipment, client_maps=client_maps
        )
        self.now = 0.0
        self.reader = PacketReader()

    def say(self, *said: Command) -> None:
        for command in said:
            self.firmware.receive(frame(command), self.now)

    def open(self) -> "Bench":
        self.firmware.receive(SYNCS, self.now)
        self.say(commands.Open())
        return self

    def wait(self, seconds: float, *, pulse: bool = True) -> list[Report]:
        heard: list[Report] = []
        for _ in range(round(seconds / 0.02)):
            self.now += 0.02
            self.world.step(0.02)
            if pulse:
                self.say(commands.Pulse())
            self.firmware.tick(self.now)
            heard += self.hear()
        return heard

    def hear(self) -> list[Report]:
        payloads = self.reader.feed(self.firmware.device.outgoing(), self.now)
        return [reports.from_payload(payload) for payload in payloads]

    def sip(self) -> Sip:
        """Return the standard report after a cycle."""
        return [report for report in self.wait(0.1) if isinstance(report, Sip)][-1]

    @property
    def speed(self) -> float:
        return self.body.drive.linear.velocity

    @property
    def turn_rate(self) -> float:
        return self.body.drive.angular.velocity
