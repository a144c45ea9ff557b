"""Hosts that ask almost sensibly, and lasers that answer so: nothing is raised, nothing grows."""

from math import inf, nan

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pioneer3.lasers.cola.client import ColaClient
from pioneer3.lasers.cola.connection import MOST_POLLS
from pioneer3.lasers.cola.wire import ColaTelegramReader, encode
from pioneer3.lasers.device import LaserDevice, Sweep
from pioneer3.lasers.lms2xx import telegram as lms
from pioneer3.lasers.lms2xx.commands import CommandCode, OperatingMode
from pioneer3.lasers.lms2xx.device import LmsDevice
from pioneer3.lasers.scip.device import ScipDevice
from pioneer3.models.lasers import LASERS
from tests.combinations import examples
from tests.unit.lasers.cola_room import LOGIN, Room, laser

WORDS = st.sampled_from(
    [
        "0",
        "1",
        "FFFF",
        "FFFFFFFF",
        "80000000",
        "7FFFFFFF",
        "7FC00000",
        "7F800000",
        "FF800000",
        "3F800000",
        "1388",
        "x",
        "DIST1",
        "RSSI1",
        "+0",
        "-1",
        "+5000",
        "+2500",
        "-450000",
        "+2250000",
        "+65535",
        "+9999999999",
        "LMDscandata",
        "ÿ",
        "",
        "",
    ]
)
COLA_BEGINS = f"""{LOGIN}
sRN LMDscandata
sRN STlms
sRI0
sMN Run
sMN LMCstopmeas
sMN LMCstartmeas
sMN mSCreboot
sMN mEEwriteall
sMN mLMPsetscancfg +5000 +1 +5000
sMN LSPsetdatetime +9999 +12 +31 +23 +59
sWN LMDscandatacfg FF FF 1 1 0 FF FF 1 1 1 1
sWN LMPoutputRange 1 1388
sWN FREchoFilter
sWN
sEN LMDscandata
""".split("\n")
COLA_REQUESTS = st.builds(
    lambda begin, words: " ".join([begin, *words]),
    st.sampled_from(COLA_BEGINS),
    st.lists(WORDS, max_size=3),
)
SCIP_REQUESTS = st.one_of(
    st.sampled_from(
        [
            "BM",
            "QT",
            "RS",
            "RB",
            "TM0",
            "TM1",
            "TM2",
            "VV",
            "PP",
            "II",
            "SCIP2.0",
            "V",
            "L1",
            "L0",
            "CR10",
            "HS1",
            "%SL",
            ";",
            "VV;comment",
            "SS115200",
            "SS000000",
            "SS999999",
            "S0576007654321",
            "S0000007654321",
            "G00076801",
            "G76800001",
            "G99999999",
        ]
    ),
    st.builds(
        "{}{:04}{:04}{:02}{}".format,
        st.sampled_from(["MD", "MS", "ME", "ND", "NE", "GD", "GS", "GE", "HD", "HE"]),
        st.sampled_from([0, 44, 384, 725, 1080, 9999]),
        st.sampled_from([0, 44, 384, 725, 1080, 9999]),
        st.integers(0, 99),
        st.sampled_from(["", "000", "999", "001"]),
    ),
)
LMS_REQUESTS = st.builds(
    lms.encode,
    st.sampled_from([*CommandCode, 0x55]),
    st.one_of(
        st.binary(max_size=40),
        st.sampled_from([bytes((mode,)) for mode in OperatingMode] + [b"\x00SICK_LMS", b"\x01"]),
        st.sampled_from(["b4006400", "b4003200", "640019000", "2701000101"]).map(
            lambda text: bytes.fromhex(text[: len(text) // 2 * 2])
        ),
    ),
)
RANGES = st.sampled_from([0.0, 1e-9, 0.5, 7.9, 1e3, 1e12, inf, nan])


def turn_and_send(device: LaserDevice, metres: float, now: float) -> float:
    """Let the mirror turn, if it does, and all bytes leave; return the time afterwards."""
    if (turn := device.turn) is not None:
        assert 0 < turn.count < 3000
        assert turn.period > 0
        ranges, light = [metres] * turn.count, [abs(metres) if metres < inf else 0.0] * turn.count
        device.measured(Sweep(turn=turn, began=now, ranges=ranges, intensities=light), now + 0.1)
    device.tick(now + 0.1)
    return now + 0.1


@pytest.mark.parametrize("name", ["lms-111", "lms-511", "tim551"])
@settings(max_examples=examples(60))
@given(st.lists(st.tuples(COLA_REQUESTS, RANGES, st.floats(0, 1e5)), max_size=12))
def test_no_request_stops_a_cola_laser(name: str, asked: list[tuple[str, float, float]]) -> None:
    device, now = laser(name), 0.0
    host, other = device.connect(), device.connect()
    host.receive(encode(LOGIN), now)
    for text, metres, pause in asked:
        host.receive(encode(text or " "), now)
        now = turn_and_send(device, metres, now + pause)
        heard = ColaTelegramReader()
        heard.feed(host.outgoing(now))
        assert heard.rejected == 0
    other.receive(encode("sRN STlms"), now)
    device.connect().receive(encode("sRN STlms"), now)


@pytest.mark.parametrize("name", ["urg-04lx", "utm-30lx", "ust-10lx"])
@settings(max_examples=examples(60))
@given(st.lists(st.tuples(SCIP_REQUESTS, RANGES), max_size=12))
def test_no_request_stops_a_scip_laser(name: str, asked: list[tuple[str, float]]) -> None:
    device, now = ScipDevice(LASERS[name], boot_time=0.0), 0.0
    host = device.connect()
    for text, metres in asked:
        host.receive(text.encode() + b"\n", now)
        now = turn_and_send(device, metres, now)
        assert host.outgoing(now).isascii()
        now += 60.0
        host.outgoing(now)
        host.outgoing(now)
    host.receive(b"\nTM2\nSCIP2.0\nTM2\nQT\n", now)
    host.outgoing(now + 60.0)
    assert device.turn is None


@settings(max_examples=examples(60))
@given(st.lists(st.tuples(LMS_REQUESTS, RANGES), max_size=12))
def test_no_request_stops_an_lms(asked: list[tuple[bytes, float]]) -> None:
    device, now = LmsDevice(LASERS["lms-200"], boot=0.0), 0.0
    host = device.connect()
    for data, metres in asked:
        host.receive(data, now)
        now = turn_and_send(device, metres, now)
        for _ in range(4):
            now += 2.0
            device.tick(now)
            host.outgoing(now)
    host.receive(lms.encode(CommandCode.MODE, b"\x25"), now + 1.0)
    host.outgoing(now + 9.0)
    assert device.turn is None


def test_a_date_at_the_end_of_the_calendar_is_refused() -> None:
    device = laser()
    host = device.connect()
    host.receive(encode(LOGIN) + encode("sMN LSPsetdatetime +9999 +12 +31 +23 +59 +59 0"), 0.0)
    assert host.outgoing(0.0).endswith(encode("sAN LSPsetdatetime 0"))
    host.receive(encode("sRN STlms"), 1e4)
    assert host.outgoing(1e4).startswith(b"\x02sRA STlms 7 ")


def test_requests_for_a_scan_that_is_long_in_coming_do_not_pile_up() -> None:
    device = laser()
    host = device.connect()
    for _ in range(100):
        host.receive(encode("sRN LMDscandata"), 0.0)
    assert host.polling == MOST_POLLS
    assert host.outgoing(0.0).count(b"sFA D") == 100 - MOST_POLLS
    assert turn_and_send(device, 1.0, 0.0) > 0
    assert host.outgoing(0.1).count(b"sRA LMDscandata") == MOST_POLLS


def test_a_scip_host_that_only_asks_costs_bounded_memory() -> None:
    device = ScipDevice(LASERS["urg-04lx"], scip1=False)
    host = device.connect()
    for _ in range(5000):
        host.receive(b"BM\nGD0044072501\nVV\nPP\nII\n", 0.0)
        if host.wants_readings:
            turn_and_send(device, 1.0, 0.0)
    assert host.line.waiting < 300_000


@settings(max_examples=examples(150), deadline=None)
@given(st.data())
def test_no_word_of_an_answer_makes_a_cola_client_raise(data: st.DataObject) -> None:
    room = Room(laser(), ColaClient(0.0))
    assert room.client is not None
    room.run(0.2)
    room.connection.receive(encode("sRN LMDscandata"), room.now)
    scan = ColaTelegramReader().feed(room.connection.outgoing(room.now))[-1]
    other = data.draw(st.sampled_from(["sAN SetAccessMode 1", "sRA STlms 7 0 8 00:00:00 8 1"]))
    words = data.draw(st.sampled_from([scan, other])).split(" ")
    for _ in range(data.draw(st.integers(1, 3))):
        place = data.draw(st.integers(0, min(len(words) - 1, 40)))
        words[place] = data.draw(WORDS)
    before = len(room.scans)
    room.events += room.client.receive(
        b"\x02" + " ".join(words).encode("latin-1") + b"\x03", room.now
    )
    for each in room.scans[before:]:
        assert len(each.ranges) < 5000
    room.run(0.2)
    assert len(room.scans[-1].ranges) == 541
