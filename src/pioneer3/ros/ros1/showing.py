"""What shows a robot in rviz: the files of the ROS 1 package that are for looking."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from textwrap import indent
from typing import Final

from pioneer3.models import load_model
from pioneer3.ros.description.frames import Frames
from pioneer3.ros.description.tree import tree_of
from pioneer3.ros.description.urdf import describe

Settings = Mapping[str, str | int | float]
"""Of a display, by their names in rviz."""
MODELS: Final = ("p3at", "p3at-sh", "p3dx", "p3dx-sh")
"""Those that the package has a description of; a node describes whatever robot it has."""
TRANSDUCERS: Final = 16
"""Of a Pioneer with both rows of sonars."""
LAUNCH: Final = """<launch>
  <!-- a model's name, such as p3at, to see a recording: no node describes the robot then -->
  <arg name="model" default="" />
  <param if="$(eval arg('model') != '')" name="robot_description"
    textfile="$(find pioneer3)/urdf/$(arg model).urdf" />
  <node pkg="rviz" type="rviz" name="rviz" args="-d $(find pioneer3)/rviz/pioneer3.rviz" />
</launch>
"""
CONFIG: Final = """Panels:
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


def showing_files(package: Path) -> dict[Path, str]:
    """Return the contents of the files in `package`, by path."""
    return {
        package / "launch" / "rviz.launch": LAUNCH,
        package / "rviz" / "pioneer3.rviz": CONFIG.format(displays="".join(_displays())),
        **{package / "urdf" / f"{name}.urdf": _urdf(name) for name in MODELS},
    }


def _urdf(name: str) -> str:
    model, frames = load_model(name), Frames()
    return describe(model, tree_of(model, frames), frames, laser=False)


def _displays() -> Iterator[str]:
    yield _display("Grid", "Grid", {"Color": "160; 160; 160", "Plane Cell Count": 20})
    yield _display("RobotModel", "Robot", {"Robot Description": "robot_description"})
    yield _display("TF", "Frames", {"Marker Scale": 0.3, "Show Names": "true"}, enabled=False)
    yield _display("LaserScan", "Laser", {"Topic": "scan", **_points("200; 0; 0", 3)})
    yield _display("PointCloud2", "Sonar", {"Topic": "sonar/points", **_points("0; 90; 200", 5)})
    rosarias: Settings = {"Topic": "RosAria/sonar", **_points("0; 90; 200", 5)}
    yield _display("PointCloud", "Sonar of RosAria", rosarias, enabled=False)
    touched: Settings = {"Topic": "bumpers/points", **_points("255; 120; 0", 12)}
    yield _display("PointCloud2", "Bumpers", touched)
    poses: Settings = {
        "Topic": "odom",
        "Keep": 100,
        "Position Tolerance": 0.1,
        "Angle Tolerance": 0.1,
    }
    yield _display("Odometry", "Odometry", poses, enabled=False)
    yield "    - Class: rviz/Group\n      Name: Ranges\n      Enabled: true\n      Displays:\n"
    for number in range(TRANSDUCERS):
        beam: Settings = {"Topic": f"sonar/range_{number}", "Alpha": 0.15, "Color": "0; 150; 90"}
        yield indent(_display("Range", f"Range {number}", beam), "    ")


def _points(color: str, size: int) -> Settings:
    """Return how points look: they stay for half a second, as each transducer pings that often."""
    return {
        "Color": color,
        "Color Transformer": "FlatColor",
        "Decay Time": 0.5,
        "Position Transformer": "XYZ",
        "Size (Pixels)": size,
        "Style": "Points",
    }


def _display(kind: str, name: str, settings: Settings, *, enabled: bool = True) -> str:
    lines = [
        f"- Class: rviz/{kind}",
        f"  Name: {name}",
        f"  Enabled: {str(enabled).lower()}",
        *(f"  {key}: {value}" for key, value in settings.items()),
    ]
    return "".join(f"    {line}\n" for line in lines)
