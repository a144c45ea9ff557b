"""The launch files in the real launch and launch_ros, where a ROS 2 is installed."""

import json
import os
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

from pioneer3.ros.ament.install import install_package

pytestmark = pytest.mark.skipif(
    find_spec("launch_ros") is None, reason="launch_ros is part of a ROS 2, which is not here"
)
LAUNCH = """
import sys
from launch import LaunchDescription, LaunchService
from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource

file, *arguments = sys.argv[1:]
source = PythonLaunchDescriptionSource(file)
arguments = [each.split(":=", 1) for each in arguments]
service = LaunchService(noninteractive=True)
service.include_launch_description(
    LaunchDescription([IncludeLaunchDescription(source, launch_arguments=arguments)])
)
sys.exit(service.run())
"""
NODE = """#!{python}
import json
import os
import sys
from pathlib import Path
from pioneer3.ros.ros2.arguments import parse
from pioneer3.ros.ros2.backend import NodeName

words = sys.argv[sys.argv.index("--ros-args"):]
given = parse(words, NodeName("node", "/"))
said = dict(program=Path(sys.argv[0]).name, namespace=given.namespace, **given.parameters)
Path({folder!r}, f"{{os.getpid()}}.json").write_text(json.dumps(said))
"""
OTHERS = ("rviz2", "robot_state_publisher", "twist_mux")
"""Packages whose programs the launch files start; each has one of its own name."""


def run(folder: Path, name: str, *arguments: str) -> list[dict[str, Any]]:
    """Return the arguments with which a launch file starts each of its programs, which end."""
    reports, program = folder / "reports", folder / "node.py"
    reports.mkdir()
    program.write_text(NODE.format(python=sys.executable, folder=str(reports)))
    program.chmod(0o755)
    prefix = install_package(folder / "prefix", python=str(program))
    for other in OTHERS:
        (prefix / "share/ament_index/resource_index/packages" / other).touch()
        (prefix / "lib" / other).mkdir()
        (prefix / "lib" / other / other).symlink_to(program)
    path = os.pathsep.join(filter(None, (str(prefix), os.environ.get("AMENT_PREFIX_PATH"))))
    file = prefix / f"share/pioneer3/launch/{name}.launch.py"
    done = subprocess.run(
        [sys.executable, "-c", LAUNCH, str(file), *arguments],
        env={**os.environ, "AMENT_PREFIX_PATH": path, "ROS_LOG_DIR": str(folder)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return [json.loads(each.read_text()) for each in reports.iterdir()]


@pytest.mark.parametrize(("sim_time", "value"), [("false", False), ("True", True)])
def test_a_robot_is_launched_by_the_clock_that_is_asked_for(
    tmp_path: Path, sim_time: str, *, value: bool
) -> None:
    given = (f"use_sim_time:={sim_time}", "respawn:=false", "namespace:=robot1", "map:=12")
    (node,) = run(tmp_path, "robot", *given)
    assert node["use_sim_time"] is value
    assert (node["namespace"], node["map"]) == ("/robot1", "12")
    assert node["autostart"] is True  # of the file of parameters


def test_several_robots_are_launched(tmp_path: Path) -> None:
    robots = "robots:=robot1=host:8101,robot2=/dev/ttyUSB0"
    nodes = run(tmp_path, "robots", robots, "style:=prefixes", "respawn:=false")
    ports = {node["namespace"]: (node["port"], node["frame_prefix"]) for node in nodes}
    assert ports == {
        "/robot1": ("host:8101", "robot1/"),
        "/robot2": ("/dev/ttyUSB0", "robot2/"),
    }


def test_programs_of_other_packages_are_launched(tmp_path: Path) -> None:
    nodes = run(tmp_path, "rviz", "namespace:=robot1", "model:=p3dx", "use_sim_time:=true")
    assert {node["program"] for node in nodes} == {"rviz2", "robot_state_publisher"}
    assert all(node["use_sim_time"] is True for node in nodes)


def test_a_multiplexer_of_commands_is_launched(tmp_path: Path) -> None:
    (mux,) = run(tmp_path, "twist_mux", "nav_vel:=plan_vel")
    assert (mux["use_sim_time"], mux["topics.navigation.topic"]) == (False, "plan_vel")
