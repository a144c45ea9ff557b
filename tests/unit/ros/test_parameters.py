import re
from dataclasses import replace
from math import inf, nan, pi
from pathlib import Path

import pytest

from docs.reference.ros_tables import PAGE
from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.models.description.tree import Frames
from pioneer3.ros.messages.update import NoEcho
from pioneer3.ros.node.driving_parameters import DrivingSettings
from pioneer3.ros.node.laser_parameters import BELOW, LaserParameters
from pioneer3.ros.node.names import Profile
from pioneer3.ros.node.parameter import Effect, Parameter, ParameterKind, rows_of
from pioneer3.ros.node.parameter_reading import read_parameters, unused_parameters
from pioneer3.ros.node.parameters import BELOW_NAMES, MODEL, NAVIGATION, SIMULATED, NodeParameters
from pioneer3.ros.node.parameters import parameters_in as rows_in
from pioneer3.ros.ros2.backend import NodeName
from pioneer3.ros.ros2.parameter_files import parameters_in

CASES = Path(__file__).parents[4] / "shared" / "cases"

ROWS = (
    *rows_of(NodeParameters),
    *(replace(row, name=f"{BELOW}.{row.name}") for row in rows_of(LaserParameters)),
    *rows_of(DrivingSettings),
    *NAVIGATION,
)
NUMBERS = [
    row for row in ROWS if row.bounded and not row.kind.is_array and Profile.ROS2 in row.profiles
]


def raw_of(name: str, value: object) -> dict[str, object]:
    """Return parameters as they lie on the parameter server."""
    below, _, part = name.partition(".")
    return {below: {part: value}} if below in BELOW_NAMES and part else {name: value}


def test_without_any_it_is_as_rosaria() -> None:
    assert read_parameters({}).timeout == 0.6
    frames = read_parameters({}).options.frames
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
        ("standard", {"base_frame_id": "/base_footprint"}, ""),
        ("p2os", {}, ""),
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
    assert frames.root == (footprint or frames.base)


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
    assert read_parameters({"port": port}).url == url


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
    assert read_parameters({"start": start}).initial_pose == found


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
        ("goal_speed", 10**400),
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
    named = ["cmd_vel_timout", "debug_aria", "port", "TicksMM", MODEL, "max_xspeed"]
    told = [
        "parameter ~cmd_vel_timout is unknown; did you mean ~cmd_vel_timeout?",
        "parameter ~debug_aria of RosAria has no effect here",
        "parameter ~max_xspeed of p2os has no effect here: write ~max_linear_velocity",
    ]
    raw = dict.fromkeys(named)
    assert unused_parameters(raw, Profile.COMPATIBILITY) == told
    in_ros2 = [sentence.replace("~", "") for sentence in told]
    assert unused_parameters(raw, Profile.ROS2) == in_ros2


@pytest.mark.parametrize(
    ("name", "instead"),
    [
        ("max_xspeed", "~max_linear_velocity"),
        ("max_yawspeed", "~max_angular_velocity"),
        ("max_xaccel", "~trans_accel"),
        ("base_link_frame_id", "~base_link_frame"),
        ("use_tcp", "~port"),
        ("tcp_remote_host", "~port"),
        ("tcp_remote_port", "~port"),
        ("baud_rate", "~baud"),
        ("publish_aria_lasers", "scan"),
        ("pulse", "awake"),
        ("bumpstall", "bumper"),
        ("rot_kp", "gains"),
    ],
)
def test_names_of_other_nodes_tell_what_stands_in_their_place(name: str, instead: str) -> None:
    profile = Profile.STANDARD if name == "publish_aria_lasers" else Profile.COMPATIBILITY
    (told,) = unused_parameters({name: 0}, profile)
    assert re.match(rf"parameter ~{name} of \S.* has no effect here: .*{instead}", told)
    assert "did you mean" not in told


def test_a_parameter_file_of_p2os_tells_what_to_write_in_ros2(tmp_path: Path) -> None:
    written = {
        "port": '"tcp://127.0.0.1:23501"',
        "base_link_frame_id": "base_footprint",
        "cmd_vel_timeout": "0.2",
        "max_xspeed": "0.3",
        "max_yawspeed": "0.8",
        "tf_prefix": '"r1/"',
    }
    own = tmp_path / "own.yaml"
    lines = "".join(f"    {name}: {value}\n" for name, value in written.items())
    own.write_text(f"/**:\n  ros__parameters:\n{lines}", encoding="utf-8")
    for path in (own, CASES / "p2os-speed-limit" / "ros2params.yaml"):
        if path.exists():
            raw = parameters_in(path, NodeName("pioneer3"))
            read = read_parameters(raw, Profile.ROS2)
            assert (read.timeout, read.options.prefix) == (0.2, "r1/")
            assert unused_parameters(raw, Profile.ROS2) == [
                "parameter base_link_frame_id of p2os has no effect here: write base_frame_id",
                "parameter max_xspeed of p2os has no effect here: write max_linear_velocity",
                "parameter max_yawspeed of p2os has no effect here: write max_angular_velocity",
            ]


def test_in_the_profile_of_p2os_its_own_names_act() -> None:
    raw = {
        "profile": "p2os",
        "max_xspeed": 0.2,
        "max_yawspeed": 0.8,
        "max_xaccel": 0.4,
        "base_link_frame_id": "base",
        "use_tcp": True,
        "tcp_remote_host": "10.0.0.3",
        "tcp_remote_port": 8102,
        "use_sonar": False,
    }
    read = read_parameters(raw)
    assert (read.max_linear_velocity, read.max_angular_velocity) == (0.2, 0.8)
    assert (read.driving.max_linear_acceleration, read.frames.base) == (0.4, "base")
    assert (read.url, read.use_sonar) == ("tcp://10.0.0.3:8102", False)
    assert unused_parameters(raw, Profile.P2OS) == []
    assert read_parameters({"profile": "p2os", "max_linear_velocity": 0.3}).timeout == 0.6
    assert read_parameters({"profile": "p2os", "port": "/dev/ttyS0"}).url == "/dev/ttyS0"


@pytest.mark.parametrize("profile", ["compatibility", "p2os", "standard"])
@pytest.mark.parametrize(
    ("raw", "prefix"),
    [
        ({"tf_prefix": "/r1"}, "r1/"),
        ({"tf_prefix": "r1/"}, "r1/"),
        ({"tf_prefix": ""}, ""),
        ({"tf_prefix": "r1", "frame_prefix": "r2_"}, "r2_"),
    ],
)
def test_the_prefix_of_tf_is_before_all_frames(
    profile: str, raw: dict[str, object], prefix: str
) -> None:
    given = {"profile": profile, **raw}
    assert read_parameters(given).options.prefix == prefix
    assert unused_parameters(given, Profile(profile)) == []


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
    assert (read.max_linear_velocity, read.max_angular_velocity) == (0.4, None)
    assert not read.use_sonar
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


@pytest.mark.parametrize("row", NUMBERS, ids=lambda row: row.name)
def test_each_number_out_of_range_is_refused_with_name_value_and_range(row: Parameter) -> None:
    step = 1 if row.whole else 0.001
    for value in (row.low - step, row.high + step):
        with pytest.raises(ConfigError) as refused:
            read_parameters(raw_of(row.name, value), Profile.ROS2)
        assert str(refused.value).startswith(f"{row.name} must be a ")
        assert str(refused.value).endswith(f" from {row.range}, not {value!r}")
    highest = int(row.high) if row.whole else row.high
    assert row.checked(highest) == highest


def test_rosarias_own_number_for_what_the_robot_has_is_read() -> None:
    raw = {"TicksMM": 0, "DriftFactor": -99999, "RevCount": 0}
    assert read_parameters(raw).driving.drift_factor == -99999
    with pytest.raises(ConfigError, match="~ticks_mm must be a whole number from 1 to 200, not 0"):
        read_parameters({"ticks_mm": 0})


def test_in_ros2_all_that_is_read_at_the_start_has_a_value_or_is_not_set() -> None:
    raw = {"goal_speed": 1, "max_linear_velocity": 0.4, BELOW: {"min_ang": -1, "skip": 2}}
    rows = read_parameters(raw, Profile.ROS2).values
    values = {row.name: value for row, value in rows.items()}
    assert list(values)[: -len(rows_of(LaserParameters)) - len(NAVIGATION)] == [
        row.name for row in rows_in(Profile.ROS2)
    ]
    assert (values["goal_speed"], values["max_linear_velocity"]) == (1.0, 0.4)
    assert (values["cmd_vel_timeout"], values["bumpers_frame"]) == (0.5, "base_link")
    assert (values["laser.angle_min"], values["laser.skip"]) == (-1.0, 2)
    not_set = {name for name, value in values.items() if value is None}
    assert {"max_angular_velocity", "baud", "wheel_joint_names", "laser.angle_max"} <= not_set
    assert not any(row.acts is Effect.AT_ONCE for row in rows)
    told = {row.name: row for row in rows}
    assert told["baud"].constraints.startswith("not set means any; ")
    assert told["sonar_no_echo"].constraints.startswith("max_range or inf; ")
    assert told["laser.time_offset"].described.startswith("[s] ")
    assert told["laser.skip"].kind is ParameterKind.INTEGER


def test_every_parameter_is_in_the_docs() -> None:
    text = PAGE.read_text(encoding="utf-8")
    names = {
        f"{BELOW}/serial_port",
        MODEL,
        SIMULATED,
        *(
            name
            for profile in (Profile.COMPATIBILITY, Profile.BOTH)
            for row in (*rows_of(NodeParameters), *rows_of(DrivingSettings))
            for name in row.names(profile)
        ),
    }
    assert not {name for name in names if f"`~{name}`" not in text}


def test_settings_of_navigation_lie_below_the_names_of_their_groups() -> None:
    raw = {"planner": {"margin": 0.05, "comfrt": 0.3}, "localizer": {"particles": 100}}
    found = read_parameters(raw, Profile.STANDARD).navigation
    assert (found.planner.margin, found.localizer.particles) == (0.05, 100)
    assert unused_parameters(raw, Profile.STANDARD) == [
        "parameter ~planner/comfrt is unknown; did you mean ~planner/comfort?"
    ]
    with pytest.raises(ConfigError, match=r"^~planner/margin must be a number from 0 to 0.5 m"):
        read_parameters({"planner": {"margin": 3.0}}, Profile.BOTH)
    with pytest.raises(ConfigError, match=r"planner holds parameters such as planner.margin"):
        read_parameters({"planner": 1.0}, Profile.ROS2)
