import os
import subprocess
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import pytest
import yaml

from pioneer3.errors import ConfigError
from pioneer3.models import load_model
from pioneer3.ros.ament.install import DRIVEN, NODES_OF_OTHERS, PROGRAMS, install_package
from pioneer3.ros.node.driving_parameters import PARAMETERS as DRIVING
from pioneer3.ros.node.names import Profile
from pioneer3.ros.node.navigation_topics import NAVIGATION_TOPICS
from pioneer3.ros.node.parameter import ParameterKind
from pioneer3.ros.node.parameter_reading import read_parameters
from pioneer3.ros.node.topics import STAMPED_COMMANDS, UNSTAMPED_NAME, topics_of
from pioneer3.ros.ros2.arguments import RosArguments
from pioneer3.ros.ros2.distros import distros
from tests.unit.ros.ros2.launch_system import LaunchContext, install, launched
from tests.unit.ros.support import P3AT

DISTROS = tuple(distros())
TYPES = {
    ParameterKind.BOOL: bool,
    ParameterKind.INTEGER: int,
    ParameterKind.DOUBLE: float,
    ParameterKind.STRING: str,
}


@pytest.fixture
def prefix(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return an install space, in which launch files find their package."""
    prefix = install_package(tmp_path / "in stall", python="/opt/my python")
    install(monkeypatch, prefix / "share/pioneer3")
    return prefix


def launch(prefix: Path, name: str, **arguments: str) -> LaunchContext:
    return launched(prefix / f"share/pioneer3/launch/{name}.launch.py", **arguments)


def configuration(prefix: Path, name: str) -> dict[str, Any]:
    read: dict[str, Any] = yaml.safe_load((prefix / "share/pioneer3/config" / name).read_text())
    return read


def names_in_ros2() -> set[str]:
    topics = (*topics_of(P3AT), *NAVIGATION_TOPICS)
    return {name for topic in topics for name in topic.names(Profile.ROS2)}


def test_the_index_of_ament_has_the_package(prefix: Path) -> None:
    assert (prefix / "share/ament_index/resource_index/packages/pioneer3").exists()
    manifest = ET.parse(prefix / "share/pioneer3/package.xml").getroot()
    assert manifest.get("format") == "3"
    assert manifest.findtext("name") == "pioneer3"


def test_the_programs_run_with_the_python_that_has_pioneer3(prefix: Path) -> None:
    assert {path.name for path in (prefix / "lib/pioneer3").iterdir()} == set(PROGRAMS)
    for name, command in PROGRAMS.items():
        program = prefix / "lib/pioneer3" / name
        assert os.access(program, os.X_OK)
        wanted = f"exec '/opt/my python' -m pioneer3 ros2 {command}".rstrip()
        assert program.read_text() == f'#!/bin/sh\n{wanted} "$@"\n'


@pytest.mark.parametrize(("owner", "name"), NODES_OF_OTHERS.items())
def test_launch_files_of_other_drivers_find_the_node(prefix: Path, owner: str, name: str) -> None:
    program = prefix / "lib" / owner / name
    assert os.access(program, os.X_OK)
    assert program.read_text().endswith('-m pioneer3 ros2 "$@"\n')
    assert (prefix / "share/ament_index/resource_index/packages" / owner).exists()
    manifest = ET.parse(prefix / "share" / owner / "package.xml").getroot()
    assert manifest.findtext("name") == owner


@pytest.mark.parametrize(("shell", "setup"), [("sh", "setup.sh"), ("bash", "setup.bash")])
def test_a_setup_puts_the_prefix_before_others_once(prefix: Path, shell: str, setup: str) -> None:
    source = f". '{prefix / setup}'"
    script = f'set -eu; {source}; {source}; echo "$AMENT_PREFIX_PATH"'
    for before, after in (("", ""), ("/opt/ros/jazzy", ":/opt/ros/jazzy")):
        environment = {"PATH": os.environ["PATH"], "AMENT_PREFIX_PATH": before}
        done = subprocess.run(
            [shell, "-c", script], env=environment, capture_output=True, text=True, check=True
        )
        assert done.stdout.strip() == f"{prefix}{after}"


def test_a_copied_install_space_is_found_by_bash(prefix: Path) -> None:
    moved = prefix.with_name("elsewhere")
    prefix.rename(moved)
    script = f"source '{moved}/setup.bash' && echo $AMENT_PREFIX_PATH"
    done = subprocess.run(["bash", "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.strip().startswith(str(moved))


def test_an_unknown_distribution_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="jazzy"):
        install_package(tmp_path, "dashing")


def test_a_folder_that_cannot_be_written_is_told(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(ConfigError, match="cannot write the package"):
        install_package(tmp_path / "file")


@pytest.mark.parametrize("distro", DISTROS)
def test_every_file_of_parameters_is_one_of_ros(tmp_path: Path, distro: str) -> None:
    prefix = install_package(tmp_path, distro)
    files = list((prefix / "share/pioneer3/config").glob("*.yaml"))
    assert len(files) == 6
    for path in files:
        _check_parameters(yaml.safe_load(path.read_text()), path.name)
        assert "@" not in path.read_text()


def _check_parameters(node: Any, where: str) -> None:
    """Refuse values that ROS 2's parser does not take: nulls, empty and mixed arrays."""
    assert node is not None, where
    if isinstance(node, dict):
        for name, value in node.items():
            _check_parameters(value, f"{where} {name}")
    elif isinstance(node, list):
        assert len({type(each) for each in node}) == 1, where


@pytest.mark.parametrize("distro", DISTROS)
def test_the_nodes_own_parameters_are_those_of_the_table(tmp_path: Path, distro: str) -> None:
    prefix = install_package(tmp_path, distro)
    given = configuration(prefix, "pioneer3.yaml")["/**"]["ros__parameters"]
    text = (prefix / "share/pioneer3/config/pioneer3.yaml").read_text()
    for parameter in read_parameters({}, Profile.ROS2).values:
        assert f" {parameter.name}:" in text
        assert given.get(parameter.name, 1) != []
        if parameter.name in given and parameter.kind in TYPES:
            assert type(given[parameter.name]) is TYPES[parameter.kind]
    assert all(f"# {row.name}:" in text for row in DRIVING if Profile.ROS2 in row.profiles)
    assert given["enable_stamped_cmd_vel"] is distros()[distro].stamped_commands
    assert given["pose_covariance_diagonal"][2] == 1e6
    assert read_parameters(RosArguments(parameters=given).raw, Profile.ROS2).laser.skip == 0


@pytest.mark.parametrize("distro", DISTROS)
@pytest.mark.parametrize("name", DRIVEN)
def test_nav2_has_the_numbers_of_the_model_and_the_names_of_the_distribution(
    tmp_path: Path, name: str, distro: str
) -> None:
    nav2 = configuration(install_package(tmp_path, distro), f"nav2_{name}.yaml")
    nodes = {
        node: entries["ros__parameters"] for node, entries in nav2.items() if "costmap" not in node
    }
    costmap = nav2["local_costmap"]["local_costmap"]["ros__parameters"]
    model, separator = load_model(name), "/" if distro == "humble" else "::"
    assert (
        nodes["planner_server"]["GridBased"]["plugin"]
        == f"nav2_navfn_planner{separator}NavfnPlanner"
    )
    assert nodes["behavior_server"]["spin"]["plugin"] == f"nav2_behaviors{separator}Spin"
    for node in ("controller_server", "velocity_smoother", "behavior_server", "collision_monitor"):
        stamped = distros()[distro].stamped_commands
        assert nodes[node]["enable_stamped_cmd_vel"] is stamped
    corners = yaml.safe_load(costmap["footprint"])
    assert max(x for x, _ in corners) == model.length_front
    assert min(x for x, _ in corners) == -model.length_rear
    assert {abs(y) for _, y in corners} == {model.width / 2}
    follow = nodes["controller_server"]["FollowPath"]
    assert follow["max_vel_x"] <= model.max_speed
    assert follow["decel_lim_x"] == -model.deceleration
    assert follow["sim_time"] >= follow["max_vel_x"] / model.deceleration


def test_topics_and_frames_are_those_of_the_node(prefix: Path) -> None:
    known = names_in_ros2()
    nav2 = configuration(prefix, "nav2_p3at.yaml")
    costmap = nav2["local_costmap"]["local_costmap"]["ros__parameters"]
    ranges = costmap["range_sensor_layer"]["topics"]
    assert {topic.removeprefix("/") for topic in ranges} <= known
    assert len(ranges) == len(P3AT.sonars)
    assert {"scan", "odom", "emergency_stop", "robot_description", "goal_pose"} <= known
    mux = configuration(prefix, "twist_mux.yaml")["/**"]["ros__parameters"]
    assert mux["locks"]["emergency_stop"] == {
        "topic": "emergency_stop",
        "timeout": 0.5,
        "priority": 255,
    }
    assert {each["topic"]: each["priority"] for each in mux["topics"].values()} == {
        "joy_vel": 100,
        "key_vel": 90,
        "web_vel": 80,
        "marker_vel": 20,
        "nav_vel": 10,
    }


def test_rviz_shows_topics_that_there_are(prefix: Path) -> None:
    shown = yaml.safe_load((prefix / "share/pioneer3/rviz/pioneer3.rviz").read_text())
    manager = shown["Visualization Manager"]
    assert manager["Global Options"]["Fixed Frame"] == "odom"
    displays = [*manager["Displays"]]
    displays += next(each for each in displays if each["Name"] == "Ranges")["Displays"]
    topics = {
        each[key]["Value"]
        for each in (*displays, *manager["Tools"])
        for key in ("Topic", "Description Topic")
        if key in each
    }
    of_nav2 = {"local_costmap/costmap"}
    assert topics <= names_in_ros2() | of_nav2
    assert {f"sonar/range_{number}" for number in range(16)} <= topics
    classes = {each["Class"].split("/")[0] for each in displays}
    assert classes == {"rviz_default_plugins", "rviz_common"}


def test_a_robot_is_launched_with_the_parameters_that_are_given(prefix: Path) -> None:
    (node,) = launch(prefix, "robot").nodes
    assert (node.package, node.executable, node.name) == ("pioneer3", "node", "pioneer3")
    assert node.values == {"use_sim_time": False}
    assert node.respawn
    assert node.remappings == [("cmd_vel", "cmd_vel")]
    (node,) = launch(
        prefix,
        "robot",
        namespace="robot1",
        port="host:8101",
        map="12",
        cmd_vel="mux",
        respawn="false",
        backend="dds",
        interface="wlan0",
    ).nodes
    assert node.values == {"use_sim_time": False, "port": "host:8101", "map": "12"}
    assert (node.namespace, node.respawn) == ("robot1", False)
    assert node.arguments == ["--backend", "dds", "--interface", "wlan0"]
    assert ("cmd_vel", "mux") in node.remappings


def test_robots_have_namespaces_and_if_asked_prefixes(prefix: Path) -> None:
    robots = "robot1=host:8101,robot2=/dev/ttyUSB0"
    first, second = launch(prefix, "robots", robots=robots).nodes
    assert [first.namespace, second.namespace] == ["robot1", "robot2"]
    assert [first.values["port"], second.values["port"]] == ["host:8101", "/dev/ttyUSB0"]
    assert "frame_prefix" not in first.values
    first, second = launch(prefix, "robots", robots=robots, style="prefixes").nodes
    assert second.values["frame_prefix"] == "robot2/"


def test_rviz_and_the_description_of_a_recording_are_launched(prefix: Path) -> None:
    (rviz,) = launch(prefix, "rviz").nodes
    assert (rviz.arguments[0], Path(rviz.arguments[1]).is_file()) == ("-d", True)
    rviz, publisher = launch(prefix, "rviz", namespace="robot1", model="p3dx").nodes
    assert ("/tf", "tf") in rviz.remappings
    assert ET.fromstring(publisher.values["robot_description"]).get("name")


def test_nav2_has_the_topics_of_a_namespace(prefix: Path) -> None:
    ((path, given),) = launch(prefix, "nav2", model="p3dx", map="office.yaml").included
    assert path == "nav2_bringup/launch/bringup_launch.py"
    assert (given["map"], given["slam"], given["namespace"]) == ("office.yaml", "False", "")
    plain = (prefix / "share/pioneer3/config/nav2_p3dx.yaml").read_text()
    assert given["params_file"] == plain
    ((_, given),) = launch(prefix, "nav2", namespace="robot1", cmd_vel="nav_vel").included
    read = yaml.safe_load(given["params_file"])
    costmap = read["local_costmap"]["local_costmap"]["ros__parameters"]
    assert costmap["range_sensor_layer"]["topics"][0] == "/robot1/sonar/range_0"
    assert costmap["obstacle_layer"]["scan"]["topic"] == "/robot1/scan"
    assert read["collision_monitor"]["ros__parameters"]["cmd_vel_out_topic"] == "nav_vel"
    assert given["use_namespace"] == "true"


@pytest.mark.parametrize("humble", [False, True])
def test_slam_runs_in_the_namespace_of_the_robot(
    prefix: Path, monkeypatch: pytest.MonkeyPatch, *, humble: bool
) -> None:
    install(monkeypatch, prefix / "share/pioneer3", humble=humble)
    context = launch(prefix, "slam", namespace="robot1")
    ((path, given),) = context.included
    assert path == "slam_toolbox/launch/online_async_launch.py"
    assert Path(given["slam_params_file"]).is_file()
    assert context.namespaces == ["robot1"]
    assert ("/tf", "tf") in context.remaps


def test_twist_mux_drives_the_robot(prefix: Path) -> None:
    (mux,) = launch(prefix, "twist_mux", nav_vel="cmd_vel", cmd_vel_out="mux").nodes
    assert mux.remappings == [("cmd_vel_out", "mux")]
    assert mux.values["topics.navigation.topic"] == "cmd_vel"


def test_the_other_type_of_commands_has_a_topic_of_its_own() -> None:
    assert STAMPED_COMMANDS.names(Profile.ROS2) == ("cmd_vel_stamped",)
    assert UNSTAMPED_NAME == "cmd_vel_unstamped"
