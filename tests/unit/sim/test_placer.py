"""Where robots begin."""

from dataclasses import replace
from itertools import pairwise
from math import hypot, pi
from pathlib import Path

import numpy as np
import pytest

from pioneer3.errors import ConfigError
from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.maps import LineMap, MapObject, empty_map, shipped_maps
from pioneer3.maps.line_map import distances
from pioneer3.models import RobotModel, load_model
from pioneer3.sim.collision import (
    hits,
    inside,
    outline,
    overlap,
    stands_in,
    turning_circle,
)
from pioneer3.sim.free_space import FreeGrid, Obstructions
from pioneer3.sim.placer import GAP, PlacementRequest, place_all
from pioneer3.sim.worldfile import Box, Wall, WorldFile, load_map
from pioneer3.sim.worldfile.spec import Start

AT, DX, SMALL = load_model("p3at-sh"), load_model("p3dx-sh"), load_model("amigo-sh")


def room(width: float, height: float, *homes: Pose2) -> LineMap:
    """Return a closed room."""
    corners = [(0.0, 0.0), (width, 0.0), (width, height), (0.0, height), (0.0, 0.0)]
    walls = np.array([(*a, *b) for a, b in pairwise(corners)])
    return LineMap(name="room", walls=walls, homes=homes)


def crowd(count: int, start: Start) -> list[PlacementRequest]:
    """Return `count` robots of two models that all want the same."""
    return [PlacementRequest(f"r{i}", (AT, DX)[i % 2], start) for i in range(count)]


def placed(line_map: LineMap, requests: list[PlacementRequest], seed: int = 1) -> list[Pose2]:
    return place_all(line_map, requests, np.random.default_rng(seed))


def assert_apart(requests: list[PlacementRequest], poses: list[Pose2]) -> None:
    robots = list(zip((n.model for n in requests), poses, strict=True))
    for i, (model, pose) in enumerate(robots):
        for other, there in robots[:i]:
            assert not overlap(model, pose, other, there)


def clearance(line_map: LineMap, pose: Pose2) -> float:
    return float(distances(np.array([pose.x, pose.y]), line_map.walls).min())


def test_one_robot_begins_exactly_at_home() -> None:
    home = Pose2(2.0, 3.0, 1.0)
    assert placed(room(6, 6, home), crowd(1, "home")) == [home]


def test_without_homes_home_is_the_origin() -> None:
    assert placed(empty_map(), crowd(1, "home")) == [ORIGIN]


def dock(x: float, y: float, theta: float) -> MapObject:
    return MapObject(kind="DockPioneer", name="", pose=Pose2(x, y, theta), declared="DockType")


def test_without_homes_robots_begin_at_the_first_dock_as_in_mobilesim() -> None:
    walls = room(8, 8).walls
    docks = dock(2.0, 3.0, 1.0), dock(6.0, 6.0, 0.0)
    line_map = LineMap(name="room", walls=walls, objects=docks)
    assert placed(line_map, crowd(1, "home")) == [docks[0].pose]
    with_home = LineMap(name="room", walls=walls, objects=docks, homes=(Pose2(4.0, 4.0),))
    assert placed(with_home, crowd(1, "home")) == [Pose2(4.0, 4.0)]


def test_robots_share_the_homes_of_a_map_in_turn() -> None:
    homes = Pose2(2.0, 2.0, 0.5), Pose2(6.0, 6.0, -1.0)
    poses = placed(room(8, 8, *homes), crowd(4, "home"))
    assert poses[:2] == list(homes)
    assert [pose.theta for pose in poses] == [0.5, -1.0, 0.5, -1.0]
    assert hypot(poses[2].x - 2, poses[2].y - 2) < 1.6
    assert hypot(poses[3].x - 6, poses[3].y - 6) < 1.6


@pytest.mark.parametrize("start", ["home", "random", "outside", Pose2(3.0, 3.1, 2.0)])
@pytest.mark.parametrize("name", ["office", "empty"])
def test_no_robot_begins_in_another_or_in_a_wall(name: str, start: Start) -> None:
    line_map = load_map("office") if name == "office" else empty_map()
    requests = crowd(30, start)
    poses = placed(line_map, requests)
    assert_apart(requests, poses)
    for request, pose in zip(requests, poses, strict=True):
        assert not hits(request.model, pose, line_map.walls)


def test_who_finds_home_taken_gets_a_place_where_it_can_turn_in_the_same_room() -> None:
    office = load_map("office")
    requests = crowd(12, "home")
    poses = placed(office, requests)
    homes = [(home.x, home.y) for home in office.homes]
    floor = FreeGrid(office.walls, office.bounds, DX.radius)
    reached = floor.reached_from(homes)
    for request, pose in list(zip(requests, poses, strict=True))[2:]:
        assert clearance(office, pose) >= turning_circle(request.model)
        assert reached[floor.cell_of((pose.x, pose.y))]


def test_a_home_without_room_gives_the_nearest_place() -> None:
    line_map = room(6, 6, Pose2(0.1, 3.0, 0.0))
    (pose,) = placed(line_map, crowd(1, "home"))
    assert not hits(AT, pose, line_map.walls)
    assert (pose.x, pose.y) == pytest.approx((turning_circle(AT), 3.0), abs=0.15)


def test_a_given_pose_is_taken_as_it_is_even_in_a_wall() -> None:
    pose = Pose2(0.1, 3.0, 0.5)
    assert placed(room(6, 6), crowd(1, pose)) == [pose]


def test_given_poses_side_by_side_are_left_alone() -> None:
    requests = [
        PlacementRequest("a", DX, Pose2(2.0, 2.0)),
        PlacementRequest("b", DX, Pose2(2.0, 2.5)),
    ]
    assert placed(room(6, 6), requests) == [Pose2(2.0, 2.0), Pose2(2.0, 2.5)]


def test_given_poses_go_first_and_chance_takes_nobodys_place() -> None:
    line_map, mine = room(4, 4), Pose2(2.0, 2.0, 0.0)
    for seed in range(20):
        requests = [PlacementRequest("a", DX, "random"), PlacementRequest("b", DX, mine)]
        poses = placed(line_map, requests, seed)
        assert poses[1] == mine
        assert_apart(requests, poses)


def test_random_places_are_inside_and_the_seed_repeats_them() -> None:
    office = load_map("office")
    bounds = office.bounds
    poses = placed(office, crowd(20, "random"), seed=7)
    assert poses == placed(office, crowd(20, "random"), seed=7)
    assert poses != placed(office, crowd(20, "random"), seed=8)
    for pose in poses:
        assert bounds.x_min < pose.x < bounds.x_max
        assert bounds.y_min < pose.y < bounds.y_max
        assert clearance(office, pose) >= turning_circle(DX)
    assert len({round(pose.theta, 3) for pose in poses}) == 20


def test_random_places_are_in_reach_of_a_home() -> None:
    """A locked room beside the one with the home stays empty."""
    two = room(4, 4, Pose2(1.0, 1.0))
    locked = two.walls + np.array([6.0, 0.0, 6.0, 0.0])
    line_map = LineMap(name="two", walls=np.concatenate([two.walls, locked]), homes=two.homes)
    for seed in range(10):
        assert all(pose.x < 4 for pose in placed(line_map, crowd(3, "random"), seed))


def test_without_homes_random_places_are_within_the_walls() -> None:
    for seed in range(10):
        (pose,) = placed(room(3, 3), crowd(1, "random"), seed)
        assert 0.5 <= pose.x <= 2.5
        assert 0.5 <= pose.y <= 2.5


def test_outside_is_beside_the_map_facing_it() -> None:
    office = load_map("office")
    requests = crowd(40, "outside")
    for request, pose in zip(requests, placed(office, requests), strict=True):
        assert pose.y <= office.bounds.y_min - turning_circle(request.model)
        assert pose.theta == pytest.approx(pi / 2)


def test_obstacles_are_kept_off() -> None:
    crate = outline(AT, Pose2(2.0, 2.0))
    (pose,) = place_all(
        room(6, 6, Pose2(2.0, 2.0)), crowd(1, "home"), np.random.default_rng(1), [crate]
    )
    assert not hits(AT, pose, crate)


def test_a_robot_does_not_begin_inside_a_box_that_is_larger_than_it() -> None:
    crate = Box(pose=Pose2(3.0, 3.0, 0.4), size=(2.5, 2.5))
    home = crate.pose
    (pose,) = place_all(
        room(8, 8, home), crowd(1, "home"), np.random.default_rng(1), [crate.outline]
    )
    assert not stands_in(AT, pose, crate.outline)
    # as a part of the map it is no place for chance either, though walls enclose it
    world = WorldFile(
        name="w",
        boxes=(crate,),
        walls=(Wall(points=((0, 0), (4.5, 0), (4.5, 4.5), (0, 4.5)), closed=True),),
    )
    for seed in range(30):
        (pose,) = placed(world.line_map(), [PlacementRequest("a", SMALL, "random")], seed)
        assert not stands_in(SMALL, pose, crate.outline)


def test_a_full_room_is_said_to_be_full() -> None:
    with pytest.raises(ConfigError, match=r"r\d+: no room left for a p3\w+-sh with start random"):
        placed(room(3, 3), crowd(20, "random"))
    with pytest.raises(ConfigError, match="no room left"):
        placed(room(3, 3, Pose2(1.5, 1.5)), crowd(20, "home"))


def test_robots_on_a_map_beside_the_origin_start_within_its_walls() -> None:
    walls = room(6, 6).walls + np.array([20, -40, 20, -40])
    for pose in placed(LineMap(name="far", walls=walls), crowd(4, "home")):
        assert 20 < pose.x < 26
        assert -40 < pose.y < -34


def test_a_robot_starts_at_the_origin_where_a_wall_alone_surrounds_nothing() -> None:
    wall = LineMap(name="wall", walls=np.array([[50.0, -1.0, 50.0, 1.0]]))
    assert placed(wall, crowd(1, "home")) == [Pose2()]


def test_robots_that_find_no_room_among_lonely_boxes_stand_beside_them() -> None:
    requests = crowd(10, "home")
    poses = placed(LineMap(name="box", walls=room(0.4, 0.4).walls), requests)
    assert_apart(requests, poses)
    assert all(hypot(pose.x - 0.2, pose.y - 0.2) > 0.4 for pose in poses)


def test_robots_that_are_spread_can_all_turn() -> None:
    poses = placed(empty_map(), crowd(9, "home"))
    models = [n.model for n in crowd(9, "home")]
    for i, pose in enumerate(poses):
        for j in range(i):
            apart = hypot(pose.x - poses[j].x, pose.y - poses[j].y)
            assert apart >= turning_circle(models[i]) + turning_circle(models[j]) + GAP


def test_two_robots_in_one_pose_overlap() -> None:
    """No side of one then lies inside the other."""
    pose = Pose2(1.0, 2.0, 0.3)
    assert overlap(AT, pose, AT, pose)
    assert not overlap(AT, pose, AT, pose @ Pose2(0.0, AT.width))


def test_inside_is_inside_whichever_way_the_sides_run() -> None:
    sides = Box(pose=Pose2(1.0, 1.0, 0.5), size=(2.0, 1.0)).outline
    backwards = sides[::-1, [2, 3, 0, 1]]
    for polygon in (sides, backwards):
        assert inside(polygon, 1.0, 1.0)
        assert inside(polygon, 1.8, 1.4)
        assert not inside(polygon, 1.8, 0.7)


def test_the_turning_circle_holds_the_robot() -> None:
    def reach(model: RobotModel) -> float:
        corners = outline(model, Pose2())[:, :2]
        return float(np.hypot(corners[:, 0], corners[:, 1]).max())

    for model in (AT, DX, load_model("peoplebot-sh"), load_model("amigo-sh")):
        assert turning_circle(model) >= reach(model) - 1e-12


MAPS: list[str | Path] = ["empty", *shipped_maps()]
MAPS += sorted(Path(__file__).parents[4].glob("shared/maps/*.map"))


@pytest.mark.parametrize(
    "count",
    [5, pytest.param(20, marks=pytest.mark.thorough)],  # of the same types
)
@pytest.mark.parametrize("name", MAPS, ids=lambda name: Path(name).name)
def test_every_robot_of_several_can_turn_and_drive_a_metre(name: str | Path, count: int) -> None:
    line_map = empty_map() if name == "empty" else load_map(name)
    models = [AT, DX, SMALL, load_model("peoplebot-sh")]
    requests = [PlacementRequest(f"r{i}", models[i % 4], "home") for i in range(count)]
    poses, ground = placed(line_map, requests), Obstructions.of(line_map)
    assert poses == placed(line_map, requests)
    robots = [(n.model, pose) for n, pose in zip(requests, poses, strict=True)]
    for model, pose in robots:
        others = [robot for robot in robots if robot[1] != pose]
        way = replace(model, length_front=model.length_front + 1.0)
        assert not any(overlap(way, pose, *other) for other in others)
        for other, there in others:
            apart = hypot(pose.x - there.x, pose.y - there.y)
            assert apart >= turning_circle(model) + turning_circle(other) + GAP
        if pose not in line_map.starts:  # who stands at one stands as the map says
            assert ground.clears(pose.x, pose.y, turning_circle(model))
            assert not ground.blocks(way, pose)
    near = line_map.starts or (ORIGIN,)
    far = [min(hypot(pose.x - home.x, pose.y - home.y) for home in near) for pose in poses]
    assert max(far) < (3.0 if count == 5 else 6.0)


def test_random_robots_can_drive_a_metre_too() -> None:
    office = load_map("office")
    requests = crowd(20, "random")
    robots = list(zip((n.model for n in requests), placed(office, requests), strict=True))
    for model, pose in robots:
        way = replace(model, length_front=model.length_front + 1.0)
        assert not Obstructions.of(office).blocks(way, pose)
        assert not any(overlap(way, pose, *other) for other in robots if other[1] != pose)


def test_robots_outside_can_drive_a_metre_too() -> None:
    requests = crowd(40, "outside")
    poses = placed(load_map("office"), requests)
    robots = list(zip((n.model for n in requests), poses, strict=True))
    for model, pose in robots:
        way = replace(model, length_front=model.length_front + 1.0)
        assert not Obstructions.of(load_map("office")).blocks(way, pose)
        assert not any(overlap(way, pose, *other) for other in robots if other[1] != pose)


def test_where_there_is_no_room_to_drive_on_robots_still_begin() -> None:
    narrow = room(1.2, 9.0, Pose2(0.6, 1.0, 0.0))
    requests = crowd(5, "home")
    poses = placed(narrow, requests)
    assert_apart(requests, poses)
