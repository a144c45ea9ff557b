"""A bridge between any bytes, in any pieces."""

import itertools

from hypothesis import given
from hypothesis import strategies as st

from pioneer3.arcos import commands
from pioneer3.arcos.packet import MAX_PAYLOAD, encode
from tests.support import frame
from tests.unit.bridge.rig import Rig, payloads

PAYLOADS = st.lists(st.binary(min_size=1, max_size=40), max_size=12)


def pieces(data: bytes, cuts: list[int]) -> list[bytes]:
    """Return `data` cut at these places."""
    places = sorted({cut % (len(data) + 1) for cut in cuts})
    edges = [0, *places, len(data)]
    return [data[a:b] for a, b in itertools.pairwise(edges)]


@given(sent=PAYLOADS, cuts=st.lists(st.integers(0, 10_000), max_size=20))
def test_a_holders_packets_reach_the_robot_unchanged_in_any_pieces(
    sent: list[bytes], cuts: list[int]
) -> None:
    rig = Rig()
    _, holder = rig.open_host("first")
    sent = [payload for payload in sent if payload[0] > 2]
    data = b"".join(map(encode, sent))
    arrived = b""
    for piece in pieces(data, cuts):
        rig.relay.receive(holder, piece, rig.now)
        arrived += rig.relay.robot.outgoing()
    assert arrived == data


@given(sent=PAYLOADS, cuts=st.lists(st.integers(0, 10_000), max_size=20), early=st.booleans())
def test_all_hosts_get_the_robots_bytes_from_the_beginning_of_a_packet(
    sent: list[bytes], cuts: list[int], early: bool
) -> None:
    rig = Rig()
    first, _ = rig.open_host("first")
    second, client = rig.host("second")
    before = len(first.received)
    parts = pieces(b"".join(map(encode, sent)), cuts)
    for number, part in enumerate(parts):
        if number == (0 if early else len(parts) // 2):
            for sync in (0, 1, 2):
                rig.relay.receive(client, encode(bytes([sync])), rig.now)
            rig.relay.receive(client, frame(commands.Open()), rig.now)
        rig.relay.robot_sent(part, rig.now)
    assert first.received[before:] == b"".join(parts)
    got = payloads(second.received)[3:]
    assert got == sent[len(sent) - len(got) :]


@given(noise=st.lists(st.binary(max_size=60), max_size=12), robots=st.binary(max_size=200))
def test_no_bytes_of_hosts_or_robots_break_it_and_a_stop_always_gets_through(
    noise: list[bytes], robots: bytes
) -> None:
    rig = Rig()
    hosts = [rig.host(str(number))[1] for number in range(3)]
    for number, data in enumerate(noise):
        rig.relay.receive(hosts[number % 3], data, rig.now)
        rig.exchange()
        rig.wait(0.05)
    for host in hosts:
        rig.relay.leave(host, rig.now)
    rig.exchange()
    rig.wait(2.0)
    _, holder = rig.open_host("holder")
    rig.say(holder, commands.Enable(on=True), commands.Vel(speed=0.3))
    rig.relay.robot_sent(robots, rig.now)
    _, watcher = rig.host("watcher")
    for sync in (0, 1, 2):
        rig.send(watcher, encode(bytes([sync])))
    rig.say(watcher, commands.Open())
    rig.wait(0.1)
    before = len(rig.commands)
    rig.say(watcher, commands.Stop())
    assert commands.Stop() in rig.since(before)
    assert rig.speed_mm == 0


@given(payload=st.binary(min_size=1, max_size=MAX_PAYLOAD), others=PAYLOADS)
def test_of_a_watcher_only_stops_and_questions_for_the_settings_pass(
    payload: bytes, others: list[bytes]
) -> None:
    rig = Rig()
    rig.open_host("holder")
    _, watcher = rig.open_host("watcher")
    rig.relay.robot.outgoing()
    rig.relay.receive(watcher, b"".join(map(encode, [payload, *others])), rig.now)
    passed = {sent[0] for sent in payloads(rig.relay.robot.outgoing())}
    assert passed <= {18, 29, 55, 4}
    stops = {29, 55, 57}
    if not stops & {each[0] for each in (payload, *others)}:
        assert passed <= {18}
