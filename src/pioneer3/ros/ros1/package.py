"""A ROS 1 package that `rosrun` and `roslaunch` find, without catkin and without a build."""

import shlex
import sys
from pathlib import Path
from typing import Final

from pioneer3 import __version__
from pioneer3.errors import ConfigError
from pioneer3.ros.ros1.messages import BUMPER_KIND, BUMPER_STATE
from pioneer3.ros.ros1.showing import showing_files

NAME: Final = "pioneer3"
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
"""Of the kind before catkin: ROS's tools look for Python code in `src` of such packages only."""
LAUNCHER: Final = """#!/bin/sh
exec {python} -m pioneer3 ros1 {command} "$@"
"""
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
"""What `rosrun` finds, and the command of `pioneer3 ros1` that it runs."""
MESSAGES: Final = """from genpy.dynamic import generate_dynamic

BumperState = generate_dynamic({kind!r}, {definition!r})[{kind!r}]
"""
LAUNCH: Final = """<launch>
  <!-- empty: the simulator at localhost:8101, else the robot at a serial port -->
  <arg name="port" default="" />
  <arg name="name" default="RosAria" />
  <arg name="cmd_vel_timeout" default="0.6" />
  <arg name="profile" default="compatibility" />
  <arg name="rviz" default="false" />
  <node pkg="pioneer3" type="RosAria" name="$(arg name)" output="screen">
    <param name="port" value="$(arg port)" />
    <param name="cmd_vel_timeout" value="$(arg cmd_vel_timeout)" />
    <param name="profile" value="$(arg profile)" />
  </node>
  <include if="$(arg rviz)" file="$(find pioneer3)/launch/rviz.launch" />
</launch>
"""


def install_package(folder: Path, python: str = sys.executable) -> Path:
    """Write ROS packages into `folder`, which belongs on ROS_PACKAGE_PATH; return ours.

    The programs of `pioneer3` run with `python`; `rosaria` has the node under RosAria's own name,
    for launch files and habits, and its message, which ROS's tools need to show it. What an earlier
    version wrote is written anew.

    Raises:
        ConfigError: it cannot be written there.
    """
    package, rosaria = folder.expanduser() / NAME, folder.expanduser() / "rosaria"
    launchers = {
        package / "scripts" / name: LAUNCHER.format(python=shlex.quote(python), command=command)
        for name, command in PROGRAMS.items()
    }
    node = package / "scripts" / "RosAria"
    launchers[rosaria / "scripts" / node.name] = launchers[node]
    module = rosaria / "src" / "rosaria"
    files = {
        package / "package.xml": MANIFEST.format(name=NAME, version=__version__),
        **launchers,
        package / "launch" / "pioneer3.launch": LAUNCH,
        **showing_files(package),
        rosaria / "manifest.xml": DRY_MANIFEST,
        rosaria / "msg" / "BumperState.msg": BUMPER_STATE.partition("=")[0],
        module / "__init__.py": "",
        module / "msg" / "__init__.py": MESSAGES.format(kind=BUMPER_KIND, definition=BUMPER_STATE),
    }
    try:
        for path, text in files.items():
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        for launcher in launchers:
            launcher.chmod(0o755)
    except OSError as error:
        raise ConfigError(f"cannot write the package to {folder}: {error}") from error
    return package
