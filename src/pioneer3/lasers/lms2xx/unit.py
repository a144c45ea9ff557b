"""The settings of a simulated LMS-2xx, and its answers to the requests that read and change them.

Facts: lms2xx.md 1.5 to 1.7.
"""

from struct import unpack
from typing import Final

from pioneer3.lasers.lms2xx import commands
from pioneer3.lasers.lms2xx.blocks import SPEED_CODES, UnitConfig, UnitStatus
from pioneer3.lasers.lms2xx.commands import ANSWER, CommandCode, OperatingMode
from pioneer3.lasers.lms2xx.measuring import AT_POWER_ON, VARIANTS
from pioneer3.models.lasers import LaserModel

DELIVERED_SPEED: Final = 9600
"""Speed after power-on [baud], unless another one is kept."""
TAKEN: Final = bytes((commands.ACCEPTED,))
NOT_TAKEN: Final = bytes((commands.NOT_ACCEPTED,))
MODE_TAKEN: Final = bytes((commands.MODE_ACCEPTED,))


class LmsUnit:
    """The settings of one unit.

    `config`, which has been written so many times, and `power_on_speed` [baud] are in the EEPROM.
    Modes that send a part of the field send `subrange`, its first and last reading from 1; those
    that send means take a `sample` of scans for one telegram. `speed` is that of its line [baud]; a
    new one is the caller's business.
    """

    def __init__(self, model: LaserModel, address: int, speed: int) -> None:
        self.model = model
        self.address = address
        self.config = UnitConfig()
        self.config_writes = 0
        self.power_on_speed = DELIVERED_SPEED
        self.speed = speed
        self.restart()

    def restart(self) -> None:
        """Forget what no EEPROM keeps; the speed is the caller's business."""
        self.mode = OperatingMode.ON_REQUEST
        self.variant = AT_POWER_ON
        self.subrange = (1, self.variant.count)
        self.sample = commands.SAMPLES[0]

    def answer(self, code: int, data: bytes) -> bytes | None:
        """Obey a request; return the body of the answer, or `None` to refuse it."""
        body: bytes | None = None
        match code:
            case CommandCode.MODE:
                body = self._change_mode(data)
            case CommandCode.STATUS:
                body = self._status().to_bytes()
            case CommandCode.ERRORS:
                body = b""
            case CommandCode.TYPE:
                body = self.type_text
            case CommandCode.VARIANT:
                body = self._change_variant(data)
            case CommandCode.CONFIG:
                body = self.config.to_bytes()
            case CommandCode.CONFIGURE if self.mode is OperatingMode.INSTALLATION:
                body = self._configure(data)
            case CommandCode.KEEP_SPEED if self.mode is OperatingMode.INSTALLATION and data in {
                b"\0",
                b"\1",
            }:
                self.power_on_speed = self.speed if data[0] else DELIVERED_SPEED
                body = TAKEN
        return body

    @property
    def type_text(self) -> bytes:
        """Type, number, and version of the program."""
        return self.model.product.encode("ascii")

    def _change_mode(self, data: bytes) -> bytes | None:
        match data[:1], data[1:]:
            case b"\x00", commands.PASSWORD:
                self.mode = OperatingMode.INSTALLATION
            case b"\x00", _:
                return bytes((commands.MODE_WRONG_PASSWORD,))
            case b"\x24" | b"\x25" | b"\x2a", b"":
                self.mode = OperatingMode(data[0])
            case b"\x26", count if len(count) == 1 and count[0] in commands.SAMPLES:
                self.mode, self.sample = OperatingMode.MEAN, count[0]
            case b"\x27", part if len(part) == 4 and self._choose(part):
                self.mode = OperatingMode.SUBRANGE
            case b"\x28", part if (
                len(part) == 5 and part[0] in commands.SAMPLES and self._choose(part[1:])
            ):
                self.mode, self.sample = OperatingMode.MEAN_OF_SUBRANGE, part[0]
            case _, b"" if data and self.speed_after(CommandCode.MODE, data) is not None:
                pass
            case _:
                return None
        return MODE_TAKEN

    def _choose(self, part: bytes) -> bool:
        """Take the first and the last reading of a part of the field; return if there are such."""
        first, last = unpack("<HH", part)
        exists = 1 <= first <= last <= self.variant.count
        if exists:
            self.subrange = (first, last)
        return bool(exists)

    def speed_after(self, code: int, data: bytes) -> int | None:
        """Return the speed that a request asks for [baud], or `None`."""
        baud = commands.SPEED_OF_MODE.get(data[0]) if code == CommandCode.MODE and data else None
        return baud if baud in self.model.speeds else None

    def _status(self) -> UnitStatus:
        return UnitStatus(
            version=self.type_text.rpartition(b";")[2],
            mode=self.mode,
            measuring_mode=self.config.measuring_mode,
            field_deg=self.variant.field_deg,
            step_cdeg=self.variant.step_cdeg,
            speed_code=SPEED_CODES[self.speed],
            keeps_speed=self.power_on_speed != DELIVERED_SPEED,
            address=self.address - ANSWER,
            units=self.config.units,
        )

    def _change_variant(self, data: bytes) -> bytes:
        wanted = next((v for v in VARIANTS if commands.variant_data(v) == data), None)
        if wanted is not None:
            self.variant = wanted
            self.subrange = (1, wanted.count)
        return (NOT_TAKEN if wanted is None else TAKEN) + commands.variant_data(self.variant)

    def _configure(self, data: bytes) -> bytes:
        changed = self.config.overwritten(data)
        if changed is not None:
            self.config = changed
            self.config_writes += 1
        return (NOT_TAKEN if changed is None else TAKEN) + self.config.to_bytes()
