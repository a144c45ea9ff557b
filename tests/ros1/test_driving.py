"""Commands by topic, and every way in which they end."""

import asyncio
import signal
from contextlib import AsyncExitStack
from pathlib import Path

import pytest

from pioneer3.cli.ros1 import ros1 as ros1_command
from pioneer3.geometry import Twist2
from pioneer3.ros.tcpros.node import LOOK
from tests.e2e.processes import PATIENCE, free_port, running, until
from tests.ros1.conftest import Lab, laboratory, simulated
from tests.ros1.master import ended, environment_of, ros, roscore, script

pytestmark = pytest.mark.realtime

POSE = ("rostopic", "echo", "-n", "1", "/RosAria/pose/pose/pose/position/x")


async def test_one_message_moves_the_robot_for_the_timeout_only(lab: Lab) -> None:
    poses = await script("press.py", "0.3", "3.0")
    assert max(speed for _, speed, *_ in poses) > 0.1
    assert poses[-1][1] == 0.0
    assert 0.05 < poses[-1][0] < 0.4


async def test_without_a_timeout_one_message_keeps_it_moving(ros1: None) -> None:
    async with laboratory("_cmd_vel_timeout:=0") as lab:
        poses = await script("press.py", "0.1", "3.0")
        assert poses[-1][1] == pytest.approx(0.1, abs=0.01)
        assert "UNSAFE" in await said_on_leaving(lab)
        known = await ros("rosparam", "list")
        assert "/RosAria/cmd_vel_timeout" not in known  # or the next one had it too


async def test_what_is_no_number_moves_nothing_and_is_told(lab: Lab) -> None:
    poses = await script("press.py", "nan", "1.0")
    assert {(x, speed) for x, speed, *_ in poses} == {(0.0, 0.0)}
    assert "cmd_vel is ignored: speed must be finite" in await said_on_leaving(lab)


async def test_a_pose_is_stamped_when_it_came_in(lab: Lab) -> None:
    poses = await script("press.py", "0.0", "2.0")
    stamps = [stamp for _, _, stamp, _ in poses]
    assert stamps == sorted(set(stamps))
    assert all(0 <= came - stamp < 1 for _, _, stamp, came in poses)


async def test_nothing_is_published_of_a_robot_that_has_gone(ros1: None) -> None:
    port = free_port()
    async with laboratory(sim_port=port) as lab:
        await lab.simulator.end(signal.SIGINT)
        await lab.warns("LOST THE ROBOT")
        said = await ros("rostopic", "echo", "-n", "1", "/RosAria/battery_recharge_state")
        assert "data: -1" in said
        _, silence = await ended(*POSE, patience=3.0)
        assert "---" not in silence
        async with simulated(port):
            await lab.warns("connected again")
            assert "---" in await ros(*POSE)


async def test_an_address_of_another_computer_is_told_at_the_start(
    ros1: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROS_IP", "192.0.2.77")
    async with simulated() as (_, url), running("ros1", "--port", url) as node:
        said = await node.line()
        assert said.startswith("WARN ROS_IP=192.0.2.77: this computer does not have that address")
        assert "export ROS_IP=" in said
        await node.line()
        await node.line()
        await node.end(signal.SIGINT)


async def test_an_address_of_no_master_ends_the_start(
    ros1: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROS_MASTER_URI", "localhost:11311")
    async with running("ros1") as node:
        code, said = await node.end()
    assert code != 0
    assert "export ROS_MASTER_URI=http://localhost:11311" in said


async def test_a_remapping_works_as_the_help_prints_it(ros1: None) -> None:
    rule = "~cmd_vel:=/teleop/cmd_vel"
    assert f"'{rule}'" in str(ros1_command.__doc__)
    async with laboratory(rule) as lab:
        drive = ("rostopic", "pub", "-r", "10", "/teleop/cmd_vel", "geometry_msgs/Twist")
        publishing = asyncio.create_task(ended(*drive, "{linear: {x: 0.2}}", patience=3.0))
        await until(lambda: lab.tap.now == Twist2(0.2))
        await publishing


async def test_a_remapping_of_no_name_is_told_with_the_right_one(ros1: None) -> None:
    async with laboratory("cmd_vel:=/teleop/cmd_vel") as lab:
        await lab.warns("there is no /cmd_vel here; did you mean '~cmd_vel:=/teleop/cmd_vel'?")


async def test_in_a_namespace_a_name_is_remapped_once(ros1: None) -> None:
    rules = [
        *("cmd_vel:=/cmd_vel", "/cmd_vel:=/twice"),
        *("odom:=/odom", "/odom:=/twice_odom"),
        *("e_stop_trigger:=/halt", "/halt:=/twice_halt"),
    ]
    async with laboratory("__ns:=/r1", "_profile:=standard", *rules):
        said = await ros("rosnode", "info", "/r1/RosAria")
        assert {"/cmd_vel", "/odom", "/halt"} <= set(said.split())
        assert "/twice" not in said


async def test_a_new_master_is_registered_with(home: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    port = free_port()
    for name, value in environment_of(port, home).items():
        monkeypatch.setenv(name, value)
    with roscore(port, home):
        stack = AsyncExitStack()
        lab = await stack.enter_async_context(laboratory())
        setting = "{config: {ints: [{name: TicksMM, value: 128}]}}"
        await ros("rosservice", "call", "/RosAria/set_parameters", setting)
        await asyncio.sleep(LOOK + 1)  # so that it knows its parameters
    async with stack:
        await lab.warns("ROS MASTER LOST")
        with roscore(port, home):
            await lab.warns("the ROS master is back")  # or the old one, which took its time
            await listed("/robot_description", "rosparam")  # comes last
            assert "/RosAria/cmd_vel" in await ros("rostopic", "list")
            assert (await ros("rosparam", "get", "/RosAria/TicksMM")).strip() == "128"
            poses = await script("press.py", "0.3", "2.0")
            assert poses[-1][0] > 0.05
            assert "/RosAria/enable_motors" in await ros("rosservice", "list")
            assert "Traceback" not in await said_on_leaving(lab)


async def test_a_node_that_is_killed_by_name_ends(lab: Lab) -> None:
    await ros("rosnode", "kill", "/RosAria")
    code, _ = await lab.node.end()
    assert code == 0
    assert "/RosAria" not in (await ros("rosnode", "list")).split()


async def test_on_leaving_nothing_stays_on_the_parameter_server(lab: Lab) -> None:
    setting = "{config: {ints: [{name: TicksMM, value: 128}]}}"
    await ros("rosservice", "call", "/RosAria/set_parameters", setting)
    assert (await ros("rosparam", "get", "/RosAria/TicksMM")).strip() == "128"
    code, _ = await lab.node.end(signal.SIGINT)
    assert code == 130
    assert "/RosAria/" not in await ros("rosparam", "list")


async def test_a_parameter_of_a_laser_leaves_no_empty_folder(ros1: None) -> None:
    async with laboratory("_laser/angle_min:=-1.0") as lab:
        assert (await ros("rosparam", "get", "/RosAria/laser")).strip() == "angle_min: -1.0"
        await lab.node.end(signal.SIGINT)
        assert "RosAria" not in await ros("rosparam", "get", "/")


async def listed(name: str, tool: str) -> None:
    """Wait until one of ROS's tools lists `name`."""
    async with asyncio.timeout(PATIENCE):
        while name not in (await ros(tool, "list")).split():
            pass


async def said_on_leaving(lab: Lab) -> str:
    """End the node; return what it has said of its troubles since."""
    _, said = await lab.node.end(signal.SIGINT)
    return said
