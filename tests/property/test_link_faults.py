"""Faulty cables: as often as asked for, and the same every time."""

from hypothesis import given
from hypothesis import strategies as st

from pioneer3.arcos.packet import PacketReader, encode
from pioneer3.sim.server.faults import CableDirection, LinkFaults

shares = st.floats(0, 1)
seeds = st.integers(0, 2**32)
traffic = st.lists(st.binary(max_size=60), max_size=20)
packets = st.lists(st.binary(min_size=1, max_size=40), max_size=30)


def arrivals(faults: LinkFaults, chunks: list[bytes]) -> list[bytes]:
    line = CableDirection(faults, "out")
    moments = [tick * 0.02 for tick in range(len(chunks) + 200)]
    return [
        line.transmit(chunk, now)
        for now, chunk in zip(moments, [*chunks, *[b""] * 200], strict=True)
    ]


@given(shares, shares, st.floats(0, 2), seeds, traffic)
def test_the_same_seed_gives_the_same_faults(
    drop: float, corrupt: float, delay: float, seed: int, chunks: list[bytes]
) -> None:
    first, second = (
        arrivals(LinkFaults(drop=drop, corrupt=corrupt, delay=delay, seed=seed), chunks)
        for _ in range(2)
    )
    assert first == second


@given(st.floats(0, 2), seeds, traffic)
def test_a_slow_cable_loses_nothing_and_keeps_the_order(
    delay: float, seed: int, chunks: list[bytes]
) -> None:
    assert b"".join(arrivals(LinkFaults(delay=delay, seed=seed), chunks)) == b"".join(chunks)


@given(shares, seeds, packets)
def test_what_is_not_lost_arrives_whole(drop: float, seed: int, sent: list[bytes]) -> None:
    line = CableDirection(LinkFaults(drop=drop, seed=seed), "in")
    reader = PacketReader()
    received = reader.feed(line.transmit(b"".join(map(encode, sent)), 0.0))
    left = iter(sent)
    assert all(payload in left for payload in received)  # a subsequence
    assert reader.bad_checksums == reader.bytes_skipped == 0


@given(st.floats(0.05, 0.95), seeds)
def test_as_many_packets_are_lost_as_asked_for(drop: float, seed: int) -> None:
    line = CableDirection(LinkFaults(drop=drop, seed=seed), "in")
    count = 4000
    arrived = len(line.transmit(encode(b"\0") * count, 0.0)) / 6
    six_sigma = 6 * (count * drop * (1 - drop)) ** 0.5
    assert abs(arrived - count * (1 - drop)) < six_sigma


@given(st.floats(0.05, 0.95), seeds)
def test_as_many_bytes_are_spoiled_as_asked_for(corrupt: float, seed: int) -> None:
    line = CableDirection(LinkFaults(corrupt=corrupt, seed=seed), "in")
    count = 4000
    spoiled = sum(map(bool, line.transmit(bytes(count), 0.0)))
    six_sigma = 6 * (count * corrupt * (1 - corrupt)) ** 0.5
    assert abs(spoiled - count * corrupt) < six_sigma


@given(shares, shares, st.floats(0, 1e6), seeds, st.booleans())
def test_faults_read_what_they_write(
    drop: float, corrupt: float, delay: float, seed: int, frozen: bool
) -> None:
    faults = LinkFaults(drop=drop, corrupt=corrupt, delay=delay, seed=seed)
    faults.frozen = frozen
    again = LinkFaults.parse(str(faults))
    assert (again.drop, again.corrupt, again.delay, again.frozen) == (drop, corrupt, delay, frozen)
