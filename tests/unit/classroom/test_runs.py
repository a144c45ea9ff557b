"""Runs that are handed in: their files, names and limits."""

from pathlib import Path

import pytest

from pioneer3.classroom.runs import MOST_RUNS, Draft, Run, RunFolder, file_stem
from pioneer3.errors import CommandError, ConfigError


def drafted(runs: RunFolder, text: str = "# run\n") -> Draft:
    """Return a draft with something in it."""
    draft = runs.draft(1, 1000.0)
    draft.path.write_text(text)
    return draft


def hand_in(runs: RunFolder, student: str, draft: Draft | None = None) -> Run:
    return runs.hand_in(
        draft or drafted(runs), student=student, session=student, robot=1, at=1010.0, seconds=10.0
    )


def test_runs_are_numbered_for_each_student(tmp_path: Path) -> None:
    runs = RunFolder(tmp_path / "class")
    files = [hand_in(runs, name).file for name in ("Anna", "Anna", "Bob")]
    assert files == ["Anna-1.mcap", "Anna-2.mcap", "Bob-1.mcap"]
    assert sorted(path.name for path in (tmp_path / "class").iterdir()) == files
    assert [run.file for run in runs.runs.values() if run.session == "Anna"] == files[:2]


def test_a_file_of_an_earlier_class_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "Anna-1.mcap").write_text("earlier")
    assert hand_in(RunFolder(tmp_path), "Anna").file == "Anna-2.mcap"
    assert (tmp_path / "Anna-1.mcap").read_text() == "earlier"


@pytest.mark.parametrize(
    ("name", "stem"),
    [
        ("Anna Bell", "Anna-Bell"),
        ("../../etc/passwd", "etc-passwd"),
        ("Änne", "Änne"),
        ("...", "student"),
        (r"a\b:c*?", "a-b-c"),
        ("~", "student"),
        ("a\x00b", "a-b"),
    ],
)
def test_a_name_becomes_letters_of_a_file_name(name: str, stem: str, tmp_path: Path) -> None:
    assert file_stem(name) == stem
    runs = RunFolder(tmp_path)
    assert (tmp_path / hand_in(runs, name).file).parent == tmp_path


def test_only_what_was_handed_in_is_found(tmp_path: Path) -> None:
    (tmp_path / "secret.txt").write_text("secret")
    runs = RunFolder(tmp_path)
    run = hand_in(runs, "Anna")
    assert runs.find(run.file) == tmp_path / run.file
    for name in ("secret.txt", "../secret.txt", "", "."):
        assert runs.find(name) is None


def test_one_student_hands_in_so_many_runs(tmp_path: Path) -> None:
    runs = RunFolder(tmp_path)
    for _ in range(MOST_RUNS):
        hand_in(runs, "Anna")
    draft = drafted(runs)
    with pytest.raises(CommandError, match="no more are taken"):
        hand_in(runs, "Anna", draft)
    assert draft.path.exists()
    assert hand_in(runs, "Bob").file == "Bob-1.mcap"


def test_a_folder_that_cannot_be_made_says_what_to_do(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(ConfigError, match="--folder"):
        RunFolder(tmp_path / "file" / "class").draft(1, 0.0)


def test_a_run_whose_file_is_gone_is_told(tmp_path: Path) -> None:
    runs = RunFolder(tmp_path)
    draft = runs.draft(1, 0.0)
    with pytest.raises(CommandError, match="tell your teacher"):
        hand_in(runs, "Anna", draft)
    assert list(tmp_path.iterdir()) == []


def test_a_draft_that_is_dropped_leaves_nothing(tmp_path: Path) -> None:
    draft = drafted(RunFolder(tmp_path))
    assert draft.size == 6
    draft.discard()
    draft.discard()
    assert draft.size == 0
    assert list(tmp_path.iterdir()) == []
