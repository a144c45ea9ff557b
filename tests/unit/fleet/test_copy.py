"""What a robot tells of its files is not believed."""

from collections.abc import AsyncIterator
from pathlib import Path

import pytest

from pioneer3.errors import RemoteError
from pioneer3.fleet import copy
from pioneer3.fleet.copy import RemoteFile


async def told(*sizes: float) -> AsyncIterator[RemoteFile]:
    for number, size in enumerate(sizes):
        yield RemoteFile(f"/home/{number}", (str(number),), int(size))


@pytest.mark.parametrize("name", ["..", ".", "", "/etc", "a/b", "../a", "a\0b"], ids=repr)
def test_a_name_that_is_none_is_refused(name: str) -> None:
    with pytest.raises(RemoteError, match="nothing is copied"):
        copy._part(name)


def test_a_link_that_leads_out_is_not_followed(tmp_path: Path) -> None:
    robot, elsewhere = tmp_path / "p3at-1", tmp_path / "elsewhere"
    robot.mkdir()
    elsewhere.mkdir()
    (robot / "runs").symlink_to(elsewhere)
    with pytest.raises(RemoteError, match="a link there leads out"):
        copy._place(robot, ("runs", "a"))
    assert copy._place(robot, ("maps", "..a", "b c")) == robot / "maps/..a/b c"


async def test_what_is_too_much_is_refused_before_it_comes(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    with pytest.raises(RemoteError, match="name fewer"):
        await copy._all([told(copy.MOST / 2), told(copy.MOST / 2, 1)])
    monkeypatch.setattr(copy, "MOST_FILES", 3)
    with pytest.raises(RemoteError, match="more than 3 files"):
        await copy._all([told(1, 1), told(1, 1)])
    assert len(await copy._all([told(1, 1), told(1)])) == 3
