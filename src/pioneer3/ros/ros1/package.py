"""A ROS 1 package that `rosrun` and `roslaunch` find, without catkin and without a build."""

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Final

from pioneer3 import __version__
from pioneer3.ros.definitions import DEFINITIONS, file_of, module_of
from pioneer3.ros.installation import (
    DEMOS,
    NAME,
    launcher,
    rendered,
    rviz_config,
    urdf_files,
    write_files,
)

OWN: Final[Mapping[str, tuple[str, ...]]] = {
    "RosAria": ("ros1",),
    **{name: ("ros1", name) for name in DEMOS},
}
"""The programs that `rosrun pioneer3` finds, and their commands of `pioneer3`."""
PROGRAMS: Final[Mapping[str, Mapping[str, tuple[str, ...]]]] = {
    NAME: OWN,
    "rosaria": {
        **OWN,
        "rob_key_multi_robot_con_separately": ("ros1", "rob_key_multi"),
        "p3_sonar_following_moving_object": ("ros1", "follow", "--rule", "lab"),
        "robotWander": ("ros1", "wander", "--preset", "aria"),
        "robotDemo": ("demo",),
    },
    "p2os_driver": dict.fromkeys(
        ("p2os_driver", "p2os"), ("ros1", "_profile:=p2os", "__name:=p2os_driver")
    ),
    "sicktoolbox_wrapper": {"sicklms": ("ros1", "laser", "__name:=sicklms")},
    "lms1xx": {"LMS1xx_node": ("ros1", "laser", "__name:=lms1xx")},
    "hokuyo_node": {"hokuyo_node": ("ros1", "laser", "__name:=hokuyo_node")},
}
"""Programs by packages; those of others have the names that manuals and launch files have."""
OTHERS: Final = {
    "rosaria": "RosAria's message, the node in its place, and the programs of the lab's manual",
    "p2os_driver": "the node in the place of p2os",
    "p2os_msgs": "messages of p2os",
    **dict.fromkeys(
        ("sicktoolbox_wrapper", "lms1xx", "hokuyo_node"), "the laser's node in its place"
    ),
}
"""Packages in the place of others, and a line about each."""
LAUNCH_FILES: Final = ("pioneer3", "rviz")


def install_package(folder: Path, python: str = sys.executable) -> Path:
    """Write ROS packages into `folder`, which belongs on ROS_PACKAGE_PATH; return ours.

    Their programs run with `python`. All but `pioneer3` have the names of other packages, for
    launch files and habits, and their messages, which ROS's tools need to show them. The files of
    an earlier version are replaced. ConfigError if nothing can be written there.
    """
    place = folder.expanduser()
    package = place / NAME
    launchers = {
        place / owner / "scripts" / name: launcher(python, *command)
        for owner, programs in PROGRAMS.items()
        for name, command in programs.items()
    }
    files = {
        package / "package.xml": rendered("ros1", "package.xml", {"version": __version__}),
        **launchers,
        **{
            package / "launch" / f"{name}.launch": rendered("ros1", f"launch/{name}.launch", {})
            for name in LAUNCH_FILES
        },
        package / "rviz" / f"{NAME}.rviz": rviz_config("ros1"),
        **urdf_files(package / "urdf"),
        **{
            # of the kind before catkin: ROS's tools look for Python code in `src` of such only
            place / name / "manifest.xml": rendered("ros1", "manifest.xml", {"brief": brief})
            for name, brief in OTHERS.items()
        },
        **_messages(place),
    }
    write_files(files, launchers, folder)
    return package


def _messages(folder: Path) -> dict[Path, str]:
    """Return the files of messages of packages in `folder`, and their Python modules."""
    files = {}
    for kind in DEFINITIONS:
        owner, _, name = kind.partition("/")
        module = folder / owner / "src" / owner
        files[folder / owner / "msg" / f"{name}.msg"] = file_of(kind)
        files[module / "__init__.py"] = ""
        files[module / "msg" / "__init__.py"] = module_of(owner)
    return files
