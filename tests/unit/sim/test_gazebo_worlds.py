"""Worlds of Gazebo: poses, shapes, includes and robots, and what is wrong with one."""

from math import pi
from pathlib import Path

import numpy as np
import pytest

from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.maps.load import looks_like_map
from pioneer3.sim.map_convert import convert
from pioneer3.sim.relief import Cylinder
from pioneer3.sim.relief.mesh_file import Triangles, read_mesh
from pioneer3.sim.relief.shapes import MANY, outer
from pioneer3.sim.worldfile import WorldFile, gazebo, load_world

BOX = "<geometry><box><size>2 1 1</size></box></geometry>"
WRONG = "w.world:1: "
WALL_STL = """solid
facet normal 0 1 0
outer loop
vertex 0 0 0
vertex 1 0 0
vertex 0 0 1
endloop
endfacet
endsolid
"""


def model(inside: str, name: str = "m", collision: str = "") -> str:
    shape = f"<collision name='c'>{collision}{inside}</collision>" if inside else ""
    return f"<model name='{name}'><link name='l'>{shape}</link></model>"


def solid(shape: str, pose: str = "0 0 0 0 0 0") -> str:
    return model(f"<pose>{pose}</pose><geometry>{shape}</geometry>")


def load(folder: Path, inside: str) -> WorldFile:
    path = folder / "w.world"
    path.write_text(f"<sdf version='1.7'><world name='w'>{inside}</world></sdf>")
    return load_world(path)


def test_poses_of_models_links_and_collisions_add_up(tmp_path: Path) -> None:
    half_turn = f"0 0 {pi / 2}"
    world = load(
        tmp_path,
        f"<model name='a'><pose>1 2 0 {half_turn}</pose>"
        f"<model name='b'><pose>1 0 0.5 0 0 0</pose><link name='l'><pose>0 1 0 {half_turn}</pose>"
        f"<collision name='c'><pose>0 0 0.2 0 0 0</pose>{BOX}</collision></link></model></model>",
    )
    (box,) = world.boxes
    assert (box.pose.x, box.pose.y) == pytest.approx((0, 3))
    assert abs(box.pose.theta) == pytest.approx(pi)
    assert (*box.size, box.z, box.height) == pytest.approx((2, 1, 0.2, 1))


def test_a_pose_may_be_relative_to_a_frame_another_model_or_in_degrees(tmp_path: Path) -> None:
    first = f"<model name='a'><pose>3 0 0 0 0 {pi / 2}</pose></model>"
    frame = "<frame name='f' attached_to='a'><pose>1 0 0 0 0 0</pose></frame>"
    pose = "<pose relative_to='f' degrees='true'>1 0 0.5 0 0 90</pose>"
    link = f"<link name='l'><collision name='c'>{BOX}</collision></link>"
    (box,) = load(tmp_path, f"{first}{frame}<model name='b'>{pose}{link}</model>").boxes
    assert (box.pose.x, box.pose.y) == pytest.approx((3, 2))
    assert abs(box.pose.theta) == pytest.approx(pi)


def test_a_saved_state_tells_where_models_are(tmp_path: Path) -> None:
    state = "<state world_name='w'><model name='m'><pose>5 6 0.5 0 0 0</pose></model></state>"
    (box,) = load(tmp_path, model(BOX) + state).boxes
    assert (box.pose.x, box.pose.y, box.z) == (5, 6, 0)


def test_a_box_on_its_side_stands_by_its_other_axis(tmp_path: Path) -> None:
    (box,) = load(tmp_path, solid("<box><size>2 1 0.4</size></box>", f"0 0 1 0 {pi / 2} 0")).boxes
    assert sorted(box.size) == [0.4, 1]
    assert (box.z, box.height) == pytest.approx((0, 2))


def test_columns_and_balls_are_cylinders_and_tilted_solids_walls(tmp_path: Path) -> None:
    column = solid("<cylinder><radius>0.3</radius><length>2</length></cylinder>", "1 1 1 0 0 0")
    ball = solid("<sphere><radius>0.5</radius></sphere>", "2 2 0.5 0 0 0")
    pipe = solid(
        "<cylinder><radius>0.1</radius><length>2</length></cylinder>", "0 0 0.1 0 1.5708 0"
    )
    world = load(tmp_path, column + ball + pipe)
    columns = [solid for solid in world.solids if isinstance(solid, Cylinder)]
    assert [(each.radius, each.height, each.z) for each in columns] == [
        (0.3, 2, 0),
        (pytest.approx(0.4), 1, 0),
    ]
    (wall,) = world.walls
    assert np.ptp(wall.points, axis=0) == pytest.approx((2, 0.2), abs=0.01)


def test_a_leaning_board_is_a_wall_only_where_sensors_meet_it(tmp_path: Path) -> None:
    board = solid("<box><size>4 1 0.02</size></box>", f"0 0 1 0 {-pi / 6} 0")
    walls = load(tmp_path, board).line_map().walls.reshape(-1, 2)
    assert np.ptp(walls, axis=0) == pytest.approx((0.04, 1))
    assert walls[:, 0].mean() == pytest.approx(-0.8 / np.tan(pi / 6))


def test_shapes_without_a_size_have_that_of_the_format(tmp_path: Path) -> None:
    world = load(tmp_path, solid("<box/>", "0 0 0.5 0 0 0") + solid("<cylinder/>"))
    (box,), (column,) = world.boxes, world.solids
    assert isinstance(column, Cylinder)
    assert (*box.size, box.height, column.radius, column.height) == (1, 1, 1, 1, 0.5)


@pytest.mark.parametrize(
    "text",
    [
        "<!-- a -- b -->\n<?xml version='1.0' encoding='no-such'?>\n<sdf>{}</sdf>",
        "<sdf><!-- one <b> --><!-- --- --><a b='x & y'>&c; d & e</a>{}</sdf>",
        "<?xml version='1.0' encoding='UTF-8'?><sdf><!-- Größe -->{}</sdf>",
    ],
)
def test_what_gazebo_takes_for_xml_is_read(tmp_path: Path, text: str) -> None:
    path = tmp_path / "w.sdf"
    path.write_bytes(text.format(model(BOX)).encode("latin-1"))
    assert len(load_world(path).boxes) == 1


def test_an_error_below_comments_is_on_its_line(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="world:5: size: "):
        load(tmp_path, "<!--\n--\n-->\n\n" + solid("<box><size>1</size></box>"))


def test_what_fell_through_the_floor_is_left_out(tmp_path: Path) -> None:
    fallen = solid("<box><size>1 1 1</size></box>", "0 0 -7.5e8 0 0 0")
    assert load(tmp_path, fallen + solid("<box/>")).boxes[0].size == (1, 1)


def test_a_mesh_that_git_did_not_fetch_is_not_there(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    (tmp_path / "a.dae").write_text("version https://git-lfs.github.com/spec/v1\noid sha256:0\n")
    load(tmp_path, solid("<mesh><uri>a.dae</uri></mesh>"))
    assert "a.dae is not on this computer" in caplog.text


def test_a_mesh_that_is_used_often_is_read_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    read: list[Path] = []

    def noted(path: Path) -> Triangles:
        read.append(path)
        return read_mesh(path)

    (tmp_path / "a.stl").write_text(WALL_STL)
    monkeypatch.setattr(gazebo, "read_mesh", noted)
    mesh = solid("<mesh><uri>a.stl</uri></mesh>")
    assert len(load(tmp_path, mesh * 5).line_map().walls) == 5
    assert len(read) == 1


def test_a_wide_tank_is_round_within_a_centimetre(tmp_path: Path) -> None:
    tank = solid("<cylinder><radius>3.5</radius><length>1</length></cylinder>", "9 -11 0.5 0 0 1")
    walls = load(tmp_path, tank).line_map().walls
    middles = (walls[:, :2] + walls[:, 2:]) / 2 - (9, -11)
    assert np.hypot(*middles.T).min() == pytest.approx(3.5, abs=0.0101)


def test_floors_sills_and_ceilings_are_no_walls(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    floor = solid("<box><size>20 20 0.1</size></box>", "0 0 -0.05 0 0 0")
    plane = solid("<plane><normal>0 0 1</normal><size>100 100</size></plane>")
    sill = solid("<box><size>1 1 0.04</size></box>", "0 0 0.02 0 0 0")
    ceiling = solid("<box><size>20 20 0.1</size></box>", "0 0 2.5 0 0 0")
    world = load(tmp_path, floor + plane + sill * 3 + ceiling)
    assert not len(world.line_map().walls)
    assert [box.z for box in world.boxes] == [pytest.approx(2.45)]
    (record,) = caplog.records
    assert record.getMessage().count("no higher than 5 cm") == 1


def test_a_mesh_is_cut_at_the_height_of_sensors(tmp_path: Path) -> None:
    corners = [(0, 0, 0), (2, 0, 0), (0, 2, 0), (0, 0, 0.4)]
    points = "".join(f"v {x} {y} {z}\n" for x, y, z in corners)
    (tmp_path / "pyramid.obj").write_text(points + "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n")
    mesh = "<mesh><uri>pyramid.obj</uri><scale>1 2 1</scale></mesh>"
    line_map = load(tmp_path, solid(mesh, "1 0 0 0 0 0")).line_map()
    assert len(line_map.walls) == 3
    assert line_map.bounds == pytest.approx((1, 0, 2, 2))


def test_meshes_that_are_outlined_from_above_use_up_their_share(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(gazebo, "MOST_CUT", 4 * gazebo.SLOWER)
    (tmp_path / "low.stl").write_text(WALL_STL.replace("0 0 1\n", "1 1 0.15\n", 1))
    mesh = solid("<mesh><uri>low.stl</uri></mesh>")
    assert load(tmp_path, mesh * 3).walls
    with pytest.raises(ConfigError, match="the meshes have more than"):
        load(tmp_path, mesh * 6)


def test_a_tilted_polygon_with_a_notch_is_cut_as_its_hull(tmp_path: Path) -> None:
    corners = [(-1, -1), (1, -1), (0, 0), (1, 1), (-1, 1)]
    points = "".join(f"<point>{x} {y}</point>" for x, y in corners)
    shape = f"<polyline>{points}<height>2</height></polyline>"
    (wall,) = load(tmp_path, solid(shape, f"0 0 0.2 {pi / 4} 0 0")).walls
    x, y = np.array(wall.points).T
    assert (x.min(), x.max(), y.max() - y.min()) == pytest.approx((-1, 1, 2**0.5), abs=0.1)
    assert len(wall.points) == 4


def test_the_hull_of_many_points_is_that_of_a_plain_reference() -> None:
    points = np.random.default_rng(1).integers(-40, 40, (4000, 2)) / 7
    turned = [(x, y) for x, y in outer(points).tolist()]
    assert len(points) > MANY
    for (ax, ay), (bx, by) in zip(turned, turned[1:] + turned[:1], strict=True):
        left = (bx - ax) * (points[:, 1] - ay) - (by - ay) * (points[:, 0] - ax)
        assert left.min() > -1e-6
        assert len(np.unique(points[abs(left) < 1e-6], axis=0)) >= 2


POINTS = "0 0 0  4 0 0  4 4 0  0 4 0  0 0 2  4 0 2  4 4 2  0 4 2"


def collada(faces: str, node: str, unit: float = 0.5) -> str:
    return f"""<?xml version="1.0"?><COLLADA><asset><unit meter="{unit}"/></asset>
<library_geometries><geometry id="g"><mesh>
<source id="s"><float_array>{POINTS}</float_array></source>
<vertices id="v"><input semantic="POSITION" source="#s"/></vertices>{faces}
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene><node>{node}<instance_geometry url="#g"/></node>
</visual_scene></library_visual_scenes></COLLADA>"""


SIDES = "0 1 5 4  1 2 6 5  2 3 7 6  3 0 4 7"
INPUT = "<input semantic='VERTEX' source='#v' offset='0'/>"
POLYLIST = f"<polylist>{INPUT}<vcount>4 4 4 4</vcount><p>{SIDES}</p></polylist>"


def test_a_mesh_of_collada_is_placed_by_its_nodes_and_unit(tmp_path: Path) -> None:
    node = "<translate>2 0 0</translate><rotate>0 0 1 90</rotate><scale>1 2 1</scale>"
    (tmp_path / "hall.dae").write_text(collada(POLYLIST, node))
    line_map = load(tmp_path, solid("<mesh><uri>hall.dae</uri></mesh>")).line_map()
    assert line_map.bounds == pytest.approx((-3, 0, 1, 2))
    assert len(line_map.walls) == 8


@pytest.mark.parametrize(
    ("faces", "said"),
    [
        (POLYLIST.replace("7 6", "99 6"), "hall.dae: is damaged"),
        (POLYLIST.replace("4 4 4 4", "4 4 4 9"), "hall.dae: is damaged"),
        (POLYLIST.replace("#v", "#x"), "hall.dae: is damaged"),
        ("", "hall.dae: holds no triangles"),
    ],
)
def test_a_damaged_mesh_is_said_with_both_files(tmp_path: Path, faces: str, said: str) -> None:
    (tmp_path / "hall.dae").write_text(collada(faces, ""))
    with pytest.raises(ConfigError, match=r"w\.world:1: mesh: ") as error:
        load(tmp_path, solid("<mesh><uri>hall.dae</uri></mesh>"))
    assert said in str(error.value)


def test_a_polyline_is_a_closed_wall_of_its_height(tmp_path: Path) -> None:
    points = "".join(f"<point>{x} {y}</point>" for x, y in ((0, 0), (3, 0), (3, 1)))
    (wall,) = load(tmp_path, solid(f"<polyline>{points}<height>1.5</height></polyline>")).walls
    assert (wall.points, wall.closed, wall.height) == (((0, 0), (3, 0), (3, 1)), True, 1.5)


def test_includes_are_found_in_models_and_by_the_environment(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for folder in (tmp_path / "models/desk", tmp_path / "far/shelf"):
        folder.mkdir(parents=True)
        (folder / "model.config").write_text("<model><sdf version='1.6'>model.sdf</sdf></model>")
        (folder / "model.sdf").write_text(f"<sdf version='1.6'>{model(BOX)}</sdf>")
    monkeypatch.setenv("GAZEBO_MODEL_PATH", str(tmp_path / "far"))
    (tmp_path / "worlds").mkdir()
    include = "<include><uri>model://{}</uri><name>i</name><pose>{} 0 0.5 0 0 0</pose></include>"
    world = load(tmp_path / "worlds", include.format("desk", 1) + include.format("shelf", 4))
    assert [box.pose.x for box in world.boxes] == [1, 4]


def test_what_is_not_on_this_computer_is_named_once(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    gone = "<include><uri>https://fuel.org/cafe</uri></include>"
    usual = "<include><uri>model://sun</uri></include><include><uri>model://ground_plane</uri></include>"
    load(tmp_path, gone * 3 + usual + "<actor name='a'/>" * 2)
    (record,) = caplog.records
    assert "https://fuel.org/cafe is not on this computer (w.world:1)" in record.getMessage()
    assert record.getMessage().count("cafe") == record.getMessage().count("actor") == 1
    assert "sun" not in record.getMessage()


def test_pioneers_and_what_drives_two_wheels_are_robots(tmp_path: Path) -> None:
    pioneer = "<include><uri>model://pioneer3at</uri><pose>1 2 0 0 0 1.5</pose></include>"
    sensor = (
        "<sensor name='hokuyo' type='ray'><ray><scan><horizontal><samples>640</samples>"
        "</horizontal></scan><range><max>10</max></range></ray></sensor>"
    )
    plugin = "<plugin name='diff_drive' filename='libdiff.so'/>"
    other = (
        f"<model name='tug'><pose>3 0 0 0 0 0</pose><link name='l'>{sensor}</link>{plugin}</model>"
    )
    first, second = load(tmp_path, pioneer + other).robots
    assert (first.model, first.name) == ("p3at-sh", "pioneer3at")
    assert first.start == Pose2(1, 2, 1.5)
    assert (second.model, second.name, second.equipment.laser) == ("p3dx-sh", "tug", "urg-04lx")


def test_a_converted_world_keeps_its_walls_and_columns(tmp_path: Path) -> None:
    column = solid("<cylinder><radius>0.3</radius><length>2</length></cylinder>", "1 1 1 0 0 0")
    before = load(tmp_path, model(BOX) + column)
    convert(str(tmp_path / "w.world"), tmp_path / "t.toml", resolution=0.05, force=False)
    after = load_world(tmp_path / "t.toml")
    assert np.allclose(after.line_map().walls, before.line_map().walls)
    assert looks_like_map(tmp_path / "w.world")


@pytest.mark.parametrize(
    ("inside", "said"),
    [
        ("<model>", WRONG + "not valid XML: mismatched tag"),
        (solid("<box><size>1 1</size></box>"), WRONG + "size: expected 3 numbers, not '1 1'"),
        (solid("<box><size>1 1 1e9</size></box>"), WRONG + "size: '1 1 1e9' is not within 100000"),
        (
            solid("<sphere><radius>x</radius></sphere>"),
            WRONG + "radius: expected a number, not 'x'",
        ),
        (
            "<frame name='a' attached_to='b'/><frame name='b' attached_to='a'/>"
            "<model name='m'><pose relative_to='a'/></model>",
            WRONG + "frame: is relative to itself, by 'a'",
        ),
        (
            "<model name='m'><pose relative_to='x'>0 0 0 0 0 0</pose></model>",
            WRONG + "pose: relative to 'x', and there is no such frame here",
        ),
        (
            solid("<cylinder><radius>999</radius><length>1</length></cylinder>") * 100,
            "w.world:1: cylinder: round and tilted solids of more than 50000 corners",
        ),
        (
            "".join(f"<include><uri>model://gone{n}</uri></include>" for n in range(1100)),
            WRONG + "include: more than 1000 files that are not on this computer",
        ),
        ("<include><uri>w.world</uri></include>", None),
        ("<a>" * 200, WRONG + "'a': a world of more than"),
    ],
)
def test_what_is_wrong_is_said_with_file_and_line(
    tmp_path: Path, inside: str, said: str | None
) -> None:
    if said is None:
        assert not load(tmp_path, inside).boxes
        return
    with pytest.raises(ConfigError) as error:
        load(tmp_path, inside)
    assert said in str(error.value)


def test_entities_are_refused_before_they_grow(tmp_path: Path) -> None:
    path = tmp_path / "w.sdf"
    path.write_text("<!DOCTYPE sdf [<!ENTITY a 'aa'><!ENTITY b '&a;&a;'>]><sdf>&b;</sdf>")
    with pytest.raises(ConfigError, match="entities are not read"):
        load_world(path)


def test_a_model_that_includes_itself_ends_in_an_error(tmp_path: Path) -> None:
    (tmp_path / "m.sdf").write_text(
        "<sdf><model name='m'><include><uri>m.sdf</uri></include></model></sdf>"
    )
    with pytest.raises(ConfigError, match="in each other"):
        load_world(tmp_path / "m.sdf")
