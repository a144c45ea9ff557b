"""Commands as people type them (facts.md 8.13)."""

import pytest

from pioneer3.arcos import commands
from pioneer3.arcos.commands import to_payload
from pioneer3.errors import CommandError
from pioneer3.robot.devices import parse_typed


@pytest.mark.parametrize(
    ("line", "payload"),
    [
        ("0", "00"),
        ("29", "1d"),
        (" 4  1 ", "04 3b 01 00"),
        ("11 -200", "0b 1b c8 00"),
        ("11 32767", "0b 3b ff 7f"),
        ("28 0", "1c 3b 00 00"),
        ("30 1 255", "1e 3b ff 01"),
        # 0xF60A is -2550 as a signed number: 0x1B 0x09F6 (protocol.md 1.3)
        ("32 -10 10", "20 1b f6 09"),
        ("32 10 -10", "20 3b f6 0a"),
        ("199 5", "c7 3b 05 00"),
    ],
)
def test_what_goes_on_the_wire(line: str, payload: str) -> None:
    assert to_payload(parse_typed(line)) == bytes.fromhex(payload)


def test_it_is_the_command_that_the_number_means() -> None:
    assert parse_typed("4 1") == commands.Enable(on=True)
    assert parse_typed("30 1 255") == commands.DigOut(mask=1, values=255)


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("", "type a command's number"),
        ("four", "'four' is not a whole number"),
        ("4 1.5", "'1.5' is not"),
        ("4 --1", "'--1' is not"),
        ("4 ²", "is not a whole number"),
        ("256", "there are 0 to 255"),
        ("-1", "there are 0 to 255"),
        ("11 32768", "-32767 to 32767"),
        ("11 -32768", "-32767 to 32767"),
        ("32 256 0", "byte 256"),
        ("32 0 -129", "byte -129"),
        ("1 2 3 4", "4 numbers are too many"),
        ("11 " + "9" * 5000, "is not a whole number"),
    ],
)
def test_what_is_wrong_is_said(line: str, words: str) -> None:
    with pytest.raises(CommandError, match=words):
        parse_typed(line)
