"""The camera against what ARIA's ArVCC4 sends and expects."""

from math import radians

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pioneer3.sim.accessories.canon import SimulatedCanonVcc4
from pioneer3.sim.accessories.pan_tilt_zoom import PtzPosition


def frame(command: int, parameters: bytes = b"") -> bytes:
    return b"\xff00\x00" + bytes([command]) + parameters + b"\xef"


def answer(error: bytes = b"0", data: bytes = b"") -> bytes:
    return b"\xfe00" + error + b"0" + data + b"\xef"


POWER_ON, CONTROL, INIT = frame(0xA0, b"1"), frame(0x90, b"0"), frame(0x58, b"0")
RANGE = frame(0x64, b"17EF5830E")
OK, BAD, MODE = answer(), answer(b"5"), answer(b"9")


def say(camera: SimulatedCanonVcc4, said: bytes, now: float = 0.0) -> bytes:
    camera.receive(said, now)
    return camera.transmit(now)


@pytest.fixture
def camera() -> SimulatedCanonVcc4:
    made = SimulatedCanonVcc4()
    for step in (POWER_ON, CONTROL, INIT, frame(0x50, b"320"), frame(0x51, b"265"), RANGE):
        assert say(made, step) == OK
    return made


def test_answers_have_the_lengths_that_aria_asks_for(camera: SimulatedCanonVcc4) -> None:
    assert len(say(camera, INIT)) == 6
    assert len(say(camera, frame(0x63))) == 14
    assert len(say(camera, frame(0xB4, b"0"))) == 10


def test_it_turns_to_a_position_and_says_where_it_is(camera: SimulatedCanonVcc4) -> None:
    pan, tilt = round(45 / 0.1125) + 0x8000, round(-20 / 0.1125) + 0x8000
    assert say(camera, frame(0x62, b"%04X%04X" % (pan, tilt)), 1.0) == OK
    assert say(camera, frame(0x63), 10.0) == answer(data=b"%04X%04X" % (pan, tilt))
    position = camera.position(10.0)
    assert position.pan == pytest.approx(radians(-45), abs=1e-3)
    assert position.tilt == pytest.approx(radians(-20), abs=1e-3)


def test_it_takes_the_time_of_its_slew_rate(camera: SimulatedCanonVcc4) -> None:
    say(camera, frame(0x62, b"%04X8000" % (0x8000 + 800)), 1.0)
    assert camera.position(1.5).pan == pytest.approx(radians(-45))
    assert say(camera, frame(0x50, b"0C8"), 1.5) == OK
    assert camera.position(2.5).pan == pytest.approx(radians(-67.5))
    assert say(camera, frame(0x53, b"0"), 2.5) == OK
    assert camera.position(9.0).pan == pytest.approx(radians(-67.5))


def test_it_zooms_and_stops_zooming(camera: SimulatedCanonVcc4) -> None:
    assert say(camera, frame(0xB3, b"07A8"), 0.0) == OK
    assert camera.position(1.5).zoom == pytest.approx(0.5)
    assert say(camera, frame(0xA2, b"0"), 1.5) == OK
    assert say(camera, frame(0xB4, b"0"), 5.0) == answer(data=b"03D4")


@pytest.mark.parametrize(
    "bad",
    [
        frame(0x62, b"9000"),
        frame(0x62, b"FFFF8000"),
        frame(0x62, b"8000FFFF"),
        frame(0x62, b"80008zz0"),
        frame(0xB3, b"FFFF"),
        frame(0x50, b"001"),
        frame(0x64, b"100000000"),
        frame(0x01),
    ],
)
def test_nonsense_is_refused_and_moves_nothing(camera: SimulatedCanonVcc4, bad: bytes) -> None:
    assert say(camera, bad, 1.0) == BAD
    assert camera.position(9.0) == PtzPosition(0.0, 0.0, 0.0)


def test_until_the_range_is_set_it_tilts_to_30_degrees() -> None:
    made = SimulatedCanonVcc4()
    say(made, POWER_ON + CONTROL)
    high = frame(0x62, b"8000%04X" % (0x8000 + round(60 / 0.1125)))
    assert say(made, high) == BAD
    assert say(made, RANGE) == OK
    assert say(made, high) == OK


def test_it_wants_power_and_control_first() -> None:
    made = SimulatedCanonVcc4()
    assert say(made, CONTROL) == MODE
    assert say(made, POWER_ON) == OK
    assert say(made, INIT) == MODE
    assert say(made, CONTROL + INIT) == OK + OK
    assert say(made, frame(0xA0, b"0")) == OK
    assert say(made, INIT) == MODE


@pytest.mark.parametrize("command", [0x8E, 0xA1, 0xB5, 0xB7, 0x76])
def test_lamps_focus_and_filters_are_acknowledged(camera: SimulatedCanonVcc4, command: int) -> None:
    assert say(camera, frame(command, b"0")) == OK


def test_it_says_its_name(camera: SimulatedCanonVcc4) -> None:
    assert say(camera, frame(0x87)) == answer(data=b"VC-C4")


def test_frames_may_come_in_pieces_and_in_noise(camera: SimulatedCanonVcc4) -> None:
    for byte in b"\x12\xef\x00" + INIT[:-1]:
        assert say(camera, bytes([byte])) == b""
    assert say(camera, INIT[-1:]) == OK
    assert say(camera, INIT[:4] + INIT) == OK
    assert say(camera, b"\xff" + b"x" * 100 + b"\xef" + INIT) == OK
    assert say(camera, b"\xff11\x00\x58\xef") == b""


@given(st.lists(st.tuples(st.binary(max_size=12), st.floats(0, 5)), max_size=12))
def test_it_takes_anything(said: list[tuple[bytes, float]]) -> None:
    made = SimulatedCanonVcc4()
    now = 0.0
    for data, pause in said:
        now += pause
        made.receive(POWER_ON + CONTROL + data, now)
        if data:
            made.receive(frame(data[0], data[1:].replace(b"\xff", b"").replace(b"\xef", b"")), now)
        assert made.transmit(now).count(b"\xef") >= 2
        position = made.position(now)
        assert abs(position.pan) <= radians(99)
        assert 0 <= position.zoom <= 1
