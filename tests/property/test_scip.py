"""Whatever the line does, a SCIP client returns the scans that were sent, and nothing else."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pioneer3.lasers.client import Event, Measured, ScanSettings
from pioneer3.lasers.device import MirrorTurn, Sweep
from pioneer3.lasers.scip.client import ScipClient
from pioneer3.lasers.scip.device import ScipDevice
from pioneer3.lasers.scip.scans import FORMATS, decode
from pioneer3.lasers.scip.sweeps import codes_of, data_lines
from pioneer3.lasers.scip.timing import WRAP, ScipClock
from pioneer3.lasers.scip.wire import (
    AnswerReader,
    checksum,
    decode_values,
    encode_values,
    from_lines,
    from_pairs,
    pair,
    to_lines,
)
from pioneer3.models.lasers import LASERS
from tests.combinations import examples
from tests.unit.lasers.scip_rig import UTM, Rig

NARROW = ScanSettings(first=-0.3, last=0.3, calibrate_time=False)
KINDS = {
    "MD": NARROW,
    "ME": ScanSettings(first=-0.3, last=0.3, intensities=True, calibrate_time=False),
    "ND": ScanSettings(first=-0.3, last=0.3, multi_echo=True, calibrate_time=False),
    "NE": ScanSettings(
        first=-0.3, last=0.3, intensities=True, multi_echo=True, calibrate_time=False
    ),
}
NOISE = st.lists(
    st.one_of(
        st.sampled_from([b"\n", b"\r", b"\n\n", b"99b\n", b"MD", b"00P\n\n", b"&", b"\0"]),
        st.binary(max_size=40),
    ),
    max_size=10,
).map(b"".join)


def scanning(wishes: ScanSettings, scans: int = 3) -> tuple[Rig, ScipClient, list[bytes]]:
    """Return a client that has had a scan, and the bytes of some scans that follow."""
    rig = Rig(ScipDevice(UTM))
    client = rig.connect(settings=wishes)
    rig.run(2.0, Measured)
    rig.client = None
    rig.run(0.025 * (scans + 1))
    return rig, client, rig.unheard[:scans]


def measured(events: Sequence[Event]) -> list[tuple[float, ...]]:
    return [event.scan.ranges for event in events if isinstance(event, Measured)]


@given(st.integers(2, 4), st.data())
def test_numbers_go_both_ways(width: int, data: st.DataObject) -> None:
    values = data.draw(st.lists(st.integers(0, 64**width - 1), max_size=200))
    text = encode_values(values, width)
    assert len(text) == width * len(values)
    assert decode_values(text, width) == values
    assert from_lines(to_lines(text).splitlines()) == text


@given(st.binary(max_size=80) | st.binary(min_size=300, max_size=400))
def test_a_checksum_is_six_bits_of_the_sum(data: bytes) -> None:
    assert checksum(data) == 0x30 + sum(data) % 64


@given(
    st.text(st.characters(min_codepoint=65, max_codepoint=90), min_size=1, max_size=8),
    st.text(st.characters(min_codepoint=32, max_codepoint=126), max_size=40),
)
def test_pairs_go_both_ways(key: str, value: str) -> None:
    assert from_pairs([pair(key, value).removesuffix(b"\n")]) == {key: value}


@given(st.sampled_from(["ND", "NE"]), st.data())
def test_echoes_go_both_ways(letters: str, data: st.DataObject) -> None:
    format_ = FORMATS[letters]
    number = st.integers(0, (1 << 18) - 1)
    echo = st.tuples(number, number) if format_.intensities else st.tuples(number)
    sent = data.draw(st.lists(st.lists(echo, min_size=1, max_size=3), min_size=1, max_size=60))
    text = b"".join(b"&".join(encode_values(echo, 3) for echo in step) for step in sent)
    readings = decode(to_lines(text).splitlines(), format_, len(sent))
    assert readings is not None
    assert readings.echoes == [[echo[0] for echo in step] for step in sent]
    if format_.intensities:
        assert readings.intensities == [step[0][1] for step in sent]


@given(st.lists(NOISE | st.just(b"VV\n00P\n\n"), max_size=12).map(b"".join), st.data())
def test_chunking_does_not_matter(stream: bytes, data: st.DataObject) -> None:
    cuts = sorted(data.draw(st.lists(st.integers(0, len(stream)), max_size=10)))
    whole, pieces = AnswerReader(), AnswerReader()
    got = []
    for start, end in pairwise([0, *cuts, len(stream)]):
        got += pieces.feed(stream[start:end], 0.0)
    assert [answer.lines for answer in got] == [answer.lines for answer in whole.feed(stream, 0.0)]


@pytest.mark.parametrize("kind", KINDS)
@settings(max_examples=20)
@given(seed=st.integers(0, 1 << 16))
def test_a_client_returns_the_same_scans_in_any_pieces(kind: str, seed: int) -> None:
    rig, client, sent = scanning(KINDS[kind])
    random, stream, events = Random(seed), b"".join(sent), list[Event]()
    while stream:
        size = random.choice([1, 2, 7, 66, 1000])
        events += client.receive(stream[:size], rig.now)
        stream = stream[size:]
    assert len(measured(events)) == len(sent)
    assert client.refused == 0
    assert {len(ranges) for ranges in measured(events)} == {len(rig.scans[0].ranges)}


@pytest.mark.parametrize("kind", KINDS)
def test_no_scan_with_any_one_bit_flipped_is_accepted(kind: str) -> None:
    rig, client, (scan, following, *_) = scanning(KINDS[kind])
    (wanted,) = measured(client.receive(following, rig.now))
    bits = range(len(scan) * 8)
    for bit in Random(kind).sample(bits, examples(len(bits))):
        raw = bytearray(scan)
        raw[bit // 8] ^= 1 << bit % 8
        refused = client.refused
        got = measured(client.receive(bytes(raw), rig.now))
        got += measured(client.receive(following, rig.now))
        assert got == [wanted], (bit, bytes(raw))
        assert client.refused > refused, (bit, bytes(raw))


def test_no_answer_with_any_one_bit_flipped_changes_the_geometry() -> None:
    rig = Rig(ScipDevice(UTM))
    rig.enter(b"PP\n")
    answer = rig.host.outgoing(rig.now)
    wanted = {"DMIN": "23", "AMIN": "0", "SCAN": "2400"}
    reader = AnswerReader()
    (whole,) = reader.feed(answer, 0.0)
    assert wanted.items() <= (from_pairs(whole.lines[2:]) or {}).items()
    keys = [b"DMIN", b"DMAX", b"ARES", b"AMIN", b"AMAX", b"AFRT", b"SCAN"]
    for number, line in enumerate(whole.lines):
        if line[:4] not in keys:
            continue
        for bit in range(len(line) * 8):
            raw = bytearray(line)
            raw[bit // 8] ^= 1 << bit % 8
            pairs = from_pairs([bytes(raw)])
            key, value = line[:-2].decode().split(":")
            assert pairs is None or key not in pairs or not pairs[key].isdecimal(), (number, bit)
            assert pairs != {key: value}


def test_a_megabyte_of_noise_is_neither_raised_nor_kept() -> None:
    rig, client, (scan, *_) = scanning(NARROW)
    random = Random(1)
    for _ in range(256):
        assert measured(client.receive(random.randbytes(4096), rig.now)) == []
        assert len(client._reader._buffer) <= 1 << 16
    got = measured(client.receive(b"\n\n" + scan, rig.now))
    assert len(got) == 1


@given(NOISE)
@settings(max_examples=examples(50))
def test_noise_before_a_scan_costs_at_most_that(noise: bytes) -> None:
    rig, client, (scan, following, *_) = scanning(NARROW)
    got = measured(client.receive(noise + scan, rig.now))
    got += measured(client.receive(following, rig.now))
    assert 1 <= len(got) <= 2


@given(st.lists(NOISE, max_size=10), st.sampled_from(["urg-04lx", "utm-30lx"]))
def test_no_bytes_make_a_laser_raise(noise: list[bytes], name: str) -> None:
    device = ScipDevice(LASERS[name])
    host = device.connect()
    for number, data in enumerate(noise):
        host.receive(data, float(number))
    host.receive(b"\nSCIP2.0\nTM2\nQT\n", 100.0)
    host.outgoing(1000.0)
    host.receive(b"QT\n", 2000.0)
    assert host.outgoing(2010.0).endswith(b"QT\n00P\n\n")


@given(st.integers(0, WRAP - 1), st.lists(st.integers(1, 600000), max_size=60))
def test_the_laser_clock_goes_on_behind_its_24_bits(start: int, ahead: list[int]) -> None:
    clock = ScipClock()
    first = clock.unwrap(start)
    total = 0
    for milliseconds in ahead:
        total += milliseconds
        assert clock.unwrap((start + total) % WRAP) - first == pytest.approx(total / 1000)


@pytest.mark.parametrize("reach", [(0.05, 3.0), (0.0, 3.0), (0.05, 35.0)])  # codes in two of them
@pytest.mark.parametrize("letters", ["MD", "MS", "ME", "ND"])
def test_millimetres_that_are_known_change_no_byte(
    letters: str, reach: tuple[float, float]
) -> None:
    steps, random = UTM.steps, Random(1)
    assert steps is not None
    ranges = [random.uniform(*reach) for _ in range(steps.first, steps.last + 1)]
    known = [int(metres * 1000 + 0.5) for metres in ranges]
    turn = MirrorTurn(first=0.0, step=0.1, count=len(ranges), beam_time=0.0, period=0.025)
    plain = Sweep(turn=turn, began=0.0, ranges=ranges, intensities=[0.5] * len(ranges))
    rounded = replace(plain, millimetres=known, least=min(known), most=max(known))
    lines = [
        data_lines(
            sweep,
            FORMATS[letters],
            steps,
            codes_of(UTM, steps),
            start=steps.first,
            end=steps.last,
            cluster=1,
        )
        for sweep in (plain, rounded)
    ]
    assert len({*lines}) == 1
