"""Clients get the maps that are meant for them, and no other file."""

import os
from pathlib import Path

import pytest

from pioneer3.errors import ConfigError
from pioneer3.sim.worldfile import ClientMaps

MAP = "2D-Map\nLINES\n0 0 1000 0\n0 0 0 1000\n"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Return a folder with `lab.map`, beside `secret.map` in the one above."""
    inside = tmp_path / "maps"
    (inside / "below").mkdir(parents=True)
    for path in (inside / "lab.map", inside / "below" / "deep.map", tmp_path / "secret.map"):
        path.write_text(MAP)
    (inside / "link.map").symlink_to(tmp_path / "secret.map")
    (inside / "loop.map").symlink_to(inside / "loop.map")
    (inside / "notes.txt").write_text("nothing\n")
    os.mkfifo(inside / "pipe.map")
    return inside


def test_files_right_in_the_folder_are_found_by_name_and_by_path(folder: Path) -> None:
    client_maps = ClientMaps(folder)
    for name in ("lab.map", "./lab.map", "below/../lab.map", str(folder / "lab.map")):
        assert len(client_maps.find(name).line_map().walls) == 2


def test_shipped_maps_are_always_there(folder: Path) -> None:
    for name in ("office", "office.map"):
        assert ClientMaps(folder).find(name).name == "office"


def test_a_file_wins_over_a_shipped_map_of_the_same_name(folder: Path) -> None:
    (folder / "office.map").write_text(MAP)
    assert len(ClientMaps(folder).find("office.map").line_map().walls) == 2


@pytest.mark.parametrize(
    "name",
    [
        "",
        ".",
        "..",
        "nowhere.map",
        "../secret.map",
        "below",
        "below/deep.map",
        "link.map",
        "loop.map",
        "pipe.map",
        "/etc/passwd",
        "../maps/../secret.map",
        "lab.map\0.txt",
        "x" * 5000,
        "notes.txt",
    ],
)
def test_nothing_else_is(folder: Path, name: str) -> None:
    with pytest.raises(ConfigError):
        ClientMaps(folder).find(name).line_map()


def test_by_default_it_is_the_working_directory(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    client_maps = ClientMaps()
    monkeypatch.chdir(folder)
    assert len(client_maps.find("lab.map").line_map().walls) == 2
