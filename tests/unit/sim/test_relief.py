"""Solids of world files: what they say in SI, what they are on a plane, what is refused."""

import tracemalloc
from dataclasses import replace
from math import pi
from pathlib import Path

import numpy as np
import pytest

from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap
from pioneer3.sim.relief import (
    FLAT,
    Carpet,
    Cylinder,
    HeightField,
    Mesh,
    Ramp,
    Relief,
    Step,
    Table,
)
from pioneer3.sim.relief.mesh_file import read_mesh
from pioneer3.sim.worldfile import Box, Wall, WorldFile, parse_world, to_toml
from pioneer3.sim.worldfile.flattened import flattened
from tests.unit.sim.solid_files import cuboid, write_block, write_hill, write_stl

FULL = """
[world]
wall_height = 2.4
physics_step_ms = 1.0

[[wall]]
points = [[-5, -5], [5, -5]]
height = 1.2

[[box]]
center = [2, 8]
size = [1, 1]
movable = true
height = 0.2
mass = 2.5
friction = 0.3
z = 0.75

[[step]]
center = [0, 0]
size = [2, 1]
height = 0.1
theta_deg = 90

[[ramp]]
center = [3, 0]
size = [2, 1]
height = 0.1
theta_deg = 180

[[carpet]]
center = [0, 3]
size = [2, 1]
friction = 0.9

[[cylinder]]
center = [5, 5]
radius = 0.2
height = 1.5

[[table]]
center = [2, 8]
size = [1.2, 0.8]
height = 0.75

[[table]]
center = [2, 9]
size = [0.4, 0.4]
height = 0.45
back = 0.4
theta_deg = -90

[[heightfield]]
file = "hill.png"
center = [-3, 3]
size = [3, 2]
height = 0.05

[[mesh]]
file = "rock.stl"
center = [-3, -3]
scale = 0.001
theta_deg = 90
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    write_hill(tmp_path / "hill.png")
    write_block(tmp_path / "rock.stl", (1000.0, 500.0, 600.0))
    return tmp_path


def read(folder: Path, text: str = FULL) -> WorldFile:
    return parse_world(folder / "w.toml", text)


def test_everything_is_read_in_si(folder: Path) -> None:
    world = read(folder)
    assert (world.wall_height, world.physics_step) == (2.4, 0.001)
    assert world.walls[0].height == 1.2
    (box,) = world.boxes
    assert (box.height, box.mass, box.friction, box.z) == (0.2, 2.5, 0.3, 0.75)
    assert world.solids == (
        Step(pose=Pose2(0, 0, pi / 2), size=(2, 1), height=0.1),
        Ramp(pose=Pose2(3, 0, pi), size=(2, 1), height=0.1),
        Carpet(pose=Pose2(0, 3), size=(2, 1), friction=0.9),
        Cylinder(pose=Pose2(5, 5), radius=0.2, height=1.5),
        Table(pose=Pose2(2, 8), size=(1.2, 0.8), height=0.75),
        Table(pose=Pose2(2, 9, -pi / 2), size=(0.4, 0.4), height=0.45, back=0.4),
        HeightField(file=folder / "hill.png", pose=Pose2(-3, 3), size=(3, 2), height=0.05),
        Mesh(file=folder / "rock.stl", pose=Pose2(-3, -3, pi / 2), scale=0.001),
    )


def test_what_is_written_reads_the_same_from_any_folder(folder: Path) -> None:
    world = read(folder)
    assert parse_world(folder / "v.toml", to_toml(world, folder)) == world
    (folder / "below").mkdir()
    written = to_toml(world, folder / "below")
    again = parse_world(folder / "below" / "v.toml", written)
    np.testing.assert_array_equal(again.line_map().walls, world.line_map().walls)


def test_a_plane_has_only_what_is_in_the_way_of_sensors(folder: Path) -> None:
    walls = read(folder).line_map().walls
    wall, cylinder, legs, chair, mesh = np.split(walls, np.cumsum([1, 16, 16, 16]))
    assert wall.tolist() == [[-5, -5, 5, -5]]
    assert np.hypot(*(cylinder[:, :2] - 5).T) == pytest.approx(0.2)
    corners = legs[:, :2] - (2, 8)
    assert abs(corners).max(axis=0).tolist() == pytest.approx([0.6, 0.4])
    assert abs(corners).min(axis=0).tolist() == pytest.approx([0.55, 0.35])
    assert len(chair) == 16
    assert len(mesh) == 4
    assert mesh[:, :2].min(axis=0).tolist() == pytest.approx([-3.25, -3.5])
    assert mesh[:, :2].max(axis=0).tolist() == pytest.approx([-2.75, -2.5])


@pytest.mark.parametrize(
    ("solid", "sides"),
    [
        (Cylinder(pose=Pose2(), radius=0.2, height=0.1), 16),
        (Cylinder(pose=Pose2(), radius=0.2, height=0.1, z=1.0), 0),
        (Table(pose=Pose2(), size=(1, 1), height=0.2), 4),
        (Table(pose=Pose2(), size=(1, 1), height=0.7, z=0.3), 0),
        (Step(pose=Pose2(), size=(1, 1), height=0.5), 0),
    ],
)
def test_what_hangs_above_the_sensors_is_no_wall(solid: Cylinder | Table, sides: int) -> None:
    assert len(solid.walls) == sides


@pytest.mark.parametrize(("z", "sides"), [(0.0, 4), (0.3, 0), (-0.5, 0)])
def test_a_mesh_is_a_wall_where_it_is_as_high_as_the_sensors(
    folder: Path, z: float, sides: int
) -> None:
    rock = Mesh(file=folder / "rock.stl", pose=Pose2(), scale=0.001, z=z)
    assert len(rock.walls) == sides


def test_a_box_that_hangs_is_no_wall() -> None:
    boxes = tuple(Box(pose=Pose2(), size=(1, 1), z=z, height=0.3) for z in (0.0, 0.1, 1.0))
    world = WorldFile(name="w", boxes=boxes)
    line_map = world.line_map()
    relief = world.relief(line_map)
    assert relief.heights_of(line_map).tolist() == [0.3] * 4 + [0.0] * 4
    assert list(relief.solids) == ["box_0", "box_1", "box_2"]


def test_solids_are_named_after_their_table_and_number(folder: Path) -> None:
    world = read(folder)
    relief = world.relief(world.line_map())
    assert list(relief.solids) == [
        *("step_0", "ramp_0", "carpet_0", "cylinder_0"),
        *("table_0", "table_1", "heightfield_0", "mesh_0"),
    ]
    assert relief.heights.tolist() == [1.2] + [0.0] * 52
    assert relief.source == str(folder / "w.toml")


def test_walls_that_stay_keep_their_heights_on_another_map() -> None:
    before = LineMap(name="a", walls=np.array([[0, 0, 1, 0], [0, 1, 1, 1], [0, 2, 1, 2.0]]))
    after = LineMap(name="b", walls=np.array([[0, 2, 1, 2], [5, 5, 6, 6], [0, 0, 1, 0.0]]))
    relief = Relief(wall_height=2.0, heights=np.array([0.5, 1.5, 0.0]))
    assert relief.carried(before, after).heights.tolist() == [0.0, 2.0, 0.5]
    assert FLAT.heights_of(after).tolist() == [1.0, 1.0, 1.0]


def test_what_a_plane_flattens_is_said_in_one_line(folder: Path) -> None:
    assert flattened(WorldFile(name="w")) == ""
    assert flattened(read(folder)) == (
        "on a plane 1 step, 1 ramp, 1 carpet and 1 heightfield are flat floor, 1 cylinder and "
        "1 mesh are walls, and 2 tables are their legs; --physics has them in three dimensions"
    )
    alone = WorldFile(name="w", solids=(Step(pose=Pose2(), size=(1, 1), height=0.1),))
    assert flattened(alone).startswith("on a plane 1 step is flat floor; --physics")


STEP = "[[step]]\ncenter=[0,0]\nsize=[2,1]\nheight=0.1\n"
TABLE = "[[table]]\ncenter=[0,0]\nsize=[1,0.5]\nheight=0.7\n"


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("physics_step_ms=3", "w.toml:2: world.physics_step_ms: 3 is out of range"),
        ("wall_height=0", "world.wall_height: 0 is out of range"),
        ("[[box]]\ncenter=[0,0]\nsize=[1,1]\nmass=-1", "w.toml:5: box[0].mass: -1 is out of"),
        ("[[box]]\ncenter=[0,0]\nsize=[1,1]\nfriction=0", "box[0].friction: 0 is out of range"),
        ("[[ramp]]\ncenter=[0,0]\nsize=[1,1]", "w.toml:2: ramp[0].height: missing, add it"),
        ("[[ramps]]", "ramps: unknown key, did you mean ramp?"),
        ("[[mesh]]\ncenter=[0,0]\nfile='no.stl'", "w.toml:4: mesh[0].file: "),
        ("[[mesh]]\ncenter=[0,0]\nfile='no.stl'", "no.stl: cannot read this mesh file: No such"),
        ("[[mesh]]\ncenter=[0,0]\nfile='hill.png'", "is no mesh that can be read: expected .stl"),
        ("[[mesh]]\ncenter=[0,0]\nfile='bad.stl'", "bad.stl: is damaged: no STL file"),
        ("[[mesh]]\ncenter=[0,0]\nfile='bad.obj'", "bad.obj: is damaged: no OBJ file"),
        ("[[mesh]]\ncenter=[0,0]\nfile='open.obj'", "open.obj: has no volume: close its surface"),
        ("[[mesh]]\ncenter=[0,0]\nfile='none.obj'", "none.obj: holds no triangles"),
        ("[[mesh]]\ncenter=[0,0]\nfile='far.obj'", "far.obj: is damaged: a corner is missing"),
        ("[[mesh]]\ncenter=[0,0]\nfile='huge.obj'", "huge.obj: is damaged: no OBJ file"),
        ("[[mesh]]\ncenter=[0,0]\nfile='away.obj'", "away.obj: reaches farther than 100 km"),
        ("[[mesh]]\ncenter=[0,0]\nscale=1000\nfile='rock.stl'", "rock.stl: reaches farther"),
        ("[[mesh]]\ncenter=[0,0]\nfile='thin.stl'", "thin.stl: is 0.0005 m thick: expected 0.001"),
        ("[[mesh]]\ncenter=[0,0]\nfile='many.obj'", "many.obj: holds more than 50000 triangles"),
        ("[[mesh]]\ncenter=[0,0]\nfile='many.stl'", "many.stl: holds more than 50000 triangles"),
        (
            "[[heightfield]]\nfile='no.png'\ncenter=[0,0]\nsize=[1,1]\nheight=1",
            "w.toml:3: heightfield[0].file: ",
        ),
        (
            "[[heightfield]]\nfile='rock.stl'\ncenter=[0,0]\nsize=[1,1]\nheight=1",
            "rock.stl: header: no picture",
        ),
        (
            "[[heightfield]]\nfile='flat.pgm'\ncenter=[0,0]\nsize=[1,1]\nheight=1",
            "flat.pgm: is of one shade: take a [[step]]",
        ),
        (
            "[[heightfield]]\nfile='wide.pgm'\ncenter=[0,0]\nsize=[1,1]\nheight=1",
            "wide.pgm: is 501 x 2 pixels: expected 2 to 500 a side",
        ),
        (TABLE + "leg_width=0.3", "w.toml:6: table[0].leg_width: two legs are wider than"),
        (TABLE + "thickness=0.7", "w.toml:6: table[0].thickness: no room for legs below"),
        (
            STEP + "[[step]]\ncenter=[5,0]\nsize=[2,1]\nheight=0.1\n"
            "[[wall]]\npoints=[[5,-3],[5,0.4]]",
            "w.toml:7: step[1].center: a wall goes through it at 5.00 -0.05; move either",
        ),
        (
            "[[ramp]]\ncenter=[0,0]\nsize=[2,1]\nheight=0.1\n[[box]]\ncenter=[1,0]\nsize=[0.5,0.5]",
            "w.toml:3: ramp[0].center: a wall goes through it",
        ),
    ],
)
def test_what_is_wrong_is_said_in_one_line(folder: Path, text: str, complaint: str) -> None:
    (folder / "bad.stl").write_bytes(b"no mesh")
    (folder / "bad.obj").write_text("v 1 2 x\n")
    (folder / "none.obj").write_text("v 1 2 3\n")
    (folder / "open.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    (folder / "far.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n")
    (folder / "huge.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 99999999999999999999 1 2\n")
    (folder / "away.obj").write_text("v 0 0 1e300\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    write_block(folder / "thin.stl", (1.0, 1.0, 0.0005))
    (folder / "many.obj").write_text("v 0 0 0\n" + "f" + " 1" * 50_003)
    (folder / "many.stl").write_text("solid\n" + "vertex 0 0 0\n" * 150_003)
    (folder / "flat.pgm").write_bytes(b"P5 2 2 255\n\5\5\5\5")
    (folder / "wide.pgm").write_bytes(b"P5 501 2 255\n" + bytes(501) + b"\5" * 501)
    with pytest.raises(ConfigError) as caught:
        read(folder, f"[world]\n{text}\n")
    message = str(caught.value)
    assert message.startswith(f"{folder / 'w.toml'}:")
    assert complaint in message
    assert message.isprintable()


def test_solids_are_limited_in_sum(folder: Path) -> None:
    steps = "".join(f"[[step]]\ncenter=[{n},0]\nsize=[1,1]\nheight=1\n" for n in range(501))
    with pytest.raises(ConfigError, match=r"w\.toml:2002: step\[500\]: .* no more than 500 solids"):
        read(folder, f"[world]\n{steps}")
    (folder / "large.pgm").write_bytes(b"P5 500 500 255\n" + bytes(500) * 499 + b"\5" * 500)
    large = "[[heightfield]]\nfile='large.pgm'\ncenter=[0,0]\nsize=[1,1]\nheight=1\n"
    assert len(read(folder, "[world]\n" + 8 * large).solids) == 8
    rock = "[[mesh]]\nfile='rock.stl'\ncenter=[0,0]\nscale=0.001\n"
    with pytest.raises(ConfigError, match=r"w\.toml:43: mesh\[0\]\.file: .* 2 million cells and"):
        read(folder, "[world]\n" + 8 * large + rock)


def test_a_face_of_many_corners_takes_no_memory(tmp_path: Path) -> None:
    (tmp_path / "a.obj").write_text("v 0 0 0\nf" + " 1" * 4_000_000)
    tracemalloc.start()
    try:
        with pytest.raises(ConfigError, match="more than 50000 triangles"):
            read_mesh(tmp_path / "a.obj")
        assert tracemalloc.get_traced_memory()[1] < 100e6
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize(
    "wall",
    [
        Wall(points=((1.0, -3.0), (1.0, 3.0))),  # along an edge
        Wall(points=((-3.0, 0.5), (3.0, 0.5))),
        Wall(points=((1.0, 0.5), (2.0, 2.0))),  # at a corner
        Wall(points=((0.0, 0.6), (0.0, 3.0))),  # beside it
    ],
)
def test_a_wall_may_touch_a_step(tmp_path: Path, wall: Wall) -> None:
    solids = (Step(pose=Pose2(), size=(2.0, 1.0), height=0.1),)
    world = WorldFile(name="w", walls=(wall,), solids=solids)
    text = to_toml(world, tmp_path)
    assert parse_world(tmp_path / "w.toml", text) == world
    turned = replace(world, solids=(replace(solids[0], pose=Pose2(0.0, 0.0, 0.4)),))
    if wall.points[0] not in ((1.0, 0.5), (0.0, 0.6)):
        with pytest.raises(ConfigError, match="a wall goes through"):
            parse_world(tmp_path / "w.toml", to_toml(turned, tmp_path))


def test_what_stands_on_a_platform_does_not_go_through_it(tmp_path: Path) -> None:
    solids = (
        Step(pose=Pose2(), size=(4.0, 4.0), height=0.2),
        Step(pose=Pose2(), size=(1.0, 1.0), height=0.1, z=0.2),
        Table(pose=Pose2(1.0, 1.0), size=(1.0, 1.0), height=0.7, z=0.2),
    )
    boxes = (Box(pose=Pose2(-1.0, 0.0), size=(0.5, 0.5), z=0.2),)
    world = WorldFile(name="w", boxes=boxes, solids=solids)
    assert parse_world(tmp_path / "w.toml", to_toml(world, tmp_path)) == world


def test_meshes_are_read_in_three_formats(tmp_path: Path) -> None:
    triangles = cuboid((0.0, 0.0, 0.0), (1.0, 2.0, 3.0))
    write_stl(tmp_path / "a.stl", [triangles])
    rows = "".join(
        "facet normal 0 0 0\nouter loop\n"
        + "".join(f"vertex {x:e} {y:e} {z:e}\n" for x, y, z in corners.tolist())
        + "endloop\nendfacet\n"
        for corners in triangles
    )
    (tmp_path / "b.stl").write_text(f"solid block\n{rows}endsolid block\n")
    (tmp_path / "c.obj").write_text(
        "# a block\nv 0 0 0\nv 0 0 3\nv 0 2 0\nv 0 2 3\nv 1 0 0\nv 1 0 3\nv 1 2 0\nv 1 2 3\n"
        "vn 0 0 1\nf 1/1 2//1 4 3\nf -4 -2 -1 -3\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4\n"
    )
    for name in ("a.stl", "b.stl", "c.obj"):
        mesh = read_mesh(tmp_path / name)
        assert mesh.volume == pytest.approx(6.0), name
        assert len(mesh.points) == 8
        assert len(mesh.corners) == 12


def test_a_mesh_that_is_written_anew_is_read_anew(tmp_path: Path) -> None:
    write_block(tmp_path / "a.stl", (1.0, 1.0, 1.0))
    assert read_mesh(tmp_path / "a.stl").volume == pytest.approx(1.0)
    (tmp_path / "a.stl").unlink()
    with pytest.raises(ConfigError, match="cannot read"):
        read_mesh(tmp_path / "a.stl")
