"""Whatever the network does, CoLa-A telegrams come through, and nothing else passes for a scan."""

from math import inf, radians
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pioneer3.lasers.client import ScanSettings, ScansLost
from pioneer3.lasers.cola import scan, wire
from pioneer3.lasers.cola.client import ColaClient
from pioneer3.lasers.cola.configuration import DataConfig, OutputRange, ScanConfig
from pioneer3.lasers.cola.families import LMS1XX, LMS5XX, TIM
from pioneer3.lasers.cola.scan import (
    Encoder,
    InputEvent,
    Moment,
    Position,
    ReadingChannel,
    ScanData,
)
from pioneer3.lasers.cola.script import wished_output, wished_scan
from pioneer3.lasers.cola.wire import ColaTelegramReader, TelegramError, TelegramWords, encode
from tests.unit.lasers.cola_room import Room, laser

U8, U16, U32 = st.integers(0, 0xFF), st.integers(0, 0xFFFF), st.integers(0, 0xFFFFFFFF)
S32 = st.integers(-(1 << 31), (1 << 31) - 1)
REAL = st.floats(width=32, allow_nan=False, allow_infinity=False)
LETTERS = st.characters(min_codepoint=0x20, max_codepoint=0xFF, exclude_categories=["Cc"])
TEXT = st.text(LETTERS, max_size=16)
TELEGRAM = st.text(LETTERS, min_size=1, max_size=60)
NOISE = st.lists(
    st.one_of(
        st.sampled_from([b"\x02", b"\x03", b"\x02\x03", b"\x02sSN LMDscandata", b" 7\x03"]),
        st.binary(max_size=30),
    ),
    max_size=8,
).map(b"".join)


@st.composite
def channel_sets(draw: st.DrawFn) -> tuple[tuple[ReadingChannel, ...], tuple[ReadingChannel, ...]]:
    contents = draw(
        st.lists(
            st.sampled_from([f"{kind}{n}" for kind in ("DIST", "RSSI") for n in range(1, 6)]),
            min_size=1,
            max_size=4,
            unique=True,
        )
    )
    wide = draw(st.integers(0, len(contents)))
    first, step, count = draw(S32), draw(st.integers(1, 0xFFFF)), draw(st.integers(1, 12))

    def channel(content: str, most: int) -> ReadingChannel:
        return ReadingChannel(
            content=content,
            scale=draw(st.sampled_from([1.0, 2.0, 0.5])),
            offset=draw(REAL),
            first_tick=first,
            step_tick=step,
            values=tuple(draw(st.lists(st.integers(0, most), min_size=count, max_size=count))),
        )

    return (
        tuple(channel(content, 0xFFFF) for content in contents[:wide]),
        tuple(channel(content, 0xFF) for content in contents[wide:]),
    )


@st.composite
def scans(draw: st.DrawFn) -> ScanData:
    wide, narrow = draw(channel_sets())
    return ScanData(
        version=draw(U16),
        device=draw(U16),
        serial=draw(U32),
        status=(draw(U8), draw(U8)),
        telegrams=draw(U16),
        scans=draw(U16),
        sensed_us=draw(U32),
        sent_us=draw(U32),
        inputs=(draw(U8), draw(U8)),
        outputs=(draw(U8), draw(U8)),
        layer=draw(U16),
        frequency_chz=draw(st.integers(1, 0xFFFFFFFF)),
        pulses=draw(U32),
        encoders=tuple(draw(st.lists(st.builds(Encoder, U32, U16), max_size=3))),
        channels=wide,
        narrow_channels=narrow,
        position=draw(
            st.none()
            | st.builds(
                Position,
                x=REAL,
                y=REAL,
                z=REAL,
                x_rotation=REAL,
                y_rotation=REAL,
                z_rotation=REAL,
                rotation=U8,
            )
        ),
        name=draw(st.none() | TEXT),
        comment=draw(st.none() | TEXT),
        moment=draw(
            st.none()
            | st.builds(
                Moment,
                year=U16,
                month=st.integers(0, 12),
                day=st.integers(0, 31),
                hour=st.integers(0, 23),
                minute=st.integers(0, 59),
                second=st.integers(0, 60),
                microsecond=st.integers(0, 999_999),
            )
        ),
        event=draw(
            st.none()
            | st.builds(
                InputEvent,
                kind=st.sampled_from(["FREE", "I1"]),
                encoder=U32,
                time_us=U32,
                angle_tick=S32,
            )
        ),
    )


@given(scans())
def test_a_scan_survives_the_wire(sent: ScanData) -> None:
    (text,) = ColaTelegramReader().feed(encode(f"sSN LMDscandata {scan.encode(sent)}"))
    assert scan.decode(TelegramWords(text.split(" ")[2:])) == sent


@given(scans(), st.data())
def test_a_scan_with_words_missing_or_added_is_refused(sent: ScanData, data: st.DataObject) -> None:
    words = scan.encode(sent).split(" ")
    cut = words[: data.draw(st.integers(0, len(words) - 1))]
    with pytest.raises(TelegramError):
        scan.decode(TelegramWords(cut))
    with pytest.raises(TelegramError):
        scan.decode(TelegramWords([*words, "0"]))


@given(scans(), st.data())
def test_a_flipped_bit_never_raises_anything_else(sent: ScanData, data: st.DataObject) -> None:
    raw = bytearray(encode(f"sSN LMDscandata {scan.encode(sent)}"))
    bit = data.draw(st.integers(0, len(raw) * 8 - 1))
    raw[bit // 8] ^= 1 << bit % 8
    for text in ColaTelegramReader().feed(bytes(raw)):
        try:
            scan.decode(TelegramWords(text.split(" ")[2:]))
        except TelegramError:
            continue


@given(st.lists(TELEGRAM, max_size=8), NOISE, st.data())
def test_chunking_does_not_matter(sent: list[str], noise: bytes, data: st.DataObject) -> None:
    stream = noise + b"".join(map(encode, sent))
    cuts = sorted(data.draw(st.lists(st.integers(0, len(stream)), max_size=10)))
    whole, pieces = ColaTelegramReader(), ColaTelegramReader()
    got = []
    for start, end in zip([0, *cuts], [*cuts, len(stream)], strict=True):
        got += pieces.feed(stream[start:end])
    assert got == whole.feed(stream)
    assert got[len(got) - len(sent) :] == sent
    assert pieces.bytes_skipped + len(pieces._buffer) == whole.bytes_skipped + len(whole._buffer)
    assert pieces.rejected == whole.rejected


@settings(max_examples=5)
@given(st.integers(0, 1 << 32))
def test_a_megabyte_of_random_bytes_does_no_harm(seed: int) -> None:
    random, reader, taken = Random(seed), ColaTelegramReader(), 0
    for _ in range(256):
        taken += sum(len(text) + 2 for text in reader.feed(random.randbytes(4096)))
        assert len(reader._buffer) <= wire.MAX_TELEGRAM + 1
    assert taken + reader.bytes_skipped + len(reader._buffer) == 1 << 20
    assert reader.feed(encode("sRI0"))[-1] == "sRI0"


@given(S32, U32, REAL)
def test_numbers_survive_the_wire(signed: int, unsigned: int, real: float) -> None:
    assert wire.TelegramWords([wire.hex_word(signed)]).signed() == signed
    assert wire.TelegramWords([wire.long_word(signed)]).signed() == signed
    assert wire.TelegramWords([wire.decimal_word(signed)]).signed() == signed
    assert wire.parse_number(wire.hex_word(unsigned)) == unsigned
    assert wire.TelegramWords([wire.real_word(real)]).real() == real


@given(TEXT, TEXT)
def test_texts_survive_the_wire(first: str, second: str) -> None:
    words = TelegramWords(f"{wire.text_words(first)} {wire.text_words(second)} 7".split(" "))
    assert (words.text(), words.text(), words.number()) == (first, second, 7)


@given(
    st.builds(
        ScanConfig,
        frequency_chz=U32.filter(lambda n: n < 1 << 31),
        step_tick=U16,
        first_tick=S32,
        last_tick=S32,
    )
)
def test_scan_settings_survive_both_ways(config: ScanConfig) -> None:
    for text in (config.answer(), config.request()):
        assert ScanConfig.parse(TelegramWords(text.split(" "))) == config


@given(st.builds(OutputRange, step_tick=U16, first_tick=S32, last_tick=S32))
def test_output_ranges_survive(output: OutputRange) -> None:
    assert OutputRange.parse(TelegramWords(output.words().split(" "))) == output


@given(
    st.builds(
        DataConfig,
        echoes=U16,
        remission=st.booleans(),
        wide=st.booleans(),
        unit=U8,
        encoders=U16,
        position=st.booleans(),
        name=st.booleans(),
        comment=st.booleans(),
        moment=st.booleans(),
        interval=U16,
    )
)
def test_contents_of_scans_survive_both_ways(config: DataConfig) -> None:
    for text in (config.answer(), config.request()):
        assert DataConfig.parse(TelegramWords(text.split(" "))) == config


@given(
    st.sampled_from([LMS1XX, LMS5XX, TIM]),
    st.none() | st.floats(-4, 4),
    st.none() | st.floats(-4, 4),
    st.none() | st.floats(1e-4, 0.1),
    st.data(),
)
def test_no_wish_asks_for_what_the_laser_cannot_do(
    family: object, first: float | None, last: float | None, step: float | None, data: st.DataObject
) -> None:
    assert family in {LMS1XX, LMS5XX, TIM}
    own = next(f for f in (LMS1XX, LMS5XX, TIM) if f is family)
    frequency, present_step = data.draw(
        st.sampled_from(
            [(f, s) for f in own.frequencies_chz for s in own.steps_tick if own.fits(f, s)]
        )
    )
    present = ScanConfig(
        frequency_chz=frequency,
        step_tick=present_step,
        first_tick=own.first_tick,
        last_tick=own.last_tick,
    )
    wishes = ScanSettings(first=first, last=last, step=step)
    wanted = wished_scan(present, wishes, own)
    output = wished_output(wanted, wishes, own)
    assert own.check(wanted) == 0
    assert own.holds(output.first_tick, output.last_tick)


@given(NOISE, st.lists(st.integers(1, 400), max_size=12), st.booleans())
def test_noise_at_the_client_costs_no_session(
    noise: bytes, pieces: list[int], intensities: bool
) -> None:
    room = Room(laser(), ColaClient(0.0, ScanSettings(intensities=intensities, step=radians(0.25))))
    assert room.client is not None
    for size in pieces:
        room.events += room.client.receive(noise[:size], room.now)
        room.run(0.013)
    room.run(1.0)
    assert not [event for event in room.events if isinstance(event, ScansLost)]
    assert len(room.scans[-1].ranges) == 1081
    assert room.scans[-1].ranges[9] == inf


@given(st.lists(st.tuples(st.binary(max_size=60), st.floats(0, 1)), max_size=15))
def test_no_bytes_make_client_or_laser_raise(chunks: list[tuple[bytes, float]]) -> None:
    device, client, now = laser(spin_up=1.0), ColaClient(0.0), 0.0
    connection = device.connect()
    for data, pause in chunks:
        now += pause
        connection.receive(data + b"\x03\x02sRN", now)
        connection.receive(b"\x02" + data + b"\x03", now)
        client.tick(now)
        client.receive(b"\x02" + data + b"\x03", now)
        device.tick(now)
        connection.outgoing(now)
    assert device.connect() is not connection
