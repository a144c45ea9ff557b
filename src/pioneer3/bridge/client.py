"""One host of a bridge: the robot's side of its handshake. No I/O, no clock.

The robot has shaken hands with the bridge; each host gets the same answers, identity included. A
host that asks for the identity before the robot has told it waits for the answer.
"""

from enum import Enum, auto
from typing import Protocol

from pioneer3.arcos.packet import PacketReader, encode


class HostPort(Protocol):
    """The connection of one host, with a name for people; it may give way to another host."""

    name: str
    gives_way: bool

    def send(self, data: bytes) -> None:
        """Send `data` at once or later; a host that takes nothing is closed instead."""

    def close(self) -> None:
        """Close the connection, once the bytes sent have left."""


class ClientPhase(Enum):
    """Progress of a host's session."""

    WAITING = auto()
    SYNCED0 = auto()
    SYNCED1 = auto()
    ASKED = auto()
    """Waits for the identity."""
    READY = auto()
    OPEN = auto()


class BridgeClient:
    """One host; it joined at `joined_at`, and was heard last at `heard_at` [s, monotonic]."""

    def __init__(self, port: HostPort, now: float) -> None:
        self.port = port
        self.phase = ClientPhase.WAITING
        self.joined_at = self.heard_at = now
        self.reader = PacketReader()

    @property
    def is_open(self) -> bool:
        """Whether it gets the robot's reports."""
        return self.phase is ClientPhase.OPEN

    def shake_hands(self, payload: bytes, identity: bytes) -> bool:
        """Answer a packet before OPEN; return whether that opened the session.

        `identity` is the payload of the robot's answer to SYNC2; empty while it is not known.
        """
        match payload[0], self.phase:
            case 0, _:
                self._answer(payload[:1], ClientPhase.SYNCED0)
            case 1, ClientPhase.READY:
                self.phase = ClientPhase.OPEN
                return True
            case 1, ClientPhase.SYNCED0 | ClientPhase.SYNCED1:
                self._answer(payload[:1], ClientPhase.SYNCED1)
            case 2, ClientPhase.SYNCED1 | ClientPhase.ASKED | ClientPhase.READY:
                self.phase = ClientPhase.ASKED
                self.introduce(identity)
        return False

    def introduce(self, identity: bytes) -> None:
        """Send the robot's identity if the host waits for it, and it is known."""
        if identity and self.phase is ClientPhase.ASKED:
            self._answer(identity, ClientPhase.READY)

    def _answer(self, payload: bytes, phase: ClientPhase) -> None:
        self.phase = phase
        self.port.send(encode(payload))
