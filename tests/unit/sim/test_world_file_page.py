"""The reference page of world files says what the parser takes."""

import re
from pathlib import Path
from typing import get_args, get_type_hints

import pytest

from pioneer3.maps import shipped_maps
from pioneer3.maps.materials import Material
from pioneer3.models import load_model
from pioneer3.models.lasers import LASERS
from pioneer3.sim.equipment import EquipmentOptions
from pioneer3.sim.map_check import check_world
from pioneer3.sim.relief import SOLIDS
from pioneer3.sim.worldfile import WorldFile, parse_world, shipped_worlds
from pioneer3.sim.worldfile.person import RADIUS, SPEED
from pioneer3.sim.worldfile.toml import Tables
from pioneer3.tables import keys
from tests.unit.sim.solid_files import write_block, write_hill

PAGE = Path(__file__).parents[3] / "docs/reference/world-file.md"
TEXT = PAGE.read_text()
EXAMPLE = TEXT.partition("```toml\n")[2].partition("```")[0]
PLACES = "`[[goal]]`, `[[dock]]`, `[[home]]`"
HEADINGS = {
    "world": "## `[world]`",
    "robot": "## `[[robot]]`",
    "robot.start": "### `start`",
    "robot.equipment": "### `equipment`",
    "box": "## `[[box]]`",
    "wall": "## `[[wall]]`",
    **{kind.table: f"### `[[{kind.table}]]`" for kind in SOLIDS},
    "goal": f"## {PLACES}",
    "dock": f"## {PLACES}",
    "home": f"## {PLACES}",
    "person": "## `[[person]]`",
}

TABLES = get_type_hints(Tables)
KEYS = {
    name: keys(hint if name == "world" else get_args(hint)[0]) for name, hint in TABLES.items()
} | {"robot.start": ("x", "y", "theta_deg"), "robot.equipment": keys(EquipmentOptions)}


def test_every_table_has_a_heading() -> None:
    assert KEYS.keys() == HEADINGS.keys()


def keys_on_the_page(heading: str) -> list[str]:
    """Return the keys in the first table below a heading."""
    section = re.split(r"\n#+ ", TEXT.partition(f"\n{heading}\n")[2])[0]
    rows = re.findall(r"^\| (`[^|]*) \|", section, re.MULTILINE)
    return [key for row in rows for key in re.findall(r"`(\w+)`", row)]


@pytest.mark.parametrize("table", [*KEYS])
def test_every_key_is_on_the_page_and_no_other(table: str) -> None:
    assert sorted(keys_on_the_page(HEADINGS[table])) == sorted(KEYS[table])


def example(tmp_path: Path) -> WorldFile:
    write_hill(tmp_path / "hill.png")
    write_block(tmp_path / "rock.stl", (400.0, 300.0, 500.0))
    return parse_world(tmp_path / "course.toml", EXAMPLE)


def test_the_example_is_fine_and_runs(tmp_path: Path) -> None:
    example(tmp_path)
    (tmp_path / "course.toml").write_text(EXAMPLE)
    assert check_world(tmp_path / "course.toml", load_model("p3at-sh")) == ()


@pytest.mark.parametrize("table", [*KEYS])
def test_the_example_shows_every_key(table: str, tmp_path: Path) -> None:
    if table != "robot.equipment":
        for key in KEYS[table]:
            assert re.search(rf"\b{key} = ", EXAMPLE), key
    assert example(tmp_path).people[0].loop is False


def test_the_defaults_are_those_of_the_page(tmp_path: Path) -> None:
    text = "[world]\n[[robot]]\n[[box]]\ncenter=[0,9]\nsize=[1,1]\n[[person]]\npath=[[9,9]]"
    world = parse_world(tmp_path / "w.toml", text)
    (robot,), (box,), (person,) = world.robots, world.boxes, world.people
    assert (world.name, world.map, world.seed) == ("w", "empty", None)
    assert (robot.model, robot.start, robot.port) == ("p3at-sh", "home", None)
    assert (box.movable, box.pose.theta, box.name) == (False, 0.0, "")
    assert (person.speed, person.radius, person.loop, person.pause) == (SPEED, RADIUS, True, 0.0)
    assert f"| `speed` | {SPEED} |" in TEXT
    assert f"| `radius` | {RADIUS} |" in TEXT


def test_the_lasers_and_materials_that_there_are_are_on_the_page() -> None:
    for name in LASERS:
        assert f'`"{name}"`' in TEXT
    for material in Material:
        assert f'| `"{material}"` |' in TEXT


def test_the_worlds_that_ship_are_named() -> None:
    assert shipped_worlds() == ("cafe", "dining", "lab", "ramps")
    for name in shipped_worlds():
        assert f"| `{name}` |" in TEXT
    assert '`"office"`' in TEXT
    assert "office" in shipped_maps()
