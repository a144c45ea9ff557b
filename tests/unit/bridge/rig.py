"""A relay between fake ports and a real device, in time that the test moves."""

from msgspec.structs import replace

from pioneer3.arcos import commands, reports
from pioneer3.arcos.commands import Command
from pioneer3.arcos.device import Commanded, Device, SessionClosed
from pioneer3.arcos.host_events import Timing
from pioneer3.arcos.packet import PacketReader, encode
from pioneer3.arcos.reports import Sip
from pioneer3.bridge.client import BridgeClient
from pioneer3.bridge.relay import Relay
from pioneer3.bridge.robot_side import RobotSideState
from pioneer3.state import Identity
from tests.support import frame

STEP = 0.05
IDENTITY = Identity(name="Odd_Name", family="Pioneer", model="p3dx-sh")


class FakePort:
    """The connection of a host.

    Attributes:
        received: All that the bridge sent.
        closed: Whether the bridge has closed it.
    """

    def __init__(self, name: str, *, gives_way: bool = False) -> None:
        self.name, self.gives_way = name, gives_way
        self.received = b""
        self.closed = False

    def send(self, data: bytes) -> None:
        assert not self.closed
        self.received += data

    def close(self) -> None:
        self.closed = True


class Rig:
    """A relay, a robot, and hosts.

    Attributes:
        commands: What the robot has been commanded, in order.
        speed_mm: Of both wheels, as the robot reports it [mm/s].
        motors: Whether it reports that they have power.
        reporting: Whether it sends reports.
        brakes: Whether it obeys a STOP.
        told: What the relay said for people.
    """

    def __init__(self, expiry: float = 0.5, silence: float = 1.5) -> None:
        self.now = 100.0
        self.told: list[str] = []
        self.relay = Relay(
            expiry=expiry, silence=silence, timing=Timing(listen=0.1), say=self.told.append
        )
        self.device = Device(IDENTITY, watchdog=0)
        self.commands: list[Command] = []
        self.speed_mm = 0
        self.motors = False
        self.reporting = self.brakes = True

    def host(self, name: str, *, gives_way: bool = False) -> tuple[FakePort, BridgeClient]:
        """Return a host that has connected."""
        port = FakePort(name, gives_way=gives_way)
        client = self.relay.join(port, self.now)
        assert client is not None
        return port, client

    def open_host(self, name: str, *, gives_way: bool = False) -> tuple[FakePort, BridgeClient]:
        """Return a host with an open session."""
        port, client = self.host(name, gives_way=gives_way)
        for number in (0, 1, 2):
            self.send(client, encode(bytes([number])))
        self.wait(0.5)
        self.send(client, frame(commands.Open()))
        return port, client

    def send(self, client: BridgeClient, data: bytes) -> None:
        """Let a host send bytes."""
        self.relay.receive(client, data, self.now)
        self.exchange()

    def say(self, client: BridgeClient, *said: Command) -> None:
        """Let a host send commands."""
        self.send(client, b"".join(map(frame, said)))

    def wait(self, seconds: float) -> None:
        """Let time pass; the robot reports twenty times a second."""
        for _ in range(round(seconds / STEP)):
            self.now += STEP
            if self.reporting:
                self.device.send(self._report())
            self.relay.tick(self.now)
            self.exchange()

    def since(self, count: int) -> list[Command]:
        """Return the commands after the first `count`."""
        return self.commands[count:]

    def exchange(self) -> None:
        """Pass bytes between the relay and the robot, and open and close the link."""
        relay = self.relay
        while True:
            if relay.wanted:
                relay.robot.begin(self.now)
            data = relay.robot.outgoing()
            for event in self.device.receive(data, self.now) if data else ():
                match event:
                    case Commanded(command):
                        self._obey(command)
                    case SessionClosed():
                        self.commands.append(commands.Close())
            if answer := self.device.outgoing():
                relay.robot_sent(answer, self.now)
            elif relay.robot.state is RobotSideState.CLOSED:
                relay.link_closed()
            elif not data and not relay.wanted:
                return

    def _obey(self, command: Command) -> None:
        self.commands.append(command)
        match command:
            case commands.Vel(speed=speed):
                self.speed_mm = round(speed * 1000)
            case commands.Stop() if self.brakes:
                self.speed_mm = 0
            case commands.Enable(on=on):
                self.motors = on
            case commands.RequestConfig():
                self.device.send(reports.from_payload(CONFIG))

    def _report(self) -> Sip:
        report = reports.from_payload(SIP)
        assert isinstance(report, Sip)
        return replace(
            report,
            left_speed_raw=self.speed_mm,
            right_speed_raw=self.speed_mm,
            flags=type(report.flags)(int(self.motors)),
        )


def payloads(data: bytes) -> list[bytes]:
    """Return the payloads in the bytes that a host got."""
    return PacketReader().feed(data)


SIP = bytes.fromhex("326e00c8000000000000000000820000000001000000")
CONFIG = bytes.fromhex("2050696f6e65657200703361740053494d00000f270f270f270f279001414d524953696d00")
