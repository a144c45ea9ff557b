"""Writes a ROS 2 package that `ros2 run` and `ros2 launch` find, without colcon and a build."""

import shlex
import sys
from functools import partial
from math import ceil, hypot
from pathlib import Path
from textwrap import wrap
from typing import Final

from pioneer3 import __version__
from pioneer3.models import RobotModel, load_model
from pioneer3.ros.installation import (
    DEMOS,
    NAME,
    launcher,
    rendered,
    rviz_config,
    urdf_files,
    write_files,
)
from pioneer3.ros.node.driving_parameters import PARAMETERS as DRIVING
from pioneer3.ros.node.names import Profile
from pioneer3.ros.node.parameter import Parameter
from pioneer3.ros.node.parameter_reading import read_parameters
from pioneer3.ros.ros2.distros import DEFAULT, Distro, distro_of

PROGRAMS: Final = {"node": "", "bridge": "bridge", **{name: name for name in DEMOS}}
"""The programs that `ros2 run pioneer3` finds, and their commands of `pioneer3 ros2`."""
NODES_OF_OTHERS: Final = {"rosaria": "RosAria", "p2os_driver": "p2os_driver"}
"""Packages in the place of others, for launch files, and the name of the node in each."""
LAUNCH_FILES: Final = ("robot", "robots", "rviz", "nav2", "slam", "twist_mux")
DRIVEN: Final = ("p3at", "p3dx")
"""Models that Nav2 has parameters for."""
SETUPS: Final = ("setup.sh", "setup.bash", "setup.zsh")
SPEED: Final = 0.5
"""Top speed of Nav2 [m/s]: among people, with the deceleration of the models."""
TURN_RATE: Final = 1.0
"""Top turn rate of Nav2 [rad/s]."""
BACK_SPEED: Final = 0.2
"""Top speed of Nav2 backwards [m/s]: a laser does not see there."""
CLEARANCE: Final = 0.3
"""From the corners of the robot to where costs end [m]."""
WIDTH: Final = 96
"""Width of comments [characters]."""


def install_package(folder: Path, distro: str = DEFAULT, python: str = sys.executable) -> Path:
    """Write a ROS 2 install space for a distribution into `folder`; return its absolute path.

    After `source folder/setup.bash` ROS 2 finds the package `pioneer3`, whose programs run with
    `python`, which has it. The files of an earlier version are replaced. Raises ConfigError if it
    cannot be written there, or there is no such distribution.
    """
    prefix = folder.expanduser().absolute()
    share, programs = prefix / "share" / NAME, prefix / "lib" / NAME
    launchers = {
        programs / name: launcher(python, "ros2", command) for name, command in PROGRAMS.items()
    } | {
        prefix / "lib" / owner / name: launcher(python, "ros2")
        for owner, name in NODES_OF_OTHERS.items()
    }
    index = prefix / "share" / "ament_index" / "resource_index" / "packages"
    packages = (NAME, *NODES_OF_OTHERS)
    shell = {"prefix": shlex.quote(str(prefix))}
    contents = {
        **dict.fromkeys((index / name for name in packages), ""),
        **launchers,
        **{prefix / name: rendered("ament", name, shell) for name in SETUPS},
        **{
            prefix / "share" / name / "package.xml": rendered(
                "ament", "package.xml", {"name": name, "version": __version__}
            )
            for name in packages
        },
        **_launch_files(share / "launch"),
        **_configuration(share / "config", distro_of(distro)),
        share / "rviz" / f"{NAME}.rviz": rviz_config("ament"),
        **urdf_files(share / "urdf"),
    }
    write_files(contents, launchers, prefix)
    return prefix


def _launch_files(folder: Path) -> dict[Path, str]:
    names = (f"{name}.launch.py" for name in LAUNCH_FILES)
    return {folder / name: rendered("ament", f"launch/{name}", {}) for name in names}


def _configuration(folder: Path, distro: Distro) -> dict[Path, str]:
    """Return the files of parameters, by path."""
    values = {"distro": distro.name.title(), "stamped": _yaml(distro.stamped_commands)}
    slam = rendered("ament", "config/slam_toolbox.yaml", {})
    values["slam"] = slam.partition("/**:\n")[2].rstrip()
    fill = partial(rendered, "ament", values=values)
    nav2 = {
        folder / f"nav2_{name}.yaml": rendered(
            "ament", "config/nav2.yaml", {**values, **_nav2_values(load_model(name), distro)}
        )
        for name in DRIVEN
    }
    return {
        **nav2,
        folder / "slam_toolbox.yaml": slam,
        folder / "twist_mux.yaml": fill("config/twist_mux.yaml"),
        folder / "teleop_joy.yaml": fill("config/teleop_joy.yaml"),
        folder / f"{NAME}.yaml": _parameters(distro),
    }


def _nav2_values(model: RobotModel, distro: Distro) -> dict[str, str]:
    """Return the values of Nav2's parameters that depend on the robot and the distribution."""
    speed = min(SPEED, model.max_speed)
    corners = [
        (model.length_front, model.width / 2),
        (model.length_front, -model.width / 2),
        (-model.length_rear, -model.width / 2),
        (-model.length_rear, model.width / 2),
    ]
    numbers = {
        "max_speed": model.max_speed,
        "max_turn_rate": model.max_turn_rate,
        "speed": speed,
        "turn_rate": min(TURN_RATE, model.max_turn_rate),
        "back_speed": min(BACK_SPEED, speed),
        "acceleration": model.acceleration,
        "deceleration": model.deceleration,
        "turn_acceleration": model.turn_acceleration,
        "turn_deceleration": model.turn_deceleration,
        "stopping_time": ceil(10 * speed / model.deceleration) / 10,
        "inflation": max(hypot(*corner) for corner in corners) + CLEARANCE,
        "turn_noise": 0.4 if model.drive == "skid" else 0.2,
    }
    # https://docs.nav2.org/configuration/packages/configuring-navfn.html: "In Iron and older
    # versions, "/" was used instead of "::""
    humble = distro.name == "humble"
    return {
        **{name: _yaml(round(number, 3)) for name, number in numbers.items()},
        "title": model.title,
        "footprint": str([list(corner) for corner in corners]),
        "sonars": ", ".join(f"/sonar/range_{number}" for number in range(len(model.sonars))),
        "separator": "/" if humble else "::",
        "behavior_frame": "odom" if humble else "map",
    }


def _parameters(distro: Distro) -> str:
    """Return a file of the node's own parameters, with their meanings as comments."""
    lines = [
        f"# Parameters of the node pioneer3 in {distro.name.title()}. What the robot, its model or",
        "# a search tells is commented out.",
        "/**:",
        "  ros__parameters:",
    ]
    for parameter in read_parameters({}, Profile.ROS2).values:
        note = _in_ros2(parameter.described)
        lines += (f"    # {line}" for line in wrap(note, WIDTH - 6, break_on_hyphens=False))
        lines.append(f"    {_entry(parameter, distro)}")
    lines.append("    # Parameters that may change while the node runs:")
    lines += (
        f"    # {row.name}:  # {row.described}" for row in DRIVING if Profile.ROS2 in row.profiles
    )
    return "\n".join((*lines, ""))


def _entry(parameter: Parameter, distro: Distro) -> str:
    if parameter.name == "enable_stamped_cmd_vel":
        return f"{parameter.name}: {_yaml(distro.stamped_commands)}"
    if parameter.default is None:
        clauses = _in_ros2(parameter.otherwise).split("; ")
        otherwise = next((each for each in clauses if "ROS 2" in each), clauses[0])
        return f"# {parameter.name}:{f'  # {otherwise}' if otherwise else ''}"
    return f"{parameter.name}: {_yaml(parameter.default)}"


def _in_ros2(text: str) -> str:
    """Return a sentence of the table without its clauses about RosAria's names."""
    return "; ".join(part for part in text.split("; ") if "`compatibility`" not in part)


def _yaml(value: object) -> str:
    """Return a value as ROS 2 reads it: a float has a point, and so has each of an array."""
    match value:
        case bool():
            return str(value).lower()
        case tuple():
            return f"[{', '.join(map(_yaml, value))}]"
        case float():
            return f"{value:.9f}".rstrip("0") + ("0" if value == int(value) else "")
        case str():
            return f'"{value}"'
    return str(value)
