"""Who speaks on a line that is not a robot."""

import pytest

from pioneer3.arcos.packet import encode
from pioneer3.doctor.recognition import (
    SCIP_QUESTION,
    Kind,
    lms_checksum,
    recognise,
)

VERSION = (
    b"\nVV\n00P\nVEND:Hokuyo Automatic Co.,Ltd.;[\nPROD:SOKUIKI Sensor URG-04LX;R\n"
    b"FIRM:3.3.00;b\nPROT:SCIP 2.0;N\nSERI:H0902345;k\n\n"
)
SENT = b"".join(encode(bytes([number])) for number in (0, 1, 2))


def telegram(data: bytes) -> bytes:
    """Return a SICK telegram from the laser."""
    body = b"\x02\x80" + len(data).to_bytes(2, "little") + data
    return body + lms_checksum(body).to_bytes(2, "little")


def test_silence_is_nobody() -> None:
    assert recognise(b"") is None


def test_a_scip_version_tells_maker_product_and_serial_number() -> None:
    who = recognise(VERSION)
    assert who is not None
    assert who.kind is Kind.LASER
    assert who.name.startswith("Hokuyo Automatic Co.,Ltd., SOKUIKI Sensor URG-04LX")
    assert who.name.endswith("serial number H0902345")


@pytest.mark.parametrize(
    "heard",
    [
        b"VV\n0E\n\n",
        b"\nMD0044072501000\n99b\n0001_\n00000\n\n",
        b"G00076801\n0\nabc\n\n",
        b"VV\r\n00P\r\n\r\n",
    ],
)
def test_an_echoed_scip_command_is_enough_for_a_laser(heard: bytes) -> None:
    who = recognise(heard)
    assert who is not None
    assert who.kind is Kind.LASER


def test_the_sick_checksum_is_the_one_of_the_status_request() -> None:
    assert lms_checksum(bytes.fromhex("0200010031")) == 0x1215


def test_a_sick_telegram_is_found_inside_noise() -> None:
    who = recognise(b"\x02\x80\xff" + telegram(b"\x90LMS200;30106;V02.10\x10") + b"\x02")
    assert who is not None
    assert (who.kind, who.name) == (Kind.LASER, "SICK LMS 2xx")


def test_a_sick_telegram_with_a_flipped_bit_is_no_laser() -> None:
    good = telegram(b"\x90LMS200;30106;V02.10\x10")
    for bit in range(32, len(good) * 8):
        bad = bytearray(good)
        bad[bit // 8] ^= 1 << bit % 8
        who = recognise(bytes(bad))
        assert who is not None
        assert who.kind is not Kind.LASER


def test_our_own_words_are_an_echo() -> None:
    who = recognise(SENT * 3, SENT)
    assert who is not None
    assert who.kind is Kind.ECHO


def test_a_robot_that_answers_two_of_three_syncs_is_no_echo() -> None:
    who = recognise(SENT[:12], SENT)
    assert who is not None
    assert (who.kind, who.name) == (Kind.PACKETS, "2 well-formed packets (number 0, 1)")


def test_packets_between_a_few_spoilt_bytes_are_still_packets() -> None:
    who = recognise(b"\xfb\x07" + encode(b"\x1d") + b"\xfa")
    assert who is not None
    assert (who.kind, who.name) == (Kind.PACKETS, "1 well-formed packet (number 29)")


def test_a_packet_in_much_noise_is_noise() -> None:
    who = recognise(b"\x91\x00\xfe" * 20 + encode(b"\x1d"))
    assert who is not None
    assert who.kind is Kind.NOISE


def test_a_readable_banner_is_quoted() -> None:
    who = recognise(b"SSH-2.0-OpenSSH_9.2\r\n", SENT)
    assert who is not None
    assert (who.kind, who.name) == (Kind.TEXT, "something that writes 'SSH-2.0-OpenSSH_9.2'")


def test_anything_else_is_noise() -> None:
    who = recognise(b"\x91\x00\xfe", SENT)
    assert who is not None
    assert who.kind is Kind.NOISE


def test_the_question_to_a_laser_asks_for_its_version_and_nothing_else() -> None:
    assert SCIP_QUESTION.split(b"\n") == [b"", b"VV", b""]
