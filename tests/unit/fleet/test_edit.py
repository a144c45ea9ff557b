"""Files of people are changed as a whole, with a backup, and not at all where that fails."""

import os
import stat
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pioneer3.errors import ConfigError, FilePermissionError
from pioneer3.fleet.edit import BEGIN, END, Change, with_block

LINES = st.lists(st.text(st.characters(exclude_categories=["C", "Z"]), max_size=5), max_size=4)


@given(LINES, LINES, LINES, LINES)
def test_a_block_is_replaced_where_it_stands(
    before: list[str], old: list[str], after: list[str], new: list[str]
) -> None:
    def text(block: list[str]) -> str:
        return "".join(f"{line}\n" for line in (*before, BEGIN, *block, END, *after))

    assert with_block(text(old), new) == text(new)


@given(st.text(), LINES)
def test_a_block_comes_last_once(text: str, lines: list[str]) -> None:
    once = with_block(text, lines)
    assert once.startswith(text)
    assert with_block(once, lines) == once


def test_the_old_file_is_kept_and_so_are_its_permissions(tmp_path: Path) -> None:
    path = tmp_path / "hosts"
    path.write_text("one\n")
    path.chmod(0o640)
    change = Change.of(path, "two\n")
    assert change.diff().splitlines()[-2:] == ["-one", "+two"]
    assert change.apply() == tmp_path / "hosts.before-fleet-1"
    assert Change.of(path, "three\n").apply() == tmp_path / "hosts.before-fleet-2"
    assert path.read_text() == "three\n"
    assert (tmp_path / "hosts.before-fleet-1").read_text() == "one\n"
    assert stat.S_IMODE(path.stat().st_mode) == 0o640
    assert sorted(file.name for file in tmp_path.iterdir()) == [
        "hosts",
        "hosts.before-fleet-1",
        "hosts.before-fleet-2",
    ]


def test_nothing_to_change_writes_nothing(tmp_path: Path) -> None:
    path = tmp_path / "hosts"
    path.write_text("one\n")
    before = path.stat()
    assert Change.of(path, "one\n").apply() is None
    assert path.stat().st_mtime_ns == before.st_mtime_ns
    assert len(list(tmp_path.iterdir())) == 1


def test_a_link_stays_a_link(tmp_path: Path) -> None:
    (tmp_path / "real").write_text("one\n")
    (tmp_path / "link").symlink_to("real")
    Change.of(tmp_path / "link", "two\n").apply()
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "real").read_text() == "two\n"


def test_a_file_that_somebody_else_changes_meanwhile_is_left_alone(tmp_path: Path) -> None:
    path = tmp_path / "hosts"
    path.write_text("one\n")
    change = Change.of(path, "two\n")
    path.write_text("theirs\n")
    with pytest.raises(ConfigError, match="somebody else changed it just now"):
        change.apply()
    assert path.read_text() == "theirs\n"


def test_a_file_that_cannot_be_written_stays_whole(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "hosts"
    path.write_text("one\n")

    def full(descriptor: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(ConfigError, match="hosts: cannot be written: No space left on device"):
        Change.of(path, "two\n").apply()
    assert path.read_text() == "one\n"
    assert [file.name for file in tmp_path.iterdir() if file.name.startswith(".")] == []


def test_who_may_not_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "hosts"
    path.write_text("one\n")

    def refused(*arguments: object, **named: object) -> int:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(os, "open", refused)
    with pytest.raises(FilePermissionError, match="hosts: you may not change it"):
        Change.of(path, "two\n").apply()
    assert path.read_text() == "one\n"
