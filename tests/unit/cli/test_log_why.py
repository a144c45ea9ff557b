"""`pioneer3 log why` tells on a terminal who wanted what, and what was decided."""

import json
from pathlib import Path

import pytest

from pioneer3.behaviors.action import Contribution
from pioneer3.cli.log_why import why
from pioneer3.errors import ConfigError
from pioneer3.log.topics import EVENT, LogEvent
from pioneer3.runtime.recording import CommandGiven, DecisionMade
from tests.unit.analysis.support import decided, driven, given, topic, write_log

LIMIT = Contribution("limiter", "v_max", 0.1, 1.0, "0.42 m \x1b[31mahead")
WANTS = Contribution("keyboard", "v", 0.4, 1.0, "held")


@pytest.fixture
def log(tmp_path: Path) -> str:
    """Return a log of a robot that a key drives towards a wall."""
    messages = [
        *driven(2.0, v=0.1),
        (0.5, topic("command", CommandGiven), given("keyboard", "drive", 0.4, "not now")),
        (0.6, topic("decision", DecisionMade), decided("", 0.1, LIMIT, WANTS)),
        (0.7, EVENT, LogEvent("page", "ann came")),
    ]
    return str(write_log(tmp_path / "a.mcap", messages))


def test_the_parts_are_told_with_what_was_taken(
    log: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert why(log, at="1s") == 0
    text = capsys.readouterr().out
    assert "\x1b" not in text
    for words in (
        "1.0 s after the log began",
        "It moves: limiter, 0.42 m \\x1b[31mahead; keyboard, held (by its readings",
        "0.10 m/s, 0°/s, 12.5 V",
        "limiter: at most 0.10 m/s ahead, 0.42 m \\x1b[31mahead: takes 0.30 m/s",
        "keyboard: 0.40 m/s, held",
        "keyboard: drive 0.40 m/s, 0°/s; refused: not now; 0.5 s before",
        "page: ann came; 0.3 s before",
    ):
        assert words in " ".join(text.split()), words


def test_the_end_is_told_without_a_time(log: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert why(log, json=True) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["time"] == pytest.approx(2.01)
    assert told["parts"][0]["took"] == "0.30 m/s"


def test_a_time_that_is_not_in_the_log_is_told_with_those_that_are(log: str) -> None:
    for wrong in ("3s", "-1s"):
        with pytest.raises(ConfigError, match=rf"--at {wrong}: the log is from .* to .*, 2\.0 s"):
            why(log, at=wrong)
    with pytest.raises(ConfigError, match="--at 'soon' is not a time"):
        why(log, at="soon")


def test_one_of_several_robots_has_to_be_named(tmp_path: Path) -> None:
    messages = [*driven(1.0, "amy/"), *driven(2.0, "bob/")]
    path = write_log(tmp_path / "a.mcap", messages, robots={"amy/": "", "bob/": ""})
    with pytest.raises(ConfigError, match=r"a\.mcap has several robots: --robot amy or bob"):
        why(str(path))
    assert why(str(path), robot="bob") == 0
