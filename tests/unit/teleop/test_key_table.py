"""The table of keys in `docs/how-to/drive.md` says what the code does."""

import re
from pathlib import Path

import pytest

from pioneer3.demo.modes import MODES
from pioneer3.demo.program import EMERGENCY_KEYS, HELP_KEYS, QUIT_KEYS, RESET_KEY, STOP_KEY, named
from pioneer3.teleop.gamepad import SCHEME
from pioneer3.teleop.keyboard import Key
from pioneer3.teleop.several import FOR_ALL, KEYS, TABLE, RobotChooser, act_of
from pioneer3.teleop.terminal import keys_in

ROOT = Path(__file__).parents[3]
PAGE = (ROOT / "docs/how-to/drive.md").read_text("utf-8")
TOKENS = {
    "space": " ",
    "arrows": "\x1b[A",
    "Ctrl-R": "\x12",
    "Ctrl-D": "\x04",
    "Escape": "\x1b",
    "Tab": "\t",
    "another letter": "x",
}
WORDS = {
    Key.STOP: "stop",
    Key.EMERGENCY: "emergency stop",
    Key.RESET: "release the emergency stop",
    Key.MOTORS: "motors",
    Key.QUIT: "quit",
    Key.FASTER: "speed",
    Key.SLOWER: "speed",
    **dict.fromkeys((Key.FORWARD, Key.BACK, Key.LEFT, Key.RIGHT), "drive"),
}
CHOICES = {
    RobotChooser.NEXT: "next robot",
    RobotChooser.NUMBER: "this robot",
    RobotChooser.ALL: "all robots",
    RobotChooser.SEVERAL: "several robots",
    RobotChooser.CONFIRM: "those marked",
}
LETTERS_OF_MODES = frozenset(mode.key for mode in MODES)


def table(head: str) -> list[list[str]]:
    """Return the cells of the table whose first line begins with `head`."""
    lines = PAGE[PAGE.index(head) :].split("\n\n")[0].splitlines()[2:]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]


ROWS = [
    (TOKENS.get(key) or key, row)
    for row in table("| key | page |")
    for key in re.findall(r"`(.)`", row[0]) or row[0].split(", ")
    if key != "Ctrl-C"  # a signal, not a key
]
IDS = [repr(token) for token, _ in ROWS]


@pytest.mark.parametrize(("token", "row"), ROWS, ids=IDS)
def test_the_keys_of_drive(token: str, row: list[str]) -> None:
    assert row[2] == "".join(WORDS[key] for key in keys_in(token))


@pytest.mark.parametrize(("token", "row"), ROWS, ids=IDS)
def test_the_keys_of_several_robots(token: str, row: list[str]) -> None:
    act = act_of(token)
    if isinstance(act, Key):
        told = WORDS[act] + (" of all" if act in {Key.STOP, Key.EMERGENCY} else "")
        assert (act in FOR_ALL) == (act in {Key.STOP, Key.EMERGENCY, Key.RESET})
    else:
        told = CHOICES[act] if act else ""
    assert row[3] == told


def test_every_key_of_several_robots_is_in_the_help() -> None:
    for row in TABLE:
        assert f"{row.name}: {row.words}" in KEYS or not row.name


@pytest.mark.parametrize(("token", "row"), ROWS, ids=IDS)
def test_the_keys_of_the_demo(token: str, row: list[str]) -> None:
    key = named(token)
    if key in EMERGENCY_KEYS:
        told = "emergency stop"
    elif key in QUIT_KEYS:
        told = "quit"
    elif key in HELP_KEYS:
        told = "help"
    else:
        told = {STOP_KEY: "stop", RESET_KEY: "release the emergency stop"}.get(key, "")
    if told:
        assert row[4] == told
    else:
        assert ("mode" in row[4] and "of the mode" not in row[4]) == (key in LETTERS_OF_MODES) or (
            key == "x"
        )


def test_no_mode_of_the_demo_takes_a_key_of_safety() -> None:
    assert len(LETTERS_OF_MODES) == len(MODES)
    assert LETTERS_OF_MODES.isdisjoint({*EMERGENCY_KEYS, *HELP_KEYS, *QUIT_KEYS})


@pytest.mark.parametrize(("token", "row"), ROWS, ids=IDS)
def test_any_key_ends_a_robot_that_drives_by_itself(token: str, row: list[str]) -> None:
    keys = list(keys_in(token))
    stops = "emergency stop, end" if Key.EMERGENCY in keys else "stop, end" if keys else ""
    assert row[5] == stops


def test_the_buttons_of_a_gamepad() -> None:
    names = {int(row[0]): row[1] for row in table("| button | Xbox |")}
    told = {row[0]: row[6] for row in table("| key | page |")}
    assert names[SCHEME.stop] == told["space"]
    assert names[SCHEME.emergency_stop].split(", ")[0] == told["`k`"]
    assert names[SCHEME.reset].split(", ")[0] == told["Ctrl-R"]


def test_the_keys_of_the_page() -> None:
    script = (ROOT / "src/pioneer3/web/static/drive/keys.js").read_text("utf-8")
    driving = set(re.findall(r"^  (?:Key|Arrow)(\w+): \{ forward", script, re.MULTILINE))
    told = {key: row[1] for key, row in ROWS if row[1]}
    assert driving == {"Up", "Down", "Left", "Right", "W", "S", "A", "D"}
    assert {key for key, words in told.items() if words == "drive while held"} == {
        TOKENS["arrows"],
        *"wasd",
    }
    assert 'event.code === "Space" ? stop : isEmergency(event) ? emergencyStop' in script
    assert 'code === "KeyK"' in script
    assert told[" "] == "stop"
    assert told["k"] == "emergency stop of all"
    assert len(told) == 2 + 5
