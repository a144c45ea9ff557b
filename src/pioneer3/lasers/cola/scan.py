"""LMDscandata, the telegram of one scan, as data: decode and encode (cola.md 3).

Decoding refuses every telegram that is not exactly as described there, rather than guess.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Final

from pioneer3.lasers.cola.wire import (
    U8,
    U16,
    TelegramError,
    TelegramWords,
    hex_word,
    long_word,
    real_word,
    text_words,
)

NAME: Final = "LMDscandata"
MAX_CHANNELS: Final = 10
"""Distances and remissions of five echoes."""
MAX_ENCODERS: Final = 3
MAX_COUNT: Final = 4096
"""Readings of a channel; the finest scan of an LMS-5xx has 1141."""
_CONTENT: Final = re.compile(r"(?:DIST|RSSI)[1-5]")
_HEX_DIGITS: Final = b"0123456789ABCDEF"
_from_hex = partial(int, base=16)
_REALS: Final = ("x", "y", "z", "x_rotation", "y_rotation", "z_rotation")
"""Parts of a position before the last."""
_MOMENT: Final = {
    "year": U16,
    "month": 12,
    "day": 31,
    "hour": 23,
    "minute": 59,
    "second": 60,
    "microsecond": 999_999,
}
"""Parts of a date and time, and the most that each is."""


@dataclass(frozen=True, slots=True)
class Encoder:
    """A wheel encoder connected to the laser: position [ticks], speed [ticks/mm]."""

    position: int = 0
    speed: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class ReadingChannel:
    """Values of all readings, before `scale`, [mm] for ranges, and `offset`, added after that.

    `content` is DIST1 to DIST5, ranges of the first to the fifth echo, or RSSI1 to RSSI5,
    remissions. Directions are in [1/10000 degree], 90 degrees is straight ahead.
    """

    content: str
    scale: float = 1.0
    offset: float = 0.0
    first_tick: int
    step_tick: int
    values: tuple[int, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Position:
    """A position that a program has given to the laser; angles in the same unit as it gave them."""

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0
    x_rotation: float = 0.0
    y_rotation: float = 0.0
    z_rotation: float = 0.0
    rotation: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class Moment:
    """Date and time of the laser's calendar."""

    year: int
    month: int
    day: int
    hour: int
    minute: int
    second: int
    microsecond: int


@dataclass(frozen=True, slots=True, kw_only=True)
class InputEvent:
    """A change at an input of the laser, of a `kind` as the laser calls it.

    It came `time_us` after the laser's start, with the encoder at a position [ticks] and the mirror
    in a direction [1/10000 degree].
    """

    kind: str
    encoder: int
    time_us: int
    angle_tick: int


@dataclass(frozen=True, slots=True, kw_only=True)
class ScanData:
    """One LMDscandata telegram.

    `status` is (0, 0) well, (0, 1) error, (0, 2) dirty, (0, 4) too dirty. The counters `telegrams`
    and `scans` have 16 bits, the times since the laser started 32. `layer` is an angle, 0 with one
    layer; `frequency_chz` is in [1/100 Hz], `pulses` in [100 Hz]. There are three encoders at most.
    `channels` have 16 bits, `narrow_channels` 8. All behind them is there if it is switched on,
    `event` if there was one.
    """

    version: int = 1
    device: int = 1
    serial: int = 0
    status: tuple[int, int] = (0, 0)
    telegrams: int = 0
    scans: int = 0
    sensed_us: int = 0
    sent_us: int = 0
    inputs: tuple[int, int] = (0, 0)
    outputs: tuple[int, int] = (0, 0)
    layer: int = 0
    frequency_chz: int
    pulses: int
    encoders: tuple[Encoder, ...] = ()
    channels: tuple[ReadingChannel, ...]
    narrow_channels: tuple[ReadingChannel, ...] = ()
    position: Position | None = None
    name: str | None = None
    comment: str | None = None
    moment: Moment | None = None
    event: InputEvent | None = None

    def channel(self, content: str) -> ReadingChannel | None:
        """Return the channel of this content, of either width."""
        for channel in (*self.channels, *self.narrow_channels):
            if channel.content == content:
                return channel
        return None


def decode(words: TelegramWords) -> ScanData:
    """Return the scan of the words after the name; TelegramError if they are not those of one."""
    scan = ScanData(
        version=words.number(U16),
        device=words.number(U16),
        serial=words.number(),
        status=(words.number(U8), words.number(U8)),
        telegrams=words.number(U16),
        scans=words.number(U16),
        sensed_us=words.number(),
        sent_us=words.number(),
        inputs=(words.number(U8), words.number(U8)),
        outputs=(words.number(U8), words.number(U8)),
        layer=words.number(U16),
        frequency_chz=words.number(),
        pulses=words.number(),
        encoders=tuple(
            Encoder(words.number(), words.number(U16)) for _ in range(words.number(MAX_ENCODERS))
        ),
        channels=_channels(words, U16),
        narrow_channels=_channels(words, U8),
        position=_position(words) if words.flag() else None,
        name=words.text() if words.flag() else None,
        comment=words.text() if words.flag() else None,
        moment=_moment(words) if words.flag() else None,
        event=_event(words) if words.flag() else None,
    )
    words.end()
    _check(scan)
    return scan


def _check(scan: ScanData) -> None:
    """Refuse a scan whose parts contradict each other."""
    channels = scan.channels + scan.narrow_channels
    if not scan.frequency_chz:
        raise TelegramError("the scan frequency is 0")
    if not channels:
        raise TelegramError("there is no channel")
    if len({channel.content for channel in channels}) < len(channels):
        raise TelegramError("a channel comes twice")
    if len({(c.first_tick, c.step_tick, len(c.values)) for c in channels}) > 1:
        raise TelegramError("the channels differ in their angles")


def _channels(words: TelegramWords, most: int) -> tuple[ReadingChannel, ...]:
    return tuple(_channel(words, most) for _ in range(words.number(MAX_CHANNELS)))


def _channel(words: TelegramWords, most: int) -> ReadingChannel:
    content = words.word()
    if not _CONTENT.fullmatch(content):
        raise TelegramError(f"{content[:20]!r} is no known channel")
    scale, offset, first = words.real(), words.real(), words.signed()
    step, count = words.number(U16), words.number(MAX_COUNT)
    if scale <= 0 or not step or not count:
        raise TelegramError("a channel has no scale, no step or no values")
    return ReadingChannel(
        content=content,
        scale=scale,
        offset=offset,
        first_tick=first,
        step_tick=step,
        values=_values(words.block(count), most),
    )


def _values(words: Sequence[str], most: int) -> tuple[int, ...]:
    """Return the numbers; this is the part that decides how long decoding takes."""
    try:
        values = tuple(map(_from_hex, words))
    except ValueError as error:
        raise TelegramError(f"among the values: {error}") from None
    # int() takes more than the protocol has: signs, lower case, underscores
    if "".join(words).encode("latin-1", "replace").translate(None, _HEX_DIGITS):
        raise TelegramError("a value has characters other than hexadecimal digits")
    if max(values) > most:
        raise TelegramError(f"a value is above {most}")
    return values


def _position(words: TelegramWords) -> Position:
    return Position(**{name: words.real() for name in _REALS}, rotation=words.number(U8))


def _moment(words: TelegramWords) -> Moment:
    return Moment(**{name: words.number(most) for name, most in _MOMENT.items()})


def _event(words: TelegramWords) -> InputEvent:
    return InputEvent(
        kind=words.word(),
        encoder=words.number(),
        time_us=words.number(),
        angle_tick=words.signed(),
    )


def encode(scan: ScanData) -> str:
    """Return the words of `scan`, those after the name."""
    head = (scan.version, scan.device, scan.serial, *scan.status, scan.telegrams, scan.scans)
    times = (scan.sensed_us, scan.sent_us, *scan.inputs, *scan.outputs, scan.layer)
    words = [*map(hex_word, (*head, *times, scan.frequency_chz, scan.pulses, len(scan.encoders)))]
    for encoder in scan.encoders:
        words += [hex_word(encoder.position), hex_word(encoder.speed)]
    for channels in (scan.channels, scan.narrow_channels):
        words.append(hex_word(len(channels)))
        for channel in channels:
            words += _channel_words(channel)
    words += _last_words(scan)
    return " ".join(words)


def _channel_words(channel: ReadingChannel) -> list[str]:
    return [
        channel.content,
        real_word(channel.scale),
        real_word(channel.offset),
        long_word(channel.first_tick),
        hex_word(channel.step_tick),
        hex_word(len(channel.values)),
        *map("{:X}".format, channel.values),
    ]


def _last_words(scan: ScanData) -> list[str]:
    """Return the blocks after the channels: 1 and its words for each that there is, else 0."""
    at, when, event = scan.position, scan.moment, scan.event
    blocks: list[list[str] | None] = [
        None
        if at is None
        else [*(real_word(getattr(at, name)) for name in _REALS), hex_word(at.rotation)],
        *(None if text is None else [text_words(text)] for text in (scan.name, scan.comment)),
        None if when is None else [hex_word(getattr(when, name)) for name in _MOMENT],
        None
        if event is None
        else [event.kind, *map(hex_word, (event.encoder, event.time_us, event.angle_tick))],
    ]
    return [word for block in blocks for word in (["0"] if block is None else ["1", *block])]
