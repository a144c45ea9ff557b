"""`pioneer3 drive`: its options and its live line. The rest is in `tests/e2e/test_keyboard.py`."""

import os
from collections.abc import Callable
from pathlib import Path

import pytest

from pioneer3.cli.drive import GAMEPAD, KEYS
from pioneer3.cli.live import rewrite
from pioneer3.cli.main import execute
from pioneer3.teleop.gamepad import SCHEME
from pioneer3.teleop.terminal import SEQUENCES


@pytest.mark.parametrize("option", ["--speed", "--turn-rate"])
@pytest.mark.parametrize("value", ["nan", "inf", "-inf", "-0.1", "0", "1e999"])
def test_a_speed_that_is_none_is_refused_before_anything_is_opened(
    option: str, value: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert execute(["drive", option, value, "--port", "tcp://x.invalid:1"]) == 2
    told = capsys.readouterr().err
    assert told.count("\n") == 1
    assert option.removeprefix("--").split("-")[0] in told


def test_the_help_line_names_every_letter() -> None:
    letters = [s for s in SEQUENCES if s.isalpha()] + ["+", "-"]
    assert all(letter in KEYS.replace(":", " ").split() for letter in letters)
    assert "space: stop" in KEYS


@pytest.fixture
def show(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Callable[[str, int], str]:
    """Return what a live line looks like on a terminal of so many columns."""
    monkeypatch.delenv("COLUMNS", raising=False)

    def shown(line: str, columns: int) -> str:
        with monkeypatch.context() as patched:
            patched.setattr(os, "get_terminal_size", lambda *_: os.terminal_size((columns, 24)))
            rewrite(line)
        text = capsys.readouterr().out
        assert text.startswith("\r\x1b[K")
        return text.removeprefix("\r\x1b[K")

    return shown


@pytest.mark.parametrize(("columns", "visible"), [(80, 79), (20, 19)])
def test_the_live_line_never_wraps(
    columns: int, visible: int, show: Callable[[str, int], str]
) -> None:
    assert show("x" * 300, columns) == "x" * visible


def test_a_terminal_that_does_not_tell_its_width_is_taken_to_have_80_columns(
    show: Callable[[str, int], str],
) -> None:
    assert show("x" * 300, 0) == "x" * 79


@pytest.mark.parametrize("option", ["--speed", "--turn-rate"])
def test_a_gamepads_speed_is_checked_as_well(
    option: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert execute(["drive", "--gamepad", option, "0", "--port", "tcp://x.invalid:1"]) == 2
    assert "must be positive" in capsys.readouterr().err


def test_what_is_no_gamepad_is_refused_before_anything_is_opened(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "my pad"
    file.touch()
    words = str(file).split()  # a name may be several words
    assert execute(["drive", "--gamepad", *words, "--port", "tcp://x.invalid:1"]) == 2
    assert capsys.readouterr().err == f"pioneer3: {file}: this is no gamepad\n"


def test_the_help_line_of_a_gamepad_names_what_the_scheme_uses() -> None:
    named = {SCHEME.deadman: "L1", SCHEME.turbo: "R1", SCHEME.stop: "circle"}
    named |= {SCHEME.emergency_stop: "Share", SCHEME.reset: "Options"}
    assert all(name in GAMEPAD for name in named.values())
    assert len(named) == 5
