"""`pioneer3 fleet list` asks a real master, and a real node, without ROS of its own."""

from pathlib import Path

import pytest

from pioneer3.fleet.inventory import parse_fleet
from pioneer3.fleet.live import Live, Questions, SshAnswer, look_at
from pioneer3.fleet.ros_graph import NodeAddress
from tests.e2e.processes import free_port
from tests.ros1.conftest import Lab

pytestmark = pytest.mark.realtime
FLEET = """\
[[robot]]
name = "{name}"
address = "127.0.0.1"
ros = "1"
node = "{node}"
"""


async def test_node_battery_and_motors_are_told(lab: Lab, master: dict[str, str]) -> None:
    answers = [await ask(master, node) for node in ("RosAria", "RosAria_p3at_1")]
    here, elsewhere = answers
    assert here.driver == SshAnswer(True, "RosAria")
    assert here.ros == SshAnswer(True, master["ROS_MASTER_URI"].removeprefix("http://"))
    assert here.battery is not None
    assert 10 < here.battery < 14
    assert here.motors is not None
    assert elsewhere.driver == SshAnswer(False, "no node")


async def ask(master: dict[str, str], node: str) -> Live:
    fleet = parse_fleet(Path("fleet.toml"), FLEET.format(name="p3at-1", node=node))
    questions = Questions(
        masters=(NodeAddress.of(master["ROS_MASTER_URI"]),),
        addresses=fleet.addresses,
        ssh_port=free_port(),
        master_port=free_port(),
    )
    return await look_at(fleet.robots[0], questions)
