"""A simulated laser without its connections: power, settings, calendar, scans. No I/O.

Rules:

1. The mirror turns as soon as there is power; it is up to speed after `spin_up`.
2. Settings are kept while there is power. A power cycle brings back those that mEEwriteall stored.

Facts: cola.md 2, 3, 4, 6.2.
"""

from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from datetime import UTC, datetime, timedelta
from math import floor, radians
from typing import Final

from pioneer3.errors import ConfigError
from pioneer3.lasers.cola.clock import WRAP_US
from pioneer3.lasers.cola.configuration import (
    DataConfig,
    Error,
    LaserSettings,
    Measuring,
    OutputRange,
    ScanConfig,
    ScanConfigCode,
)
from pioneer3.lasers.cola.families import (
    FRONT_TICK,
    FULL_TURN_TICK,
    delivered,
    exact_step,
    family_of,
)
from pioneer3.lasers.cola.scan import Moment, Position, ScanData, encode
from pioneer3.lasers.cola.sweeps import LAST_ECHO, scan_data
from pioneer3.lasers.cola.wire import U16, hex_word, text_words
from pioneer3.lasers.device import MirrorTurn, Sweep
from pioneer3.models.lasers import LaserModel

FIRMWARE: Final = "V1.36-21.10.2010"
PLACE: Final = "not defined"
"""LocationName at delivery."""
CALENDAR_BEGIN: Final = datetime(2006, 1, 1, tzinfo=UTC)
"""Date of a laser that nobody has told the date."""
YEARS: Final = range(1970, 2100)
"""That the calendar can be set to."""
FRESH_TURNS: Final = 2
"""A request for the last scan gets it if it is no older than this many turns."""
_ALMOST: Final = 1e-3


class RefusedError(Exception):
    """A request is answered with sFA and this number."""

    def __init__(self, number: Error) -> None:
        super().__init__(number)
        self.number = number


class ColaUnit:
    """One laser, which has run for long until :meth:`switch_on` is called.

    It measures `spin_up` after power-on [s]: then its mirror is `up` to speed, at `ready_at` [s].
    `status` is that of LMDscandata: (0, 2) when the front screen is dirty. Settings that are not
    possible raise :exc:`RefusedError`. Raises ConfigError if the model does not speak CoLa-A.
    """

    def __init__(self, model: LaserModel, *, spin_up: float, serial: int) -> None:
        family = family_of(model.product)
        if family is None:
            raise ConfigError(f"{model.name} does not speak CoLa-A")
        self.status = (0, 0)
        self._model, self._family = model, family
        self._spin_up, self._serial = spin_up, serial
        scan = delivered(model, family)
        whole = OutputRange(
            step_tick=scan.step_tick, first_tick=scan.first_tick, last_tick=scan.last_tick
        )
        self.settings = self._stored = LaserSettings(scan=scan, output=whole)
        self._power_ups = -1
        self.switch_on(0.0)
        self.up, self.ready_at = True, 0.0

    def switch_on(self, now: float) -> None:
        """Begin as after a power cycle: unstored settings are forgotten."""
        self.settings = self._stored
        self._on_at, self.ready_at = now, now + self._spin_up
        self.up = self._spin_up <= 0
        self._measuring = True
        self._power_ups += 1
        self._telegrams = self._scans = 0
        self._date, self._date_at = CALENDAR_BEGIN, now
        self._latest: tuple[float, str] | None = None

    def tick(self, now: float) -> None:
        """Act on the passing of time."""
        self.up = self.up or now >= self.ready_at

    @property
    def state(self) -> Measuring:
        """The answer to STlms."""
        if not self.up:
            return Measuring.ROTATED
        return Measuring.MEASURING if self._measuring else Measuring.READY

    @property
    def ident(self) -> str:
        """Product and version with their lengths, the answer to sRI0."""
        return f"{text_words(self._model.product)} {text_words(FIRMWARE)}"

    def turn(self) -> MirrorTurn | None:
        """Return the next turn of the mirror, `None` while nothing is measured."""
        if self.state is not Measuring.MEASURING:
            return None
        scan, output = self.settings.scan, self.settings.output
        first = max(scan.first_tick, output.first_tick)
        last = min(scan.last_tick, output.last_tick)
        step = exact_step(scan.step_tick)
        count = floor((last - first) / step + _ALMOST) + 1
        if count < 1:
            return None
        period = 100 / scan.frequency_chz
        return MirrorTurn(
            first=radians((first - FRONT_TICK) / 1e4),
            step=radians(step / 1e4),
            count=count,
            beam_time=period * step / FULL_TURN_TICK,
            period=period,
        )

    def measured(self, sweep: Sweep, now: float) -> str | None:
        """Return the words of a scan, `None` if it is not one that is sent."""
        if self.state is not Measuring.MEASURING:
            return None
        self._scans = (self._scans + 1) & U16
        if self._scans % self.settings.data.interval:
            return None
        self._telegrams = (self._telegrams + 1) & U16
        words = encode(self._scan_data(sweep, now))
        self._latest = now, words
        return words

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
            "ODpwrc": hex_word(self._power_ups),
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
        """Change frequency, step and area, if possible; return the code."""
        code = self._family.check(scan)
        if not self._family.adjustable and scan != self.settings.scan:
            code = code or ScanConfigCode.OTHER
        if code is ScanConfigCode.OK:
            self.settings = replace(self.settings, scan=scan)
            self._latest = None
        return code

    def set_output(self, output: OutputRange) -> None:
        """Change the part of the scan that is sent, within the field."""
        if not self._family.holds(output.first_tick, output.last_tick):
            raise RefusedError(Error.VALUE_NOT_ALLOWED)
        self.settings = replace(self.settings, output=output)
        self._latest = None

    def set_data(self, data: DataConfig) -> None:
        """Change the content of scans, which must have ranges, and be sent at all."""
        possible = (1 << self._family.echoes) - 1
        if not data.interval or not data.echoes & possible:
            raise RefusedError(Error.VALUE_NOT_ALLOWED)
        self.settings = replace(self.settings, data=data)
        self._latest = None

    def set_echo_filter(self, echo_filter: int) -> None:
        """Choose the echoes that are sent."""
        if echo_filter > LAST_ECHO:
            raise RefusedError(Error.VALUE_NOT_ALLOWED)
        self.settings = replace(self.settings, echo_filter=echo_filter)
        self._latest = None

    def set_date(self, numbers: Sequence[int], micros: int, now: float) -> bool:
        """Set the calendar to year, month, day, hour, minute, second; tell whether they exist."""
        year, month, day, hour, minute, second = numbers
        if year not in YEARS:
            return False
        try:
            self._date = datetime(year, month, day, hour, minute, second, micros, tzinfo=UTC)
        except ValueError:
            return False
        self._date_at = now
        return True

    def _calendar(self, now: float) -> datetime:
        return self._date + timedelta(seconds=now - self._date_at)

    def _scan_data(self, sweep: Sweep, now: float) -> ScanData:
        config, date = self.settings.data, self._calendar(now)
        moment = {field.name: getattr(date, field.name) for field in fields(Moment)}
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
            moment=Moment(**moment) if config.moment else None,
        )

    def _micros(self, at: float) -> int:
        return round((at - self._on_at) * 1e6) % WRAP_US
