"""Settings that both sides of CoLa-A exchange, and the numbers of errors and states (cola.md 2)."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum
from types import MappingProxyType
from typing import Final, Self

from pioneer3.lasers.cola.wire import (
    TelegramError,
    TelegramWords,
    decimal_word,
    hex_word,
    long_word,
)

U8: Final = 0xFF
U16: Final = 0xFFFF


class Error(IntEnum):
    """Numbers of `sFA`, the answer to a request that is refused (cola.md 1.5)."""

    METHOD_ACCESS_DENIED = 0x1
    UNKNOWN_METHOD = 0x2
    UNKNOWN_VARIABLE = 0x3
    VALUE_NOT_ALLOWED = 0x4
    WRITE_ACCESS_DENIED = 0xA
    UNKNOWN_REQUEST = 0xC
    SERVER_BUSY = 0xD
    UNKNOWN_EVENT = 0xF
    VALUE_OVERFLOW = 0x10
    INVALID_CHARACTER = 0x11


ERRORS: Final[Mapping[int, str]] = MappingProxyType(
    {
        Error.METHOD_ACCESS_DENIED: "this login may not do that",
        Error.UNKNOWN_METHOD: "it has no such method",
        Error.UNKNOWN_VARIABLE: "it has no such variable",
        Error.VALUE_NOT_ALLOWED: "a value is not allowed",
        Error.WRITE_ACCESS_DENIED: "this login may not write that",
        Error.UNKNOWN_REQUEST: "it does not know that kind of request",
        Error.SERVER_BUSY: "it is busy",
        Error.UNKNOWN_EVENT: "it has no such event",
        Error.VALUE_OVERFLOW: "a value is too large",
        Error.INVALID_CHARACTER: "a character is not allowed",
    }
)


class ScanConfigCode(IntEnum):
    """Answers to mLMPsetscancfg (cola.md 2.3)."""

    OK = 0
    FREQUENCY = 1
    STEP = 2
    FREQUENCY_AND_STEP = 3
    AREA = 4
    OTHER = 5


class Measuring(IntEnum):
    """States in the answer to STlms (cola.md 2.6)."""

    UNDEFINED = 0
    INITIALISING = 1
    CONFIGURING = 2
    IDLE = 3
    ROTATED = 4
    PREPARING = 5
    READY = 6
    MEASURING = 7


class AccessMode(IntEnum):
    """Levels of SetAccessMode (cola.md 2.2)."""

    RUN = 0
    MAINTENANCE = 2
    AUTHORISED = 3
    SERVICE = 4


PASSWORDS: Final[Mapping[int, int]] = MappingProxyType(
    {
        AccessMode.MAINTENANCE: 0xB21ACE26,
        AccessMode.AUTHORISED: 0xF4724744,
        AccessMode.SERVICE: 0x81BE23AA,
    }
)
"""Hashes of the passwords at delivery."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ScanConfig:
    """LMPscancfg: frequency, step and area of the scan.

    Attributes:
        frequency_chz: Scans a second [1/100 Hz].
        step_tick: From one reading to the next [1/10000 degree].
        first_tick: Direction of the first one [1/10000 degree]; 90 degrees is straight ahead.
        last_tick: Direction of the last one.
        sectors: Number of sectors, 1.
    """

    frequency_chz: int
    step_tick: int
    first_tick: int
    last_tick: int
    sectors: int = 1

    @classmethod
    def parse(cls, words: TelegramWords) -> Self:
        """Return the settings in `words`.

        Raises:
            TelegramError: they are others.
        """
        frequency, sectors = words.number(), words.number(U16)
        step, first, last = words.number(), words.signed(), words.signed()
        words.end()
        return cls(
            frequency_chz=frequency,
            step_tick=step,
            first_tick=first,
            last_tick=last,
            sectors=sectors,
        )

    def answer(self) -> str:
        """Return the words as a laser sends them."""
        numbers = (self.frequency_chz, self.sectors, self.step_tick)
        return " ".join(map(hex_word, (*numbers, self.first_tick, self.last_tick)))

    def request(self) -> str:
        """Return the words as a host sends them."""
        numbers = (self.frequency_chz, self.sectors, self.step_tick)
        return " ".join(map(decimal_word, (*numbers, self.first_tick, self.last_tick)))


@dataclass(frozen=True, slots=True, kw_only=True)
class OutputRange:
    """LMPoutputRange: the part of the scan that is sent; angles as in :class:`ScanConfig`."""

    step_tick: int
    first_tick: int
    last_tick: int

    @classmethod
    def parse(cls, words: TelegramWords) -> Self:
        """Return the settings in `words`.

        Raises:
            TelegramError: they are others.
        """
        if words.number() != 1:
            raise TelegramError("an output range of more sectors than one")
        step, first, last = words.number(), words.signed(), words.signed()
        words.end()
        return cls(step_tick=step, first_tick=first, last_tick=last)

    def words(self) -> str:
        """Return the words as both sides send them."""
        return " ".join(
            ("1", hex_word(self.step_tick), long_word(self.first_tick), hex_word(self.last_tick))
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class DataConfig:
    """LMDscandatacfg: the content of LMDscandata (cola.md 2.5).

    Attributes:
        echoes: Bit 0 is the first echo, bit 1 the second and so on.
        remission: Whether remissions are sent.
        wide: Whether those have 16 bits instead of 8.
        unit: Of remissions, 0.
        encoders: Bit 0 is the first one.
        position: Whether that block is sent; so for the others.
        name: That of the laser.
        comment: That of the laser.
        moment: Date and time.
        interval: Every n-th scan is sent.
    """

    echoes: int = 1
    remission: bool = False
    wide: bool = False
    unit: int = 0
    encoders: int = 0
    position: bool = False
    name: bool = False
    comment: bool = False
    moment: bool = False
    interval: int = 1

    @classmethod
    def parse(cls, words: TelegramWords) -> Self:
        """Return the settings in `words`.

        Raises:
            TelegramError: they are others.
        """
        config = cls(
            echoes=words.number(U8) | words.number(U8) << 8,
            remission=words.flag(),
            wide=words.flag(),
            unit=words.number(U8),
            encoders=words.number(U8) | words.number(U8) << 8,
            position=words.flag(),
            name=words.flag(),
            comment=words.flag(),
            moment=words.flag(),
            interval=words.number(U16),
        )
        words.end()
        return config

    def answer(self) -> str:
        """Return the words as a laser sends them."""
        return f"{self._flags()} {hex_word(self.interval)}"

    def request(self) -> str:
        """Return the words as a host sends them."""
        return f"{self._flags()} {decimal_word(self.interval)}"

    def _flags(self) -> str:
        return (
            f"{self.echoes & U8:02X} {self.echoes >> 8:02X}"
            f" {self.remission:d} {self.wide:d} {self.unit:X}"
            f" {self.encoders & U8:02X} {self.encoders >> 8:02X}"
            f" {self.position:d} {self.name:d} {self.comment:d} {self.moment:d}"
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class LaserSettings:
    """All settings of a laser that mEEwriteall stores.

    Attributes:
        scan: Frequency, step and area.
        output: The part that is sent.
        data: Content of scans.
        echo_filter: FREchoFilter of the LMS-5xx: 0 first echo, 1 all echoes, 2 last echo.
    """

    scan: ScanConfig
    output: OutputRange
    data: DataConfig = DataConfig()
    echo_filter: int = 0
