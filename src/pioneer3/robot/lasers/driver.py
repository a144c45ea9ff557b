"""Keeps one laser connected, whatever happens to it, and hands out its scans."""

import asyncio
import logging
from collections.abc import AsyncGenerator, Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from math import inf, isfinite
from typing import TypeVar

from pioneer3.errors import DeviceError, LinkError, RecordingOverError
from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.lasers.client import (
    AS_DELIVERED,
    Event,
    Identified,
    LaserClient,
    LaserIdentity,
    LineSpeedWanted,
    Measured,
    Patience,
    RawScan,
    Remarked,
    ScanSettings,
    ScansLost,
)
from pioneer3.links import Link, Opener
from pioneer3.links.base import TimedLink
from pioneer3.models.lasers import LaserProtocol
from pioneer3.robot.devices.presence import Presence
from pioneer3.robot.lasers.mounting import Mounting, PoseAt
from pioneer3.robot.lasers.search import ProtocolSearch, client_of
from pioneer3.robot.reports import ArrivalRate
from pioneer3.robot.supervisor import Connection, ConnectionStatus, Feed
from pioneer3.state import Scan

log = logging.getLogger(__name__)
T = TypeVar("T")

OPEN_PATIENCE = 1.5
"""A laser that is not there is looked for again after this [s]."""
RETRY = 0.4
"""Pause before the next attempt [s]."""
CLOSE_PATIENCE = 0.5
WRITE_PATIENCE = 2.0
READING_PATIENCE = 10.0
USUAL = Patience()


@dataclass(frozen=True, slots=True, kw_only=True)
class LaserConfig:
    """A laser of some `name` in scans, frames and messages, and how to use it.

    Its language, the `protocol`, is found out if it is `None`; the offset is added to the times of
    scans [s]. Its link is waited for as long as `open_patience` [s], for ever if that is `None`.
    """

    url: str
    open: Opener
    name: str = "laser"
    protocol: LaserProtocol | None = None
    settings: ScanSettings = AS_DELIVERED
    patience: Patience = USUAL
    open_patience: float | None = OPEN_PATIENCE
    time_offset: float = 0.0


class LaserDriver:
    """One laser; a source of scans like the laser of a simulator.

    `mounting` returns its place on the robot, which is known once the robot is. The `speeds` are
    those of its link [baud], empty where it has none. `latest` is the
    last scan, `None` before any, and `latency` the time from its last reading until it was here
    [s]; `scans` and `losses` count. The `protocol` is `None` until it is known. `scan_taken` is
    called with every scan, also those that slow readers miss.
    """

    def __init__(
        self,
        config: LaserConfig,
        pose_at: PoseAt = lambda time: ORIGIN,
        mounting: Callable[[], Mounting] = Mounting,
    ) -> None:
        self.config = config
        self.status: Feed[ConnectionStatus] = Feed()
        self.latest: Scan | None = None
        self.scan_taken: Callable[[Scan], None] = lambda scan: None
        self.scans = 0
        self.losses = 0
        self._pose_at = pose_at
        self.mounting = mounting
        self.speeds: Sequence[int] = ()
        self.name = config.name
        self.protocol = config.protocol
        self._feed: Feed[Scan] = Feed()
        self._identities: Feed[LaserIdentity] = Feed()
        self._clock = asyncio.get_running_loop().time
        self._rate = ArrivalRate()
        self._failure = ""
        self.latency = 0.0
        self._speed: int | None = None
        self._good_speed: int | None = None

    @property
    def identity(self) -> LaserIdentity | None:
        """As the laser gave it; `None` before."""
        return self._identities.latest

    @property
    def sensor_in_robot(self) -> Pose2:
        """Its pose on the robot [m, rad]."""
        return self.mounting().sensor_in_robot

    @property
    def connected(self) -> bool:
        """Whether scans come."""
        return self.status.latest is not None and (
            self.status.latest.connection is Connection.CONNECTED
        )

    @property
    def presence(self) -> Presence:
        """There is one: it was asked for. The reason tells its state."""
        status = self.status.latest
        return Presence(True, f"{self.title}: {status.message if status else 'not asked yet'}.")

    @property
    def title(self) -> str:
        """Product and port, for people."""
        product = self.identity.product if self.identity else ""
        return f"{product or 'laser'} at {self.config.url}"

    @property
    def lost(self) -> str | None:
        """While no scans come, a few words; else `None`."""
        return None if self.connected else f"the {self.name} is lost"

    @property
    def words(self) -> str:
        """Product, rate and nearest reading while scans come; else why they do not."""
        if not self.connected or self.latest is None:
            return f"{self.name} LOST: {self.presence}"
        nearest = min(filter(isfinite, self.latest.ranges), default=inf)
        near = f"nearest {nearest:.2f} m" if nearest < inf else "nothing in range"
        return f"{self.title}: {self.rate:.0f} scans/s, {near}"

    @property
    def rate(self) -> float:
        """Scans in the last second [1/s]."""
        return self._rate.at(self._clock())

    @contextmanager
    def wanted(self) -> Iterator[None]:
        """Keep :attr:`latest` new during the block; this laser scans all the time."""
        yield

    async def values(self) -> AsyncGenerator[Scan, None]:
        """Yield each scan; the newest when the reader is slow."""
        async for scan in self._feed.values():
            yield scan

    async def reading(self, patience: float = READING_PATIENCE) -> Scan:
        """Return the next scan; DeviceError if none came for `patience` [s]."""
        return await self._next(self._feed, patience)

    async def identified(self, patience: float = READING_PATIENCE) -> LaserIdentity:
        """Return its identity as soon as it is known; DeviceError without it for `patience` [s]."""
        known = self.identity
        return known if known is not None else await self._next(self._identities, patience)

    async def _next(self, feed: Feed[T], patience: float) -> T:
        try:
            async with asyncio.timeout(patience):
                return await anext(feed.values())
        except (TimeoutError, StopAsyncIteration):
            raise DeviceError(f"Nothing for {patience:g} s. {self.presence}") from None

    async def run(self) -> None:
        """Connect, and again after every loss; ends by cancellation, or with a recording."""
        end = "closed"
        try:
            while True:
                after = f" after: {self._failure}" if self._failure else ""
                self._publish(Connection.CONNECTING, f"connecting{after}")
                try:
                    await self._serve_once()
                except RecordingOverError as over:
                    end = str(over)
                    return
                except LinkError as error:
                    self._lose(str(error))
                except Exception as error:  # it must not end the robot beside it
                    log.exception("%s failed", self.config.url)
                    self._lose(f"{self.config.url}: failed: {error!r}")
                await asyncio.sleep(RETRY)
        finally:
            self._publish(Connection.CLOSED, end)
            for feed in (self._feed, self._identities, self.status):
                feed.close()

    async def _serve_once(self) -> None:
        url, patience = self.config.url, self.config.open_patience
        try:
            async with asyncio.timeout(patience):
                link = await self.config.open()
        except TimeoutError:
            raise LinkError(f"{url}: no answer within {patience:g} s") from None
        self.speeds = link.speeds
        client = self._client(link.speeds, link.round_trip)
        try:
            await self._serve(link, client)
        finally:
            client.leave(self._clock())
            with suppress(LinkError, TimeoutError):
                async with asyncio.timeout(CLOSE_PATIENCE):
                    await link.write(client.outgoing())
            await link.close()

    def _client(self, speeds: Sequence[int], round_trip: float) -> LaserClient:
        now, config = self._clock(), self.config
        if self.protocol is not None:
            return client_of(
                self.protocol,
                now,
                speeds,
                config.settings,
                config.patience,
                round_trip=round_trip,
                first_speed=self._good_speed,
            )
        return ProtocolSearch(
            now,
            speeds,
            config.settings,
            config.patience,
            round_trip=round_trip,
            found=self._learn_protocol,
        )

    def _learn_protocol(self, protocol: LaserProtocol) -> None:
        self.protocol = protocol

    async def _serve(self, link: Link, client: LaserClient) -> None:
        """Pass bytes between `link` and `client` until it is lost: LinkError has the reason."""
        timed = link if isinstance(link, TimedLink) else None  # slow to ask
        while True:
            await self._obey(link, client, client.tick(self._clock()))
            data = await self._read(link, client.deadline)
            if data is not None:
                now = timed.read_at if timed else self._clock()
                await self._obey(link, client, client.receive(data, now))

    async def _read(self, link: Link, deadline: float) -> bytes | None:
        """Return the next bytes, or `None` if none come before `deadline`."""
        try:
            async with asyncio.timeout_at(deadline):
                data = await link.read()
        except TimeoutError:
            return None
        if not data:
            raise LinkError(f"{link.url}: the laser closed the connection")
        return data

    async def _obey(self, link: Link, client: LaserClient, events: list[Event]) -> None:
        for event in events:
            match event:
                case Measured(scan):
                    self._take(scan)
                case LineSpeedWanted(baud):
                    self._speed = baud
                    await link.set_speed(baud)
                case Identified(identity):
                    self._identities.publish(identity)
                    log.info("%s: %s", self.config.url, identity)
                case Remarked(text):
                    log.info("%s: %s", self.config.url, text)
                    if not self.connected:
                        self._publish(Connection.CONNECTING, text)
                case ScansLost(reason):
                    raise LinkError(f"{self.config.url}: {reason}")
        await self._write(link, client.outgoing())

    async def _write(self, link: Link, data: bytes) -> None:
        if not data:
            return
        try:
            async with asyncio.timeout(WRITE_PATIENCE):
                await link.write(data)
        except TimeoutError:
            raise LinkError(f"{link.url}: the laser does not take what is sent to it") from None

    def _take(self, raw: RawScan) -> None:
        self.scans += 1
        now = self._clock()
        self.latency = now - raw.stamp - raw.beam_time * max(0, len(raw.ranges) - 1)
        mounting = self.mounting()
        if (offset := self.config.time_offset - (mounting.delay or 0.0)) != 0.0:
            raw = replace(raw, stamp=raw.stamp + offset)
        scan = mounting.scan(raw, self.scans, self.config.name, self._pose_at)
        if not self.connected:
            self._failure, self._good_speed = "", self._speed
            self._publish(Connection.CONNECTED, f"{len(scan.ranges)} readings a scan")
        self.latest = scan
        self._rate.add(now)
        self.scan_taken(scan)
        self._feed.publish(scan)

    def _lose(self, reason: str) -> None:
        self.losses += self.connected
        self._failure = reason
        self._publish(Connection.LOST, reason)

    def _publish(self, connection: Connection, message: str) -> None:
        latest = self.status.latest
        status = ConnectionStatus(connection, message)
        if latest != status and connection is not Connection.CONNECTING:
            log.info("%s: %s: %s", self.config.url, connection, message)
        self.status.publish(status)
