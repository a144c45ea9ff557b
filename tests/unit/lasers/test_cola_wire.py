"""Frames, words and numbers of CoLa-A."""

import pytest

from pioneer3.lasers.cola import wire
from pioneer3.lasers.cola.wire import ColaTelegramReader, TelegramError, TelegramWords


def test_a_telegram_stands_between_stx_and_etx() -> None:
    assert wire.encode("sRN STlms") == b"\x02sRN STlms\x03"
    assert ColaTelegramReader().feed(b"\x02sRN STlms\x03\x02sRI0\x03") == ["sRN STlms", "sRI0"]


@pytest.mark.parametrize("text", ["", "a\x02b", "a\x03", "\n", "€", "x" * (wire.MAX_TELEGRAM + 1)])
def test_text_that_is_no_telegram_is_not_sent(text: str) -> None:
    with pytest.raises(TelegramError):
        wire.encode(text)


def test_a_telegram_cut_short_costs_only_itself() -> None:
    reader = ColaTelegramReader()
    assert reader.feed(b"\x02sRA STl\x02sRA STlms 7\x03") == ["sRA STlms 7"]
    assert reader.bytes_skipped == len(b"\x02sRA STl")


def test_a_telegram_with_control_characters_is_rejected() -> None:
    reader = ColaTelegramReader()
    assert reader.feed(b"\x02sRA\x00 7\x03\x02\x03\x02ok\x03") == ["ok"]
    assert reader.rejected == 2


def test_the_reader_does_not_keep_a_telegram_without_an_end() -> None:
    reader = ColaTelegramReader()
    for _ in range(1 << 10):
        assert reader.feed(b"\x02" + b"7" * 1023) == []
    for _ in range(1 << 10):
        assert reader.feed(b"7" * 1024) == []
        assert len(reader._buffer) <= wire.MAX_TELEGRAM + 1
    assert reader.feed(b"\x03\x02sRI0\x03") == ["sRI0"]


@pytest.mark.parametrize(
    ("word", "number"),
    [
        ("0", 0),
        ("00", 0),
        ("03", 3),
        ("1388", 5000),
        ("89A27F", 0x89A27F),
        ("F4724744", 0xF4724744),
        ("+10", 10),
        ("-45", -45),
        ("+2250000", 2250000),
    ],
)
def test_numbers_are_hexadecimal_when_bare_and_decimal_with_a_sign(word: str, number: int) -> None:
    assert wire.parse_number(word) == number


@pytest.mark.parametrize(
    "word", ["", " ", "G", "1a", "0x10", "1_0", "+", "+1F", "--1", "123456789", "٣", "+12345678901"]
)
def test_what_is_no_number_is_refused(word: str) -> None:
    with pytest.raises(TelegramError):
        wire.parse_number(word)


@pytest.mark.parametrize(
    ("word", "number"),
    [("FFF92230", -450000), ("225510", 2250000), ("FFFF3CB0", -50000), ("-450000", -450000)],
)
def test_negative_angles_are_in_twos_complement(word: str, number: int) -> None:
    assert wire.TelegramWords([word]).signed() == number
    assert wire.TelegramWords([wire.hex_word(number)]).signed() == number


def test_a_signed_number_of_more_than_32_bits_is_refused() -> None:
    with pytest.raises(TelegramError):
        wire.TelegramWords(["+2147483648"]).signed()


@pytest.mark.parametrize(("word", "number"), [("3F800000", 1.0), ("40000000", 2.0)])
def test_reals_are_their_bits(word: str, number: float) -> None:
    assert wire.TelegramWords([word]).real() == number
    assert wire.real_word(number) == word


@pytest.mark.parametrize("word", ["3F8", "7F800000", "7FC00000", "1.0", "3f800000"])
def test_what_is_no_finite_real_is_refused(word: str) -> None:
    with pytest.raises(TelegramError):
        wire.TelegramWords([word]).real()


def test_long_words_have_eight_digits() -> None:
    assert wire.long_word(450000) == "0006DDD0"
    assert wire.long_word(-450000) == "FFF92230"


def test_a_text_may_hold_spaces() -> None:
    words = TelegramWords(["B", "not", "defined", "0"])
    assert (words.text(), words.number()) == ("not defined", 0)
    words.end()


def only_text(words: TelegramWords) -> str:
    text = words.text()
    words.end()
    return text


@pytest.mark.parametrize("text", ["6 LMS1111", "6 LMS11", "B not definite", "1"])
def test_a_text_of_another_length_is_refused(text: str) -> None:
    with pytest.raises(TelegramError):
        only_text(TelegramWords(text.split(" ")))


def test_words_too_few_and_too_many_are_refused() -> None:
    with pytest.raises(TelegramError, match="more words"):
        TelegramWords([]).number()
    with pytest.raises(TelegramError, match="too many"):
        TelegramWords(["0"]).end()
    with pytest.raises(TelegramError, match="0 to 1"):
        TelegramWords(["2"]).flag()


def test_a_telegram_that_has_begun_is_kept_behind_much_noise() -> None:
    reader = ColaTelegramReader()
    assert reader.feed(b"\x02" * wire.MAX_TELEGRAM) == []
    assert reader.feed(b"noise\x02sR") == []
    assert reader.feed(b"I0\x03") == ["sRI0"]
