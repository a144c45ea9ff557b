"""A simulated LMS-1xx, LMS-5xx or TiM. No I/O.

::

    STARTING ──spin_up──► MEASURING ◄──LMCstartmeas, Run / LMCstopmeas──► STOPPED

Rules:

1. The mirror turns as soon as there is power; it is up to speed after `spin_up`. All connections
   share it and the settings.
2. Settings are kept while there is power. A power cycle brings back those that mEEwriteall stored,
   and ends all connections.
3. :attr:`ColaDevice.turn` is `None` while nobody waits for a scan. A request for the last scan is
   answered with the next one where the last one is old.
4. A scan goes to all subscribers, if its number fits the interval of LMDscandatacfg.

Facts: cola.md 2, 3, 4, 6.2.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from math import floor, inf, radians
from typing import Final

from pioneer3.errors import ConfigError
from pioneer3.lasers.cola.clock import WRAP_US
from pioneer3.lasers.cola.configuration import (
    U16,
    DataConfig,
    Error,
    Measuring,
    OutputRange,
    ScanConfig,
    ScanConfigCode,
    Settings,
)
from pioneer3.lasers.cola.connection import ColaConnection, RefusedError
from pioneer3.lasers.cola.families import FULL_TURN_TICK, delivered, exact_step, family_of
from pioneer3.lasers.cola.scan import Moment, Position, ScanData, encode
from pioneer3.lasers.cola.sweeps import LAST_ECHO, scan_data
from pioneer3.lasers.cola.wire import hex_word, text_words
from pioneer3.lasers.cola.wishes import FRONT_TICK
from pioneer3.lasers.device import Sweep, Turn
from pioneer3.models.lasers import LaserModel

FIRMWARE: Final = "V1.36-21.10.2010"
PLACE: Final = "not defined"
"""LocationName at delivery."""
DEFAULT_SERIAL: Final = 10_010_001
CALENDAR_BEGIN: Final = datetime(2006, 1, 1, tzinfo=UTC)
"""Date of a laser that nobody has told the date."""
FRESH_TURNS: Final = 2
"""The last scan is given to who asks for it, if it is no older than this many turns."""
_ALMOST: Final = 1e-3


class ColaDevice:
    """One laser.

    Args:
        model: Its type.
        spin_up: From power-on until it measures [s].
        serial: Its serial number.

    Attributes:
        speed: `None`: there is no serial line.
        deadline: When :meth:`tick` has something to do, or bytes may leave [s]; `inf`: never.
        settings: As they are now.
        status: Of LMDscandata: (0, 2) when the front screen is dirty.

    Raises:
        ConfigError: the model does not speak CoLa-A.
    """

    def __init__(
        self, model: LaserModel, *, spin_up: float = 15.0, serial: int = DEFAULT_SERIAL
    ) -> None:
        family = family_of(model.product)
        if family is None:
            raise ConfigError(f"{model.name} does not speak CoLa-A")
        self.speed: int | None = None
        self.deadline = inf
        self.status = (0, 0)
        self._model, self._family = model, family
        self._spin_up, self._serial = spin_up, serial
        scan = delivered(model, family)
        whole = OutputRange(
            step_tick=scan.step_tick, first_tick=scan.first_tick, last_tick=scan.last_tick
        )
        self.settings = self._stored = Settings(scan=scan, output=whole)
        self._connections: list[ColaConnection] = []
        self._switched_on = -1
        self.switch_on(0.0)

    @property
    def turn(self) -> Turn | None:
        """What the mirror does next, or `None` while nobody wants readings."""
        wanted = any(c.subscribed or c.polling for c in self._connections)
        return self._turn() if wanted and self.state is Measuring.MEASURING else None

    @property
    def state(self) -> Measuring:
        """The answer to STlms."""
        if not self._up:
            return Measuring.ROTATED
        return Measuring.MEASURING if self._measuring else Measuring.READY

    @property
    def ident(self) -> str:
        """Product and version with their lengths, the answer to sRI0."""
        return f"{text_words(self._model.product)} {text_words(FIRMWARE)}"

    def connect(self) -> ColaConnection:
        """Return the connection of one more host."""
        connection = ColaConnection(self)
        self._connections.append(connection)
        return connection

    def forget(self, connection: ColaConnection) -> None:
        """Drop a connection that has been closed."""
        if connection in self._connections:
            self._connections.remove(connection)

    def switch_on(self, now: float) -> None:
        """Begin as after a power cycle: what is not stored is forgotten, connections are dead."""
        for connection in self._connections:
            connection.cut()
        self.settings = self._stored
        self._on_at = now
        self._up = self._spin_up <= 0
        self._measuring = True
        self._switched_on += 1
        self._telegrams = self._scans = 0
        self._date = CALENDAR_BEGIN
        self._date_at = now
        self._latest: tuple[float, str] | None = None
        self.plan(now)

    def tick(self, now: float) -> None:
        """Act on the passing of time."""
        if not self._up and now >= self._on_at + self._spin_up:
            self._up = True
        self.plan(now)

    def plan(self, now: float) -> None:
        """Set the deadline anew; connections call this when their output changes."""
        if any(connection.has_output for connection in self._connections):
            self.deadline = now
        else:
            self.deadline = inf if self._up else self._on_at + self._spin_up

    def measured(self, sweep: Sweep, now: float) -> None:
        """Take the readings of a turn that is over."""
        self.tick(now)
        if self.state is not Measuring.MEASURING:
            return
        self._scans = (self._scans + 1) & U16
        if self._scans % self.settings.data.interval == 0:
            self._telegrams = (self._telegrams + 1) & U16
            words = encode(self._scan_data(sweep, now))
            self._latest = now, words
            for connection in self._connections:
                connection.send_scan(words)
        self.plan(now)

    def latest_scan(self, now: float) -> str | None:
        """Return the words of the last scan, `None` if there is none or it is old."""
        if self._latest is None:
            return None
        at, words = self._latest
        turns = FRESH_TURNS * self.settings.data.interval
        fresh = now - at <= turns * 100 / self.settings.scan.frequency_chz
        return words if fresh else None

    def variables(self, now: float) -> Mapping[str, str]:
        """Return the values of all variables that can be read."""
        date = self._calendar(now)
        settings = self.settings
        output = replace(settings.output, step_tick=settings.scan.step_tick)
        hours = (now - self._on_at) / 3600
        return {
            "DeviceIdent": self.ident,
            "SerialNumber": text_words(f"{self._serial:08d}"),
            "FirmwareVersion": text_words(FIRMWARE),
            "LocationName": text_words(PLACE),
            "ODoprh": hex_word(int(hours)),
            "ODpwrc": hex_word(self._switched_on),
            "STlms": f"{self.state:X} 0 {text_words(f'{date:%H:%M:%S}')}"
            f" {text_words(f'{date:%d.%m.%y}')} 0 0 0",
            "SCdevicestate": f"{self.state is Measuring.MEASURING:d}",
            "LMPscancfg": settings.scan.answer(),
            "LMPoutputRange": output.words(),
            "LMDscandatacfg": settings.data.answer(),
            "FREchoFilter": hex_word(settings.echo_filter),
        }

    def measure(self, *, on: bool) -> None:
        """Start or stop measuring; the mirror turns on."""
        self._measuring = on

    def store(self) -> None:
        """Keep the settings over power cycles."""
        self._stored = self.settings

    def set_scan(self, scan: ScanConfig) -> ScanConfigCode:
        """Change what the mirror does, if it can; return the answer."""
        code = self._family.check(scan)
        if not self._family.adjustable and scan != self.settings.scan:
            code = code or ScanConfigCode.OTHER
        if code is ScanConfigCode.OK:
            self.settings = replace(self.settings, scan=scan)
            self._latest = None
        return code

    def set_output(self, output: OutputRange) -> None:
        """Change the part of the scan that is sent.

        Raises:
            RefusedError: it is outside the field.
        """
        if not self._family.holds(output.first_tick, output.last_tick):
            raise RefusedError(Error.VALUE_NOT_ALLOWED)
        self.settings = replace(self.settings, output=output)
        self._latest = None

    def set_data(self, data: DataConfig) -> None:
        """Change the content of scans.

        Raises:
            RefusedError: they would have no ranges, or never be sent.
        """
        possible = (1 << self._family.echoes) - 1
        if not data.interval or not data.echoes & possible:
            raise RefusedError(Error.VALUE_NOT_ALLOWED)
        self.settings = replace(self.settings, data=data)
        self._latest = None

    def set_echo_filter(self, echo_filter: int) -> None:
        """Choose the echoes that are sent.

        Raises:
            RefusedError: there is no such choice.
        """
        if echo_filter > LAST_ECHO:
            raise RefusedError(Error.VALUE_NOT_ALLOWED)
        self.settings = replace(self.settings, echo_filter=echo_filter)
        self._latest = None

    def set_date(self, numbers: Sequence[int], micros: int, now: float) -> bool:
        """Set the calendar to year, month, day, hour, minute, second; tell whether they exist."""
        year, month, day, hour, minute, second = numbers
        try:
            self._date = datetime(year, month, day, hour, minute, second, micros, tzinfo=UTC)
        except ValueError:
            return False
        self._date_at = now
        return True

    def _calendar(self, now: float) -> datetime:
        return self._date + timedelta(seconds=now - self._date_at)

    def _turn(self) -> Turn | None:
        scan, output = self.settings.scan, self.settings.output
        first = max(scan.first_tick, output.first_tick)
        last = min(scan.last_tick, output.last_tick)
        step = exact_step(scan.step_tick)
        count = floor((last - first) / step + _ALMOST) + 1
        if count < 1:
            return None
        period = 100 / scan.frequency_chz
        return Turn(
            first=radians((first - FRONT_TICK) / 1e4),
            step=radians(step / 1e4),
            count=count,
            beam_time=period * step / FULL_TURN_TICK,
            period=period,
        )

    def _scan_data(self, sweep: Sweep, now: float) -> ScanData:
        config = self.settings.data
        return replace(
            scan_data(sweep, self._family, self.settings),
            serial=self._serial,
            status=self.status,
            telegrams=self._telegrams,
            scans=self._scans,
            sensed_us=self._micros(sweep.began),
            sent_us=self._micros(now),
            position=Position() if config.position else None,
            name=PLACE if config.name else None,
            comment=PLACE if config.comment else None,
            moment=_moment(self._calendar(now)) if config.moment else None,
        )

    def _micros(self, at: float) -> int:
        return round((at - self._on_at) * 1e6) % WRAP_US


def _moment(date: datetime) -> Moment:
    return Moment(
        year=date.year,
        month=date.month,
        day=date.day,
        hour=date.hour,
        minute=date.minute,
        second=date.second,
        microsecond=date.microsecond,
    )
