"""What is written reads back the same."""

from math import pi
from pathlib import Path

import numpy as np
import pytest

from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.maps import (
    LineMap,
    MapObject,
    empty_map,
    read_map,
    shipped_map,
    write_aria_map,
    write_map_server,
)
from pioneer3.maps.grid import samples
from pioneer3.maps.line_map import distances

SHARED = Path(__file__).parents[4] / "shared/maps"
shared = pytest.mark.skipif(not SHARED.is_dir(), reason="no maps beside this tree")


def there_and_back(line_map: LineMap, folder: Path) -> LineMap:
    path = folder / f"{line_map.name}.map"
    write_aria_map(line_map, path)
    return read_map(path)


def assert_same(before: LineMap, after: LineMap) -> None:
    np.testing.assert_allclose(after.walls, before.walls, atol=0.00072)
    assert len(after.objects) == len(before.objects)
    for old, new in zip(before.objects, after.objects, strict=True):
        assert (new.kind, new.name, new.solid) == (old.kind, old.name, old.solid)
        assert (new.pose.x, new.pose.y) == pytest.approx((old.pose.x, old.pose.y), abs=0.0006)
        assert new.pose.theta == pytest.approx(old.pose.theta)
        np.testing.assert_allclose(new.outline, old.outline, atol=0.00072)
    assert len(after.homes) == len(before.homes)


def test_the_shipped_map_comes_back(tmp_path: Path) -> None:
    assert_same(shipped_map("office"), there_and_back(shipped_map("office"), tmp_path))


@shared
@pytest.mark.parametrize("name", ["AMROffice", "columbia", "office", "triangle"])
def test_known_maps_come_back(tmp_path: Path, name: str) -> None:
    before = read_map(SHARED / f"{name}.map")
    assert_same(before, there_and_back(before, tmp_path))


def test_all_kinds_of_objects_come_back(tmp_path: Path) -> None:
    text = (
        "2D-Map\n"
        "MapInfo: SectorType Name=Crate Sim.Obstacle=yes\n"
        'MapInfo: BoundaryType Name=Mirror "Sim.LaserReflect=5"\n'
        "MapInfo: BoundaryType Name=Tape\n"
        'Cairn: Crate 0 0 30 "" ICON "a" 1000 1000 2000 1500\n'
        'Cairn: Mirror 0 0 30 "" ICON "" 1 2 3000 4000\n'
        'Cairn: Tape 0 0 0 "" ICON "" 1 2 3 4\n'
        'Cairn: ForbiddenArea 0 0 -45 "" ICON "off limits" 0 0 1000 1000\n'
        'Cairn: "Odd Kind" 5 6 180 "" ICON "x"\n'
        "LINES\n0 0 5000 0\n"
    )
    path = tmp_path / "a.map"
    path.write_text(text)
    before = read_map(path)
    assert len(before.walls) == 1 + 4 + 1
    assert_same(before, there_and_back(before, tmp_path))


def test_names_cannot_break_out_of_their_line(tmp_path: Path) -> None:
    goal = MapObject(kind='G"o\nal', name='a "b"\nLINES', pose=Pose2(1, 2, pi))
    after = there_and_back(LineMap(name="m", walls=np.empty((0, 4)), objects=(goal,)), tmp_path)
    assert after.objects[0].name == "a 'b' LINES"
    assert after.objects[0].pose == goal.pose


def test_a_picture_of_walls_lies_within_a_pixel_of_them(tmp_path: Path) -> None:
    before, cell = shipped_map("office"), 0.05
    write_map_server(before, tmp_path / "o.yaml", cell)
    after = read_map(tmp_path / "o.yaml")
    for one, other in ((before.walls, after.walls), (after.walls, before.walls)):
        for point in samples(one, 0.5):
            assert distances(point, other).min() <= 1.42 * cell


def test_a_wall_on_the_edge_of_a_pixel_is_in_the_one_above_or_right(tmp_path: Path) -> None:
    walls = np.array([[0.03, -0.2, 1.9, 3.3]])
    write_map_server(LineMap(name="a", walls=walls), tmp_path / "a b's.yaml", 0.1)
    drawn = read_map(tmp_path / "a b's.yaml")
    assert drawn.bounds == pytest.approx((0.0, -0.2, 2.0, 3.4))


def test_no_walls_are_a_small_free_picture(tmp_path: Path) -> None:
    write_map_server(empty_map(), tmp_path / "e.yaml")
    assert not len(read_map(tmp_path / "e.yaml").walls)
    assert not len(there_and_back(empty_map(), tmp_path).walls)


def test_a_huge_picture_is_refused(tmp_path: Path) -> None:
    far = LineMap(name="far", walls=np.array([[-9e4, -9e4, 9e4, 9e4]]))
    with pytest.raises(ConfigError, match="take larger ones"):
        write_map_server(far, tmp_path / "far.yaml")
    assert not list(tmp_path.iterdir())


def test_where_nothing_can_be_written_is_said(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"m\.map: cannot be written: No such file"):
        write_aria_map(empty_map(), tmp_path / "no" / "m.map")


@pytest.mark.parametrize(
    ("info", "kind", "solid"),
    [
        ("", "Sim.BoxObstacle", True),
        ("MapInfo: SectorType Name=A Sim.Obstacle=yes", "A", True),
        ('MapInfo: SectorType Name=A "Sim.Obstacle=True"', "A", True),
        ("MapInfo: SectorType Name=A Sim.Obstacle=no", "A", False),
        ("MapInfo: SectorType Name=A Sim.LaserReflect=2", "A", False),
        ("MapInfo: SectorType Name=Sim.BoxObstacle Sim.Obstacle=no", "Sim.BoxObstacle", False),
        ("", "Reflector", True),
        ("", "Sim.Reflector", True),
        ("MapInfo: BoundaryType Name=Odd.Reflect", "Odd.Reflect", True),
        ("MapInfo: BoundaryType Name=A Sim.LaserReflect=33", "A", True),
        ("MapInfo: BoundaryType Name=A Sim.LaserReflect=1", "A", False),
        ("MapInfo: BoundaryType Name=A Sim.LaserReflect=no", "A", False),
        ("MapInfo: BoundaryType Name=A Sim.SonarReflect=no", "A", False),
        ("", "ForbiddenArea", False),
        ("", "ForbiddenLine", False),
        ("", "BadGPSSector", False),
    ],
)
def test_which_objects_become_walls(tmp_path: Path, info: str, kind: str, solid: bool) -> None:
    path = tmp_path / "m.map"
    path.write_text(f'2D-Map\n{info}\nCairn: {kind} 0 0 0 "" ICON "" 0 0 1000 500\n')
    read = read_map(path)
    assert read.objects[0].solid is solid
    assert len(read.walls) == (len(read.objects[0].sides) if solid else 0)
