"""ROS's own tools, as people use them."""

import re
from pathlib import Path

import pytest

from pioneer3.arcos import commands
from pioneer3.arcos.commands import Command
from tests.e2e.processes import until
from tests.ros1.conftest import Lab
from tests.ros1.master import PYTHON, ended, ros

pytestmark = [pytest.mark.realtime, pytest.mark.asyncio(loop_scope="module")]

DYNPARAM = (PYTHON, "/usr/lib/dynamic_reconfigure/dynparam")
TOPICS = ("/RosAria/pose", "/tf", "/RosAria/sonar", "/RosAria/bumper_state")


PACKAGE = """<package format="2">
  <name>dynamic_reconfigure</name><version>1.7.3</version><license>BSD</license>
  <description>What Debian's package lacks</description>
  <maintainer email="nobody@example.org">nobody</maintainer>
</package>
"""
"""Without it Debian's dynparam does not start."""


def said_to(lab: Lab) -> list[Command]:
    """Return what the robot has heard."""
    return [command for _, command in lab.tap.heard]


async def test_dynparam_finds_shows_and_sets(
    shared_lab: Lab, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "dynamic_reconfigure").mkdir()
    (tmp_path / "dynamic_reconfigure" / "package.xml").write_text(PACKAGE)
    monkeypatch.setenv("ROS_PACKAGE_PATH", f"{tmp_path}:/usr/share")
    assert (await ros(*DYNPARAM, "list")).split() == ["/RosAria"]
    said = await ros(*DYNPARAM, "get", "/RosAria")
    assert "'trans_accel': 0.3" in said
    assert "'rot_accel': 1.745" in said
    await ros(*DYNPARAM, "set", "/RosAria", "trans_accel", "50")
    assert "'trans_accel': 2.0" in await ros(*DYNPARAM, "get", "/RosAria")
    await until(lambda: commands.SetA(acceleration=2.0) in said_to(shared_lab))  # though it stands
    await ros(*DYNPARAM, "set", "/RosAria", "trans_accel", "0.3")
    await ros(*DYNPARAM, "set", "/RosAria", "TicksMM", "128")
    assert commands.TicksMM(ticks_per_mm=128) in said_to(shared_lab)
    assert "'TicksMM': 128" in await ros(*DYNPARAM, "get", "/RosAria")


async def test_a_bag_has_what_was_published(shared_lab: Lab, tmp_path: Path) -> None:
    bag = tmp_path / "lab.bag"
    await ended("rosbag", "record", "-O", str(bag), "--duration", "3", *TOPICS, patience=15.0)
    said = await ros("rosbag", "info", str(bag))
    counts = {name: int(count) for name, count in re.findall(r"(/\S+)\s+(\d+) msgs", said)}
    assert counts.keys() == set(TOPICS)
    assert min(counts.values()) >= 20
    assert re.search(r"nav_msgs/Odometry\s+\[cd5e73d190d741a2f92e81eda573aca7\]", said)
    assert re.search(r"rosaria/BumperState\s+\[f81947761ff7e166a3bbaf937b9869b5\]", said)


async def test_the_node_is_told_of_in_full(shared_lab: Lab) -> None:
    said = await ros("rosnode", "info", "/RosAria")
    assert " * /RosAria/cmd_vel [" in said
    assert " * /RosAria/pose [nav_msgs/Odometry]" in said
    assert "xmlrpc reply from" in await ros("rosnode", "ping", "-c", "1", "/RosAria")
