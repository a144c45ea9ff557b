"""Faults in words, and what a cable with them delivers."""

from math import inf

import pytest

from pioneer3.arcos.packet import encode
from pioneer3.errors import ConfigError
from pioneer3.sim.server.faults import CableDirection, LinkFaults

PULSE = encode(b"\0")


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("drop=0.01,corrupt=0.001,delay=0.2", (0.01, 0.001, 0.2, False, False)),
        (" delay = 1 , drop=1", (1.0, 0.0, 1.0, False, False)),
        ("frozen", (0, 0, 0, True, False)),
        ("unplugged,corrupt=1e-3", (0, 0.001, 0, False, True)),
        ("", (0, 0, 0, False, False)),
        ("none", (0, 0, 0, False, False)),
    ],
)
def test_faults_are_read(text: str, values: tuple[object, ...]) -> None:
    faults = LinkFaults.parse(text)
    got = (faults.drop, faults.corrupt, faults.delay, faults.frozen, faults.unplugged)
    assert got == values
    again = LinkFaults.parse(str(faults))
    assert str(again) == str(faults)


def test_the_seed_is_in_the_text_or_beside_it() -> None:
    assert LinkFaults.parse("drop=0.5", seed=7).seed == 7
    assert LinkFaults.parse("drop=0.5,seed=8", seed=7).seed == 8
    assert str(LinkFaults.parse("drop=0.5,seed=8")) == "drop=0.5,seed=8"


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("drap=0.1", "link faults: 'drap' is none; did you mean 'drop'?"),
        ("weather=bad", "link faults: 'weather' is none; write them such as drop="),
        ("drop", "drop needs a value"),
        ("drop=", "drop: '' is not a number"),
        ("drop=much", "drop: 'much' is not a number"),
        ("drop=2", "drop: 2 is not a share from 0 to 1"),
        ("corrupt=-0.1", "corrupt: -0.1 is not a share from 0 to 1"),
        ("corrupt=nan", "corrupt: nan is not a share from 0 to 1"),
        ("delay=-1", "delay: -1 is not a time from 0 s"),
        ("delay=inf", "delay: inf is not a time from 0 s"),
        ("frozen=1", "frozen takes no value"),
        ("seed=1.5", "seed: '1.5' is not a number"),
    ],
)
def test_a_wrong_word_is_named(text: str, says: str) -> None:
    with pytest.raises(ConfigError) as error:
        LinkFaults.parse(f"delay=0.1,{text}")
    assert says in str(error.value)


def test_a_good_cable_says_so() -> None:
    assert str(LinkFaults()) == "none"
    assert not LinkFaults().any


def test_bytes_travel_as_long_as_the_cable_says_and_do_not_overtake_each_other() -> None:
    faults = LinkFaults(delay=0.2)
    line = CableDirection(faults, "out")
    assert line.transmit(b"a", 1.0) == b""
    faults.delay = 0.0  # a better cable does not bring the new ones before the old
    assert line.transmit(b"b", 1.1) == b""
    assert line.due == 1.2
    assert line.transmit(b"", 1.19) == b""
    assert line.transmit(b"", 1.2) == b"ab"
    assert line.due == inf
    assert line.transmit(b"c", 1.3) == b"c"


def test_what_is_sent_through_a_frozen_cable_is_lost() -> None:
    faults = LinkFaults(delay=0.1)
    line = CableDirection(faults, "out")
    line.transmit(b"on its way", 1.0)
    faults.frozen = True
    assert line.transmit(b"more", 1.05) == b""
    faults.frozen = False
    assert line.transmit(b"", 5.0) == b""
    assert line.transmit(b"heard", 5.0) == b""
    assert line.transmit(b"", 5.1) == b"heard"


def test_packets_are_lost_whole_and_one_by_one() -> None:
    line = CableDirection(LinkFaults(drop=0.5, seed=1), "out")
    arrived = line.transmit(b"noise" + PULSE * 200, 0.0)
    assert arrived.count(PULSE) * len(PULSE) + 5 * arrived.startswith(b"noise") == len(arrived)
    assert 70 <= arrived.count(PULSE) <= 130


def test_nothing_arrives_where_everything_is_lost() -> None:
    assert CableDirection(LinkFaults(drop=1.0), "in").transmit(PULSE * 9, 0.0) == b""


def test_a_corrupt_byte_is_another_one() -> None:
    data = bytes(range(256))
    arrived = CableDirection(LinkFaults(corrupt=1.0), "in").transmit(data, 0.0)
    assert len(arrived) == len(data)
    assert all(a != b for a, b in zip(arrived, data, strict=True))


def test_the_two_directions_have_chances_of_their_own() -> None:
    faults = LinkFaults(corrupt=0.5)
    data = bytes(100)
    assert CableDirection(faults, "in").transmit(data, 0.0) != CableDirection(
        faults, "out"
    ).transmit(data, 0.0)
