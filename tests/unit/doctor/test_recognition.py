"""Who speaks on a line that is not a robot."""

import pytest

from pioneer3.arcos.packet import PacketReader, encode
from pioneer3.doctor.recognition import DeviceKind, recognise
from pioneer3.lasers.lms2xx.telegram import encode as telegram_of
from pioneer3.lasers.recognition import COLA_QUESTION, LMS_QUESTION, QUESTION, SCIP_QUESTION

VERSION = (
    b"\nVV\n00P\nVEND:Hokuyo Automatic Co.,Ltd.;[\nPROD:SOKUIKI Sensor URG-04LX;R\n"
    b"FIRM:3.3.00;b\nPROT:SCIP 2.0;N\nSERI:H0902345;k\n\n"
)
SENT = b"".join(encode(bytes([number])) for number in (0, 1, 2))


def telegram(data: bytes) -> bytes:
    """Return a SICK telegram from the laser."""
    return telegram_of(data[0], data[1:], address=0x80)


def test_silence_is_nobody() -> None:
    assert recognise(b"") is None


def test_a_scip_version_tells_maker_product_and_serial_number() -> None:
    who = recognise(VERSION)
    assert who is not None
    assert who.kind is DeviceKind.LASER
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
    assert who.kind is DeviceKind.LASER


def test_a_sick_telegram_is_found_inside_noise() -> None:
    who = recognise(b"\x02\x80\xff" + telegram(b"\x90LMS200;30106;V02.10\x10") + b"\x02")
    assert who is not None
    assert (who.kind, who.name) == (DeviceKind.LASER, "SICK LMS200-30106")


def test_a_sick_telegram_with_a_flipped_bit_is_no_laser() -> None:
    good = telegram(b"\x90LMS200;30106;V02.10\x10")
    for bit in range(32, len(good) * 8):
        bad = bytearray(good)
        bad[bit // 8] ^= 1 << bit % 8
        who = recognise(bytes(bad))
        assert who is not None
        assert who.kind is not DeviceKind.LASER


def test_a_sick_that_only_sends_scans_has_no_name() -> None:
    who = recognise(telegram(b"\xb0\x02\x40\x64\x00\x65\x00\x10"))
    assert who is not None
    assert (who.kind, who.name) == (DeviceKind.LASER, "SICK LMS 2xx")


@pytest.mark.parametrize(
    ("heard", "name"),
    [
        (b"\x02sRA DeviceIdent 6 LMS111 10 V1.36-21.10.2010\x03", "SICK LMS111"),
        (b"\xfb\x02sSN LMDscandata 0 1 89A27F\x03", "a laser that speaks CoLa-A (SICK)"),
    ],
)
def test_a_laser_in_the_network_is_named_if_it_says_its_name(heard: bytes, name: str) -> None:
    who = recognise(heard)
    assert who is not None
    assert (who.kind, who.name) == (DeviceKind.LASER, name)


def test_our_own_words_are_an_echo() -> None:
    who = recognise(SENT * 3, SENT)
    assert who is not None
    assert who.kind is DeviceKind.ECHO


def test_a_robot_that_answers_two_of_three_syncs_is_no_echo() -> None:
    who = recognise(SENT[:12], SENT)
    assert who is not None
    assert (who.kind, who.name) == (DeviceKind.PACKETS, "2 well-formed packets (number 0, 1)")


def test_packets_between_a_few_spoilt_bytes_are_still_packets() -> None:
    who = recognise(b"\xfb\x07" + encode(b"\x1d") + b"\xfa")
    assert who is not None
    assert (who.kind, who.name) == (DeviceKind.PACKETS, "1 well-formed packet (number 29)")


def test_a_packet_in_much_noise_is_noise() -> None:
    who = recognise(b"\x91\x00\xfe" * 20 + encode(b"\x1d"))
    assert who is not None
    assert who.kind is DeviceKind.NOISE


def test_a_readable_banner_is_quoted() -> None:
    who = recognise(b"SSH-2.0-OpenSSH_9.2\r\n", SENT)
    assert who is not None
    assert (who.kind, who.name) == (DeviceKind.TEXT, "something that writes 'SSH-2.0-OpenSSH_9.2'")


def test_anything_else_is_noise() -> None:
    who = recognise(b"\x91\x00\xfe", SENT)
    assert who is not None
    assert who.kind is DeviceKind.NOISE


def test_the_questions_to_lasers_ask_for_the_type_and_nothing_else() -> None:
    assert SCIP_QUESTION.split(b"\n") == [b"", b"VV", b""]
    assert bytes.fromhex("02 00 01 00 3A 1E 12") == LMS_QUESTION
    assert COLA_QUESTION == b"\x02sRN DeviceIdent\x03"


def test_the_questions_are_nothing_to_a_robot() -> None:
    reader = PacketReader()
    assert reader.feed(QUESTION) == []
    assert reader.feed(encode(b"\x00")) == [b"\x00"]
