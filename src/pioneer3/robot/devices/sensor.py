"""Sensors with readings on demand, over all sessions with the robot."""

import asyncio
from collections import deque
from collections.abc import AsyncGenerator, Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

from pioneer3.arcos.commands import Command
from pioneer3.arcos.reports import Report
from pioneer3.errors import DeviceError
from pioneer3.robot.devices.presence import Presence
from pioneer3.robot.report_requests import RENEW, ReportRequest
from pioneer3.robot.supervisor import Supervisor

V = TypeVar("V", bound="Stamped")
R = TypeVar("R", bound=Report)

PATIENCE = RENEW + 1.0
"""Longest wait for a first reading [s]: a lost request has been sent again by then."""
ANSWER_PATIENCE = 1.0
TRIES = 3
RATE_WINDOW = 1.0


class Stamped(Protocol):
    """A reading with the time of its arrival."""

    @property
    def stamp(self) -> float:
        """[s, monotonic]."""


@dataclass(frozen=True, slots=True)
class Shown:
    """A value of a reading, for display.

    Attributes:
        name: Field of the reading.
        label: In a few words.
        unit: Unit shown; empty for counts and texts.
        scale: One SI unit of the field in `unit`.
        decimals: Digits after the point.
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
        name: Key of the sensor in :attr:`Devices.sensors` and in messages to the page.
        title: For a sentence, such as `the compass`.
        request: For its reports.
        reports: The reports that hold a reading, in the order in which they come.
        shown: The values that the page shows.
    """

    name: str
    title: str
    request: ReportRequest
    reports: tuple[type[Report], ...]
    shown: tuple[Shown, ...] = ()


class Sensor(Generic[V]):
    """Readings of one device, requested while they are wanted.

    Args:
        read: Returns the reading in a report received at a time [s], or `None`.

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
        self._stamps: deque[float] = deque()
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
        self._forget(asyncio.get_running_loop().time())
        return len(self._stamps) / RATE_WINDOW

    def wanted(self) -> AbstractContextManager[None]:
        """Request readings and keep :attr:`latest` new during the block."""
        return self._asked()

    @contextmanager
    def _asked(self) -> Iterator[None]:
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

    def values(self) -> AsyncGenerator[V, None]:
        """Yield each reading from now on; the newest when the reader is slow."""
        return self._each()

    async def _each(self) -> AsyncGenerator[V, None]:
        reports = self._supervisor.reports
        with self.wanted(), reports.subscribe(*self.kind.reports, room=1) as heard:
            seen = self._count
            async for _ in heard:
                if self._count != seen and self.latest is not None:
                    seen = self._count
                    yield self.latest

    async def reading(self, patience: float = PATIENCE) -> V:
        """Return the next reading.

        Raises:
            DeviceError: none came for `patience` [s].
        """
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
            self._stamps.append(stamp)
            self._forget(stamp)

    def _forget(self, now: float) -> None:
        while self._stamps and now - self._stamps[0] >= RATE_WINDOW:
            self._stamps.popleft()


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
