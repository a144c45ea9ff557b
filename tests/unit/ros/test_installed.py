import re
import subprocess
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

from pioneer3.cli.ros1 import ros1_app
from pioneer3.errors import ConfigError
from pioneer3.ros.node.names import Profile
from pioneer3.ros.node.navigation_topics import NAVIGATION_TOPICS
from pioneer3.ros.node.topics import topics_of
from pioneer3.ros.ros1.package import install_package
from tests.unit.ros.support import P3AT

DEMOS = (
    "robots",
    "rob_key",
    "rob_key_multi",
    "p3_sonar",
    "follow",
    "wander",
    "android_teleop",
)


def test_the_package_starts_the_command_with_the_python_of_now(tmp_path: Path) -> None:
    package = install_package(tmp_path / "ros", python="/bin/echo")
    launcher = package / "scripts" / "RosAria"
    said = subprocess.run([launcher, "_port:=a b"], capture_output=True, text=True, check=True)
    assert said.stdout == "-m pioneer3 ros1 _port:=a b\n"
    assert install_package(tmp_path / "ros") == package


def test_the_package_has_a_program_for_each_demo(tmp_path: Path) -> None:
    scripts = install_package(tmp_path, python="/bin/echo") / "scripts"
    assert {path.name for path in scripts.iterdir()} == {"RosAria", *DEMOS}
    for demo in DEMOS:
        said = subprocess.run(
            [scripts / demo, "-r", "x"], capture_output=True, text=True, check=True
        )
        assert said.stdout == f"-m pioneer3 ros1 {demo} -r x\n"
    assert set(DEMOS) <= set(ros1_app)


def test_a_package_that_cannot_be_written_is_told(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(ConfigError, match="cannot write the package"):
        install_package(tmp_path / "file")


def test_the_package_shows_every_model_it_describes(tmp_path: Path) -> None:
    package = install_package(tmp_path)
    drawn = {path.stem: ET.parse(path).getroot() for path in (package / "urdf").iterdir()}
    assert {name: root.get("name") for name, root in drawn.items()} == {
        name: name for name in ("p3at", "p3at-sh", "p3dx", "p3dx-sh")
    }
    shown = (package / "rviz" / "pioneer3.rviz").read_text()
    told = {name for topic in topics_of(P3AT) for name in topic.names(Profile.BOTH)}
    told |= {name for topic in NAVIGATION_TOPICS for name in topic.names(Profile.BOTH)}
    told |= {"scan", "RosAria/sonar"}
    topics = re.findall(r"Topic: (.*)", shown)
    assert len(topics) > 16
    assert set(topics) <= told
    for launch in (package / "launch").iterdir():
        assert ET.parse(launch).getroot().tag == "launch"
