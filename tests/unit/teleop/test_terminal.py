"""From what a terminal sends to keys."""

import asyncio
import os
import pty
import sys
import termios
from collections.abc import AsyncIterator, Iterator
from dataclasses import dataclass

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pioneer3.errors import ConfigError
from pioneer3.teleop.keyboard import Key
from pioneer3.teleop.terminal import SEQUENCES, keys, keys_in, raw_terminal

UNKNOWN = {
    "F1": "\x1bOP",
    "F5": "\x1b[15~",
    "Home": "\x1b[H",
    "Delete": "\x1b[3~",
    "Shift-Tab": "\x1b[Z",
    "Ctrl-Up": "\x1b[1;5A",
    "focus in": "\x1b[I",
    "cursor report": "\x1b[24;80R",
    "private mode report": "\x1b[?1;2c",
}


@pytest.mark.parametrize(("sequence", "key"), [*SEQUENCES.items()], ids=[*map(repr, SEQUENCES)])
def test_every_sequence_is_its_key(sequence: str, key: Key) -> None:
    assert list(keys_in(sequence)) == [key]


@pytest.mark.parametrize("letter", [s for s in SEQUENCES if s.isalpha()])
def test_capital_letters_mean_the_same(letter: str) -> None:
    assert list(keys_in(letter.upper())) == [SEQUENCES[letter]]


@pytest.mark.parametrize(
    ("letter", "key"),
    [("A", Key.FORWARD), ("B", Key.BACK), ("C", Key.RIGHT), ("D", Key.LEFT)],
)
@pytest.mark.parametrize("mode", ["\x1b[", "\x1bO"], ids=["normal", "application"])
def test_arrows_are_understood_in_both_cursor_modes(mode: str, letter: str, key: Key) -> None:
    assert list(keys_in(mode + letter)) == [key]


@pytest.mark.parametrize("sequence", [*UNKNOWN.values()], ids=[*UNKNOWN])
def test_a_sequence_that_means_nothing_is_skipped_whole(sequence: str) -> None:
    assert list(keys_in(f"w{sequence}\x1b[A")) == [Key.FORWARD, Key.FORWARD]


def test_keys_that_come_together_stay_in_order() -> None:
    text = "\x1b[A\x1b[A w\x1b[C+q"
    assert list(keys_in(text)) == [
        Key.FORWARD,
        Key.FORWARD,
        Key.STOP,
        Key.FORWARD,
        Key.RIGHT,
        Key.FASTER,
        Key.QUIT,
    ]


@pytest.mark.parametrize("text", ["\x1b ", " \x1b", "\x1b\x1b "])
def test_an_escape_beside_the_space_bar_swallows_no_stop(text: str) -> None:
    assert Key.STOP in list(keys_in(text))


def test_escape_pressed_again_and_again_quits() -> None:
    assert list(keys_in("\x1b\x1b\x1b")) == [Key.QUIT] * 3


@pytest.mark.parametrize("text", ["", "\x00\x01\x07", "\r\n\t"])
def test_control_characters_that_mean_nothing_give_no_key(text: str) -> None:
    assert list(keys_in(text)) == []


@pytest.mark.parametrize("text", ["x", "e", "E", "1", "ß", "😀"])
def test_any_other_character_stops(text: str) -> None:
    assert list(keys_in(text)) == [Key.STOP]


def test_space_stops_and_k_is_the_emergency_stop() -> None:
    assert list(keys_in(" kK")) == [Key.STOP, Key.EMERGENCY, Key.EMERGENCY]


@given(st.text())
def test_no_text_is_too_strange(text: str) -> None:
    assert len(list(keys_in(text))) <= len(text)


@given(st.lists(st.sampled_from(sorted({*SEQUENCES, *UNKNOWN.values()} - {"\x1b"}))))
def test_any_series_of_sequences_is_taken_apart_again(sequences: list[str]) -> None:
    assert list(keys_in("".join(sequences))) == [SEQUENCES[s] for s in sequences if s in SEQUENCES]


@dataclass
class Terminal:
    """A pseudo terminal: what is typed at one end is read at the other."""

    keyboard: int
    screen: int

    def type(self, data: bytes) -> None:
        os.write(self.keyboard, data)


@pytest.fixture
def terminal(monkeypatch: pytest.MonkeyPatch) -> Iterator[Terminal]:
    """Make standard input a pseudo terminal."""
    keyboard, screen = pty.openpty()
    with os.fdopen(screen, closefd=False) as stdin:
        monkeypatch.setattr(sys, "stdin", stdin)
        yield Terminal(keyboard, screen)
    os.close(screen)
    os.close(keyboard)


async def next_key(pressed: AsyncIterator[Key]) -> Key:
    async with asyncio.timeout(10):
        return await anext(pressed)


@pytest.mark.realtime
async def test_a_sequence_that_the_network_cuts_in_two_is_one_key(
    terminal: Terminal, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("pioneer3.teleop.terminal.PATIENCE", 10.0)  # machines may be slow
    with raw_terminal() as descriptor:
        pressed = keys(descriptor)
        for pieces in ((b"\x1b", b"[A"), (b"\x1b[", b"A"), (b"\x1bO", b"A")):
            waiting = asyncio.ensure_future(next_key(pressed))
            for piece in pieces:
                terminal.type(piece)
                await asyncio.sleep(0.02)
            assert await waiting is Key.FORWARD


@pytest.mark.realtime
async def test_a_lone_escape_is_the_key(terminal: Terminal) -> None:
    with raw_terminal() as descriptor:
        terminal.type(b"\x1b")
        assert await next_key(keys(descriptor)) is Key.QUIT


@pytest.mark.realtime
async def test_bytes_that_are_no_text_are_skipped(terminal: Terminal) -> None:
    with raw_terminal() as descriptor:
        terminal.type(b"\xff\xc3\x80\xfe ")
        assert await next_key(keys(descriptor)) is Key.STOP


@pytest.mark.realtime
async def test_keys_end_when_the_terminal_goes_away(terminal: Terminal) -> None:
    with raw_terminal() as descriptor:
        pressed = keys(descriptor)
        waiting = asyncio.ensure_future(anext(pressed, None))
        await asyncio.sleep(0)
        spare = os.open(os.devnull, os.O_RDONLY)
        os.dup2(spare, terminal.keyboard)  # closes our end, and leaves something to close
        os.close(spare)
        async with asyncio.timeout(10):
            assert await waiting is None


def test_the_terminal_is_restored_after_an_error(terminal: Terminal) -> None:
    before = termios.tcgetattr(terminal.screen)

    def fail() -> None:
        with raw_terminal() as descriptor:
            assert not termios.tcgetattr(descriptor)[3] & (termios.ICANON | termios.ECHO)
            assert termios.tcgetattr(descriptor)[3] & termios.ISIG  # Ctrl-C stays a signal
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        fail()
    assert termios.tcgetattr(terminal.screen) == before


@pytest.mark.parametrize("stdin", [None, "/dev/null"], ids=["closed", "/dev/null"])
def test_without_a_terminal_there_is_no_driving(
    stdin: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = open(stdin) if stdin else None  # noqa: PTH123, SIM115
    monkeypatch.setattr(sys, "stdin", file)
    with pytest.raises(ConfigError, match="needs a terminal"), raw_terminal():
        pass
    if file:
        file.close()
