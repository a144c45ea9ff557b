"""A session that probes the device at the end of a link: handshake and listening, no motion.

It sends SYNC, OPEN, STOP, ENABLE 0, CONFIG, SONAR 1, PULSE and CLOSE, and to a device that is no
robot the questions for a laser's type. None of that changes a setting that lasts.
"""

import asyncio
from collections import defaultdict
from contextlib import suppress
from typing import Final

from pioneer3.arcos import commands, reports
from pioneer3.arcos.host import Host
from pioneer3.arcos.host_events import (
    Configured,
    Event,
    Lost,
    Opened,
    ReportReceived,
    SpeedWanted,
    Timing,
)
from pioneer3.arcos.packet import PacketReader
from pioneer3.arcos.reports import Config, Sip
from pioneer3.doctor.lasers import laser_on
from pioneer3.doctor.recognition import DeviceKind, OtherDevice, recognise
from pioneer3.errors import LinkError
from pioneer3.links import Link
from pioneer3.models import GivenModel
from pioneer3.robot.limits import limits_for
from pioneer3.robot.session import model_of
from pioneer3.robot.supervisor import RobotInfo
from pioneer3.state import Identity

QUICK: Final = Timing(retry=0.25, give_up=3.5)
"""Once over all serial speeds."""
THOROUGH: Final = Timing(retry=0.3, give_up=8.5)
"""Twice over all serial speeds."""
CLOSE_TIMEOUT: Final = 0.5
CERTAIN: Final = {DeviceKind.LASER, DeviceKind.ECHO, DeviceKind.PACKETS}
MAX_RECEIVED: Final = 4096


class ProbeSession:
    """The facts that one session finds about the device at the end of a link.

    A robot that answered has an `identity` and, on links with a speed, the `speed` at which it did
    [baud]; `streaming`: it was still serving an earlier session. `config_settled`: it sent CONFIG,
    or the time for that has passed. `config_trusted` is false where the checksum was wrong, but
    twice the same. `sips` are the information packets with the time of arrival [s]; `failure` is
    the reason that there is no session, and the far end `closed` the link.
    """

    def __init__(self, link: Link, timing: Timing = THOROUGH, *, model: GivenModel = None) -> None:
        self.identity: Identity | None = None
        self.speed: int | None = None
        self.streaming = False
        self.config: Config | None = None
        self.config_settled = False
        self.config_trusted = True
        self.sips: list[tuple[float, Sip]] = []
        self.failure: str | None = None
        self.closed = False
        self._link = link
        self._model = model
        self._clock = asyncio.get_running_loop().time
        self._host = Host(self._clock(), link.speeds, timing, round_trip=link.round_trip)
        self._early_reader = PacketReader()
        self._heard: defaultdict[int | None, bytearray] = defaultdict(bytearray)
        self._sent = bytearray()

    @property
    def is_over(self) -> bool:
        """Whether nothing more can come."""
        return self.closed or self.failure is not None

    @property
    def reader(self) -> PacketReader:
        """Counts the frames of the session."""
        return self._host.reader

    @property
    def heard_at(self) -> tuple[int | None, ...]:
        """The speeds at which bytes were received before the session."""
        return tuple(speed for speed, data in self._heard.items() if data)

    @property
    def info(self) -> RobotInfo | None:
        """Description of the robot as the driver has it; `None` before its identity is known."""
        if self.identity is None:
            return None
        model = model_of(self.identity, self.config, self._model)
        return RobotInfo(
            identity=self.identity,
            model=model,
            limits=limits_for(model, self.config),
            config=self.config,
            url=self._link.url,
            speed=self.speed,
        )

    async def handshake(self) -> bool:
        """Do the handshake and wait for CONFIG; return whether this is a robot."""
        while not (self.is_over or self.config_settled):
            await self._step(float("inf"))
        return self.identity is not None

    async def listen(self, seconds: float) -> None:
        """Keep the session open for `seconds`."""
        end = self._clock() + seconds
        while not self.is_over and self._clock() < end:
            await self._step(end)

    async def other_device(self) -> OtherDevice | None:
        """Return the device that does not answer as a robot; `None` when nothing was received.

        A device whose bytes are not those of an echo or a robot is asked as a laser.
        """
        said = [recognise(bytes(data), bytes(self._sent)) for data in self._heard.values()]
        known = [who for who in said if who is not None]
        certain = next((who for who in known if who.kind in CERTAIN), None)
        if (certain is None or certain.kind is DeviceKind.LASER) and not self.closed:
            laser = await laser_on(self._link)
            certain = OtherDevice(DeviceKind.LASER, laser.name) if laser else certain
        return certain or next(iter(known), None)

    async def close(self) -> None:
        """Stop the robot and end the session; close the link."""
        self._host.leave(self._clock())
        with suppress(LinkError, TimeoutError):
            async with asyncio.timeout(CLOSE_TIMEOUT):
                await self._link.write(self._host.outgoing())
        await self._link.close()

    async def _step(self, end: float) -> None:
        """Send the due bytes, then receive until `end` or the host's next deadline."""
        try:
            now = self._clock()
            for event in self._host.tick(now):
                await self._handle(event, now)
            if data := self._host.outgoing():
                self._sent += data[: MAX_RECEIVED - len(self._sent)]
                await self._link.write(data)
            if self.failure is None:
                await self._receive(min(self._host.deadline, end))
        except LinkError as error:
            self.closed, self.failure = True, str(error)

    async def _receive(self, until: float) -> None:
        with suppress(TimeoutError):
            async with asyncio.timeout_at(until):
                data = await self._link.read()
                now = self._clock()
                self.closed = not data
                if self.identity is None:
                    self._keep_early_bytes(data, now)
                for event in self._host.receive(data, now):
                    await self._handle(event, now)

    def _keep_early_bytes(self, data: bytes, now: float) -> None:
        """Keep bytes from before the session: of another device or an earlier session."""
        heard = self._heard[self._host.speed]
        heard += data[: MAX_RECEIVED - len(heard)]
        payloads = self._early_reader.feed(data, now)
        self.streaming |= any(isinstance(reports.from_payload(p), Sip) for p in payloads)

    async def _handle(self, event: Event, now: float) -> None:
        match event:
            case SpeedWanted(baud):
                await self._link.set_speed(baud)
            case Opened(identity):
                self.identity, self.speed = identity, self._host.speed
                self._host.send(commands.Sonar(on=True), now)
            case Configured(config, trusted):
                self.config, self.config_trusted, self.config_settled = config, trusted, True
            case ReportReceived(Sip() as sip):
                self.sips.append((now, sip))
            case Lost(reason):
                self.failure = reason
