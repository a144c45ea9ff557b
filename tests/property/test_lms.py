"""LMS-2xx: whatever the line does, the telegrams that were sent come out, and nothing else."""

from dataclasses import fields
from math import inf
from random import Random
from typing import get_type_hints

from hypothesis import assume, given, settings
from hypothesis import strategies as st

from pioneer3.lasers.client import Patience, ScansLost
from pioneer3.lasers.lms2xx import LmsClient, LmsDevice
from pioneer3.lasers.lms2xx.blocks import UnitConfig, UnitStatus
from pioneer3.lasers.lms2xx.commands import CommandCode, OperatingMode
from pioneer3.lasers.lms2xx.measuring import MEASURING_MODES, MeasuringMode, Units
from pioneer3.lasers.lms2xx.scans import (
    MEAN_SUBRANGE_VALUES,
    MEAN_VALUES,
    SUBRANGE_VALUES,
    VALUES,
    Measurement,
)
from pioneer3.lasers.lms2xx.telegram import (
    FRAME,
    MAX_LENGTH,
    PAUSE,
    STX,
    UNITS,
    LmsTelegramReader,
    Sign,
    Telegram,
    checksum,
    encode,
)
from tests.unit.lasers.lms_support import LMS200, Cable

CODES = st.integers(0x10, 0xFF)
SENT = st.tuples(CODES, st.binary(min_size=1, max_size=200), st.sampled_from(UNITS))
# noise that looks like the real thing: beginnings, lengths, signs, telegrams cut short
NOISE = st.lists(
    st.one_of(
        st.sampled_from([b"\x02", b"\x80", b"\x02\x80", b"\x02\x81\x10\x00\xb0", b"\x06", b"\x15"]),
        st.binary(max_size=40),
        SENT.map(lambda sent: encode(*sent)[:-1]),
    ),
    max_size=10,
).map(b"".join)
WORDS = st.integers(0, 0xFFFF)
VALID_MODES = st.sampled_from([mode for mode in MEASURING_MODES.values() if mode.codes])
METRIC = st.sampled_from([Units.CENTIMETRES, Units.MILLIMETRES])


def frame(sent: tuple[int, bytes, int]) -> bytes:
    return encode(*sent)


def content(items: list[Telegram | Sign]) -> list[tuple[int, bytes, int] | Sign]:
    return [i if isinstance(i, Sign) else (i.code, i.data, i.address) for i in items]


def pieces(stream: bytes, data: st.DataObject) -> list[bytes]:
    cuts = sorted(data.draw(st.lists(st.integers(0, len(stream)), max_size=10)))
    ends = [*cuts, len(stream)]
    return [stream[start:end] for start, end in zip([0, *cuts], ends, strict=True)]


def slow_checksum(data: bytes) -> int:
    """Return the checksum bit by bit: the sum of all bytes, each times a power of x, modulo P."""
    total = 0
    for index, byte in enumerate(data):
        shifts = len(data) - 1 - index
        total ^= byte << shifts
        if shifts:  # the same byte as the high one of the next word
            total ^= byte << 8 + shifts - 1
    while total.bit_length() > 16:
        total ^= 0x18005 << total.bit_length() - 17
    return total


@given(st.binary(max_size=300))
def test_the_checksum_is_a_remainder_of_polynomials(data: bytes) -> None:
    assert checksum(data) == slow_checksum(data)


@given(st.lists(st.one_of(SENT, st.sampled_from(Sign)), max_size=8), st.data())
def test_chunking_does_not_matter(
    sent: list[tuple[int, bytes, int] | Sign], data: st.DataObject
) -> None:
    stream = b"".join(bytes((s.value,)) if isinstance(s, Sign) else frame(s) for s in sent)
    reader = LmsTelegramReader(UNITS)
    got = [item for piece in pieces(stream, data) for item in reader.feed(piece, 0.0)]
    assert content(got) == sent
    assert reader.skipped == reader.rejected == 0


@given(st.lists(st.one_of(NOISE, SENT.map(frame)), max_size=8).map(b"".join), st.data())
def test_chunking_does_not_matter_amid_noise_either(stream: bytes, data: st.DataObject) -> None:
    whole, cut = LmsTelegramReader(UNITS), LmsTelegramReader(UNITS)
    got = [item for piece in pieces(stream, data) for item in cut.feed(piece, 0.0)]
    assert content(got) == content(whole.feed(stream, 0.0))
    assert (cut.skipped, cut.rejected) == (whole.skipped, whole.rejected)


@given(NOISE, st.lists(SENT, min_size=1, max_size=5))
def test_no_telegram_sent_after_noise_is_lost(
    noise: bytes, sent: list[tuple[int, bytes, int]]
) -> None:
    stream = noise + b"".join(map(frame, sent))
    # noise that happens to complete a right checksum with what follows is a telegram like any other
    assume(not any(start < len(noise) < end for start, end in telegrams_within(stream)))
    assume(not any(start > 0 for s in sent for start, _ in telegrams_within(frame(s))))
    reader = LmsTelegramReader(UNITS)
    got = reader.feed(stream, 0.0) + reader.feed(b"", PAUSE)
    assert content([item for item in got if isinstance(item, Telegram)])[-len(sent) :] == sent


def telegrams_within(data: bytes) -> list[tuple[int, int]]:
    """Return where all telegrams with a right checksum begin and end, at any offset."""
    found = []
    for start in range(len(data) - FRAME):
        if data[start] == STX and data[start + 1] in UNITS:
            end = start + FRAME + int.from_bytes(data[start + 2 : start + 4], "little")
            told = int.from_bytes(data[end - 2 : end], "little")
            if end <= len(data) and checksum(data[start : end - 2]) == told:
                found.append((start, end))
    return found


@given(SENT, st.data())
def test_a_telegram_with_a_flipped_bit_is_never_delivered(
    sent: tuple[int, bytes, int], data: st.DataObject
) -> None:
    raw = bytearray(frame(sent))
    bit = data.draw(st.integers(0, len(raw) * 8 - 1))
    raw[bit // 8] ^= 1 << bit % 8
    reader = LmsTelegramReader(UNITS)
    got = reader.feed(bytes(raw), 0.0) + reader.feed(b"", PAUSE)
    within = telegrams_within(bytes(raw))  # a piece may by chance be a telegram of its own
    assert (0, len(raw)) not in within
    assert len([item for item in got if isinstance(item, Telegram)]) <= len(within)
    assert sent not in content(got)


def test_no_flipped_bit_of_a_scan_is_accepted() -> None:
    scan = frame((VALUES, Random(3).randbytes(205), 0x80))
    for bit in range(len(scan) * 8):
        reader, raw = LmsTelegramReader(UNITS), bytearray(scan)
        raw[bit // 8] ^= 1 << bit % 8
        got = reader.feed(bytes(raw), 0.0) + reader.feed(b"", PAUSE)
        assert [item for item in got if isinstance(item, Telegram)] == [], bit


@given(st.lists(st.tuples(st.binary(max_size=300), st.floats(0, 0.3)), max_size=20))
def test_no_bytes_and_no_pauses_make_it_raise(chunks: list[tuple[bytes, float]]) -> None:
    reader, now = LmsTelegramReader(UNITS), 0.0
    fed = taken = 0
    for data, pause in chunks:
        now += pause
        fed += len(data)
        for item in reader.feed(data, now):
            taken += 1 if isinstance(item, Sign) else len(item.data) + FRAME + 1
            assert isinstance(item, Sign) or item.began <= now
    assert taken + reader.skipped + len(reader._buffer) == fed


@settings(max_examples=3)
@given(st.integers(0, 1 << 32))
def test_a_megabyte_of_random_bytes_does_no_harm(seed: int) -> None:
    random, reader = Random(seed), LmsTelegramReader(UNITS)
    taken = 0
    for _ in range(256):
        for item in reader.feed(random.randbytes(4096), 0.0):
            taken += 1 if isinstance(item, Sign) else len(item.data) + FRAME + 1
        assert len(reader._buffer) < MAX_LENGTH + FRAME
        assert len(reader._arrivals) <= MAX_LENGTH + FRAME
    assert taken + reader.skipped + len(reader._buffer) == 1 << 20


@given(st.binary(min_size=34, max_size=34))
def test_every_configuration_survives(block: bytes) -> None:
    assert UnitConfig.from_bytes(block).to_bytes() == block
    assert UnitConfig.from_bytes(block[:32]).to_bytes(32) == block[:32]


@given(st.binary(min_size=152, max_size=152))
def test_every_status_keeps_its_fields(block: bytes) -> None:
    status = UnitStatus.from_bytes(block)
    assert UnitStatus.from_bytes(status.to_bytes()) == status
    places = get_type_hints(UnitStatus, include_extras=True)
    for field in fields(UnitStatus):
        place = places[field.name].__metadata__[0]
        assert (
            status.to_bytes()[place.offset - 1 : place.end - 1]
            == (block[place.offset - 1 : place.end - 1])
        )


ANSWERS = st.builds(
    lambda code, body, status: encode(code, body + bytes((status,)), 0x80),
    st.sampled_from([0x90, 0x91, 0x92, 0xA0, 0xB0, 0xB1, 0xB7, 0xBA, 0xBB, 0xF4, 0xF7]),
    st.sampled_from([0, 1, 2, 5, 34, 152, 364]).flatmap(
        lambda size: st.binary(min_size=size, max_size=size)
    )
    | st.sampled_from([b"\0", b"\1", b"\1\xb4\0\x64\0", b"\xb5\x40" + bytes(362)]),
    st.integers(0, 255),
)


@given(
    st.lists(st.tuples(st.one_of(ANSWERS, NOISE, st.just(b"")), st.floats(0, 4)), max_size=60),
    st.sampled_from([(), (9600,), (38400, 9600, 500000)]),
)
def test_no_answers_make_the_client_raise(
    heard: list[tuple[bytes, float]], speeds: tuple[int, ...]
) -> None:
    client, now = LmsClient(0.0, speeds, patience=Patience(give_up=60.0)), 0.0
    for data, pause in heard:
        now += pause
        events = client.receive(data, now)
        while client.deadline <= now:
            events += client.tick(now)
        assert len(client.outgoing()) < 1000
        if any(isinstance(event, ScansLost) for event in events):
            assert client.deadline == inf
            return
        assert client.deadline > now
    client.leave(now)
    assert client.deadline == inf


REQUESTS = st.builds(
    encode,
    st.sampled_from(CommandCode) | CODES,
    st.binary(max_size=34)
    | st.sampled_from(OperatingMode).map(lambda mode: bytes((mode,)))
    | st.sampled_from([b"\0SICK_LMS", b"\x27\1\0\3\0", b"\x64\0\x19\0", b"\xb4\0\x64\0"]),
)


@given(st.lists(st.tuples(st.one_of(REQUESTS, NOISE), st.floats(0, 0.2)), max_size=40))
def test_no_requests_make_the_unit_raise(asked: list[tuple[bytes, float]]) -> None:
    unit = LmsDevice(LMS200, boot=0.5)
    cable = Cable(unit, speed=None)
    for data, pause in asked:
        cable.send(data)
        cable.step(pause)
        assert unit.speed in {9600, 19200, 38400, 500000}
        assert unit._line.waiting < 4096
        assert unit.deadline > cable.now - pause - 1e-6
        assert (unit.turn is None) or unit.turn.count in {180, 181, 100, 101}


@st.composite
def measurements(draw: st.DrawFn) -> Measurement:
    code = draw(st.sampled_from([VALUES, MEAN_VALUES, SUBRANGE_VALUES, MEAN_SUBRANGE_VALUES]))
    has_sample = code in {MEAN_VALUES, MEAN_SUBRANGE_VALUES}
    has_part = code in {SUBRANGE_VALUES, MEAN_SUBRANGE_VALUES}
    return Measurement(
        code=code,
        values=tuple(draw(st.lists(WORDS, max_size=401))),
        units=draw(st.sampled_from(Units)),
        partial=draw(st.booleans()),
        offset_cdeg=25 * draw(st.integers(0, 3)),
        sample=draw(st.integers(0, 255)) if has_sample else 0,
        first=draw(WORDS) if has_part else 0,
        last=draw(WORDS) if has_part else 0,
        indices=draw(st.binary(max_size=2)),
    )


@given(measurements())
def test_measurements_survive(telegram: Measurement) -> None:
    assert Measurement.from_body(telegram.code, telegram.to_body()) == telegram


@given(st.integers(0, 255), st.binary(max_size=900))
def test_no_body_makes_decoding_raise_but_for_its_value(code: int, body: bytes) -> None:
    try:
        telegram = Measurement.from_body(code, body)
    except ValueError:
        return
    again = telegram.to_body()
    assert len(again) == len(body)
    assert Measurement.from_body(code, again) == telegram


@given(VALID_MODES, METRIC, st.lists(st.floats(0.01, 400) | st.just(inf), max_size=40), st.data())
def test_ranges_survive_to_the_unit_or_are_beyond(
    row: MeasuringMode, units: Units, ranges: list[float], data: st.DataObject
) -> None:
    light = data.draw(st.lists(st.floats(0, 99), min_size=len(ranges), max_size=len(ranges)))
    values = row.values(ranges, light, units)
    far = row.far(units)
    for sent, got in zip(ranges, row.ranges(values, units), strict=True):
        if sent > far + units.metres / 2:
            assert got == inf
        elif sent < far:
            assert abs(sent - got) <= 0.5000001 * units.metres
    if row.reflectivity:
        assert all(0 <= level < row.levels for level in row.reflectivities(values))
