"""Worlds of Stage: their macros, pictures, blocks and robots, and what is wrong with one."""

from math import radians
from pathlib import Path

import numpy as np
import pytest

from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.maps.image import to_pgm, to_png
from pioneer3.maps.load import looks_like_map
from pioneer3.models import load_model
from pioneer3.sim.map_check import check_world
from pioneer3.sim.map_convert import convert
from pioneer3.sim.worldfile import load_map, load_world
from pioneer3.sim.worldfile.stand_ins import laser_of, pioneer_of, robot_of_size

CASE = Path(__file__).parents[4] / "shared/cases/stage-world/lab.world"
MAP_INC = 'define floorplan model ( color "gray30" boundary 1 obstacle_return 0 )\n'
ROBOT_INC = """
define sicklaser ranger ( sensor ( range [0 8] samples 180 ) )
define base position ( size [0.44 0.38 0.22] )
define pioneer2dx base ( mass 23 )
"""
LAB = """
include "map.inc"
include "robot.inc"  # beside it
window ( size [600 600] scale 30 )
resolution 0.02
floorplan ( bitmap "lab.pgm" size [4 2 0.8] pose [1 0 0 90] )
pioneer2dx ( name "r0" pose [1 0.5 0 -45] sicklaser ( pose [0.1 0 0 0] ) ctrl "wander" )
"""


def write_lab(folder: Path, world: str = LAB) -> Path:
    picture = np.full((12, 22), 255, dtype=np.uint8)
    picture[1:-1, 1:-1] = 0
    picture[2:-2, 2:-2] = 255
    (folder / "lab.pgm").write_bytes(to_pgm(picture))
    (folder / "map.inc").write_text(MAP_INC)
    (folder / "robot.inc").write_text(ROBOT_INC)
    path = folder / "lab.world"
    path.write_text(world)
    return path


def test_a_picture_without_its_margin_fills_the_size_of_its_model(tmp_path: Path) -> None:
    bounds = load_map(write_lab(tmp_path)).bounds
    assert bounds == pytest.approx((0, -2, 2, 2))


def test_a_position_model_is_a_robot_with_its_type_laser_and_pose(tmp_path: Path) -> None:
    (robot,) = load_world(write_lab(tmp_path)).robots
    assert (robot.model, robot.name, robot.equipment.laser) == ("p2dx", "r0", "lms-200")
    assert robot.start == Pose2(1.0, 0.5, radians(-45))


def test_robots_of_a_command_line_start_where_those_of_the_world_do(tmp_path: Path) -> None:
    assert load_map(write_lab(tmp_path)).homes == (Pose2(1.0, 0.5, radians(-45)),)


def test_what_has_no_counterpart_is_named_once(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    more = 'camera ( )\ncamera ( )\ninclude "gone.inc"\nbot ( )\ndefine bot position ( )\nbot ( )'
    load_world(write_lab(tmp_path, LAB + more))
    (record,) = caplog.records
    told = record.getMessage()
    assert told.count("camera") == told.count("ctrl") == told.count("gone.inc") == 1
    assert told.count("amigo-sh stands for bot") == 1
    assert "window" not in told


def test_the_red_of_a_pixel_makes_it_a_wall(tmp_path: Path) -> None:
    path = write_lab(tmp_path, 'model ( bitmap "c.png" size [4 1 1] )')
    red, blue, grey = (255, 0, 0), (100, 200, 255), (127, 127, 127)
    pixels = np.array([[red, blue, grey, grey, grey, (128, 0, 0)]], dtype=np.uint8)
    (tmp_path / "c.png").write_bytes(to_png(pixels))
    assert load_map(path).bounds == pytest.approx((-2, -0.5, 2, 0.5))


def test_numbers_after_the_last_that_counts_are_skipped(tmp_path: Path) -> None:
    world = "model ( size [2 1 1 9] pose [1.65 7.25 0 90 0] )"
    (box,) = load_world(write_lab(tmp_path, world)).boxes
    assert (box.pose.x, box.pose.theta, box.size) == (1.65, radians(90), (2, 1))


def test_a_picture_that_is_missing_beside_other_walls_is_named(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    gone = 'floorplan ( bitmap "gone.png" size [1 1 1] )\n'
    world = load_world(write_lab(tmp_path, LAB + gone * 2))
    assert len(world.line_map().walls) == 4 + 8
    assert caplog.text.count("the picture gone.png, which is not there") == 1


def test_blocks_fill_the_size_of_a_model_at_its_origin(tmp_path: Path) -> None:
    block = "block ( points 4 point[0] [0 0] point[1] [8 0] point[2] [8 4] point[3] [0 4] z [0 1] )"
    world = f"model ( size [2 1 1] pose [3 0 0 0] origin [1 0 0 0] {block} )"
    path = write_lab(tmp_path, world)
    assert load_map(path).bounds == pytest.approx((3, -0.5, 5, 0.5))
    old = world.replace("block (", "").replace(" )", "", 1).replace("point[", "polygon[0].point[")
    path.write_text(old)
    assert load_map(path).bounds == pytest.approx((3, -0.5, 5, 0.5))


def test_models_in_models_are_placed_in_their_parent_and_on_top_of_it(tmp_path: Path) -> None:
    inner = "model ( size [1 1 1] pose [1 0 0 0] )"
    world = f"model ( size [1 1 0.5] pose [2 2 0 90] {inner} )"
    bottom, top = load_world(write_lab(tmp_path, world)).boxes
    assert (bottom.z, bottom.height, top.z) == (0, 0.5, 0.5)
    assert (top.pose.x, top.pose.y) == pytest.approx((2, 3))
    assert len(load_map(tmp_path / "lab.world").walls) == 4


def test_a_puck_is_movable_and_a_zone_is_nothing(tmp_path: Path) -> None:
    puck = "model ( size [0.2 0.2 0.2] gripper_return 1 )"
    zone = "model ( size [4 4 0.01] obstacle_return 0 ranger_return -1 )"
    world = load_world(write_lab(tmp_path, f'unit_length "cm"\n{puck} {zone}'))
    (box,) = world.boxes
    assert box.movable
    assert box.size == (0.01, 0.01)


def test_a_converted_world_keeps_its_walls_and_robots(tmp_path: Path) -> None:
    source = write_lab(tmp_path)
    target = tmp_path / "mine.toml"
    done = convert(str(source), target, resolution=0.05, force=False)
    assert done.files == (target, target.with_suffix(".map"))
    before, after = load_world(source), load_world(target)
    assert after.robots == before.robots
    assert after.wall_height == before.wall_height == 0.8
    assert np.allclose(after.line_map().walls, before.line_map().walls, atol=0.001)


def test_a_check_finds_nothing_wrong_and_lists_name_the_world(tmp_path: Path) -> None:
    path = write_lab(tmp_path)
    assert check_world(path, load_model("p3dx")) == ()
    assert looks_like_map(path)


def test_robots_of_other_makers_get_the_model_nearest_in_size() -> None:
    assert robot_of_size(0.3, 0.3) == "amigo-sh"
    assert robot_of_size(0.6, 0.5) == "p3at-sh"
    names = ("pioneer3at", "fancyPioneer2DX", "p3dx", "Pioneer_2_AT", "amigobot", "erratic")
    models = ["p3at-sh", "p2dx", "p3dx-sh", "p2at", "amigo-sh", ""]
    assert [pioneer_of((name,)) for name in names] == models
    assert laser_of(("fancysicklaser",), 8) == laser_of(("scanner",), 0) == "lms-200"
    assert laser_of(("scanner",), 30) == laser_of(("topurg",), 30) == "utm-30lx"
    assert laser_of(("hokuyo",), 0) == laser_of(("scanner",), 4) == "urg-04lx"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("model (\n size [1 1]", "lab.world:1: model: has no closing bracket )"),
        ("\nmodel ( pose [0 0 0 x] )", "lab.world:2: pose: expected a number or ], not 'x'"),
        ("model ( pose [0 0 0 1e999] )", "lab.world:1: pose: '1e999' is not a number"),
        ("model ( size [1 1e9] )", "lab.world:1: size: '1e9' is not within 100000"),
        ("model ( size [1] )", "lab.world:1: size: expected 3 numbers: x y z"),
        ('model ( bitmap "no.png" size [1 1] )', "lab.world:1: bitmap: no such file: 'no.png'"),
        ("define a b ( )\ndefine b a ( )\na ( )", "lab.world:2: a: is defined by itself"),
        ('include "lab.world"', "lab.world:1: include: 'lab.world' includes itself"),
        ("name ?", "lab.world:1: syntax: '?': not of Stage"),
        ('name "a\n', "no end of a text in quotes"),
        ("model", "lab.world:1: syntax: the file ends in the middle"),
        ("a (" * 100, "lab.world:1: a: more than 24 entities in each other"),
        ("a " * 200_000, "lab.world:1: syntax: more than 150000 words and numbers"),
    ],
)
def test_what_is_wrong_is_said_with_file_and_line(tmp_path: Path, text: str, said: str) -> None:
    path = write_lab(tmp_path, text)
    with pytest.raises(ConfigError) as error:
        load_world(path)
    assert said in str(error.value)


def test_macros_that_multiply_end_in_an_error(tmp_path: Path) -> None:
    text = "define a0 model ( )\n" + "".join(
        f"define a{n + 1} model ( {f'a{n} ( ) ' * 10} )\n" for n in range(9)
    )
    with pytest.raises(ConfigError, match="more than 50000 entities"):
        load_world(write_lab(tmp_path, text + "a9 ( )"))


@pytest.mark.skipif(not CASE.exists(), reason="no cases beside this tree")
def test_the_world_of_a_lab_is_ten_by_six_metres_with_a_robot() -> None:
    world = load_world(CASE)
    assert world.line_map().bounds == pytest.approx((-5, -3, 5, 3))
    assert [(robot.name, robot.start) for robot in world.robots] == [
        ("r0", Pose2(-3.0, -2.0, radians(45)))
    ]
