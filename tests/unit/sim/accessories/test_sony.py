"""The camera against what ARIA's ArSonyPTZ and libvisca send."""

from math import radians

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pioneer3.sim.accessories.pan_tilt_zoom import PtzPosition
from pioneer3.sim.accessories.sony import SimulatedSonyEvi

ACK, DONE, SYNTAX = b"\x90\x41\xff", b"\x90\x51\xff", b"\x90\x60\x02\xff"
ARIA_INIT = bytes.fromhex("88010001ff 883001ff")


def say(camera: SimulatedSonyEvi, said: str, now: float = 0.0) -> bytes:
    camera.receive(bytes.fromhex(said), now)
    return camera.transmit(now)


@pytest.fixture
def camera() -> SimulatedSonyEvi:
    return SimulatedSonyEvi()


def test_aria_s_init_clears_and_numbers_the_chain(camera: SimulatedSonyEvi) -> None:
    assert say(camera, ARIA_INIT.hex()) == bytes.fromhex("88010001ff 883002ff")
    assert say(camera, "81 01 00 01 ff") == bytes.fromhex("9050ff")


def test_a_position_is_acknowledged_at_once_and_done_later(camera: SimulatedSonyEvi) -> None:
    # 50 degrees right and 12.5 up: 50 degrees at 80 a second
    assert say(camera, "81 01 06 02 18 14 00010b08 00000906 ff") == ACK
    assert camera.transmit(0.6) == b""
    assert camera.transmit(0.63) == DONE
    position = camera.position(0.63)
    assert position.pan == pytest.approx(radians(-50))
    assert position.tilt == pytest.approx(radians(12.5))
    assert say(camera, "81 09 06 12 ff", 1.0) == bytes.fromhex("9050 00010b08 00000906 ff")


def test_left_and_down_are_negative(camera: SimulatedSonyEvi) -> None:
    camera.receive(bytes.fromhex("81 01 06 02 18 14 0f0c0900 0f0e0d04 ff"), 0.0)
    position = camera.position(9.0)
    assert position.pan == pytest.approx(radians(100))
    assert position.tilt == pytest.approx(radians(-25))
    assert camera.transmit(9.0) == ACK + DONE
    assert say(camera, "81 09 06 12 ff", 9.0) == bytes.fromhex("9050 0f0c0900 0f0e0d04 ff")


def test_beyond_the_end_it_stops_at_the_end(camera: SimulatedSonyEvi) -> None:
    say(camera, "81 01 06 02 18 14 070f0f0f 070f0f0f ff")
    assert camera.position(9.0).pan == pytest.approx(radians(-100))


def test_the_speed_counts(camera: SimulatedSonyEvi) -> None:
    say(camera, "81 01 06 02 03 14 00030700 00000000 ff")
    assert camera.position(1.0).pan == pytest.approx(radians(-10))


def test_relative_home_and_stop(camera: SimulatedSonyEvi) -> None:
    turn = "81 01 06 03 18 14 00000508 00000000 ff"
    for second in (0.0, 1.0):
        say(camera, turn, second)
    assert camera.position(2.0).pan == pytest.approx(radians(-20))
    say(camera, "81 01 06 04 ff", 2.0)
    assert say(camera, "81 01 06 01 00 00 03 03 ff", 2.125) == ACK + DONE
    assert camera.position(9.0).pan == pytest.approx(radians(-10))
    say(camera, "81 01 06 05 ff", 9.0)
    assert camera.position(20.0) == PtzPosition(0.0, 0.0, 0.0)


def test_it_zooms(camera: SimulatedSonyEvi) -> None:
    assert say(camera, "81 01 04 47 00030f0f ff") == ACK
    assert camera.position(1.5).zoom == pytest.approx(0.5)
    assert say(camera, "81 09 04 47 ff", 9.0) == DONE + bytes.fromhex("9050 00030f0f ff")


def test_settings_are_taken_without_effect(camera: SimulatedSonyEvi) -> None:
    assert say(camera, "81 01 04 33 02 ff") == ACK + DONE


def test_switched_off_it_only_wakes_up(camera: SimulatedSonyEvi) -> None:
    assert say(camera, "81 01 04 00 03 ff") == ACK + DONE
    assert say(camera, "81 09 04 00 ff") == bytes.fromhex("905003ff")
    assert say(camera, "81 01 06 04 ff") == bytes.fromhex("906141ff")
    assert say(camera, "81 01 04 00 02 ff") == ACK + DONE
    assert say(camera, "81 01 06 04 ff") == ACK + DONE


@pytest.mark.parametrize(
    "bad",
    [
        "81 ff",
        "81 01 06 02 18 14 00 ff",
        "81 01 06 02 00 14 00000000 00000000 ff",
        "81 01 06 77 01 ff",
        "81 01 04 47 00 ff",
        "81 01 33 01 01 ff",
        "81 02 04 47 00 ff",
        "81 09 09 09 ff",
    ],
)
def test_nonsense_is_refused(camera: SimulatedSonyEvi, bad: str) -> None:
    assert say(camera, bad) == SYNTAX


@pytest.mark.parametrize("other", ["ff", "82 01 06 04 ff", "00 11 22 33 ff"])
def test_what_is_for_others_is_not_answered(camera: SimulatedSonyEvi, other: str) -> None:
    assert say(camera, other) == b""


def test_packets_may_come_in_pieces(camera: SimulatedSonyEvi) -> None:
    for byte in bytes.fromhex("81 01 06 04"):
        camera.receive(bytes([byte]), 0.0)
    assert say(camera, "ff") == ACK + DONE
    assert say(camera, "01" * 50 + "ff" + "81 01 06 04 ff") == ACK + DONE


@given(st.lists(st.tuples(st.binary(max_size=14), st.floats(0, 5)), max_size=12))
def test_it_takes_anything(said: list[tuple[bytes, float]]) -> None:
    made = SimulatedSonyEvi()
    now = 0.0
    for data, pause in said:
        now += pause
        made.receive(data + b"\xff\x81\x01" + data + b"\xff\x81\x09" + data + b"\xff", now)
        made.transmit(now)
        position = made.position(now)
        assert abs(position.pan) <= radians(100.1)
        assert abs(position.tilt) <= radians(25.1)
        assert 0 <= position.zoom <= 1
    assert isinstance(made.transmit(now + 1000), bytes)
    assert made.transmit(now + 2000) == b""
