"""Whatever the cable does, the reader delivers the packets that were sent, and nothing else."""

from collections.abc import Iterator
from pathlib import Path
from random import Random

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from pioneer3.arcos import reports
from pioneer3.arcos.packet import HEADER, PAUSE, PacketReader, checksum, encode

PAYLOADS = st.binary(min_size=1, max_size=200)
# noise that looks like the real thing: pieces of headers, counts, whole frames cut short
NOISE = st.lists(
    st.one_of(
        st.sampled_from([b"\xfa", b"\xfb", HEADER, HEADER + b"\x03", HEADER + b"\xff", b"\0"]),
        st.binary(max_size=40),
        PAYLOADS.map(lambda payload: encode(payload)[:-1]),
    ),
    max_size=10,
).map(b"".join)
CAPTURES = Path(__file__).parents[2].parent / "shared" / "captures"


def frames_within(data: bytes) -> Iterator[tuple[int, int]]:
    """Yield where every frame with a right checksum begins and ends, at any offset."""
    start = data.find(HEADER)
    while 0 <= start < len(data) - 2:
        end = start + 3 + data[start + 2]
        payload = data[start + 3 : end - 2]
        if (
            end <= len(data)
            and payload
            and checksum(payload) == int.from_bytes(data[end - 2 : end])
        ):
            yield start, end
        start = data.find(HEADER, start + 1)


@given(st.lists(PAYLOADS, max_size=8), st.data())
def test_chunking_does_not_matter(sent: list[bytes], data: st.DataObject) -> None:
    stream = b"".join(map(encode, sent))
    cuts = sorted(data.draw(st.lists(st.integers(0, len(stream)), max_size=10)))
    reader, got = PacketReader(), []
    for start, end in zip([0, *cuts], [*cuts, len(stream)], strict=True):
        got += reader.feed(stream[start:end])
    assert got == sent
    assert reader.bytes_skipped == 0


@given(st.lists(st.one_of(NOISE, PAYLOADS.map(encode)), max_size=8).map(b"".join), st.data())
def test_chunking_does_not_matter_amid_noise_either(stream: bytes, data: st.DataObject) -> None:
    cuts = sorted(data.draw(st.lists(st.integers(0, len(stream)), max_size=10)))
    whole, pieces = PacketReader(), PacketReader()
    got = []
    for start, end in zip([0, *cuts], [*cuts, len(stream)], strict=True):
        got += pieces.feed(stream[start:end])
    assert got == whole.feed(stream)
    assert pieces.bytes_skipped == whole.bytes_skipped
    assert pieces.bad_checksums == whole.bad_checksums


@given(st.lists(st.tuples(st.binary(max_size=300), st.floats(0, 1)), max_size=20))
def test_no_bytes_and_no_pauses_make_it_raise(chunks: list[tuple[bytes, float]]) -> None:
    reader, now, fed, taken = PacketReader(), 0.0, 0, 0
    for data, pause in chunks:
        now += pause
        fed += len(data)
        taken += sum(len(payload) + 5 for payload in reader.feed(data, now))
    assert taken + reader.bytes_skipped + len(reader._buffer) == fed


@given(NOISE, st.lists(PAYLOADS, min_size=1, max_size=5))
def test_no_packet_sent_after_noise_is_lost(noise: bytes, sent: list[bytes]) -> None:
    stream = noise + b"".join(map(encode, sent))
    # noise that happens to complete a right checksum with what follows is a frame like any other
    assume(not any(start < len(noise) < end for start, end in frames_within(stream)))
    assume(not any(HEADER in encode(payload)[2:] for payload in sent))
    reader = PacketReader()
    got = reader.feed(stream, 0.0)
    for beat in range(1, 6):  # the line pauses; each look costs nothing
        got += reader.feed(b"", beat * 1.1 * PAUSE)
    assert got[len(got) - len(sent) :] == sent


def real_frames() -> list[bytes]:
    """Return some SIPs and CONFIGs that a robot sent."""
    found: dict[bytes, bytes] = {}
    for capture in sorted(CAPTURES.glob("*.txt")):
        for line in capture.read_text().splitlines():
            match line.split():
                case [_, "S>C", _, text] if text[6:8] in {"20", "32", "33"}:
                    data = bytes.fromhex(text)
                    first = data[: data[2] + 3]
                    found.setdefault(first[3:4] + bytes([len(first)]), first)
    return list(found.values())


@pytest.mark.skipif(not CAPTURES.exists(), reason="no captures beside this checkout")
def test_no_frame_with_any_one_bit_flipped_is_accepted() -> None:
    frames = real_frames()
    assert len(frames) >= 2
    for frame in frames:
        for bit in range(len(frame) * 8):
            raw = bytearray(frame)
            raw[bit // 8] ^= 1 << bit % 8
            reader = PacketReader()
            got = reader.feed(bytes(raw), 0.0)
            got += reader.feed(bytes(300), 0.01)  # a longer count finds the bytes it claims
            for payload in got:
                report = reports.from_payload(payload)
                assert not isinstance(report, reports.Sip | reports.Config), bit


@pytest.mark.skipif(not CAPTURES.exists(), reason="no captures beside this checkout")
def test_a_flipped_bit_costs_one_frame_and_not_the_next() -> None:
    for frame in real_frames():
        after = encode(b"\x32 the next report")
        for bit in range(len(frame) * 8):
            raw = bytearray(frame)
            raw[bit // 8] ^= 1 << bit % 8
            reader = PacketReader()
            got = reader.feed(bytes(raw) + after, 0.0) + reader.feed(b"", 2 * PAUSE)
            assert got[-1] == after[3:-2], bit


@given(PAYLOADS, st.data())
def test_a_payload_with_a_flipped_bit_is_never_delivered(
    payload: bytes, data: st.DataObject
) -> None:
    raw = bytearray(encode(payload))
    bit = data.draw(st.integers(24, len(raw) * 8 - 1))  # behind the count
    raw[bit // 8] ^= 1 << bit % 8
    reader = PacketReader()
    reader.feed(bytes(raw))
    assert reader.bad_checksums >= 1
    assert bytes(raw[3:-2]) in reader.rejected


@settings(max_examples=5)
@given(st.integers(0, 1 << 32))
def test_a_megabyte_of_random_bytes_does_no_harm(seed: int) -> None:
    random, reader = Random(seed), PacketReader()
    taken = 0
    for _ in range(256):
        taken += sum(len(payload) + 5 for payload in reader.feed(random.randbytes(4096)))
        assert len(reader._buffer) <= 3 + 255
    assert taken + reader.bytes_skipped + len(reader._buffer) == 1 << 20
