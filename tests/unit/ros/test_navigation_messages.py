"""Maps and ways to messages, and goals and starts from them."""

from math import inf, nan, pi, sqrt
from types import SimpleNamespace

import numpy as np
import pytest

from pioneer3.errors import CommandError
from pioneer3.geometry import Pose2
from pioneer3.maps.line_map import FREE, OCCUPIED, UNKNOWN, OccupancyGrid
from pioneer3.ros.messages import navigation
from pioneer3.ros.messages.navigation import MapUpdate, NavigationUpdate
from tests.unit.ros.support import Blank

UPRIGHT = (0.0, 0.0, 0.0, 1.0)


def pose(
    x: float = 1.0, y: float = 2.0, turned: tuple[float, float, float, float] = UPRIGHT
) -> SimpleNamespace:
    qx, qy, qz, qw = turned
    return SimpleNamespace(
        position=SimpleNamespace(x=x, y=y, z=0.0),
        orientation=SimpleNamespace(x=qx, y=qy, z=qz, w=qw),
    )


def header(frame: str) -> SimpleNamespace:
    return SimpleNamespace(frame_id=frame, stamp=0)


def test_a_map_has_the_numbers_of_map_server() -> None:
    states = np.array([[FREE, OCCUPIED, UNKNOWN], [FREE, FREE, FREE]], dtype=np.uint8)
    grid = OccupancyGrid(states=states, resolution=0.1, origin=Pose2(1.0, 2.0, pi / 2))
    message = Blank()
    navigation.occupancy_grid(message, MapUpdate(grid=grid, frame="map", stamp=7))
    assert message.data == [0, 100, -1, 0, 0, 0]
    assert (message.info.width, message.info.height, message.info.resolution) == (3, 2, 0.1)
    assert message.info.origin.position.y == 2.0
    assert message.info.origin.orientation.z == pytest.approx(sqrt(0.5))
    assert message.header.frame_id == "map"


def moving(way: tuple[tuple[float, float], ...], heading: float | None) -> NavigationUpdate:
    covariance = np.array([[1.0, 2.0, 3.0], [2.0, 4.0, 5.0], [3.0, 5.0, 6.0]])
    return NavigationUpdate(
        robot_in_map=Pose2(1.0, 2.0, pi),
        odom_in_map=Pose2(),
        covariance=covariance,
        sure=True,
        way=way,
        heading=heading,
        frame="map",
        moment=1.0,
        stamp=1,
        make=lambda kind: Blank(kind=kind),
    )


def test_a_place_has_its_covariance_in_six_rows() -> None:
    message = Blank()
    navigation.place(message, moving((), None))
    matrix = np.array(message.pose.covariance).reshape(6, 6)
    assert matrix[np.ix_([0, 1, 5], [0, 1, 5])].tolist() == [[1, 2, 3], [2, 4, 5], [3, 5, 6]]
    assert matrix.sum() == 31
    assert message.pose.pose.orientation.z == pytest.approx(1.0)


@pytest.mark.parametrize(("heading", "last"), [(None, pi / 2), (pi, pi)])
def test_a_way_looks_ahead_and_ends_as_the_goal(heading: float | None, last: float) -> None:
    message = Blank()
    navigation.way(message, moving(((0.0, 0.0), (1.0, 0.0), (1.0, 1.0)), heading))
    headings = [navigation.flat_pose(_complete(each.pose)).theta for each in message.poses]
    assert headings == pytest.approx([0.0, pi / 2, last])
    end = Blank()
    navigation.goal(end, moving(((0.0, 0.0), (1.0, 0.0), (1.0, 1.0)), heading))
    found = navigation.flat_pose(_complete(end.pose))
    assert (found.x, found.y, found.theta) == pytest.approx((1.0, 1.0, last))


def _complete(pose: Blank) -> Blank:
    pose.orientation.x = pose.orientation.y = 0.0
    return pose


def test_a_quaternion_of_any_length_turns() -> None:
    found = navigation.flat_pose(pose(turned=(0.0, 0.0, 2.0, 2.0)))
    assert (found.x, found.y, found.theta) == pytest.approx((1.0, 2.0, pi / 2))


@pytest.mark.parametrize(
    "wrong",
    [
        pose(turned=(0.0, 0.0, 0.0, 0.0)),
        pose(turned=(0.0, 0.0, nan, 1.0)),
        pose(turned=(0.0, 0.0, inf, 1.0)),
        pose(turned=(0.0, 0.0, 1e200, 1.0)),
        pose(turned=(0.7, 0.0, 0.0, 0.7)),
        pose(turned=(1.0, 0.0, 0.0, 0.0)),
        pose(x=nan),
        pose(y=inf),
        pose(x=1e9),
    ],
)
def test_what_is_no_pose_on_the_floor_is_refused(wrong: SimpleNamespace) -> None:
    with pytest.raises(CommandError):
        navigation.flat_pose(wrong)


def test_the_advice_for_a_missing_orientation_names_the_field() -> None:
    with pytest.raises(CommandError, match=r"0, 0, 0, 0 is no rotation: w: 1\.0"):
        navigation.flat_pose(pose(turned=(0.0, 0.0, 0.0, 0.0)))


def test_a_goal_needs_a_frame_and_loses_its_slash() -> None:
    goal = SimpleNamespace(header=header("/map"), pose=pose())
    assert navigation.placed(goal).frame == "map"
    with pytest.raises(CommandError, match="names no frame"):
        navigation.placed(SimpleNamespace(header=header(""), pose=pose()))


def start(*diagonal: float) -> SimpleNamespace:
    covariance = [0.0] * 36
    covariance[0], covariance[7], covariance[35] = diagonal
    return SimpleNamespace(
        header=header("map"), pose=SimpleNamespace(pose=pose(), covariance=covariance)
    )


def test_the_spread_of_a_start_is_that_of_its_worst_direction() -> None:
    told = navigation.start(start(0.04, 0.25, 0.09))
    assert (told.spread, told.turn_spread) == pytest.approx((0.5, 0.3))


@pytest.mark.parametrize("diagonal", [(nan, 0, 0), (-1, 0, 0), (0, inf, 0), (0, 0, 1e30)])
def test_a_covariance_that_is_none_is_refused(diagonal: tuple[float, float, float]) -> None:
    with pytest.raises(CommandError, match="covariance"):
        navigation.start(start(*diagonal))
