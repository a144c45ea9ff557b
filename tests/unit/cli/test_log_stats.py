"""`pioneer3 log stats` prints the figures of all logs that can be read."""

import json
from pathlib import Path

import pytest

from pioneer3.cli.log_stats import stats
from tests.unit.analysis.support import driven, write_log, write_parts


def test_the_figures_are_told_and_what_is_no_log_does_not_hide_them(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = write_log(tmp_path / "a.mcap", driven(2.0), robots={"": "b\x1b[31mob"})
    (tmp_path / "b.mcap").write_text("no log")
    assert stats(str(tmp_path / "b.mcap"), str(path)) == 1
    told = capsys.readouterr()
    assert "b.mcap: is no log" in told.err
    words = " ".join(told.out.split())
    assert "b\\x1b[31mob, 21 reports way 1.0 m, turned 0° under way 2 s of 2 s" in words
    assert "battery 12.5 V to 12.5 V" in words
    assert stats(str(path), json=True) == 0
    (known,) = json.loads(capsys.readouterr().out)
    assert known["robots"][0]["distance"] == pytest.approx(1.0)


def test_a_log_in_two_files_is_one(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for path in (parts := write_parts(tmp_path)):
        assert stats(*map(str, parts), json=True) == stats(str(path), json=True) == 0
        both, one = map(json.loads, capsys.readouterr().out.splitlines())
        assert both == one
        (known,) = both
        assert known["robots"][0]["distance"] == pytest.approx(2.0)
        assert known["seconds"] == pytest.approx(4.01)


def test_without_a_name_all_logs_of_the_user_are_meant(capsys: pytest.CaptureFixture[str]) -> None:
    assert stats(json=True) == 0
    assert json.loads(capsys.readouterr().out) == []
    assert stats() == 0
    assert capsys.readouterr().out.startswith("No logs in ")
