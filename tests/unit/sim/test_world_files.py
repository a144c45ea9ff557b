"""World files: what they say becomes SI; what is wrong with one is said in one line."""

from math import pi
from pathlib import Path

import numpy as np
import pytest

from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.maps import shipped_map
from pioneer3.maps.materials import Material
from pioneer3.models import load_model
from pioneer3.sim.equipment import Equipment, EquipmentOptions
from pioneer3.sim.worldfile import (
    Box,
    Person,
    Place,
    RobotSpec,
    Wall,
    WorldFile,
    load_map,
    load_world,
    parse_equipment,
    parse_world,
    to_toml,
)

FULL = """
[world]
name = "Lab course"
map = "square.map"
seed = 7

[[robot]]
model = "p3dx-sh"
name = "bob"
start = { x = 3.0, y = 3.1, theta_deg = 90 }
port = 8102

[[robot]]
model = "mine.toml"
start = "random"

[[box]]
center = [2, 1]
size = [0.6, 0.4]
theta_deg = 90

[[box]]
center = [5, 5]
size = [1, 1]
movable = true
name = "crate"

[[wall]]
points = [[0, 0], [1, 0], [1, 1]]
closed = true

[[goal]]
x = 1
y = 2
name = "door"

[[goal]]
x = 1
y = 2
theta_deg = -90

[[dock]]
x = 0.5
y = 0.5
theta_deg = 180

[[home]]
x = 3
y = 3

[[person]]
path = [[2, 7], [18, 7]]
speed = 1.2
radius = 0.3
loop = false
pause = 2
"""
SQUARE = '2D-Map\nCairn: RobotHome 9 9 0 "" ICON ""\nLINES\n0 0 9000 0\n0 0 0 9000\n'


def read(folder: Path, text: str = FULL) -> WorldFile:
    (folder / "square.map").write_text(SQUARE)
    return parse_world(folder / "w.toml", text)


def test_everything_is_read_in_si(tmp_path: Path) -> None:
    world = read(tmp_path)
    bob, other = world.robots
    assert (world.name, world.map, world.seed) == ("Lab course", tmp_path / "square.map", 7)
    assert bob == RobotSpec(model="p3dx-sh", name="bob", start=Pose2(3.0, 3.1, pi / 2), port=8102)
    assert other == RobotSpec(model=str(tmp_path / "mine.toml"), start="random")
    assert world.boxes == (
        Box(pose=Pose2(2, 1, pi / 2), size=(0.6, 0.4)),
        Box(pose=Pose2(5, 5), size=(1, 1), movable=True, name="crate"),
    )
    assert world.walls == (Wall(points=((0, 0), (1, 0), (1, 1)), closed=True),)
    assert world.people == (
        Person(path=((2, 7), (18, 7)), speed=1.2, radius=0.3, loop=False, pause=2),
    )
    assert world.places == (
        Place(kind="Goal", pose=Pose2(1, 2), name="door"),
        Place(kind="GoalWithHeading", pose=Pose2(1, 2, -pi / 2)),
        Place(kind="Dock", pose=Pose2(0.5, 0.5, pi)),
        Place(kind="RobotHome", pose=Pose2(3, 3)),
    )


def test_walls_are_all_that_stands_still(tmp_path: Path) -> None:
    line_map = read(tmp_path).line_map()
    assert len(line_map.walls) == 2 + 3 + 4
    sides = line_map.walls[-4:]
    np.testing.assert_allclose(sides[0], [2.2, 0.7, 2.2, 1.3], atol=1e-12)
    assert tuple(sides.min(axis=0)[:2]) == pytest.approx((1.8, 0.7))
    assert [(home.x, home.y) for home in line_map.homes] == [
        (3, 3),
        pytest.approx((0.009, 0.009)),
    ]
    assert [item.name for item in read(tmp_path).movable] == ["crate"]


def test_what_is_written_reads_the_same(tmp_path: Path) -> None:
    world = read(tmp_path)
    assert parse_world(tmp_path / "v.toml", to_toml(world, tmp_path)) == world
    below = tmp_path / "below"
    below.mkdir()
    again = parse_world(below / "v.toml", to_toml(world, below)).line_map()
    np.testing.assert_array_equal(again.walls, world.line_map().walls)


def test_the_least_world_is_an_empty_plane(tmp_path: Path) -> None:
    world = read(tmp_path, "[world]")
    assert world == WorldFile(name="w")
    assert world.line_map().walls.shape == (0, 4)


def test_a_world_builds_on_a_shipped_map(tmp_path: Path) -> None:
    line_map = read(tmp_path, '[world]\nmap = "office"').line_map()
    np.testing.assert_array_equal(line_map.walls, shipped_map("office").walls)


def test_a_world_can_be_given_where_a_map_is_asked_for(tmp_path: Path) -> None:
    read(tmp_path)
    path = tmp_path / "w.toml"
    path.write_text(FULL)
    assert len(load_map(path).walls) == 9
    assert load_world(path).name == "Lab course"


@pytest.mark.parametrize("name", ["office", "office.map", "empty"])
def test_a_shipped_map_is_a_world(name: str) -> None:
    assert load_world(name).line_map().name == name.removesuffix(".map")


def test_a_map_file_is_a_world(tmp_path: Path) -> None:
    read(tmp_path)
    assert len(load_world(tmp_path / "square.map").line_map().walls) == 2


@pytest.mark.parametrize("name", ["offise", "", "no/such.map", "a\0b", "a\0b.toml", "x" * 5000])
def test_an_unknown_name_is_a_one_line_error(name: str) -> None:
    with pytest.raises(ConfigError) as caught:
        load_world(name).line_map()
    assert str(caught.value).isprintable()


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("", "world: missing; a world starts with [world]"),
        ("[world", "w.toml:1: not valid TOML: Expected ']'"),
        ("world = 1", "w.toml:1: world: expected a table, got 1"),
        ("[world]\n[[robots]]", "w.toml:2: robots: unknown key, did you mean robot?"),
        ("[world]\nsead = 1", "w.toml:2: world.sead: unknown key, did you mean seed?"),
        ("[world]\n['a - at `$.world`']", "w.toml: a - at `$.world`: unknown key"),
        ("[world]\n'a - at `$.b' = 1", "w.toml:2: world.a - at `$.b: unknown key"),
        ("[world]\nzzz = 1", "world.zzz: unknown key, known are name, map, seed"),
        ("[world]\nseed = -1", "w.toml:2: world.seed: -1 is out of range, expected 0 to"),
        ("[world]\nseed = 1.5", "world.seed: expected a whole number, got 1.5"),
        ("[world]\nmap = 3", "w.toml:2: world.map: expected a text, got 3"),
        ("[world]\nmap = 'ofice'", "world.map: no such file: 'ofice', seen from here"),
        ("[world]\nmap = 'b.toml'", "world.map: 'b.toml' is a world too"),
        ("[world]\nname = '''a\nb'''", "world.name: 'a\\nb' cannot be printed on one line"),
        ("[world]\n[robot]", "w.toml:2: robot: expected [[robot]], with two brackets"),
        ("[world]\n[[robot]]\n[[robot]]\nport = 0", "w.toml:4: robot[1].port: 0 is out of range"),
        ("[world]\n[[robot]]\nstart = 'here'", "w.toml:3: robot[0].start: expected {x, y, theta"),
        ("[world]\n[[robot]]\nstart = {x = 1}", "w.toml:3: robot[0].start.y: missing, add it"),
        (
            "[world]\n[[robot]]\nstart = {x = 1, y = 1, theta = 1}",
            "robot[0].start.theta: unknown key, did you mean theta_deg?",
        ),
        (
            "[world]\n[[robot]]\nname = 'b'\n[[robot]]\nname = 'b'",
            "w.toml:5: robot[1].name: b is robot[0]'s already",
        ),
        ("[world]\n[[robot]]\nport=1\n[[robot]]\nport=1", "robot[1].port: 1 is robot[0]'s"),
        ("[world]\n[[box]]\ncenter=[1,2]", "w.toml:2: box[0].size: missing, add it"),
        ("[world]\n[[box]]\ncenter=[1,2,3]\nsize=[1,1]", "box[0].center: expected two numbers"),
        (
            "[world]\n[[box]]\ncenter=[1,2]\nsize=[1,0]",
            "w.toml:4: box[0].size[1]: 0 is out",
        ),
        ("[world]\n[[box]]\ncenter=[nan,2]\nsize=[1,1]", "box[0].center[0]: nan is out of"),
        ("[world]\n[[box]]\ncenter=[1,2]\nsize=[1,1]\nmovable=1", "movable: expected true or fa"),
        ("[world]\n[[box]]\ncenter=[1,2]\nsize=[1,true]", "size[1]: expected a number, got True"),
        ("[world]\n[[wall]]\npoints=[[1,2]]", "wall[0].points: expected a list of 2 or more"),
        ("[world]\n[[wall]]\npoints=[[1,2],3]", "w.toml:3: wall[0].points[1]: expected two nu"),
        ("[world]\n[[person]]\npath=[]", "person[0].path: expected a list of 1 or more points"),
        ("[world]\n[[person]]\npath=[[0,0]]\nspeed=0", "person[0].speed: 0 is out of range"),
        ("[world]\n[[person]]\npath=[[0,0]]\npause='x'", "pause: expected a number, got 'x'"),
        ("[world]\n[[person]]\npath=[[0,0]]\npatience=-1", "patience: -1 is out of range"),
        ("[world]\n[[person]]\npath=[[0,0]]\n_legs=1", "person[0]._legs: unknown key"),
        ("[world]\nrobots=[]", "world.robots: unknown key"),
        ("[world]\n[[goal]]\nx=1\ny=1e9", "w.toml:4: goal[0].y: 1e+09 is out of range"),
        ("[world]\nname = 0x" + "f" * 9000, "world.name: expected a text, got a huge number"),
        ("[world]\nseed = 0x" + "f" * 9000, "world.seed: a huge number is out of range"),
    ],
)
def test_what_is_wrong_is_said_in_one_line(tmp_path: Path, text: str, complaint: str) -> None:
    with pytest.raises(ConfigError) as caught:
        read(tmp_path, text)
    message = str(caught.value)
    assert message.startswith(f"{tmp_path / 'w.toml'}:")
    assert complaint in message
    assert message.isprintable()


def test_a_bad_map_is_blamed_on_its_own_file(tmp_path: Path) -> None:
    (tmp_path / "bad.map").write_text("2D-Map\nLINES\n1 2 3\n")
    with pytest.raises(ConfigError, match=r"bad\.map:3: LINES"):
        read(tmp_path, '[world]\nmap = "bad.map"').line_map()


def test_materials_are_kept_by_writing(tmp_path: Path) -> None:
    text = (
        '[world]\n[[wall]]\npoints=[[0,0],[1,0],[1,1]]\nmaterial="glass"\n'
        '[[box]]\ncenter=[3,3]\nsize=[1,1]\nmaterial="black"\n'
        '[[box]]\ncenter=[5,3]\nsize=[1,1]\nmaterial="reflector"\nmovable=true\n'
        "[[wall]]\npoints=[[9,0],[9,1]]\n"
    )
    world = parse_world(tmp_path / "w.toml", text)
    glass, black, plain = 2, 1, 0
    assert world.line_map().materials.tolist() == [glass, glass, plain, *[black] * 4]
    assert world.boxes[1].material is Material.REFLECTOR
    written = to_toml(world, tmp_path)
    assert parse_world(tmp_path / "w.toml", written) == world
    assert written.count("material = ") == 3


@pytest.mark.parametrize(
    ("table", "problem"),
    [
        ('material="glas"', "box[0].material: 'glas' is not one of plain, black, glass, reflector"),
        ('material="glass"\nmovable=true', "box[0].material: a movable box is never of glass"),
    ],
)
def test_a_wrong_material_is_refused(tmp_path: Path, table: str, problem: str) -> None:
    with pytest.raises(ConfigError) as caught:
        parse_world(tmp_path / "w.toml", f"[world]\n[[box]]\ncenter=[3,3]\nsize=[1,1]\n{table}\n")
    assert problem in str(caught.value)
    assert "w.toml:5: " in str(caught.value)


def test_a_laser_is_a_word_of_the_equipment(tmp_path: Path) -> None:
    text = '[world]\n[[robot]]\nequipment = { laser = "lms-200", laser_port = 9000 }\n'
    world = parse_world(tmp_path / "w.toml", text)
    assert world.robots[0].equipment == EquipmentOptions(laser="lms-200", laser_port=9000)
    assert parse_world(tmp_path / "w.toml", to_toml(world, tmp_path)) == world
    assert parse_equipment("laser=lms-200,laser-port=9000") == world.robots[0].equipment
    fitted = world.robots[0].equipment.equipment_of(load_model("p3dx-sh"))
    assert (fitted.laser, fitted.laser_port) == ("lms-200", 9000)
    bare = parse_equipment("laser=none").equipment_of(load_model("p3dx-sh"))
    assert bare.laser is None


def test_an_unknown_laser_is_refused() -> None:
    with pytest.raises(ConfigError, match="laser: 'utm' is not one of urg-04lx"):
        parse_equipment("laser=utm")
    with pytest.raises(ConfigError, match="did you mean utm-30lx"):
        Equipment(laser="utm-30")
