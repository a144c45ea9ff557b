from math import inf, nan, pi

import pytest

from docs.reference.ros_tables import PAGE
from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.models.description.tree import Frames
from pioneer3.ros.messages.update import NoEcho
from pioneer3.ros.node.driving_parameters import NAMES
from pioneer3.ros.node.laser_parameters import BELOW
from pioneer3.ros.node.names import Profile
from pioneer3.ros.node.parameter_table import PARAMETERS, ROS1
from pioneer3.ros.node.parameters import (
    FRAMES,
    MODEL,
    SIMULATED,
    NodeParameters,
    read_parameters,
    unused_parameters,
)

SIDEWAYS = {"lat_accel", "lat_decel"}
"""Parameters of RosAria that no Pioneer has a use for."""


def test_without_any_it_is_as_rosaria() -> None:
    assert read_parameters({}) == NodeParameters()
    assert NodeParameters().timeout == 0.6
    frames = NodeParameters().options.frames
    assert frames == Frames(
        odom="odom",
        base="base_link",
        footprint="",
        bumpers="bumpers",
        sonar="sonar",
        laser="laser_frame",
    )


@pytest.mark.parametrize(
    ("profile", "raw", "footprint"),
    [
        ("compatibility", {}, ""),  # /tf is RosAria's
        ("compatibility", {"publish_tf": False}, "base_footprint"),  # a filter's is not
        ("compatibility", {"footprint_frame_id": "floor"}, "floor"),
        ("standard", {}, "base_footprint"),
        ("standard", {"publish_tf": False}, "base_footprint"),
        ("both", {}, "base_footprint"),
        ("standard", {"publish_description": False}, ""),  # nobody says where base_link is in it
        ("standard", {"footprint_frame_id": ""}, ""),
    ],
)
def test_the_footprint_is_between_odometry_and_robot_where_it_is_told(
    profile: str, raw: dict[str, object], footprint: str
) -> None:
    frames = read_parameters({"profile": profile, **raw}).options.frames
    assert frames.footprint == footprint
    assert frames.root == (footprint or "base_link")


@pytest.mark.parametrize(
    ("port", "url"),
    [
        ("/dev/ttyS0", "/dev/ttyS0"),
        ("192.168.0.160:8101", "tcp://192.168.0.160:8101"),
        ("localhost:8101", "tcp://localhost:8101"),
        ("tcp://p3:8101", "tcp://p3:8101"),
        ("", None),
        ("auto", None),
    ],
)
def test_ports_may_be_written_as_for_rosaria(port: str, url: str | None) -> None:
    assert read_parameters({"port": port}).port == url


@pytest.mark.parametrize(
    ("start", "found"),
    [
        ("", None),
        ("Office A", "Office A"),
        ("unknown", "unknown"),
        ("1.5,-2,90", Pose2(1.5, -2.0, pi / 2)),
        ("-1.5, .5", Pose2(-1.5, 0.5)),
        ("-.5,1", Pose2(-0.5, 1.0)),
    ],
)
def test_a_start_is_a_name_or_a_pose_in_degrees(start: str, found: Pose2 | str | None) -> None:
    assert read_parameters({"start": start}).start == found


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("start", "1"),
        ("start", "1,2,3,4"),
        ("start", "1,two"),
        ("start", 3),
        ("map", 3),
        ("goal_speed", 0),
        ("goal_speed", nan),
        ("transform_tolerance", -0.1),
        ("tf_broadcast", "yes"),
        ("global_frame_id", "/"),
    ],
)
def test_what_navigation_cannot_use_is_refused(name: str, value: object) -> None:
    with pytest.raises(ConfigError):
        read_parameters({name: value})


def test_the_frame_of_the_map_has_no_prefix() -> None:
    options = read_parameters({"frame_prefix": "robot1/", "global_frame_id": "/site"}).options
    assert (options.map_frame, options.prefix) == ("site", "robot1/")


@pytest.mark.parametrize("value", [0, 0.0])
def test_a_timeout_of_zero_is_none(value: float) -> None:
    assert read_parameters({"cmd_vel_timeout": value}).timeout == inf


def test_profiles_have_their_own_names_of_frames_and_timeouts() -> None:
    given = {"odom_frame": "/a", "odom_frame_id": "b", "base_frame_id": "c"}
    assert read_parameters(given).options.frames.odom == "a"
    standard = read_parameters({**given, "profile": "standard"})
    frames = standard.options.frames
    assert (frames.odom, frames.base, frames.bumpers, standard.timeout) == ("b", "c", "c", 0.5)


@pytest.mark.parametrize(
    "given",
    [
        {"profile": "modern"},
        {"port": 8101},
        {"baud": -1},
        {"baud": "fast"},
        {"cmd_vel_timeout": nan},
        {"cmd_vel_timeout": "long"},
        {"cmd_vel_timeout": -1},
        {"cmd_vel_timeout": 0.01},
        {"odom_frame": "/"},
        {"sonar_frame": 3},
        {"port": ["a"]},
        {"frame_prefix": 1},
        {"publish_tf": "yes"},
        {"publish_description": 1},
        {"use_sonar": None},
        {"sonar_no_echo": "nan"},
        {"sonar_fov_rad": 4.0},
        {"sonar_min_range_m": -0.1},
        {"sonar_max_range_m": 5.5},
        {"sonar_z_offset_m": "high"},
        {"pose_covariance_diagonal": [1, 1, 1]},
        {"twist_covariance_diagonal": [0, 1, 1, 1, 1, 1]},
        {"wheel_joint_names": "left"},
        {"max_linear_velocity": 0},
        {"max_angular_velocity": nan},
    ],
)
def test_what_makes_no_sense_is_refused_by_name(given: dict[str, object]) -> None:
    (name,) = given
    with pytest.raises(ConfigError, match=name):
        read_parameters(given)


def test_what_changes_nothing_is_told_with_what_was_meant() -> None:
    told = unused_parameters(
        ["cmd_vel_timout", "debug_aria", "port", "TicksMM"], Profile.COMPATIBILITY, ["TicksMM"]
    )
    assert told == [
        "parameter ~cmd_vel_timout is unknown; did you mean ~cmd_vel_timeout?",
        "parameter ~debug_aria of RosAria has no effect here",
    ]


def test_what_is_said_of_messages_is_taken_over() -> None:
    given = {
        "profile": "both",
        "publish_tf": False,
        "frame_prefix": "/r1/",
        "sonar_no_echo": "inf",
        "sonar_max_range_m": 3,
        "pose_covariance_diagonal": [1, 2, 3, 4, 5, 6],
        "wheel_joint_names": ["a", "b", "c", "d"],
        "max_linear_velocity": 0.4,
        "use_sonar": False,
    }
    read = read_parameters(given)
    told = read.options
    assert (told.prefix, told.odometry_tf, told.wheels_tf) == ("r1/", False, True)
    assert (told.beam.no_echo, told.beam.farthest) == (NoEcho.INF, 3.0)
    assert told.pose_variances == (1, 2, 3, 4, 5, 6)
    assert told.wheel_joints == ("a", "b", "c", "d")
    assert (read.max_speed, read.max_turn_rate, read.sonar) == (0.4, None, False)
    assert read.timeout == 0.6
    assert unused_parameters(given, Profile.BOTH) == []


def test_in_rosarias_place_wheels_do_not_turn_in_the_tree() -> None:
    assert not read_parameters({}).options.wheels_tf
    assert not read_parameters(
        {"profile": "standard", "publish_description": False}
    ).options.wheels_tf


def test_the_nearest_range_is_less_than_the_farthest() -> None:
    with pytest.raises(ConfigError, match="sonar_min_range_m"):
        read_parameters({"sonar_min_range_m": 2.0, "sonar_max_range_m": 1.0})


def test_every_parameter_is_in_the_docs() -> None:
    text = PAGE.read_text(encoding="utf-8")
    names = {
        f"{BELOW}/serial_port",
        *(each.name for each in PARAMETERS if each.profiles & ROS1),
        *NAMES,
        MODEL,
        SIMULATED,
        *(name for pair in FRAMES.values() for name in pair),
    }
    assert {name for name in names if f"`~{name}`" not in text} == SIDEWAYS
