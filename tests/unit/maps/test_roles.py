"""What the objects of a map are to people."""

from pathlib import Path

import pytest

from pioneer3.maps import LineMap, MapObject, read_map, shipped_map, write_aria_map

TEXT = """2D-Map
MapInfo: GoalType Name=Counter "Label=Where people queue" Heading=Required
MapInfo: GoalType Name=Spot
MapInfo: DockType Name=Garage
MapInfo: LocationType Name=Label
MapInfo: BoundaryType Name=Tape
MapInfo: SectorType Name=RestArea
Cairn: Goal 1000 2000 90 "" ICON "a"
Cairn: GoalWithHeading 1000 2000 90 "" ICON "b"
Cairn: Counter 1 2 90 "" ICON "c"
Cairn: Spot 1 2 90 "" ICON "d"
Cairn: DockPioneer 1 2 90 "" ICON "e"
Cairn: Garage 1 2 90 "" ICON "f"
Cairn: RobotHome 1 2 90 "" ICON "g"
Cairn: Label 1 2 90 "" ICON "h"
Cairn: Tape 1 2 90 "" ICON "i" 0 0 1000 0
Cairn: RestArea 0 0 0 "" ICON "j" 0 0 1000 1000
Cairn: ForbiddenLine 0 0 0 "" ICON "k" 0 0 1000 1000
Cairn: ForbiddenArea 0 0 0 "" ICON "l" 0 0 1000 1000
"""


def read(folder: Path) -> LineMap:
    path = folder / "a.map"
    path.write_text(TEXT)
    return read_map(path)


def told(item: MapObject) -> tuple[str, str, bool, bool]:
    return item.name, item.role, item.heads, item.forbidden


def test_every_type_has_a_role(tmp_path: Path) -> None:
    assert [told(item) for item in read(tmp_path).objects] == [
        ("a", "goal", False, False),
        ("b", "goal", True, False),
        ("c", "goal", True, False),
        ("d", "goal", False, False),
        ("e", "dock", True, False),
        ("f", "dock", True, False),
        ("g", "home", True, False),
        ("h", "place", False, False),
        ("i", "line", False, False),
        ("j", "area", False, False),
        ("k", "line", False, True),
        ("l", "area", False, True),
    ]


def test_roles_come_back_from_a_written_map(tmp_path: Path) -> None:
    before = read(tmp_path)
    write_aria_map(before, tmp_path / "b.map")
    after = read_map(tmp_path / "b.map")
    assert list(map(told, after.objects)) == list(map(told, before.objects))


def test_the_shipped_office_has_goals_docks_and_homes() -> None:
    roles = [item.role for item in shipped_map("office").objects]
    assert (roles.count("goal"), roles.count("dock"), roles.count("home")) == (9, 1, 2)


@pytest.mark.parametrize(
    ("name", "speed"),
    [("0.3 m/s", 0.3), ("slow: .25", 0.25), ("2", 2.0), ("slow", None), ("0", None)],
)
def test_the_name_of_a_speed_area_tells_its_speed(
    tmp_path: Path, name: str, speed: float | None
) -> None:
    path = tmp_path / "a.map"
    path.write_text(
        "2D-Map\nMapInfo: SectorType Name=SpeedArea\n"
        f'Cairn: SpeedArea 0 0 0 "" ICON "{name}" 0 0 2000 1000\n'
        f'Cairn: RestArea 0 0 0 "" ICON "{name}" 0 0 2000 1000\n'
    )
    area, other = read_map(path).objects
    assert area.speed == speed
    assert other.speed is None
