"""A simulated laser in a room, with programs at it, in virtual time."""

from collections.abc import Callable
from dataclasses import dataclass, field
from math import inf

from pioneer3.lasers.client import Event, Measured, RawScan, Remarked, ScanSettings, ScansLost
from pioneer3.lasers.cola.client import ColaClient
from pioneer3.lasers.cola.connection import ColaConnection
from pioneer3.lasers.cola.device import ColaDevice
from pioneer3.lasers.cola.wire import ColaTelegramReader, encode
from pioneer3.lasers.device import MirrorTurn, Sweep
from pioneer3.models.lasers import LASERS

MOST_ROUNDS = 100_000
LOGIN = "sMN SetAccessMode 03 F4724744"


def laser(name: str = "lms-111", spin_up: float = 0.0) -> ColaDevice:
    """Return a laser, switched on at time 0 if it takes time to get ready."""
    device = ColaDevice(LASERS[name], spin_up=spin_up)
    if spin_up:
        device.switch_on(0.0)
    return device


def corridor(turn: MirrorTurn) -> list[float]:
    """Return ranges that tell the readings apart; there is nothing at every tenth."""
    return [inf if i % 10 == 9 else 1.0 + i / 500 for i in range(turn.count)]


@dataclass
class Room:
    """Lets the laser measure while time passes, and a client talk to it.

    Attributes:
        now: Virtual time [s].
        client: At the laser, if any.
        deaf: Whether the cable between them is cut.
        ranges: The room as a turn of the mirror sees it.
        instead: Answers of an odd unit by the begin of the request; empty for silence.
    """

    laser: ColaDevice
    client: ColaClient | None = None
    now: float = 0.0
    deaf: bool = False
    ranges: Callable[[MirrorTurn], list[float]] = corridor
    echoes: Callable[[MirrorTurn], list[tuple[float, ...]]] = lambda _: []
    instead: dict[str, str] = field(default_factory=dict)
    connection: ColaConnection = field(init=False)
    events: list[Event] = field(default_factory=list)
    sent: list[str] = field(default_factory=list)
    _turn: tuple[MirrorTurn, float] | None = None

    def __post_init__(self) -> None:
        self.connection = self.laser.connect()

    @property
    def scans(self) -> list[RawScan]:
        """The scans that the client has had."""
        return [event.scan for event in self.events if isinstance(event, Measured)]

    def run(self, seconds: float) -> None:
        """Let time pass."""
        until = self.now + seconds
        for _ in range(MOST_ROUNDS):
            self.talk()
            due = min(until, self._turn_over())
            if self.client is not None:
                due = min(due, self.client.deadline)
            if self.laser.deadline > self.now:  # else bytes wait that nobody fetches
                due = min(due, self.laser.deadline)
            self.now = max(self.now, due)
            self.laser.tick(self.now)
            self._measure()
            if self.client is not None:
                self.events += self.client.tick(self.now)
            if self.now >= until:
                self.talk()
                return
        raise AssertionError("time stands still")

    def talk(self) -> None:
        """Carry bytes to and fro until there are no more."""
        if self.client is None:
            return
        while data := self.client.outgoing():
            self.sent += ColaTelegramReader().feed(data)
            for text in ColaTelegramReader().feed(data):
                self._carry(text)
            self._hear()
        self._hear()

    def _carry(self, text: str) -> None:
        """Take one request to the laser, unless another unit answers in its place."""
        assert self.client is not None
        for begin, answer in self.instead.items():
            if text.startswith(begin):
                if answer:
                    self.events += self.client.receive(encode(answer), self.now)
                return
        if not self.deaf:
            self.connection.receive(encode(text), self.now)

    def _hear(self) -> None:
        assert self.client is not None
        data = self.connection.outgoing(self.now)
        if data and not self.deaf:
            self.events += self.client.receive(data, self.now)

    def _turn_over(self) -> float:
        if self._turn is None and (turn := self.laser.turn) is not None:
            self._turn = turn, self.now + turn.period
        return self._turn[1] if self._turn else inf

    def _measure(self) -> None:
        if self._turn is None or self.now < self._turn[1] - 1e-9:
            return
        turn, over = self._turn
        self._turn = None
        sweep = Sweep(
            turn=turn,
            began=over - turn.period,
            ranges=self.ranges(turn),
            intensities=[0.5] * turn.count,
            echoes=self.echoes(turn),
        )
        self.laser.measured(sweep, self.now)


@dataclass
class Program:
    """A program that sends texts and gets texts, at a laser in a room."""

    room: Room

    def ask(self, text: str) -> str:
        """Return the answer; it must come at once, alone, and in one piece."""
        self.room.connection.receive(encode(text), self.room.now)
        answers = ColaTelegramReader().feed(self.room.connection.outgoing(self.room.now))
        assert len(answers) == 1, answers
        return answers[0]

    def hear(self, seconds: float) -> list[str]:
        """Return the telegrams that come while time passes."""
        heard, until = ColaTelegramReader(), self.room.now + seconds
        texts: list[str] = []
        while self.room.now < until - 1e-9:
            self.room.run(min(0.005, until - self.room.now))
            texts += heard.feed(self.room.connection.outgoing(self.room.now))
        return texts


def program(name: str = "lms-111", spin_up: float = 0.0) -> Program:
    """Return a program at a new laser."""
    return Program(Room(laser(name, spin_up)))


def room(
    name: str = "lms-111", wishes: ScanSettings | None = None, *, spin_up: float = 0.0
) -> Room:
    return Room(laser(name, spin_up), ColaClient(0.0, wishes))


def remarks(at: Room) -> list[str]:
    return [event.text for event in at.events if isinstance(event, Remarked)]


def losses(at: Room) -> list[str]:
    return [event.reason for event in at.events if isinstance(event, ScansLost)]


def writes(at: Room) -> list[str]:
    """Return the requests that change something."""
    return [text for text in at.sent if text[:3] in {"sWN", "sMN"}]
