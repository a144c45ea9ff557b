"""CoLa-A telegrams: frames, words and numbers, both directions, no I/O (cola.md 1.2, 1.3).

A telegram is STX, words separated by single spaces, ETX. It has no checksum, so everything that
does not fit is refused; a digit that noise has turned into another one cannot be noticed.
"""

import re
from collections.abc import Sequence
from math import isfinite
from struct import pack, unpack
from typing import Final

STX: Final = b"\x02"
ETX: Final = b"\x03"
MAX_TELEGRAM: Final = 1 << 17
"""Characters between STX and ETX; the longest scan, of ten channels, has about 57 000."""
_CONTROL: Final = re.compile(r"[\x00-\x1f\x7f]")
_HEX: Final = re.compile(r"[0-9A-F]{1,8}")
_DECIMAL: Final = re.compile(r"[+-][0-9]{1,10}")
U8: Final = 0xFF
U16: Final = 0xFFFF
_U32: Final = 0xFFFFFFFF


class TelegramError(ValueError):
    """A telegram is not as the protocol has it; it is dropped, and no caller sees this."""


def encode(text: str) -> bytes:
    """Return `text` as a telegram; TelegramError for control characters, or others than Latin-1."""
    if _CONTROL.search(text) or not 0 < len(text) <= MAX_TELEGRAM:
        raise TelegramError(
            "a telegram has 1 to 131072 characters, none of them control characters"
        )
    try:
        return STX + text.encode("latin-1") + ETX
    except UnicodeEncodeError as error:
        raise TelegramError(f"{text[error.start]!r} cannot be sent") from error


class ColaTelegramReader:
    """Incremental decoder: feed it bytes in any chunks, get the texts of telegrams back.

    It never raises on bad input. A telegram goes from the last STX before an ETX to that ETX, so a
    telegram that arrives whole is never lost to the noise before it. Those with control characters,
    without text, or too long are `rejected`; `bytes_skipped` belonged to no accepted one.
    """

    def __init__(self) -> None:
        self.telegrams = 0
        self.rejected = 0
        self.bytes_skipped = 0
        self._buffer = bytearray()
        self._searched = 0

    def feed(self, data: bytes) -> list[str]:
        """Add received bytes; return the text of every telegram that they complete."""
        buffer = self._buffer
        buffer += data
        texts: list[str] = []
        start, search = 0, self._searched
        while (end := buffer.find(ETX, search)) >= 0:
            begin = buffer.rfind(STX, start, end)
            text = self._accept(buffer[begin + 1 : end]) if begin >= 0 else None
            if text is not None:
                texts.append(text)
                self.bytes_skipped += begin - start
            else:
                self.bytes_skipped += end + 1 - start
            start = search = end + 1
        kept = buffer.rfind(STX, start)
        if kept < 0 or len(buffer) - kept - 1 > MAX_TELEGRAM:
            kept = len(buffer)
        self.bytes_skipped += kept - start
        del buffer[:kept]
        self._searched = len(buffer)
        return texts

    def _accept(self, raw: bytearray) -> str | None:
        text = raw.decode("latin-1")
        if 0 < len(text) <= MAX_TELEGRAM and not _CONTROL.search(text):
            self.telegrams += 1
            return text
        self.rejected += 1
        return None


def parse_number(word: str) -> int:
    """Return the value of `word`: hexadecimal when bare, decimal with a sign (cola.md 1.3)."""
    if _HEX.fullmatch(word):
        return int(word, 16)
    if _DECIMAL.fullmatch(word):
        return int(word)
    raise TelegramError(f"{word[:20]!r} is no number")


def hex_word(number: int) -> str:
    """Return `number`, of 32 bits with or without a sign, without leading zeros."""
    return f"{number & _U32:X}"


def long_word(number: int) -> str:
    """Return `number` with eight digits, as some readers need it (cola.md 5.2)."""
    return f"{number & _U32:08X}"


def decimal_word(number: int) -> str:
    """Return `number` in decimal, with its sign."""
    return f"{number:+d}"


def real_word(number: float) -> str:
    """Return the bits of `number` as eight hexadecimal digits."""
    return pack(">f", number).hex().upper()


def text_words(text: str) -> str:
    """Return the length of `text` and `text`."""
    return f"{len(text):X} {text}"


class TelegramWords:
    """The words of a telegram, taken one by one.

    All methods raise :exc:`TelegramError` where the next word is missing, or is something else.
    """

    def __init__(self, words: Sequence[str]) -> None:
        self._words = words
        self._next = 0

    def __len__(self) -> int:
        """Number of words left."""
        return len(self._words) - self._next

    def word(self) -> str:
        """Take one word."""
        return self.block(1)[0]

    def block(self, count: int) -> Sequence[str]:
        """Take `count` words."""
        if count > len(self):
            raise TelegramError(f"{count - len(self)} more words were expected")
        self._next += count
        return self._words[self._next - count : self._next]

    def number(self, most: int = _U32) -> int:
        """Take a number from 0 to `most`."""
        number = parse_number(self.word())
        if not 0 <= number <= most:
            raise TelegramError(f"{number} is not from 0 to {most}")
        return number

    def flag(self) -> bool:
        """Take 0 or 1."""
        return self.number(most=1) == 1

    def signed(self) -> int:
        """Take a 32-bit number with a sign: decimal, or its two's complement in hexadecimal."""
        word = self.word()
        number = parse_number(word)
        if word[0] not in "+-" and number > _U32 >> 1:
            number -= _U32 + 1
        if not -(_U32 + 1) >> 1 <= number <= _U32 >> 1:
            raise TelegramError(f"{word!r} does not fit 32 bits")
        return number

    def real(self) -> float:
        """Take a finite number, whose IEEE 754 bits are eight hexadecimal digits."""
        word = self.word()
        if len(word) != 8 or not _HEX.fullmatch(word):
            raise TelegramError(f"{word[:20]!r} is no real number")
        number: float = unpack(">f", bytes.fromhex(word))[0]
        if not isfinite(number):
            raise TelegramError(f"{word!r} is not finite")
        return number

    def text(self) -> str:
        """Take a length and the text of that length, which may hold spaces."""
        length = self.number(most=MAX_TELEGRAM)
        text = self.word()
        while len(text) < length:
            text += " " + self.word()
        if len(text) != length:
            raise TelegramError(f"a text of {length} characters ends within a word")
        return text

    def rest(self) -> str:
        """Take everything that is left, as it stands."""
        return " ".join(self.block(len(self)))

    def end(self) -> None:
        """Check that no word is left."""
        if len(self):
            raise TelegramError(f"{len(self)} words too many")
