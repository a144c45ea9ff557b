"""Goals by ROS's own actionlib, seen by its own tools: what programs for move_base meet."""

import asyncio
import signal
from collections.abc import AsyncIterator
from math import hypot
from pathlib import Path

import pytest
import pytest_asyncio

from pioneer3.ros.node.navigation import SETTLED
from tests.e2e.processes import running
from tests.ros1.master import ros, script, until_said
from tests.ros1.office import ROBOT, Office

pytest.importorskip("numba")
pytest.importorskip("scipy")
pytestmark = [
    pytest.mark.realtime,
    pytest.mark.skipif(
        not all(
            (Path("/usr/lib/python3/dist-packages") / name).is_dir()
            for name in ("actionlib", "move_base_msgs")
        ),
        reason="actionlib is not installed; scripts/test installs it",
    ),
]
PLACE = "953b798c0f514ff060a53a3498ce6246"
TOPICS = {
    "/map": ("nav_msgs/OccupancyGrid", "3381f2d731d4076ec5c71b0759edbe4e", "1"),
    "/map_metadata": ("nav_msgs/MapMetaData", "10cfc8a2818024d3248802c00c95f11b", "1"),
    "/amcl_pose": ("geometry_msgs/PoseWithCovarianceStamped", PLACE, "1"),
    "/move_base/status": (
        "actionlib_msgs/GoalStatusArray",
        "8b2b82f13216d0a8ea88bd3af735e619",
        "1",
    ),
}
"""Type, md5sum and latching, as map_server, AMCL and actionlib have them."""
NODE = ("--map", "office", "_profile:=standard", "_goal_speed:=0.6")


@pytest_asyncio.fixture
async def office(ros1: None) -> AsyncIterator[Office]:
    """Run a robot in the office and its node, which knows the map."""
    async with running(*ROBOT) as simulator:
        url = (await simulator.line()).split()[-1]
        async with running("ros1", "--port", url, *NODE) as node:
            assert "Pioneer 3-AT" in await node.line()
            assert (await node.line()).startswith("node /")
            await ros("rostopic", "echo", "-n", "1", "/amcl_pose")
            yield Office(simulator, node)
            if node.process.returncode is None:
                await node.end(signal.SIGINT)


async def test_actionlibs_clients_go_to_places(office: Office) -> None:
    found = await script(
        "goals.py",
        "map 5 4 0 1 60",
        "map 3 3.1 0 1 next",
        "base_link 0.5 0 0 1 40",
        "odom 0 0 0 0 5",
        "laser 1 0 0 1 5",
        "map 3 3.1 0 1 1.5",
    )
    assert [each["state"] for each in found] == [
        "SUCCEEDED",
        "PREEMPTED",
        "SUCCEEDED",
        "ABORTED",
        "ABORTED",
        "PREEMPTED",
    ]
    texts = [each["text"] for each in found]
    assert texts[0] == "arrived"
    assert texts[1] == "another goal came"
    assert "no rotation" in texts[3]
    assert "frame laser" in texts[4]
    assert texts[5] == "cancelled"
    assert found[0]["feedbacks"] > 20


async def test_map_tree_and_place_are_those_of_map_server_and_amcl(office: Office) -> None:
    heard = await script("survey.py", "3.0", *TOPICS)
    assert {
        name: (row["type"], row["md5sum"], row["latching"]) for name, row in heard.items()
    } == TOPICS
    tree = await script("look_up.py", "1.5", "map", "base_link")
    assert tree["roots"] == ["map"]
    x, y, *_ = tree["at"]["base_link"]
    said = await ros("rostopic", "echo", "-n", "1", "/amcl_pose/pose/pose/position")
    there = dict(line.split(": ") for line in said.splitlines() if ": " in line)
    assert hypot(x - float(there["x"]), y - float(there["y"])) < 0.02
    served = await ros("rosservice", "call", "/static_map")
    assert "resolution: 0.05" in served


async def test_move_bases_services_plan_and_forget(office: Office) -> None:
    goal = "{header: {frame_id: map}, pose: {position: {x: 5, y: 4}, orientation: {w: 1}}}"
    asked = ("rosservice", "call", "/move_base/make_plan", f"{{goal: {goal}}}")
    assert (await ros(*asked)).count('frame_id: "map"') > 10
    assert "nav_msgs/GetPlan" in await ros("rosservice", "type", "/move_base/make_plan")
    assert "Empty" in await ros("rosservice", "type", "/move_base/clear_costmaps")
    await ros("rosservice", "call", "/move_base/clear_costmaps")
    assert "plan" in await ros(*asked)


async def test_a_place_is_named_by_a_tool_of_ros_and_a_cancel_stops(office: Office) -> None:
    status = ("rostopic", "echo", "-n", "1", "/move_base/status")
    latched = "publishing and latching"
    await asyncio.sleep(SETTLED)  # a latched goal that is there before the node does not drive
    async with until_said(latched, "rostopic", "pub", "/goal_name", "std_msgs/String", "Kitchen"):
        await asyncio.sleep(1.5)
        assert "on its way" in await ros(*status)
    cancel = ("rostopic", "pub", "/move_base/cancel", "actionlib_msgs/GoalID", "{}")
    async with until_said(latched, *cancel):
        await asyncio.sleep(1.0)
        assert "cancelled" in await ros(*status)
