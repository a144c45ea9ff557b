"""A ROS 1 package that `rosrun` and `roslaunch` find, without catkin and without a build."""

import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from textwrap import indent
from typing import Final

from pioneer3 import __version__
from pioneer3.ros.installation import NAME, TRANSDUCERS, launcher, urdf_files, write_files
from pioneer3.ros.ros1.middleware import BUMPER_STATE, BUMPER_TYPE

MANIFEST: Final = """<?xml version="1.0"?>
<package format="2">
  <name>{name}</name>
  <version>{version}</version>
  <description>Drives Pioneer 3 robots, in RosAria's place</description>
  <maintainer email="nobody@example.org">pioneer3</maintainer>
  <license>Apache-2.0</license>
</package>
"""
DRY_MANIFEST: Final = """<package>
  <description brief="RosAria">RosAria's message, and the node in its place</description>
  <author>pioneer3</author>
  <license>Apache-2.0</license>
</package>
"""
"""Manifest from before catkin: ROS's tools look for Python in `src` of such packages only."""
PROGRAMS: Final = {
    "RosAria": "",
    "robots": "robots",
    "rob_key": "rob_key",
    "rob_key_multi": "rob_key_multi",
    "p3_sonar": "p3_sonar",
    "follow": "follow",
    "wander": "wander",
    "android_teleop": "android_teleop",
}
"""The programs that `rosrun` finds, and their commands of `pioneer3 ros1`."""
MESSAGES: Final = """from genpy.dynamic import generate_dynamic

BumperState = generate_dynamic({kind!r}, {definition!r})[{kind!r}]
"""
LAUNCH: Final = """<launch>
  <!-- empty: the simulator at localhost:8101, else the robot at a serial port -->
  <arg name="port" default="" />
  <arg name="name" default="RosAria" />
  <arg name="cmd_vel_timeout" default="0.6" />
  <arg name="profile" default="compatibility" />
  <!-- to go to places of a map: its file or name, and where the robot is; empty for none -->
  <arg name="map" default="" />
  <arg name="start" default="" />
  <arg name="rviz" default="false" />
  <node pkg="pioneer3" type="RosAria" name="$(arg name)" output="screen">
    <param name="port" value="$(arg port)" />
    <param name="cmd_vel_timeout" value="$(arg cmd_vel_timeout)" />
    <param name="profile" value="$(arg profile)" />
    <param name="map" value="$(arg map)" type="str" />
    <param name="start" value="$(arg start)" type="str" />
  </node>
  <include if="$(arg rviz)" file="$(find pioneer3)/launch/rviz.launch" />
</launch>
"""
DisplayProperties = Mapping[str, str | int | float]
"""Properties of a display, by their names in rviz."""
RVIZ_LAUNCH: Final = """<launch>
  <!-- a model's name, such as p3at, to see a recording: no node describes the robot then -->
  <arg name="model" default="" />
  <param if="$(eval arg('model') != '')" name="robot_description"
    textfile="$(find pioneer3)/urdf/$(arg model).urdf" />
  <node pkg="rviz" type="rviz" name="rviz" args="-d $(find pioneer3)/rviz/pioneer3.rviz" />
</launch>
"""
RVIZ_CONFIG: Final = """Panels:
  - Class: rviz/Displays
    Name: Displays
    Splitter Ratio: 0.5
  - Class: rviz/Views
    Name: Views
Visualization Manager:
  Class: ""
  Global Options:
    Background Color: 245; 245; 245
    Fixed Frame: odom
    Frame Rate: 30
  Tools:
    - Class: rviz/Interact
    - Class: rviz/MoveCamera
    - Class: rviz/FocusCamera
    - Class: rviz/Measure
    - Class: rviz/SetInitialPose
      Topic: initialpose
    - Class: rviz/SetGoal
      Topic: move_base_simple/goal
  Views:
    Current:
      Class: rviz/ThirdPersonFollower
      Distance: 3
      Name: Current View
      Pitch: 0.6
      Target Frame: base_link
      Yaw: 2.6
  Displays:
{displays}Window Geometry:
  Height: 850
  Width: 1300
"""


def install_package(folder: Path, python: str = sys.executable) -> Path:
    """Write ROS packages into `folder`, which belongs on ROS_PACKAGE_PATH; return ours.

    The programs of `pioneer3` run with `python`; `rosaria` has the node under RosAria's own name,
    for launch files and habits, and its message, which ROS's tools need to show it. The files of an
    earlier version are replaced.

    Raises:
        ConfigError: it cannot be written there.
    """
    package, rosaria = folder.expanduser() / NAME, folder.expanduser() / "rosaria"
    launchers = {
        package / "scripts" / name: launcher(python, "ros1", command)
        for name, command in PROGRAMS.items()
    }
    node = package / "scripts" / "RosAria"
    launchers[rosaria / "scripts" / node.name] = launchers[node]
    module = rosaria / "src" / "rosaria"
    files = {
        package / "package.xml": MANIFEST.format(name=NAME, version=__version__),
        **launchers,
        package / "launch" / "pioneer3.launch": LAUNCH,
        **_rviz_files(package),
        rosaria / "manifest.xml": DRY_MANIFEST,
        rosaria / "msg" / "BumperState.msg": BUMPER_STATE.partition("=")[0],
        module / "__init__.py": "",
        module / "msg" / "__init__.py": MESSAGES.format(kind=BUMPER_TYPE, definition=BUMPER_STATE),
    }
    write_files(files, launchers, folder)
    return package


def _rviz_files(package: Path) -> dict[Path, str]:
    """Return the contents of the files in `package`, by path."""
    return {
        package / "launch" / "rviz.launch": RVIZ_LAUNCH,
        package / "rviz" / "pioneer3.rviz": RVIZ_CONFIG.format(displays="".join(_displays())),
        **urdf_files(package / "urdf"),
    }


def _displays() -> Iterator[str]:
    yield _display("Map", "Map", {"Topic": "map", "Alpha": 0.7})
    yield _display("Path", "Way", {"Topic": "move_base/NavfnROS/plan", "Color": "0; 120; 0"})
    yield _display("PoseWithCovariance", "Place", {"Topic": "amcl_pose"})
    yield _display("Grid", "Grid", {"Color": "160; 160; 160", "Plane Cell Count": 20})
    yield _display("RobotModel", "Robot", {"Robot Description": "robot_description"})
    yield _display("TF", "Frames", {"Marker Scale": 0.3, "Show Names": "true"}, enabled=False)
    yield _display("LaserScan", "Laser", {"Topic": "scan", **_points("200; 0; 0", 3)})
    yield _display("PointCloud2", "Sonar", {"Topic": "sonar/points", **_points("0; 90; 200", 5)})
    rosarias: DisplayProperties = {"Topic": "RosAria/sonar", **_points("0; 90; 200", 5)}
    yield _display("PointCloud", "Sonar of RosAria", rosarias, enabled=False)
    touched: DisplayProperties = {"Topic": "bumpers/points", **_points("255; 120; 0", 12)}
    yield _display("PointCloud2", "Bumpers", touched)
    poses: DisplayProperties = {
        "Topic": "odom",
        "Keep": 100,
        "Position Tolerance": 0.1,
        "Angle Tolerance": 0.1,
    }
    yield _display("Odometry", "Odometry", poses, enabled=False)
    yield "    - Class: rviz/Group\n      Name: Ranges\n      Enabled: true\n      Displays:\n"
    for number in range(TRANSDUCERS):
        beam: DisplayProperties = {
            "Topic": f"sonar/range_{number}",
            "Alpha": 0.15,
            "Color": "0; 150; 90",
        }
        yield indent(_display("Range", f"Range {number}", beam), "    ")


def _points(color: str, size: int) -> DisplayProperties:
    """Return how points look: they stay for half a second, as each transducer pings that often."""
    return {
        "Color": color,
        "Color Transformer": "FlatColor",
        "Decay Time": 0.5,
        "Position Transformer": "XYZ",
        "Size (Pixels)": size,
        "Style": "Points",
    }


def _display(kind: str, name: str, properties: DisplayProperties, *, enabled: bool = True) -> str:
    lines = [
        f"- Class: rviz/{kind}",
        f"  Name: {name}",
        f"  Enabled: {str(enabled).lower()}",
        *(f"  {key}: {value}" for key, value in properties.items()),
    ]
    return "".join(f"    {line}\n" for line in lines)
