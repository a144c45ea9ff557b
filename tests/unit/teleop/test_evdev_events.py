"""Input events as real gamepads send them."""

import pytest

from pioneer3.teleop.evdev import EVENT, Decoder, Range
from pioneer3.teleop.gamepad import Gamepad

XBOX, SONY = Range(-32768, 32767), Range(0, 255)
PRESS_L1 = "70f1a0650000000012d3040000000000 0100 3601 01000000"
LEFT_ALL_THE_WAY = "70f1a0650000000012d3040000000000 0300 0000 0080ffff"
REPORT = "70f1a0650000000012d3040000000000 0000 0000 00000000"


def test_an_event_is_as_long_as_the_kernels() -> None:
    assert EVENT.size in {16, 24}  # 32 and 64 bits


@pytest.mark.skipif(EVENT.size != 24, reason="the bytes are of a 64-bit machine")
def test_bytes_of_a_real_gamepad_are_understood() -> None:
    decoder = Decoder(Gamepad(), {0: XBOX, 1: XBOX})
    decoder.feed(bytes.fromhex(PRESS_L1 + LEFT_ALL_THE_WAY + REPORT))
    assert decoder.pressed == [4]
    assert decoder.gamepad.wanted.w == pytest.approx(0.6)
    assert decoder.gamepad.wanted.v == 0.0


@pytest.mark.parametrize(
    ("kind", "value", "part"),
    [
        (XBOX, -32768, -1.0),
        (XBOX, 32767, 1.0),
        (XBOX, 0, 0.0),
        (SONY, 0, -1.0),
        (SONY, 255, 1.0),
        (SONY, 128, 0.0),
        (Range(0, 0), 5, 0.0),
    ],
)
def test_an_axis_says_how_far_out_it_is(kind: Range, value: int, part: float) -> None:
    assert kind.part(value) == pytest.approx(part, abs=0.005)
