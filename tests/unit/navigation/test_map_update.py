"""Maps in files that are continued: what changes, and which files are there whatever fails."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from pioneer3.errors import ConfigError
from pioneer3.geometry import ORIGIN
from pioneer3.maps import LineMap, MapObject
from pioneer3.nav.changes import drawn
from pioneer3.nav.mapper import Mapper
from pioneer3.nav.settings import AS_SHIPPED
from pioneer3.navigation.map_files import files_of, load_survey, save_map, save_survey
from pioneer3.navigation.map_update import ContinuedMap
from pioneer3.sim.worldfile import load_map, load_world
from tests.unit.nav.halls import ROUND
from tests.unit.nav.test_changes import BOX, SHELF, driven

WORLD = """
[[robot]]
model = "p3at-sh"
start = { x = 1.0, y = 2.0, theta_deg = 90 }

[[box]]
center = [3.0, 1.0]
size = [0.4, 0.3]

[[wall]]
points = [[0.0, 0.0], [1.0, 0.0]]
material = "glass"

[[goal]]
name = "Kitchen"
x = 2.0
y = 1.0

[[person]]
path = [[1.0, 1.0], [2.0, 1.0]]
"""
HOME = (MapObject(kind="RobotHome", name="Home", pose=ORIGIN),)


@cache
def days() -> tuple[Mapper, LineMap, Mapper, LineMap]:
    """Return what a robot has made of the hall on one day, and on another one."""
    old, new = driven(BOX, SHELF)
    return (
        old,
        drawn(old.survey, 0.3, objects=HOME),
        new,
        drawn(new.survey, 0.3, objects=HOME),
    )


class Hall:
    """A map of the hall in a file, and what a robot has made of it on another day."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.old, old_map, self.mapper, self.new = days()
        save_map(old_map, path)
        save_survey(self.old, path)
        self.line_map = load_map(path)

    def is_old(self, path: Path) -> bool:
        """Return whether the map there and its survey are those of the day before."""
        same = len(load_survey(path)["poses"]) == len(self.old.survey.poses)
        return same and np.array_equal(load_map(path).walls, self.line_map.walls)

    def is_new(self, path: Path) -> bool:
        """Return whether the map there and its survey are the new ones."""
        same = len(load_survey(path)["poses"]) == len(self.mapper.survey.poses)
        return same and not np.array_equal(load_map(path).walls, self.line_map.walls)


@pytest.fixture(params=["hall.map", "hall.yaml"])
def hall(tmp_path: Path, request: pytest.FixtureRequest) -> Hall:
    return Hall(tmp_path / request.param)


def names(folder: Path) -> set[str]:
    return {path.stem for path in folder.glob("*.map")} | {p.stem for p in folder.glob("*.yaml")}


def test_the_mapper_goes_on_and_the_places_stay(hall: Hall) -> None:
    update = ContinuedMap(hall.path)
    mapper = update.mapper(ROUND[5], AS_SHIPPED.mapper)
    assert len(mapper.survey.frames) == len(hall.old.survey.frames)
    assert mapper.robot_in_map == ROUND[5]
    if hall.path.suffix == ".map":
        assert [place.name for place in update.objects] == ["Home"]


def test_it_tells_the_changes_each_with_its_cells(hall: Hall) -> None:
    update = ContinuedMap(hall.path)
    found = update.changes(hall.new)
    assert [change.gone for change in found].count(True) == 1
    assert [change.gone for change in found].count(False) == 1
    for change in found:
        assert change.cells.mean(axis=0) == pytest.approx((change.x, change.y))
        assert len(change.cells) * AS_SHIPPED.mapper.cell**2 == pytest.approx(change.area)
        low, high = change.cells.min(axis=0), change.cells.max(axis=0)
        thing = BOX if change.gone else SHELF
        assert low == pytest.approx([thing[:, ::2].min(), thing[:, 1::2].min()], abs=0.2)
        assert high == pytest.approx([thing[:, ::2].max(), thing[:, 1::2].max()], abs=0.2)


def test_the_old_map_is_whole_until_it_is_replaced(hall: Hall) -> None:
    update = ContinuedMap(hall.path)
    update.keep(hall.mapper)
    new = hall.path.with_stem("hall-new")
    assert len(load_survey(new)["poses"]) == len(hall.mapper.survey.poses)
    assert hall.is_old(hall.path)
    assert update.write(hall.new, hall.mapper) == new
    assert hall.is_new(new)
    assert hall.is_old(hall.path)
    line_map, before = update.replace(hall.new, hall.mapper)
    assert (before.stem, line_map.name, line_map.file) == ("hall-before", "hall", hall.path)
    assert hall.is_new(hall.path)
    assert hall.is_old(before)
    assert names(hall.path.parent) == {"hall", "hall-before"}


def test_a_world_keeps_all_that_its_file_has(tmp_path: Path) -> None:
    hall = Hall(tmp_path / "hall.toml")
    with hall.path.open("a") as file:
        file.write(WORLD)
    update = ContinuedMap(hall.path)
    old = load_world(hall.path)
    assert [place.name for place in update.objects] == ["Home"]
    update.replace(hall.new, hall.mapper)
    new, before = load_world(hall.path), load_world(tmp_path / "hall-before.toml")
    assert len(new.robots) == len(new.boxes) == len(new.walls) == len(new.places) == 1
    assert replace(new, source="") == replace(old, source="")
    assert replace(before, source="", name="hall", map=old.map) == replace(old, source="")
    assert (new.base_map().walls.tolist(), len(new.base_map().objects)) == (
        load_map(hall.path.with_suffix(".map")).walls.tolist(),
        1,
    )
    assert new.base_map().walls.tolist() != before.base_map().walls.tolist()


def test_a_new_map_that_is_not_wanted_leaves_nothing(hall: Hall) -> None:
    update = ContinuedMap(hall.path)
    update.write(hall.new, hall.mapper)
    update.discard()
    assert hall.is_old(hall.path)
    assert names(hall.path.parent) == {"hall"}


@pytest.mark.parametrize("failing", ["save_survey", "save_map"])
def test_a_disk_that_is_full_leaves_the_old_map_beside(
    hall: Hall, monkeypatch: pytest.MonkeyPatch, failing: str
) -> None:
    def full(thing: Mapper | LineMap, path: Path) -> None:
        raise ConfigError(f"{path} cannot be written: no space left on device")

    update = ContinuedMap(hall.path)
    monkeypatch.setattr(f"pioneer3.navigation.map_update.{failing}", full)
    with pytest.raises(ConfigError, match="no space left"):
        update.replace(hall.new, hall.mapper)
    assert hall.is_old(hall.path.with_stem("hall-before"))
    assert (load_map(hall.path).walls == hall.line_map.walls).all()


def test_without_a_survey_a_sentence_says_why(tmp_path: Path) -> None:
    hall = Hall(tmp_path / "hall.map")
    files_of(hall.path)[-1].unlink()
    with pytest.raises(ConfigError, match=r"hall\.survey\.npz has to lie beside it"):
        ContinuedMap(hall.path)
