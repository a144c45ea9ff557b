"""A laser's device with a tiny protocol, in place of the real ones.

`?` is answered by `!`, `S` starts a stream of scans and `Q` ends it, `F` makes the unit half as
fast on its line, `X` makes it fail. A scan is a line with the time of its first reading [us], the
time at which it was handed in [us], the number of its readings and the middle one [mm].
"""

from dataclasses import dataclass, field
from math import inf, pi

from pioneer3.lasers.device import DeviceConnection, MirrorTurn, Sweep
from pioneer3.models.lasers import LaserModel


@dataclass
class FakeDevice:
    """The laser; all connections get the same scans."""

    model: LaserModel
    deadline: float = inf
    connections: list["FakeConnection"] = field(default_factory=list)
    sweeps: list[Sweep] = field(default_factory=list)
    switched_on: list[float] = field(default_factory=list)

    def __post_init__(self) -> None:
        # a single speed is that of USB, where it does not matter
        self.speed = self.model.speeds[0] if len(self.model.speeds) > 1 else None

    @property
    def turn(self) -> MirrorTurn | None:
        model = self.model
        if not any(connection.streams for connection in self.connections):
            return None
        return MirrorTurn(
            first=model.first,
            step=model.step,
            count=model.count,
            beam_time=model.turn * model.step / (2 * pi),
            period=model.turn,
        )

    def has_heard(self, count: int, what: bytes = b"") -> bool:
        """Whether a host has sent so many bytes, and `what` among them."""
        heard = [connection.heard for connection in self.connections]
        return any(len(data) >= count and what in data for data in heard)

    def connect(self, *, network: bool = False) -> DeviceConnection:
        if self.speed is None or not self.connections:
            self.connections.append(FakeConnection(self))
        elif network:
            self.connections[0].waiting = b""
        return self.connections[-1]

    def measured(self, sweep: Sweep, now: float) -> None:
        self.sweeps.append(sweep)
        middle = sweep.ranges[len(sweep.ranges) // 2]
        shown = "-" if middle == inf else f"{1000 * middle:.0f}"
        line = f"{sweep.began * 1e6:.0f} {now * 1e6:.0f} {len(sweep.ranges)} {shown}\n"
        for connection in self.connections:
            if connection.streams:
                connection.waiting += line.encode()

    def tick(self, now: float) -> None:
        pass

    def switch_on(self, now: float) -> None:
        self.switched_on.append(now)
        self.__post_init__()
        for connection in self.connections:
            connection.streams, connection.waiting = False, b""


class FakeConnection:
    """One host."""

    def __init__(self, device: FakeDevice) -> None:
        self.device = device
        self.streams = False
        self.waiting = b""
        self.heard = b""

    def receive(self, data: bytes, now: float) -> None:
        self.heard += data
        for byte in data:
            match chr(byte):
                case "?":
                    self.waiting += b"!"
                case "S" | "Q" as word:
                    self.streams = word == "S"
                case "F":
                    assert self.device.speed is not None
                    self.device.speed //= 2
                case "X":
                    raise RuntimeError("asked to fail")

    def outgoing(self, now: float) -> bytes:
        data, self.waiting = self.waiting, b""
        return data

    def close(self) -> None:
        if self.device.speed is None:
            self.device.connections.remove(self)
