"""Lines, checksums and numbers of SCIP are as on the page, and as other programs print them."""

from math import isnan

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pioneer3.lasers.scip.identity import device_id, identity_from, is_healthy, steps_from
from pioneer3.lasers.scip.scans import FORMATS, decode, ranges_of
from pioneer3.lasers.scip.wire import (
    MAX_ANSWER,
    ZERO,
    AnswerReader,
    decode_stamp,
    decode_values,
    encode_values,
    from_lines,
    from_pairs,
    pair,
    seal,
    to_lines,
    unseal,
)
from pioneer3.models.lasers import LASERS

INF = float("inf")

PAIRS = (
    "DMIN:20;4",
    "DMAX:5600;_",
    "ARES:1024;\\",
    "AMIN:44;7",
    "AMAX:725;o",
    "AFRT:384;6",
    "SCAN:600;e",
    "MODL:URG-04LX;9",
    "MODL:UTM-30LX-EW;I",
    "DMIN:23;7",
    "DMAX:60000;J",
    "ARES:1440;^",
    "AMIN:0;?",
    "AMAX:1080;Z",
    "AFRT:540;0",
    "SCAN:2400;U",
)


@pytest.mark.parametrize("line", PAIRS)
def test_lines_of_real_lasers_both_ways(line: str) -> None:
    key, value = line[:-2].split(":")
    assert pair(key, value) == line.encode() + b"\n"
    assert from_pairs([line.encode()]) == {key: value}


@pytest.mark.parametrize(
    ("status", "line"), [(b"00", b"00P"), (b"99", b"99b"), (b"02", b"02R"), (b"0E", b"0Ee")]
)
def test_statuses_both_ways(status: bytes, line: bytes) -> None:
    assert seal(status) == line
    assert unseal(line) == status


@pytest.mark.parametrize(
    ("value", "width", "text"),
    [(1234, 2, b"CB"), (1234, 3, b"0CB"), (0, 2, b"00"), (4095, 2, b"oo"), (16777215, 4, b"oooo")],
)
def test_numbers_both_ways(value: int, width: int, text: bytes) -> None:
    assert encode_values([value], width) == text
    assert decode_values(text, width) == [value]


@given(st.sampled_from([2, 3, 4]), st.lists(st.integers(0, (1 << 24) - 1)))
def test_many_numbers_are_as_each_character_says(width: int, numbers: list[int]) -> None:
    numbers = [number % (1 << 6 * width) for number in numbers]
    places = range(6 * (width - 1), -1, -6)
    text = b"".join(bytes([(n >> shift & 0x3F) + ZERO for shift in places]) for n in numbers)
    assert encode_values(numbers, width) == text
    assert decode_values(text, width) == numbers


def test_a_line_has_64_characters_and_a_checksum() -> None:
    lines = to_lines(encode_values(range(30), 3)).splitlines()
    assert [len(line) for line in lines] == [65, 27]
    text = from_lines(lines)
    assert text is not None
    assert decode_values(text, 3) == list(range(30))
    assert from_lines([lines[0][:-2], *lines[1:]]) is None
    assert from_lines([lines[1], lines[0]]) is None


def test_a_checksum_may_count_the_semicolon() -> None:
    body = b"DMIN:20;"
    assert from_pairs([body + bytes([(sum(body) & 0x3F) + 0x30])]) == {"DMIN": "20"}


def test_the_first_firmware_sends_no_checksums() -> None:
    lines = [b"PROD:SOKUIKI Sensor URG-04LX", b"FIRM:2.2.00(18/Jul/2006)"]
    assert from_pairs(lines) is None
    assert from_pairs(lines, summed=False) == {
        "PROD": "SOKUIKI Sensor URG-04LX",
        "FIRM": "2.2.00(18/Jul/2006)",
    }


def test_a_time_stamp_is_four_characters() -> None:
    assert decode_stamp(seal(encode_values([0x123456], 4))) == 0x123456
    assert decode_stamp(seal(b"000")) is None
    assert decode_stamp(b"0000P") is None


def test_the_geometry_of_the_utm_begins_at_step_0() -> None:
    parameters = dict(line[:-2].split(":", 1) for line in PAIRS[9:])
    assert steps_from(parameters) == LASERS["utm-30lx"].steps
    assert steps_from({**parameters, "SCAN": "0"}) is None
    assert steps_from({**parameters, "ARES": "14x0"}) is None
    del parameters["AMIN"]
    assert steps_from(parameters) is None


def test_an_identity_is_told_in_parts() -> None:
    version = {"VEND": "Hokuyo", "FIRM": "3.3.00(12/Sep./2012)", "SERI": "0612345"}
    identity = identity_from(version, {"STAT": "Stable 000 no error."})
    assert (identity.firmware, identity.firmware_date) == ("3.3.00", "12/Sep./2012")
    assert identity.serial == "H612345"
    assert identity.status == "Stable 000 no error."
    assert identity_from({}, {}).firmware == ""


@pytest.mark.parametrize(
    ("serial", "told"), [("0612345", "H612345"), ("H0612345", "H0612345"), ("12", "H12"), ("", "")]
)
def test_a_serial_number_is_as_on_the_label(serial: str, told: str) -> None:
    assert device_id(serial) == told


@pytest.mark.parametrize(
    ("status", "healthy"),
    [("Sensor works well.", True), ("Stable 000 no error.", True), ("", True), ("Error 5", False)],
)
def test_health_is_read_from_the_status(status: str, healthy: bool) -> None:
    assert is_healthy(status) is healthy


@pytest.mark.parametrize(
    ("laser", "value", "metres"),
    [
        ("urg-04lx", 0, INF),
        ("urg-04lx", 6, INF),
        ("urg-04lx", 20, 0.02),
        ("urg-04lx", 5600, 5.6),
        ("urg-04lx", 5601, INF),
        ("urg-04lx", (1 << 18) - 1, INF),
        ("utm-30lx", 1, INF),
        ("utm-30lx", 2, -INF),
        ("utm-30lx", 23, 0.023),
        ("ust-10lx", 65533, INF),
        ("ust-10lx", 65535, INF),
        ("ust-10lx", 30000, 30.0),
    ],
)
def test_codes_are_as_in_rep_117(laser: str, value: int, metres: float) -> None:
    steps = LASERS[laser].steps
    assert steps is not None
    assert ranges_of([value], steps) == pytest.approx((metres,))
    assert ranges_of([1000, value], steps) == pytest.approx((1.0, metres))


@pytest.mark.parametrize(
    ("laser", "values"),
    [("urg-04lx", [1, 2, 3, 4, 5, *range(7, 20)]), ("utm-30lx", [0, 3, 4, 5, 22])],
)
def test_other_codes_are_no_reading(laser: str, values: list[int]) -> None:
    steps = LASERS[laser].steps
    assert steps is not None
    assert all(isnan(metres) for metres in ranges_of(values, steps))


def test_intensities_follow_distances() -> None:
    lines = to_lines(encode_values([1000, 7, 2000, 8], 3)).splitlines()
    readings = decode(lines, FORMATS["ME"], 2)
    assert readings is not None
    assert (readings.distances, readings.intensities) == ([1000, 2000], [7, 8])


def test_echoes_of_one_step_are_joined() -> None:
    one, two, three = (encode_values([value], 3) for value in (100, 200, 300))
    lines = to_lines(one + two + b"&" + three + one + b"&" + two + b"&" + three).splitlines()
    readings = decode(lines, FORMATS["ND"], 3)
    assert readings is not None
    assert readings.distances == [100, 200, 100]
    assert readings.echoes == [[100], [200, 300], [100, 200, 300]]
    assert decode(lines, FORMATS["ND"], 6) is None


def test_echoes_have_intensities() -> None:
    first, second, third = (encode_values(pair_, 3) for pair_ in ([100, 1], [200, 2], [300, 3]))
    readings = decode(to_lines(first + b"&" + second + third).splitlines(), FORMATS["NE"], 2)
    assert readings is not None
    assert readings.echoes == [[100, 200], [300]]
    assert readings.intensities == [1, 3]


def test_a_wrong_number_of_readings_is_refused() -> None:
    lines = to_lines(encode_values([1000, 2000], 3)).splitlines()
    assert decode(lines, FORMATS["MD"], 2) is not None
    assert decode(lines, FORMATS["MD"], 3) is None
    assert decode([], FORMATS["MD"], 2) is None


def test_an_answer_is_dated_with_its_first_byte() -> None:
    reader = AnswerReader()
    assert reader.feed(b"\n\n", 1.0) == []
    assert reader.feed(b"V", 2.0) == []
    assert reader.began(b"V") is not None
    answers = reader.feed(b"V\r\n00P\r\n\r\nPP\n00P\n\n", 3.0)
    assert [answer.lines for answer in answers] == [[b"VV", b"00P"], [b"PP", b"00P"]]
    assert [answer.began for answer in answers] == [2.0, 3.0]
    assert [answer.status for answer in answers] == ["00", "00"]


def test_an_echo_is_found_behind_noise() -> None:
    reader = AnswerReader()
    (answer,) = reader.feed(b"\xff\x00QT\n0Ee\n\n", 0.0)
    found = answer.after(b"QT")
    assert found is not None
    assert found.status == "0E"
    assert answer.after(b"VV") is None


def test_bytes_without_end_are_not_kept() -> None:
    reader = AnswerReader()
    for number in range(100):
        assert reader.feed(b"x" * (MAX_ANSWER // 10), float(number)) == []
    assert len(reader._buffer) <= MAX_ANSWER
    reader.discard()
    assert len(reader.feed(b"VV\n00P\n\n", 0.0)) == 1
