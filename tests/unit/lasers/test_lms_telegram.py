"""Telegrams of the LMS-2xx, as published, both ways (lms2xx.md 1.1 to 1.5, 1.9)."""

import pytest

from pioneer3.errors import CommandError
from pioneer3.lasers.lms2xx import commands
from pioneer3.lasers.lms2xx.commands import CommandCode, OperatingMode
from pioneer3.lasers.lms2xx.measuring import Variant
from pioneer3.lasers.lms2xx.telegram import (
    MAX_LENGTH,
    PAUSE,
    UNITS,
    Item,
    LmsTelegramReader,
    Sign,
    Telegram,
    checksum,
    encode,
)

STATUS = "02 00 01 00 31 15 12"
READY = b"\x02\x81\x17\x00\x90LMS200;301063;V02.06 \x13\x64\x5a"
TYPE = b"\x02\x80\x17\x00\xbaLMS200;301061;V02.30 \x10\x3d\xed"
REQUESTS = [
    ("02 00 01 00 10 34 12", encode(CommandCode.RESET)),
    ("02 00 02 00 20 42 52 08", commands.mode(OperatingMode.SPEED_9600)),
    ("02 00 02 00 20 41 51 08", commands.mode(OperatingMode.SPEED_19200)),
    ("02 00 02 00 20 40 50 08", commands.mode(OperatingMode.SPEED_38400)),
    ("02 00 02 00 20 48 58 08", commands.mode(OperatingMode.SPEED_500000)),
    (
        "02 00 0A 00 20 00 53 49 43 4B 5F 4C 4D 53 BE C5",
        commands.mode(OperatingMode.INSTALLATION, commands.PASSWORD),
    ),
    (
        "02 00 0A 00 20 00 53 49 43 4B 5F 50 4C 53 CC FC",
        commands.mode(OperatingMode.INSTALLATION, b"SICK_PLS"),
    ),
    ("02 00 02 00 20 24 34 08", commands.mode(OperatingMode.ALL_VALUES)),
    ("02 00 02 00 20 25 35 08", commands.mode(OperatingMode.ON_REQUEST)),
    ("02 00 02 00 20 2A 3A 08", commands.mode(OperatingMode.PARTIAL_SCANS)),
    (
        "02 00 06 00 20 27 01 00 B5 00 12 09",
        commands.mode(OperatingMode.SUBRANGE, bytes.fromhex("0100b500")),
    ),
    ("02 00 03 00 20 26 0A 76 3E", commands.mode(OperatingMode.MEAN, b"\x0a")),
    ("02 00 02 00 30 01 31 18", encode(CommandCode.SCAN, b"\x01")),
    (STATUS, encode(CommandCode.STATUS)),
    ("02 00 01 00 32 16 12", encode(CommandCode.ERRORS)),
    ("02 00 01 00 3A 1E 12", encode(CommandCode.TYPE)),
    ("02 00 05 00 3B B4 00 64 00 97 49", commands.variant(Variant(180, 100))),
    ("02 00 05 00 3B B4 00 32 00 3B 1F", commands.variant(Variant(180, 50))),
    ("02 00 05 00 3B 64 00 64 00 1D 0F", commands.variant(Variant(100, 100))),
    ("02 00 05 00 3B 64 00 32 00 B1 59", commands.variant(Variant(100, 50))),
    ("02 00 05 00 3B 64 00 19 00 E7 72", commands.variant(Variant(100, 25))),
    ("02 00 02 00 66 01 9D 4E", encode(CommandCode.KEEP_SPEED, b"\x01")),
    ("02 00 02 00 66 00 9C 4E", encode(CommandCode.KEEP_SPEED, b"\x00")),
    ("02 00 01 00 74 50 12", encode(CommandCode.CONFIG)),
    (
        "02 00 21 00 77 00 00 46 00 00 05 01 00 00 02 02" + " 00" * 21 + " 5B 51",
        encode(CommandCode.CONFIGURE, bytes.fromhex("0000460000050100000202") + bytes(21)),
    ),
]
ANSWERS = [
    ("02 80 02 00 91 10 79 30", 0x91, ""),
    ("02 80 03 00 A0 00 10 16 0A", 0xA0, "00"),
    ("02 80 03 00 A0 01 10 14 0B", 0xA0, "01"),
    ("02 80 03 00 A0 02 10 12 08", 0xA0, "02"),
    ("02 80 02 00 B2 10 3F 13", 0xB2, ""),
    ("02 80 07 00 BB 01 B4 00 64 00 10 5B 30", 0xBB, "01 B4 00 64 00"),
    ("02 80 07 00 BB 01 B4 00 32 00 10 03 9D", 0xBB, "01 B4 00 32 00"),
    ("02 80 02 00 92 10 7F 33", 0x92, ""),
    ("02 80 0A 00 B0 03 40 E8 03 E9 03 FF 1F 10 A3 EA", 0xB0, "03 40 E8 03 E9 03 FF 1F"),
]
TEXTS = [text for text, _ in REQUESTS] + [text for text, _, _ in ANSWERS]
PUBLISHED = [*map(bytes.fromhex, TEXTS), READY, TYPE]
ANYBODY = {0, *UNITS}


def reader() -> LmsTelegramReader:
    return LmsTelegramReader(ANYBODY)


def only(items: list[Item]) -> Telegram:
    (item,) = items
    assert isinstance(item, Telegram)
    return item


@pytest.mark.parametrize(("published", "ours"), REQUESTS)
def test_requests_are_as_published(published: str, ours: bytes) -> None:
    assert ours == bytes.fromhex(published)
    telegram = only(reader().feed(ours, 0.0))
    assert encode(telegram.code, telegram.data) == ours
    assert telegram.address == 0


@pytest.mark.parametrize(("published", "code", "body"), ANSWERS)
def test_answers_are_as_published(published: str, code: int, body: str) -> None:
    data = bytes.fromhex(published)
    telegram = only(reader().feed(data, 0.0))
    assert (telegram.address, telegram.code, telegram.status) == (0x80, code, 0x10)
    assert telegram.body == bytes.fromhex(body)
    assert encode(code, telegram.data, 0x80) == data


def test_texts_are_as_published() -> None:
    ready, told = only(reader().feed(READY, 0.0)), only(reader().feed(TYPE, 0.0))
    assert (ready.address, ready.code, ready.status) == (0x81, 0x90, 0x13)
    assert ready.body == b"LMS200;301063;V02.06 "
    assert encode(0x90, ready.data, 0x81) == READY
    assert encode(0xBA, told.data, 0x80) == TYPE


def test_the_checksum_shifts_once_a_byte() -> None:
    assert checksum(b"") == 0
    assert checksum(b"\x01") == 0x0001
    assert checksum(b"\x01\x02") == 0x0002 ^ 0x0102
    assert checksum(b"\x80\x00") == 0x0080 << 1 ^ 0x8000
    assert checksum(b"\x80\x00\x00") == 0x0100 << 1 ^ 0x8005  # a 1 has left the register


@pytest.mark.parametrize("frame", PUBLISHED)
def test_no_flipped_bit_is_accepted(frame: bytes) -> None:
    for bit in range(8 * len(frame)):
        spoilt = bytearray(frame)
        spoilt[bit // 8] ^= 1 << bit % 8
        reading = reader()
        items = reading.feed(bytes(spoilt), 0.0) + reading.feed(b"", PAUSE)
        assert [item for item in items if isinstance(item, Telegram)] == [], bit


@pytest.mark.parametrize("frame", PUBLISHED)
def test_a_flipped_bit_costs_no_other_telegram(frame: bytes) -> None:
    after = encode(CommandCode.STATUS)
    for bit in range(8 * len(frame)):
        spoilt = bytearray(frame)
        spoilt[bit // 8] ^= 1 << bit % 8
        reading = reader()
        items = reading.feed(bytes(spoilt) + after, 0.0) + reading.feed(b"", PAUSE)
        telegrams = [item for item in items if isinstance(item, Telegram)]
        assert [telegram.code for telegram in telegrams] == [CommandCode.STATUS], bit


def test_every_cut_gives_the_same() -> None:
    stream = b"\x06" + TYPE
    for cut in range(len(stream) + 1):
        reading = reader()
        items = reading.feed(stream[:cut], 0.0) + reading.feed(stream[cut:], 0.01)
        assert items[0] is Sign.ACK
        assert only(items[1:]).body == b"LMS200;301061;V02.30 "


def test_signs_stand_alone() -> None:
    assert reader().feed(b"\x06\x15", 0.0) == [Sign.ACK, Sign.NAK]


def test_signs_amid_noise_are_noise() -> None:
    reading = reader()
    assert reading.feed(b"\xff\x15\x06", 0.0) == []
    assert reading.skipped == 3
    assert reading.feed(b"\x15", PAUSE) == [Sign.NAK]


def test_other_addresses_are_noise() -> None:
    reading = LmsTelegramReader(UNITS)
    assert reading.feed(bytes.fromhex(STATUS), 0.0) == []
    assert reading.feed(encode(0xB2, b"\x10", 0x85), 0.0) == []
    assert only(reading.feed(encode(0xB2, b"\x10", 0x84), 0.0)).address == 0x84


def test_a_false_beginning_holds_back_a_telegram_until_the_line_pauses() -> None:
    reading = reader()
    assert reading.feed(b"\x02\x80\xff\x02\xb0" + TYPE, 0.0) == []
    assert reading.due == pytest.approx(PAUSE)
    assert reading.feed(b"", 0.9 * PAUSE) == []
    assert only(reading.feed(b"", PAUSE)).code == 0xBA
    assert reading.due == float("inf")


def test_an_unfinished_telegram_is_dropped_after_a_pause() -> None:
    reading = reader()
    reading.feed(TYPE[:-1], 0.0)
    assert only(reading.feed(TYPE, PAUSE)).began == PAUSE
    assert reading.skipped == len(TYPE) - 1


def test_a_telegram_that_hesitates_is_taken() -> None:
    reading = reader()
    for index, byte in enumerate(TYPE[:-1]):
        assert reading.feed(bytes((byte,)), 0.09 * index) == []
    assert only(reading.feed(TYPE[-1:], 0.09 * (len(TYPE) - 1))).began == 0.0


def test_impossible_lengths_are_noise() -> None:
    for length in (0, 1, MAX_LENGTH + 1):
        assert reader().feed(b"\x02\x80" + length.to_bytes(2, "little") + b"\x06", 0.0) == []
        reading = reader()
        reading.feed(b"\x02\x80" + length.to_bytes(2, "little"), 0.0)
        assert reading.skipped == 4


def test_too_long_a_telegram_is_refused() -> None:
    assert len(encode(0xB0, bytes(MAX_LENGTH - 1))) == MAX_LENGTH + 6
    with pytest.raises(CommandError, match="at most 812 bytes, not 813"):
        encode(0xB0, bytes(MAX_LENGTH))


def test_a_telegram_begins_when_its_first_byte_begins_to_arrive() -> None:
    reading = reader()
    reading.byte_time = 0.001
    reading.feed(TYPE[:10], 5.0)
    assert only(reading.feed(TYPE[10:], 5.02)).began == pytest.approx(4.99)


def test_of_two_telegrams_in_one_read_the_second_begins_later() -> None:
    reading = reader()
    reading.byte_time = 0.001
    first, second = reading.feed(TYPE * 2, 5.0)
    assert isinstance(first, Telegram)
    assert isinstance(second, Telegram)
    assert first.began == pytest.approx(5.0 - 2 * len(TYPE) * 0.001)
    assert second.began == pytest.approx(5.0 - len(TYPE) * 0.001)


def test_a_discarded_beginning_is_forgotten() -> None:
    reading = reader()
    reading.feed(TYPE[:10], 0.0)
    reading.discard()
    assert only(reading.feed(TYPE, 0.01)).code == 0xBA
