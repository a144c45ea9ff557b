"""The words of `pioneer3 class`."""

from pathlib import Path

import pytest

from pioneer3.cli.main import execute


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ([], "how many students? Say --students 20"),
        (["--students", "0"], "students"),
        (["--students", "99"], "students"),
        (["--students", "2", "--fleet", "fleet.toml"], "give one"),
        (["--fleet", "nowhere.toml"], "nowhere.toml"),
        (["--students", "2", "--map", "nowhere"], "nowhere"),
        (["--students", "2", "--robot", "p9"], "p9"),
    ],
)
def test_wrong_words_are_told_in_a_line(
    words: list[str], says: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("PIONEER3_FLEET", raising=False)
    assert execute(["class", *words]) == 2
    assert says in capsys.readouterr().err


def test_a_fleet_without_robots_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "fleet.toml").write_text("")
    assert execute(["class", "--fleet", str(tmp_path / "fleet.toml")]) == 2
    assert "fleet.toml" in capsys.readouterr().err
