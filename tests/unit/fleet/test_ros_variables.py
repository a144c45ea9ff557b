from dataclasses import replace
from pathlib import Path

import pytest

from pioneer3.fleet.inventory import parse_fleet
from pioneer3.fleet.ros_graph import master_of, missing_variables
from pioneer3.fleet.spec import Fleet, OperatorComputer

FLEET = """\
[operator]
name = "laptop"
address = "127.0.0.9"

[[robot]]
name = "p3at-1"
address = "127.0.0.2"
ros = "1"
"""


@pytest.fixture
def fleet() -> Fleet:
    return parse_fleet(Path("fleet.toml"), FLEET)


def test_the_master_is_at_the_operators_computer(fleet: Fleet) -> None:
    assert master_of(fleet) == "http://127.0.0.9:11311"
    assert master_of(replace(fleet, operator=OperatorComputer())) == "http://localhost:11311"
    elsewhere = replace(fleet, operator=OperatorComputer(address="fd00::9"))
    assert master_of(elsewhere) == "http://[fd00::9]:11311"


def test_variables_that_nobody_has_set_follow_from_the_file(fleet: Fleet) -> None:
    assert missing_variables(fleet, {}) == {
        "ROS_MASTER_URI": "http://127.0.0.9:11311",
        "ROS_IP": "127.0.0.1",
    }


@pytest.mark.parametrize("own", ["ROS_IP", "ROS_HOSTNAME"])
def test_what_somebody_has_set_stays(fleet: Fleet, own: str) -> None:
    mine = {"ROS_MASTER_URI": "http://elsewhere:11311", own: "me"}
    assert missing_variables(fleet, mine) == {}


def test_a_fleet_without_ros_needs_none(fleet: Fleet) -> None:
    (robot,) = fleet.robots
    assert missing_variables(replace(fleet, robots=(replace(robot, ros=""),)), {}) == {}
