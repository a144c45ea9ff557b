"""A check says all that is wrong with a map, and where."""

from pathlib import Path

import pytest

from pioneer3.models import load_model
from pioneer3.sim.map_check import check_world
from tests.unit.sim.solid_files import write_block, write_u

MODEL = load_model("p3at-sh")
HOME = 'Cairn: RobotHome 2000 2000 0 "" ICON "H"\n'
ROOM = "LINES\n0 0 4000 0\n4000 0 4000 4000\n4000 4000 0 4000\n0 4000 0 0\n"


def said(path: Path | str) -> list[tuple[str, int | None, str]]:
    return [(str(r.level), r.line, r.text) for r in check_world(path, MODEL)]


def check(folder: Path, text: str, name: str = "m.map") -> list[tuple[str, int | None, str]]:
    path = folder / name
    path.write_text(text)
    return said(path)


def test_a_good_map_is_fine(tmp_path: Path) -> None:
    assert said("office") == []
    assert check(tmp_path, f"2D-Map\nNumLines: 4\n{HOME}{ROOM}") == []


@pytest.mark.parametrize(
    ("text", "remark"),
    [
        (f"2D-Map\nNumLines: 5\n{HOME}{ROOM}", (2, "NumLines says '5', there are 4")),
        (f"2D-Map\nLineMaxPos: 4000 x\n{HOME}{ROOM}", (2, "it is 4000 4000")),
        (f"2D-Map\n{HOME}{ROOM}5 5 5 5\n", (8, "a line without length at 5 5")),
        (f"2D-Map\n{HOME}{ROOM}4000 0 0 0\n", (8, "the same line as on line 4")),
        (f"2D-Map\n{HOME.replace('2000', '0')}{ROOM}", (2, "stands in a wall")),
        (f"2D-Map\n{HOME.replace('2000', '380')}{ROOM}", (2, "is 0.38 m from a wall: p3at-sh")),
        (f"2D-Map\n{HOME.replace('2000', '9000')}{ROOM}", (2, "is outside the walls")),
        (f"2D-Map\n{ROOM}", (None, "there is no RobotHome")),
        (f"2D-Map\n{HOME}", (None, "there is no wall")),
        (
            f'2D-Map\n{HOME}Cairn: Goal 7000 2000 0 "" ICON "far"\n{ROOM}',
            (3, 'Goal "far" cannot be reached from any home'),
        ),
        (
            f'2D-Map\n{HOME}Cairn: Goal 3000 3900 0 "" ICON ""\n{ROOM}',
            (3, "Goal at 3.00 3.90 is too near to a wall"),
        ),
        (
            f'2D-Map\n{HOME}Cairn: Goal 3000 2000 0 "" ICON "g"\n'
            f'Cairn: ForbiddenLine 0 0 0 "" ICON "" 2600 0 2600 4000\n{ROOM}',
            (3, 'Goal "g" cannot be reached'),
        ),
    ],
)
def test_each_kind_of_warning(tmp_path: Path, text: str, remark: tuple[int | None, str]) -> None:
    ((level, line, words),) = check(tmp_path, text)
    assert (level, line) == ("warning", remark[0])
    assert remark[1] in words


def test_all_errors_are_listed_with_their_lines(tmp_path: Path) -> None:
    remarks = check(tmp_path, f"2D-Map\nCairn: Goal\n{HOME}{ROOM}1 2 3\n0 0 0 zz\n")
    assert [(level, line) for level, line, _ in remarks] == [
        ("error", 2),
        ("error", 9),
        ("error", 10),
    ]


def test_many_of_a_kind_are_counted(tmp_path: Path) -> None:
    remarks = check(tmp_path, f"2D-Map\n{HOME}{ROOM}" + "5 5 5 5\n" * 30)
    texts = [text for _, _, text in remarks]
    assert "and 20 more lines without length" in texts
    assert "and 19 more doubled lines" in texts


@pytest.mark.parametrize("content", ["", "hello", "2D-Map\nResolution: x\nDATA\n1 1\n"])
def test_no_map_is_one_error(tmp_path: Path, content: str) -> None:
    assert [level for level, _, _ in check(tmp_path, content)] == ["error"]


def test_a_missing_file_is_an_error(tmp_path: Path) -> None:
    ((level, _, text),) = said(tmp_path / "nope.map")
    assert level == "error"
    assert "no such file" in text
    assert str(tmp_path) in text


def test_misspelled_keys_of_map_server_are_warnings(tmp_path: Path) -> None:
    (tmp_path / "m.pgm").write_bytes(b"P5 1 1 255\n\0")
    yaml = "image: m.pgm\nresolution: 0.1\norigin: [0, 0, 0]\nnegat: 1\n"
    remarks = check(tmp_path, yaml, "m.yaml")
    assert ("warning", 4, "negat: unknown key, skipped, did you mean negate?") in remarks


def test_robots_of_a_world_are_checked(tmp_path: Path) -> None:
    world = (
        '[world]\nmap = "office"\n[[robot]]\nmodel = "p3zz"\n'
        "[[robot]]\nstart = { x = 0, y = 0 }\n"
        '[[robot]]\nstart = "random"\n[[goal]]\nx = 50\ny = 50\nname = "away"'
    )
    remarks = check(tmp_path, world, "w.toml")
    assert [level for level, _, _ in remarks] == ["error", "warning", "warning"]
    assert "robot[0].model: 'p3zz'" in remarks[0][2]
    texts = " ".join(text for _, _, text in remarks)
    assert "robot[1].start stands in a wall" in texts
    assert 'Goal "away" cannot be reached' in texts


@pytest.mark.parametrize(
    ("robots", "remark"),
    [
        (
            "start = { x = 3, y = 3.1 }\n[[robot]]\nstart = { x = 3.2, y = 3.1 }",
            ("warning", "robot[1].start: another robot stands there, it begins beside it"),
        ),
        (
            "start = { x = 3, y = 3.1 }\n[[box]]\ncenter = [3, 3]\nsize = [1, 1]\nmovable = true",
            ("warning", "robot[0].start: a movable box or a person stands there"),
        ),
        (
            "equipment = { table_ir = 'new' }",
            ("warning", "robot[0].equipment.table_ir: p3at-sh has no table sensors"),
        ),
        ("model = 'peoplebot-sh'\nequipment = { table_ir = 'old' }", None),
        ("equipment = { gyro = 3 }", ("error", "robot[0].equipment.gyro: 3 is out of range")),
    ],
)
def test_where_robots_begin_and_what_they_carry_is_checked(
    tmp_path: Path, robots: str, remark: tuple[str, str] | None
) -> None:
    remarks = check(tmp_path, f'[world]\nmap = "office"\n[[robot]]\n{robots}', "w.toml")
    if remark is None:
        assert remarks == []
    else:
        ((level, _, text),) = remarks
        assert level == remark[0]
        assert remark[1] in text


def test_a_crowd_without_room_is_an_error(tmp_path: Path) -> None:
    room = "[[wall]]\npoints = [[0, 0], [3, 0], [3, 3], [0, 3]]\nclosed = true\n"
    home = "[[home]]\nx = 1.5\ny = 1.5\n"
    remarks = check(tmp_path, "[world]\n" + room + home + "[[robot]]\n" * 9, "w.toml")
    assert [level for level, _, _ in remarks] == ["error"]
    assert "no room left for a p3at-sh" in remarks[0][2]


def test_the_shipped_lab_is_fine() -> None:
    assert said("lab") == []


SHARED = Path(__file__).parents[4] / "shared/maps"


@pytest.mark.skipif(not SHARED.is_dir(), reason="no maps beside this tree")
@pytest.mark.parametrize(
    ("name", "count"), [("triangle", 0), ("office", 0), ("AMROffice", 4), ("columbia", 2)]
)
def test_known_maps(name: str, count: int) -> None:
    remarks = said(SHARED / f"{name}.map")
    assert len(remarks) == count
    assert all(level == "warning" for level, _, _ in remarks)
    if name == "columbia":
        assert "Inside Forbidden Area" in remarks[0][2]
        assert "Impossible Goal" in remarks[1][2]


def test_a_ramp_that_nobody_climbs_is_told(tmp_path: Path) -> None:
    ramps = "".join(
        f"[[ramp]]\ncenter=[{x},2]\nsize=[1,1]\nheight={height}\n"
        for x, height in ((2, 0.15), (5, 0.4))
    )
    world = (
        f"[world]\n{ramps}[[wall]]\npoints=[[0,0],[9,0],[9,9],[0,9]]\nclosed=true\n"
        "[[home]]\nx=7\ny=7\n"
    )
    ((level, _, text),) = check(tmp_path, world, "w.toml")
    assert level == "warning"
    assert text == ("ramp[1]: rises 22 degrees, a P3-DX climbs 14: make it 1.60 m long, or lower")


def test_a_mesh_that_physics_refuse_is_told(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    write_u(tmp_path / "u.stl")
    write_block(tmp_path / "block.stl", (0.5, 0.5, 0.5))
    meshes = "".join(
        f"[[mesh]]\nfile='{name}.stl'\ncenter=[{x},3]\n" for name, x in (("block", 2), ("u", 5))
    )
    world = (
        f"[world]\n{meshes}[[wall]]\npoints=[[0,0],[9,0],[9,9],[0,9]]\nclosed=true\n"
        "[[home]]\nx=7\ny=7\n"
    )
    ((level, _, text),) = check(tmp_path, world, "w.toml")
    assert level == "warning"
    assert text.startswith("mesh 1, with physics: its convex hull")


def test_two_places_of_one_name_are_told(tmp_path: Path) -> None:
    goals = 'Cairn: Goal 1000 1000 0 "" ICON "A"\nCairn: Goal 3000 3000 0 "" ICON "a "\n'
    assert check(tmp_path, f"2D-Map\n{HOME}{goals}{ROOM}") == [
        ("warning", 4, 'Goal "a " has the name of Goal "A" on line 3: rename one')
    ]


def test_areas_that_robots_do_not_heed_are_told(tmp_path: Path) -> None:
    areas = "".join(
        f'Cairn: {kind} 0 0 0 "" ICON "x" 100 100 200 200\n'
        for kind in ("SlowSector", "OneWaySector", "RestrictiveSector", "ForbiddenArea")
    )
    told = check(tmp_path, f"2D-Map\n{HOME}{areas}RouteInfo: r\n{ROOM}")
    assert [(line, text.partition(":")[0]) for _, line, text in told] == [
        (3, 'SlowSector "x"'),
        (4, 'OneWaySector "x"'),
        (5, 'RestrictiveSector "x"'),
        (7, "routes and tasks are kept, and not driven"),
    ]


def test_cells_without_a_resolution_are_told(tmp_path: Path) -> None:
    text = f"2D-Map\nResolution: 0\n{HOME}{ROOM}DATA\n"
    assert check(tmp_path, text) == []
    assert check(tmp_path, text + "9 9\n")[0] == ("warning", 2, "Resolution says '0': 20 mm count")
