"""Every help fits, its examples run, and one option means one thing everywhere."""

import os
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from itertools import pairwise
from pathlib import Path

import docstring_parser
import pytest
from cyclopts import App
from docstring_parser import parse_from_object
from rich.console import Console

from pioneer3.behaviors.modes import MODES
from pioneer3.cli.main import GROUPS, app, execute
from pioneer3.cli.options import UNITS
from pioneer3.cli.ros_arguments import gather_ros_arguments
from pioneer3.models import load_model
from pioneer3.sim.map_convert import look

ROOT = Path(__file__).parents[3]
OPENED = re.compile(r"\S+\.(?:map|toml|yaml|png|p)\b")
OTHER_WORDS = {("sim", "--port"), ("sim", "--speed"), ("map check", "--robot")}
"""Options of MobileSim's that mean something else; a model in the place of a robot."""


@pytest.fixture(autouse=True, scope="module")
def _sources_read_once() -> Iterator[None]:
    """Cyclopts reads the source of each class anew for each help with options of it."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(docstring_parser, "parse_from_object", cache(parse_from_object))
        yield


def commands(parent: App = app, path: str = "") -> Iterator[tuple[str, App]]:
    """Yield every command with its words."""
    for name in parent:
        if not name.startswith("-"):
            words = f"{path} {name}".strip()
            yield words, parent[name]
            yield from commands(parent[name], words)


COMMANDS = dict(commands())


@cache
def shown(words: str, width: int = 80) -> str:
    """Return the help of a command as a terminal of so many columns shows it."""
    console = Console(width=width, force_terminal=False, color_system=None)
    with console.capture() as capture:
        app.help_print(words.split(), console=console)
    return capture.get()


def options(words: str) -> dict[str, str]:
    """Return the metavar of each long option that a help shows."""
    rows = re.findall(r"^│ \*? *(--.*?)  ", shown(words, 200), re.MULTILINE)
    found: dict[str, str] = {}
    for row in rows:
        *names, last = row.split()
        named = [*names, last] if last.startswith("-") else names
        found |= dict.fromkeys(named, "" if last.startswith("-") else last)
    return found


def examples(words: str) -> list[str]:
    """Return every example of a help."""
    return re.findall(r"^Example: pioneer3 (.*)$", shown(words, 200), re.MULTILINE)


@pytest.mark.parametrize("words", ["", *COMMANDS])
def test_a_help_fits_80_columns_as_it_is_written(words: str) -> None:
    text = shown(words)
    assert max(map(len, text.splitlines())) <= 80
    prose, wide = (shown(words, width).partition("╭")[0] for width in (80, 200))
    assert prose == wide  # no paragraph is broken where its author did not
    assert "[default: ]" not in text
    assert not re.search(r"\d\.\d{5}", text)


@pytest.mark.parametrize("words", ["", *COMMANDS])
def test_the_examples_of_a_help_can_be_copied(
    words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for example in examples(words):
        tokens = gather_ros_arguments(shlex.split(example))
        app.parse_args(tokens, exit_on_error=False, print_error=False)
        for token in tokens:
            if OPENED.fullmatch(token):
                made = tokens[0] == "map" and tokens[1] in {"convert", "build", "edit"}
                assert made, f"{token} is not there for who copies this"
                assert token == tokens[-1] or tokens[tokens.index(token) - 1] in {"-o", "edit"}
        if tokens[0] == "map" and tokens[1] not in {"build", "edit"}:  # they write what they name
            monkeypatch.chdir(tmp_path)
            assert execute(tokens) == 0
        for flag, value in pairwise(tokens):
            if flag in {"-m", "--map"}:
                look(value)
            if flag in {"-r", "--robot"} and tokens[0] not in {"ros1", "ros2"}:
                load_model(value.partition(":")[0])


@pytest.mark.parametrize("words", ["ros2", "ros2 bridge", "map edit", "sim"])
def test_a_help_shows_no_default_that_is_nothing(
    words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    execute([*words.split(), "--help"])
    told = " ".join(capsys.readouterr().out.replace("\u2502", "").split())
    assert "default: " in told or words == "map edit"
    assert not re.search(r"default: (\(|False|None|\"\"|\])", told)


def test_there_are_examples_to_copy() -> None:
    assert len({each for words in ("", *COMMANDS) for each in examples(words)}) > 15


@pytest.mark.parametrize("option", ["--port", "--speed", "--turn-rate", "--seconds", "--max-speed"])
def test_an_option_has_one_unit_and_one_form_everywhere(option: str) -> None:
    found = {
        options(words)[option].rstrip(".")
        for words in COMMANDS
        if option in options(words) and (words, option) not in OTHER_WORDS
    }
    assert len(found) == 1, found


@pytest.mark.parametrize(
    ("option", "names"),
    [
        ("--record", "run drive demo wander follow goto move turn info monitor sonar"),
        ("--seconds", "drive wander follow goto move turn monitor sonar doctor"),
        ("--max-speed", "run drive demo wander follow goto move"),
    ],
)
def test_an_option_is_there_wherever_it_makes_sense(option: str, names: str) -> None:
    assert [name for name in names.split() if option not in options(name)] == []


@pytest.mark.parametrize("words", COMMANDS)
def test_a_help_with_quantities_says_how_they_are_written(words: str) -> None:
    has = {"M", "M/S", "DEG/S", "DEG", "S"} & set(options(words).values())
    assert (UNITS in shown(words)) or not has


def test_commands_are_in_groups_and_those_to_start_with_come_first() -> None:
    text = shown("")
    places = [text.index(f"─ {name} ─") for name in GROUPS]
    assert places == sorted(places)
    listed = re.findall(r"^│ ([a-z][\w-]*) ", text, re.MULTILINE)
    assert listed[:2] == ["run", "sim"]
    assert sorted(listed) == sorted(name for name in COMMANDS if " " not in name)
    assert text.index("--install-completion") > places[-1]


@pytest.fixture(scope="module")
def home(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a home in which `pioneer3 --install-completion` was run from bash."""
    folder = tmp_path_factory.mktemp("home")
    environment = {**os.environ, "HOME": str(folder), "SHELL": "/bin/bash"}
    environment.pop("XDG_DATA_HOME", None)
    program = "from pioneer3.__main__ import main; main(['--install-completion'])"
    subprocess.run(
        [sys.executable, "-c", program], env=environment, check=True, capture_output=True
    )
    return folder


@pytest.mark.parametrize(
    ("typed", "completed"),
    [
        ("pioneer3 wan", {"wander"}),
        ("pioneer3 mo", {"model", "monitor", "move"}),
        ("pioneer3 map c", {"check", "convert"}),
        ("pioneer3 wander --max", {"--max-speed"}),
        ("pioneer3 wander --preset a", {"aria"}),
        ("pioneer3 drive --lat", {"--latch"}),
    ],
)
def test_bash_completes_commands_options_and_choices(
    home: Path, typed: str, completed: set[str]
) -> None:
    words = shlex.join(typed.split())
    script = f"""
    . "$HOME/.bashrc"
    COMP_WORDS=({words}); COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1))
    "$(complete -p pioneer3 | sed 's/.*-F \\([^ ]*\\).*/\\1/')"
    printf '%s\\n' "${{COMPREPLY[@]}}"
    """
    done = subprocess.run(
        ["bash", "--norc", "-c", script],
        env={**os.environ, "HOME": str(home)},
        capture_output=True,
        text=True,
        timeout=60,
        check=True,
    )
    assert {word.strip() for word in done.stdout.split()} == completed


def test_each_mode_has_a_command() -> None:
    assert {mode.name() for mode in MODES} <= set(COMMANDS)


def test_the_command_line_loads_no_command_that_is_not_called() -> None:
    code = "import sys, pioneer3.cli.main; print(*(n for n in sys.modules if 'pioneer3.' in n))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    commands = {
        f"pioneer3.cli.{path.partition(':')[0]}" for paths in GROUPS.values() for path in paths
    }
    assert not commands & {*done.stdout.split()}
