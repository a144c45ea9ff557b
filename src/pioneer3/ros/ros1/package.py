"""A ROS 1 package that `rosrun` and `roslaunch` find, without catkin and without a build."""

import sys
from pathlib import Path
from typing import Final

from pioneer3 import __version__
from pioneer3.ros.installation import (
    DEMOS,
    NAME,
    launcher,
    rendered,
    rviz_config,
    urdf_files,
    write_files,
)
from pioneer3.ros.ros1.middleware import BUMPER_STATE, BUMPER_TYPE

PROGRAMS: Final = {"RosAria": "", **DEMOS}
"""The programs that `rosrun` finds, and their commands of `pioneer3 ros1`."""
LAUNCH_FILES: Final = ("pioneer3", "rviz")
MESSAGES: Final = """from genpy.dynamic import generate_dynamic

BumperState = generate_dynamic({kind!r}, {definition!r})[{kind!r}]
"""


def install_package(folder: Path, python: str = sys.executable) -> Path:
    """Write ROS packages into `folder`, which belongs on ROS_PACKAGE_PATH; return ours.

    The programs of `pioneer3` run with `python`; `rosaria` has the node under RosAria's own name,
    for launch files and habits, and its message, which ROS's tools need to show it. The files of an
    earlier version are replaced. ConfigError if nothing can be written there.
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
        package / "package.xml": rendered("ros1", "package.xml", {"version": __version__}),
        **launchers,
        **{
            package / "launch" / f"{name}.launch": rendered("ros1", f"launch/{name}.launch", {})
            for name in LAUNCH_FILES
        },
        package / "rviz" / f"{NAME}.rviz": rviz_config("ros1"),
        **urdf_files(package / "urdf"),
        # of the kind before catkin: ROS's tools look for Python code in `src` of such packages only
        rosaria / "manifest.xml": rendered("ros1", "manifest.xml", {}),
        rosaria / "msg" / "BumperState.msg": BUMPER_STATE.partition("=")[0],
        module / "__init__.py": "",
        module / "msg" / "__init__.py": MESSAGES.format(kind=BUMPER_TYPE, definition=BUMPER_STATE),
    }
    write_files(files, launchers, folder)
    return package
