"""Settings that both sides of CoLa-A exchange, and the numbers of errors and states (cola.md 2).

Each `parse` raises :exc:`TelegramError` where the words are others.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum
from typing import Final, Self

from pioneer3.lasers.cola.wire import (
    U8,
    U16,
    TelegramError,
    TelegramWords,
    decimal_word,
    hex_word,
    long_word,
)


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


ERRORS: Final[Mapping[int, str]] = {
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


PASSWORDS: Final[Mapping[int, int]] = {
    AccessMode.MAINTENANCE: 0xB21ACE26,
    AccessMode.AUTHORISED: 0xF4724744,
    AccessMode.SERVICE: 0x81BE23AA,
}
"""Hashes of the passwords at delivery."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ScanConfig:
    """LMPscancfg: frequency [1/100 Hz], step and area [1/10000 degree] of the scan.

    90 degrees is straight ahead.
    """

    frequency_chz: int
    step_tick: int
    first_tick: int
    last_tick: int
    sectors: int = 1

    @classmethod
    def parse(cls, words: TelegramWords) -> Self:
        """Return the settings in `words`."""
        config = cls(
            frequency_chz=words.number(),
            sectors=words.number(U16),
            step_tick=words.number(),
            first_tick=words.signed(),
            last_tick=words.signed(),
        )
        words.end()
        return config

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
        """Return the settings in `words`."""
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

    Of `echoes` and `encoders` bit 0 is the first. `wide` remissions have 16 bits instead of 8;
    their `unit` is 0. The blocks from `position` to `moment`, which is date and time, are sent or
    not, and so is every `interval`-th scan alone.
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
        """Return the settings in `words`."""
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

    `echo_filter` is FREchoFilter of the LMS-5xx: 0 first echo, 1 all echoes, 2 last echo.
    """

    scan: ScanConfig
    output: OutputRange
    data: DataConfig = DataConfig()
    echo_filter: int = 0
