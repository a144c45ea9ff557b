"""Frames in, payloads out, whatever the line does to them."""

import pytest

from pioneer3.arcos.packet import MAX_PAYLOAD, PAUSE, PacketReader, checksum, encode
from pioneer3.errors import CommandError

PULSE = bytes.fromhex("fafb03000000")
STOP = bytes.fromhex("fafb031d001d")
LIAR = b"\xfa\xfb\xff"  # a false header that claims 255 bytes to come


@pytest.mark.parametrize(
    ("payload", "sum_"),
    [
        (b"\x1d", 0x001D),  # one byte: XORed
        (b"\x0b\x3b", 0x0B3B),  # one word
        (b"\x0b\x3b\xc8\x00", 0x0B3B + 0xC800),
        (b"\xff\xff\x00\x02", 0x0001),  # wraps at 16 bits
        (b"\x01\x02\x03", 0x0102 ^ 0x03),
    ],
)
def test_the_checksum_adds_words_and_xors_an_odd_byte(payload: bytes, sum_: int) -> None:
    assert checksum(payload) == sum_


def test_a_frame_is_header_count_payload_checksum() -> None:
    assert encode(b"\x1d") == STOP


@pytest.mark.parametrize("size", [0, MAX_PAYLOAD + 1])
def test_what_no_frame_can_carry_is_refused(size: int) -> None:
    with pytest.raises(CommandError, match=f"1 to 253 bytes, not {size}"):
        encode(bytes(size))


@pytest.mark.parametrize("size", [1, 2, 3, 200, MAX_PAYLOAD])
def test_every_size_comes_back(size: int) -> None:
    payload = bytes(i % 251 for i in range(size))
    assert PacketReader().feed(encode(payload)) == [payload]


def test_several_frames_in_one_read_come_in_order() -> None:
    assert PacketReader().feed(PULSE + STOP + PULSE) == [b"\0", b"\x1d", b"\0"]


@pytest.mark.parametrize("cut", range(len(STOP) + 1))
def test_a_frame_may_come_in_two_pieces(cut: int) -> None:
    reader = PacketReader()
    assert reader.feed(STOP[:cut]) + reader.feed(STOP[cut:]) == [b"\x1d"]


def test_a_doubled_first_header_byte_costs_nothing() -> None:
    assert PacketReader().feed(b"\xfa" + STOP) == [b"\x1d"]


def test_a_frame_with_a_wrong_checksum_is_counted_and_kept_aside() -> None:
    reader = PacketReader()
    assert reader.feed(STOP[:-1] + b"\x1c") == []
    assert (reader.packets, reader.bad_checksums) == (0, 1)
    assert reader.rejected == [b"\x1d"]
    assert reader.bytes_skipped == len(STOP)
    reader.feed(b"")
    assert reader.rejected == []


def test_only_the_last_few_rejected_frames_are_kept() -> None:
    reader = PacketReader()
    reader.feed((STOP[:-1] + b"\x1c") * 50)
    assert reader.bad_checksums == 50
    assert len(reader.rejected) == 8


def test_a_frame_inside_a_rejected_one_is_found() -> None:
    reader = PacketReader()
    assert reader.feed(b"\xfa\xfb\x09" + STOP + bytes(3)) == [b"\x1d"]


@pytest.mark.parametrize("count", [0, 1, 2])
def test_a_count_too_small_for_any_payload_is_no_frame(count: int) -> None:
    reader = PacketReader()
    assert reader.feed(bytes([0xFA, 0xFB, count]) + bytes(8) + STOP) == [b"\x1d"]
    assert reader.packets == 1


def test_every_byte_is_either_in_a_frame_or_skipped() -> None:
    reader = PacketReader()
    reader.feed(b"noise" + STOP + b"\xfa" + PULSE + b"\xfb\xfa", 0.0)
    assert reader.bytes_skipped == len(b"noise") + 1 + 1  # a last 0xFA may begin a frame
    reader.feed(b"x", 0.01)
    assert reader.bytes_skipped == len(b"noise") + 1 + 1 + 2


def test_a_liar_holds_back_frames_only_until_the_line_pauses() -> None:
    reader = PacketReader()
    assert reader.feed(LIAR + STOP, 0.0) == []
    assert reader.feed(b"", PAUSE) == []
    assert reader.feed(b"", PAUSE + 0.001 + PAUSE) == [b"\x1d"]
    assert reader.bytes_skipped == len(LIAR)


def test_behind_a_pause_all_frames_come_out_in_order() -> None:
    reader = PacketReader()
    assert reader.feed(LIAR + STOP + PULSE, 0.0) == []
    assert reader.feed(STOP, 1.0) == [b"\x1d", b"\0", b"\x1d"]


def test_a_frame_that_pauses_in_the_middle_is_still_taken() -> None:
    reader = PacketReader()
    assert reader.feed(STOP[:4], 0.0) == []
    assert reader.feed(STOP[4:], 10.0) == [b"\x1d"]


def test_a_pause_between_frames_changes_nothing() -> None:
    reader = PacketReader()
    assert reader.feed(STOP, 0.0) == [b"\x1d"]
    assert reader.feed(STOP, 10.0) == [b"\x1d"]
    assert reader.bytes_skipped == 0


def test_behind_a_pause_a_liar_behind_a_liar_does_not_help_either() -> None:
    reader = PacketReader()
    assert reader.feed(LIAR + LIAR + STOP, 0.0) == []
    assert reader.feed(b"", 1.0) == [b"\x1d"]
