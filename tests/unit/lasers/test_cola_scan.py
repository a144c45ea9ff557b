"""LMDscandata, word by word."""

from math import degrees, inf, isnan, pi

import pytest

from pioneer3.lasers.client import RawScan, ScanSettings
from pioneer3.lasers.cola.clock import WRAP_US, ColaClock
from pioneer3.lasers.cola.readings import raw_scan
from pioneer3.lasers.cola.scan import (
    Encoder,
    InputEvent,
    Moment,
    Position,
    ReadingChannel,
    ScanData,
    decode,
    encode,
)
from pioneer3.lasers.cola.wire import TelegramError, TelegramWords

HEAD = "1 1 89A27F 0 0 1 1 939B5 93D9D 0 0 0 0 0 1388 168 0"
DIST = "DIST1 3F800000 00000000 FFF92230 1388 3 7D0 7DA 0"
LMS1XX = f"{HEAD} 1 {DIST} 0 0 0 0 0 0"
TIM = (
    "1 1 107375C 0 0 E784 E789 3D611E4A 3D612D1F 0 0 1 0 0 5DC 36 0"
    " 1 DIST1 3F800000 00000000 FFF92230 2710 4 1B8 1B3 0 1"
    " 1 RSSI1 3F800000 00000000 FFF92230 2710 4 93 9A 0 FF"
    " 0 1 B not defined 0 0 0"
)
ENCODERS = (
    "1 1 109F5FA 0 0 B5A0 A6D9 69FAC4A1 69FB7AD1 0 0 7 0 0 9C4 168 1 0 3E8"
    " 2 DIST1 40000000 00000000 0006DDD0 9C4 2 3E8 3E9"
    " RSSI1 3F800000 00000000 0006DDD0 9C4 2 C800 1"
    " 0 1 3F800000 40000000 00000000 00000000 00000000 3F800000 1 0 1 2 a "
    " 1 7EA B 16 5 20 17 F423F 1 FREE 5 F4240 FFFFFFFF"
)


def parse(text: str) -> ScanData:
    return decode(TelegramWords(text.split(" ")))


def metres(text: str, wishes: ScanSettings | None = None, near: float = 0.05) -> RawScan:
    wanted = wishes or ScanSettings()
    return raw_scan(parse(text), arrival=0.0, interval=1, limits=(near, 20.0), wishes=wanted)


@pytest.mark.parametrize("text", [LMS1XX, TIM, ENCODERS])
def test_a_golden_telegram_is_read_and_written_to_the_letter(text: str) -> None:
    assert encode(parse(text)) == text


def test_the_words_of_an_lms1xx_mean_what_the_page_says() -> None:
    assert parse(LMS1XX) == ScanData(
        serial=0x89A27F,
        telegrams=1,
        scans=1,
        sensed_us=604597,
        sent_us=605597,
        frequency_chz=5000,
        pulses=360,
        channels=(
            ReadingChannel(
                content="DIST1", first_tick=-450000, step_tick=5000, values=(2000, 2010, 0)
            ),
        ),
    )


def test_the_blocks_at_the_end_are_read() -> None:
    scan = parse(ENCODERS)
    assert scan.encoders == (Encoder(0, 1000),)
    assert scan.position == Position(x=1.0, y=2.0, z_rotation=1.0, rotation=1)
    assert (scan.name, scan.comment) == (None, "a ")
    assert scan.moment == Moment(
        year=2026, month=11, day=22, hour=5, minute=32, second=23, microsecond=999999
    )
    assert scan.event == InputEvent(kind="FREE", encoder=5, time_us=1000000, angle_tick=-1)
    assert parse(TIM).name == "not defined"


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (" 3 7D0", " 2 7D0"),  # one value more than counted
        (" 3 7D0", " 4 7D0"),  # one fewer
        (" 3 7D0", " 0 7D0"),
        (" 3 7D0", " FFFF 7D0"),
        ("7DA", "7dA"),
        ("7DA", "-7D"),
        ("7DA", "7_A"),
        ("7DA", "0x7"),
        ("7DA", ""),
        ("7DA", "7DG"),
        ("7DA", "10000"),
        ("DIST1", "DIST6"),
        ("DIST1", "dIST1"),
        ("DIST1", "ANGL1"),
        ("3F800000", "3F80000"),
        ("3F800000", "00000000"),
        ("3F800000", "7F800000"),
        ("FFF92230 1388", "FFF92230 0"),
        ("1388 168", "0 168"),
        ("1388 168 0", "1388 168 4"),
        ("1 1 89A27F", "10000 1 89A27F"),
        ("1 1 89A27F", "1 1 189A27F00"),
        ("0 0 1 1 939B5", "100 0 1 1 939B5"),
        (" 0 0 0 0 0 0", " 0 0 0 0 0"),
        (" 0 0 0 0 0 0", " 0 0 0 0 0 0 0"),
        (" 0 0 0 0 0 0", " 0 0 0 0 0 2"),
        (" 0 0 0 0 0 0", " 0 0 0 0 1 7EA D 1 0 0 0 0 0"),
        (f" 1 {DIST}", f" 2 {DIST} {DIST}"),
        (f" 1 {DIST}", f" 2 {DIST} RSSI1 3F800000 00000000 FFF92230 1388 2 1 2"),
        (f" 1 {DIST}", f" 2 {DIST} RSSI1 3F800000 00000000 FFF92231 1388 3 1 2 3"),
        (f" 1 {DIST}", " 0"),
    ],
)
def test_a_telegram_with_something_wrong_is_refused(old: str, new: str) -> None:
    assert old in LMS1XX
    with pytest.raises(TelegramError):
        parse(LMS1XX.replace(old, new, 1))


def test_a_remission_of_8_bits_cannot_be_larger() -> None:
    with pytest.raises(TelegramError):
        parse(TIM.replace(" FF ", " 100 "))


def test_every_telegram_cut_short_is_refused() -> None:
    for text in (LMS1XX, TIM, ENCODERS):
        words = text.split(" ")
        for length in range(len(words)):
            with pytest.raises(TelegramError):
                decode(TelegramWords(words[:length]))


def test_angles_are_from_straight_ahead() -> None:
    scan = metres(LMS1XX)
    assert degrees(scan.first) == pytest.approx(-135)
    assert degrees(scan.step) == pytest.approx(0.5)
    assert scan.beam_time == pytest.approx(0.02 / 720)
    assert scan.period == pytest.approx(0.02)


def test_a_step_that_the_wire_rounds_is_a_third_of_a_degree() -> None:
    scan = metres(LMS1XX.replace("FFF92230 1388", "FFF92230 D05"))
    assert scan.step == pytest.approx(pi / 540, rel=1e-12)


def test_nothing_is_infinity_and_codes_are_no_reading() -> None:
    assert metres(LMS1XX).ranges == (2.0, 2.01, inf)
    nothing, dazzled, near = metres(LMS1XX.replace("7D0 7DA 0", "0 1 10")).ranges
    assert nothing == inf
    assert isnan(dazzled)
    assert near == -inf


def test_ranges_of_an_lms5xx_are_in_2_mm() -> None:
    assert metres(ENCODERS).ranges == (2.0, 2.002)


def test_remissions_become_intensities_where_they_are_wanted() -> None:
    assert metres(TIM).intensities == ()
    assert metres(TIM, ScanSettings(intensities=True)).intensities == (0x93, 0x9A, 0, 0xFF)
    assert metres(ENCODERS, ScanSettings(intensities=True)).intensities == (0xC800, 1)
    assert metres(LMS1XX, ScanSettings(intensities=True)).intensities == ()


def test_all_echoes_of_a_reading_come_together() -> None:
    second = "DIST2 3F800000 00000000 FFF92230 1388 3 BB8 0 0"
    text = LMS1XX.replace(f" 1 {DIST}", f" 2 {DIST} {second}")
    scan = metres(text, ScanSettings(multi_echo=True))
    assert scan.echoes == ((2.0, 3.0), (2.01,), ())
    assert metres(text).echoes == ()


def test_a_scan_without_ranges_of_the_first_echo_is_refused() -> None:
    with pytest.raises(TelegramError, match="first echo"):
        metres(LMS1XX.replace("DIST1", "DIST2"))


def test_delays_of_the_network_do_not_reach_the_stamps() -> None:
    clock, delays = ColaClock(), [0.003, 0.050, 0.001, 0.2, 0.001, 0.010]
    stamps = []
    for scan, delay in enumerate(delays):
        sent = 1_000_000 + 20_000 * scan
        arrival = 50.0 + 0.02 * scan + delay
        stamps.append(clock.first_reading(sent - 20_000, sent, arrival, 0.015))
    true = [49.98 + 0.02 * scan for scan in range(len(delays))]
    errors = [stamp - t for stamp, t in zip(stamps, true, strict=True)]
    assert errors[0] == pytest.approx(0.003)
    assert errors[2:] == pytest.approx([0.001] * 4, abs=1e-4)


def test_the_clock_goes_on_where_its_32_bits_are_over() -> None:
    clock = ColaClock()
    before = clock.first_reading(WRAP_US - 15_000, WRAP_US - 5_000, 10.0, 0.01)
    after = clock.first_reading(WRAP_US - 5_000, 5_000, 10.01, 0.01)
    assert after - before == pytest.approx(0.01)


def test_a_slow_clock_is_followed() -> None:
    clock = ColaClock()
    for minute in range(60):
        sent = round(minute * 60e6 * (1 - 5e-5)) + 1_000_000
        stamp = clock.first_reading(sent, sent, 60.0 * minute, 0.0)
        assert stamp == pytest.approx(60.0 * minute, abs=1e-6)


def test_a_scan_was_not_sent_before_its_last_reading() -> None:
    assert ColaClock().first_reading(9_999_000, 10_000_000, 100.0, 0.05) == pytest.approx(99.95)


def test_a_clock_that_stands_still_is_not_believed() -> None:
    clock = ColaClock()
    assert clock.first_reading(0, 0, 5.0, 0.01) == pytest.approx(4.99)
    assert clock.first_reading(0, 0, 6.0, 0.01) == pytest.approx(5.99)
