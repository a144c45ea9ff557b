"""The pictures of the architecture show what is there."""

import re
from pathlib import Path

import pytest

from docs.plots import architecture
from docs.plots.architecture import IMAGES, ROOT, WAYS, Way

PAGE = (ROOT / "docs/explanation/architecture.md").read_text("utf-8")
MOST_LETTERS = 47
"""Words of a box that fit into it, in a usual font."""


def section(way: Way) -> str:
    """Return the part of the page that a picture stands in."""
    (found,) = (part for part in PAGE.split("\n## ") if f"architecture-{way.name}.svg" in part)
    return found


@pytest.mark.parametrize("way", WAYS, ids=lambda way: way.name)
def test_each_module_of_a_picture_exists_and_is_in_the_table_below_it(way: Way) -> None:
    modules = [name for group in way.groups for box in group.boxes for name in box.modules]
    assert [name for name in modules if not (ROOT / "src/pioneer3" / name).exists()] == []
    assert [name for name in modules if Path(name).name not in section(way)] == []
    assert not way.back or way.back in modules


def test_words_fit_into_their_boxes() -> None:
    boxes = [box for way in WAYS for group in way.groups for box in group.boxes]
    assert [box.does for box in boxes if len(box.does) > MOST_LETTERS] == []
    assert [box.modules for box in boxes if max(map(len, box.modules)) > MOST_LETTERS - 5] == []


def test_the_pictures_are_up_to_date(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(architecture, "IMAGES", tmp_path)
    architecture.main()
    made = {path.name: path.read_text() for path in tmp_path.iterdir()}
    kept = {path.name: path.read_text() for path in IMAGES.glob("architecture-*.svg")}
    assert made == kept, "run: python -m docs.plots architecture-layers"
    assert [name for name in made if name not in PAGE] == []


def test_the_table_of_packages_has_those_of_the_layers() -> None:
    table = PAGE[PAGE.index("| package |") : PAGE.index("\n\n", PAGE.index("| package |"))]
    named = [
        name for row in table.split("\n") for name in re.findall(r"`(\w+)`", row.split("|")[1])
    ]
    assert named == [name for layer in architecture.layers() for name in layer]
