"""The gripper's switches and its exercise (protocol.md 4.7, facts.md 8.5)."""

import pytest

from pioneer3.arcos.commands import GripperAction
from pioneer3.arcos.packet import PacketReader, encode
from pioneer3.arcos.reports import GripperState, GripperSwitch, Sip, from_payload
from pioneer3.robot.devices.gripper import (
    GENERAL_IO,
    USER_IO,
    Exercise,
    GripperReading,
    PaddlePosition,
    read_switches,
    switches_in,
)

NOTHING_PRESSED = 0b0011_0011
"""Open 0x01, lift limit 0x02, both paddles 0x10 and 0x20 are active low."""


def reading(bits: int) -> GripperReading:
    return read_switches(GripperSwitch(bits), 0.0)


@pytest.mark.parametrize(
    ("bits", "paddles"),
    [
        (NOTHING_PRESSED, PaddlePosition.BETWEEN),
        (NOTHING_PRESSED & ~0x01, PaddlePosition.OPEN),
        (NOTHING_PRESSED & ~0x30, PaddlePosition.CLOSED),
        (
            NOTHING_PRESSED & ~0x31,
            PaddlePosition.CLOSED,
        ),  # both paddles count before the open switch
        (NOTHING_PRESSED & ~0x10, PaddlePosition.BETWEEN),
    ],
)
def test_the_paddles_as_aria_reads_them(bits: int, paddles: PaddlePosition) -> None:
    assert reading(bits).paddles is paddles


def test_beams_limit_and_motors() -> None:
    seen = reading(NOTHING_PRESSED | 0b1000_0100)
    assert (seen.outer_beam_broken, seen.inner_beam_broken) == (True, False)
    assert (seen.paddles_move, seen.lift_moves) == (True, False)
    assert not seen.lift_at_limit
    assert reading(NOTHING_PRESSED & ~0x02).lift_at_limit


def test_a_packet_on_the_wire() -> None:
    # type 2, paddles closed on something in the inner beam, lift at a limit; 10 * 20 ms
    frame = encode(bytes([0xE0, 2, 0b0000_1001, 10]))
    (payload,) = PacketReader().feed(frame, 0.0)
    packet = from_payload(payload)
    assert isinstance(packet, GripperState)
    seen = read_switches(packet.switches, 0.0)
    assert seen.paddles is PaddlePosition.CLOSED
    assert seen.inner_beam_broken
    assert seen.lift_at_limit


def test_general_wiring_reads_the_second_byte_and_user_wiring_the_inputs() -> None:
    sip = Sip(analog_port=0, gripper_state=0b0100_0100, analog=0, digital_in=0xF3, digital_out=0)
    assert switches_in(sip, GENERAL_IO) == GripperSwitch(0b0100_0100)
    # inputs 0 to 5, lift moving from bit 6 and grip moving from bit 2 of the byte
    assert switches_in(sip, USER_IO) == GripperSwitch(0b1111_0011)
    assert switches_in(Sip(), GENERAL_IO) is None


OPEN, CLOSED, AT_LIMIT = 0x32, 0x03, 0x31
"""Bits of paddles open, paddles closed, lift at a limit."""


def test_the_exercise_waits_for_the_gripper() -> None:
    exercise = Exercise(0.0)
    assert exercise.step(reading(AT_LIMIT), 2.9) is None  # three seconds at least
    assert exercise.step(reading(NOTHING_PRESSED), 3.5) is None
    assert exercise.step(reading(AT_LIMIT), 4.0) is GripperAction.CLOSE
    assert exercise.step(reading(OPEN), 13.9) is None
    assert exercise.step(reading(CLOSED), 13.9) is GripperAction.LIFT_DOWN
    assert exercise.step(reading(AT_LIMIT), 17.0) is GripperAction.OPEN
    assert exercise.step(reading(OPEN), 17.1) is GripperAction.LIFT_UP


def test_the_exercise_does_not_wait_for_ever() -> None:
    exercise, stuck = Exercise(0.0), reading(NOTHING_PRESSED)
    assert exercise.step(stuck, 29.9) is None
    assert exercise.step(stuck, 30.0) is GripperAction.CLOSE
    assert exercise.step(stuck, 39.9) is None
    assert exercise.step(stuck, 40.0) is GripperAction.LIFT_DOWN
    assert exercise.step(stuck, 70.0) is GripperAction.OPEN
    assert exercise.step(stuck, 80.0) is GripperAction.LIFT_UP
