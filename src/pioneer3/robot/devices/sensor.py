"""Sensors with readings on demand, over all sessions with the robot."""

import asyncio
from collections.abc import AsyncGenerator, Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

from pioneer3.arcos.commands import Command
from pioneer3.arcos.reports import Report
from pioneer3.errors import DeviceError
from pioneer3.robot.devices.presence import Presence
from pioneer3.robot.report_requests import RENEW, ReportRequest
from pioneer3.robot.reports import ArrivalRate
from pioneer3.robot.supervisor import Supervisor

V = TypeVar("V", bound="Stamped")
R = TypeVar("R", bound=Report)

PATIENCE = RENEW + 1.0
"""Longest wait for a first reading [s]: a lost request has been sent again by then."""
ANSWER_PATIENCE = 1.0
TRIES = 3


class Stamped(Protocol):
    """A reading with the time of its arrival."""

    @property
    def stamp(self) -> float:
        """[s, monotonic]."""


@dataclass(frozen=True, slots=True)
class Shown:
    """A value of a reading, for display: the field `name`, with a label of a few words.

    Attributes:
        unit: Unit shown; empty for counts and texts.
        scale: One SI unit of the field in `unit`.
    """

    name: str
    label: str
    unit: str = ""
    scale: float = 1.0
    decimals: int = 0

    def text(self, reading: object) -> str:
        """Return the value of `reading` with its unit; yes or no for a switch."""
        value = getattr(reading, self.name)
        if isinstance(value, bool):
            return "yes" if value else "no"
        if isinstance(value, float):
            value = f"{value * self.scale:z.{self.decimals}f}"
        return f"{value} {self.unit}".strip()


@dataclass(frozen=True, slots=True, kw_only=True)
class SensorKind:
    """A kind of sensor.

    Attributes:
        name: Key of the sensor in messages to the page, which shows the values `shown`.
        title: For a sentence, such as `the compass`.
        reports: The reports that hold a reading, in the order in which they come.
    """

    name: str
    title: str
    request: ReportRequest
    reports: tuple[type[Report], ...]
    shown: tuple[Shown, ...] = ()


class Sensor(Generic[V]):
    """Readings of one device, requested while they are wanted.

    `read` returns the reading in a report received at a time [s], or `None`.

    Attributes:
        latest: The last reading, or `None` before the first one; look at its stamp.
    """

    def __init__(
        self,
        supervisor: Supervisor,
        kind: SensorKind,
        read: Callable[[Report, float], V | None],
    ) -> None:
        self.kind = kind
        self.latest: V | None = None
        self._supervisor = supervisor
        self._read = read
        self._readers = 0
        self._count = 0
        self._rate = ArrivalRate()
        self._stop_reading: Callable[[], None] = lambda: None

    @property
    def presence(self) -> Presence:
        """Whether the robot has the device."""
        if self.latest is not None:
            return Presence(True, f"Readings come from {self.kind.title}.")
        return Presence(None, f"Nothing has come from {self.kind.title} yet.")

    @property
    def rate(self) -> float:
        """Readings in the last second [1/s]."""
        return self._rate.at(asyncio.get_running_loop().time())

    @contextmanager
    def wanted(self) -> Iterator[None]:
        """Request readings and keep :attr:`latest` new during the block."""
        kind = self.kind
        with self._supervisor.requested(kind.title, kind.request):
            if not self._readers:
                self._stop_reading = self._supervisor.reports.hand_to(self._take, *kind.reports)
            self._readers += 1
            try:
                yield
            finally:
                self._readers -= 1
                if not self._readers:
                    self._stop_reading()

    async def values(self) -> AsyncGenerator[V, None]:
        """Yield each reading from now on; the newest when the reader is slow."""
        reports = self._supervisor.reports
        with self.wanted(), reports.subscribe(*self.kind.reports, room=1) as heard:
            seen = self._count
            async for _ in heard:
                if self._count != seen and self.latest is not None:
                    seen = self._count
                    yield self.latest

    async def reading(self, patience: float = PATIENCE) -> V:
        """Return the next reading; DeviceError if none came for `patience` [s]."""
        values = self.values()
        try:
            async with asyncio.timeout(patience):
                return await anext(values)
        except (TimeoutError, StopAsyncIteration):
            raise DeviceError(silence(self._supervisor, self.kind.title, patience)) from None
        finally:
            await values.aclose()

    @property
    def is_wanted(self) -> bool:
        """Whether readings are wanted now."""
        return self._readers > 0

    def change(self, request: ReportRequest) -> None:
        """Use another request until readings are no longer wanted."""
        self._supervisor.change_request(self.kind.title, request)

    def _take(self, report: Report, stamp: float) -> None:
        value = self._read(report, stamp)
        if value is not None:
            self.latest = value
            self._count += 1
            self._rate.add(stamp)


async def ask(
    supervisor: Supervisor,
    what: str,
    command: Command,
    kind: type[R],
    *,
    patience: float = ANSWER_PATIENCE,
) -> R:
    """Send `command`, up to three times, and return the report of class `kind` that answers it.

    Raises:
        DeviceError: no answer came within `patience` [s] of any.
        CommandError: no robot is connected.
    """
    with supervisor.reports.subscribe(kind) as heard:
        answers = aiter(heard)
        for _ in range(TRIES):
            supervisor.send(command)
            try:
                async with asyncio.timeout(patience):
                    return await anext(answers)
            except TimeoutError:
                answers = aiter(heard)
            except StopAsyncIteration:
                break
    raise DeviceError(silence(supervisor, what, TRIES * patience))


def silence(supervisor: Supervisor, what: str, seconds: float) -> str:
    """Return a sentence about `what`, which did not answer for `seconds`."""
    if supervisor.snapshot is None:
        return f"Nothing is known of {what}: no robot is connected."
    return f"No answer from {what} for {seconds:g} s: is it fitted, connected and switched on?"
