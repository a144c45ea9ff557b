"""The node among others: who calls it, takes its name, or gives it the time."""

import asyncio

import pytest

from pioneer3.geometry import STILL, Twist2
from tests.e2e.processes import until
from tests.ros1.conftest import Lab, laboratory
from tests.ros1.master import ended, program, ros, script, until_said

pytestmark = pytest.mark.realtime

NAMESAKE = "import rospy; rospy.init_node('RosAria'); print('here', flush=True); rospy.spin()"
CLOCK = ("rostopic", "pub", "-l", "/clock", "rosgraph_msgs/Clock", "{clock: {secs: 1234}}")


async def test_programs_of_rospy_call_it_and_ask_about_it(lab: Lab) -> None:
    found = await script("ask.py", "/RosAria")
    assert (found["responses"], found["together"]) == (20, 8)
    assert found["set"] == {"trans_accel": 0.2, "TicksMM": 130}
    assert found["described"]["TicksMM"] == ["int", 0, 200]
    assert found["described"]["trans_accel"] == ["double", 0.0, 2.0]
    assert found["loggers"] == ["warn", "error"]
    assert ["/rosout", "o", "TCPROS", "/rosout"] in found["connections"]
    assert found["pid"] == lab.node.process.pid
    assert found["refused"] == [1, -1]


async def test_another_node_of_its_name_ends_it_and_the_robot_stands(ros1: None) -> None:
    async with laboratory("_cmd_vel_timeout:=0") as lab, program("press.py", "0.3", "60"):
        await until(lambda: lab.tap.now == Twist2(0.3))
        async with until_said("here", "/usr/bin/python3", "-c", NAMESAKE):
            code, _ = await lab.node.end()
        assert code == 0
        assert lab.tap.now == STILL


async def test_the_time_of_a_simulator_is_in_the_stamps(ros1: None) -> None:
    await ros("rosparam", "set", "/use_sim_time", "true")
    try:
        async with laboratory(), until_said("latching", *CLOCK):
            echo = ("rostopic", "echo", "/RosAria/pose/header/stamp")  # for ever: its time stands
            _, said = await ended(*echo, patience=5.0)
        assert "secs: 1233\n" in said  # the reports have come a moment ago
    finally:
        await ros("rosparam", "delete", "/use_sim_time")


async def test_warnings_are_in_the_log_of_ros(lab: Lab) -> None:
    echoing = asyncio.create_task(ended("rostopic", "echo", "/rosout", patience=5.0))
    await asyncio.sleep(1.5)
    await script("press.py", "nan", "0.5")
    said = await echoing
    assert "cmd_vel is ignored: speed must be finite" in said[1]
    assert 'name: "/RosAria"' in said[1]
