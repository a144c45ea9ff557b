"""Several robots in one DDS domain, and subscribers that stall."""

import asyncio
import time
from contextlib import AsyncExitStack
from functools import partial
from itertools import pairwise
from pathlib import Path

import pytest

from pioneer3.ros.ros2.network import BackendName
from tests.e2e.processes import until
from tests.ros2.conftest import Robot, robot_on
from tests.ros2.dds_network import TWIST, Message, program_on
from tests.ros2.networks import Ros2, network_of

pytestmark = [pytest.mark.realtime]
OWN_TREES = ("robot1", "robot2", "robot3")
"""Namespaces of robots with a tree of frames each."""
ONE_TREE = ("robot4", "robot5")
"""Namespaces of robots with prefixes in one tree."""
ROBOTS = (*OWN_TREES, *ONE_TREE)
TF = "tf2_msgs/msg/TFMessage"
ODOMETRY = "nav_msgs/msg/Odometry"
STALLED = 4.0
LONGEST_GAP = 2.0
"""Between two odometry messages beside a stalled subscriber [s]; 0.1 on an idle machine."""
MEGABYTES = 32


async def five_on(network: Ros2, stack: AsyncExitStack) -> dict[str, Robot]:
    """Run five robots, the last two with prefixes in their frames."""

    async def one(name: str) -> Robot:
        prefix = ("--ros-args", "-p", f"frame_prefix:={name}/") if name in ONE_TREE else ()
        return await stack.enter_async_context(robot_on(network, "--namespace", name, *prefix))

    return dict(zip(ROBOTS, await asyncio.gather(*map(one, ROBOTS)), strict=True))


def moves(robot: Robot) -> bool:
    return not robot.tap.now.is_zero


def stands(robot: Robot) -> bool:
    return robot.tap.now.is_zero


def frames(messages: list[Message]) -> set[tuple[str, str]]:
    return {
        (each["header"]["frame_id"], each["child_frame_id"])
        for message in messages
        for each in message.fields["transforms"]
    }


async def test_five_robots_on_one_domain_do_not_disturb_each_other() -> None:
    async with AsyncExitStack() as stack:
        network = await stack.enter_async_context(network_of(BackendName.DDS))
        elsewhere = await stack.enter_async_context(network_of(BackendName.DDS))
        robots = await five_on(network, stack)
        program = await stack.enter_async_context(program_on(network))
        beyond = await stack.enter_async_context(program_on(elsewhere))
        watcher = await stack.enter_async_context(network.peer("watcher"))
        odometry, trees = {}, {}
        for name in ROBOTS:
            odometry[name] = await program.reader(f"rt/{name}/odom", ODOMETRY)
            trees[name] = await program.reader(f"rt/{name}/tf", TF)
            await program.writer(f"rt/{name}/cmd_vel", TWIST)
        shared = await program.reader("rt/tf", TF)
        await until(lambda: all(odometry.values()) and len(shared) > 20)
        nodes = ("/watcher", *(f"/{name}/pioneer3" for name in ROBOTS))
        await until(lambda: watcher.backend.graph().nodes == tuple(sorted(nodes)))

        for name in ROBOTS:
            moving = robots[name]
            before = {other: len(robots[other].tap.velocities) for other in ROBOTS}
            slow = {"linear": {"x": 0.2}}
            await program.send_until(partial(moves, moving), f"rt/{name}/cmd_vel", fields=slow)
            await until(partial(stands, moving))
            after = {other: len(robots[other].tap.velocities) for other in ROBOTS}
            assert {other for other in ROBOTS if after[other] != before[other]} == {name}

        for name in OWN_TREES:
            assert ("odom", "base_footprint") in frames(trees[name])
            assert not any("robot" in frame for pair in frames(trees[name]) for frame in pair)
        for name in ONE_TREE:
            assert trees[name] == []
            assert (f"{name}/odom", f"{name}/base_footprint") in frames(shared)
        assert {frame.split("/")[0] for pair in frames(shared) for frame in pair} == set(ONE_TREE)
        assert all(len({m.fields["child_frame_id"] for m in odometry[n]}) == 1 for n in ROBOTS)

        by_node: dict[str, set[str]] = {}
        for each in watcher.backend.graph().endpoints:
            by_node.setdefault(each.node, set()).add(f"{each.kind} {each.name}")
        sizes = {len(by_node[f"/{name}/pioneer3"]) for name in ROBOTS}
        assert len(sizes) == 1
        for name in ROBOTS:
            own = by_node[f"/{name}/pioneer3"]
            assert {f"publisher /{name}/odom", f"subscriber /{name}/cmd_vel"} <= own
        assert not [each for each in beyond.found.values() if "odom" in each.get("topic", "")]


async def test_five_participants_know_all_of_each_other() -> None:
    async with AsyncExitStack() as stack:
        network = await stack.enter_async_context(network_of(BackendName.DDS))
        peers = [
            await stack.enter_async_context(network.peer(f"peer{number}")) for number in range(5)
        ]
        for number, peer in enumerate(peers):
            peer.publisher(f"/chat{number}", "std_msgs/String")

        def complete() -> bool:
            return all(
                each.backend.graph().nodes == tuple(f"/peer{number}" for number in range(5))
                and all(
                    (found := each.endpoint(f"/chat{number}")) and found.node == f"/peer{number}"
                    for number in range(5)
                )
                for each in peers
            )

        await until(complete)


def memory(process: int) -> float:
    """Return the resident memory of a process [MB]."""
    lines = Path(f"/proc/{process}/status").read_text().splitlines()
    return next(int(line.split()[1]) / 1024 for line in lines if line.startswith("VmRSS"))


async def test_a_stalled_subscriber_holds_up_neither_node_nor_others() -> None:
    """It asks for all, reliably, and takes nothing."""
    topics = {"rt/odom": ODOMETRY, "rt/tf": TF, "rt/rosout": "rcl_interfaces/msg/Log"}
    async with (
        network_of(BackendName.DDS) as network,
        program_on(network) as stalled,
        program_on(network) as other,
        robot_on(network) as robot,
    ):
        heard = {}
        for topic, type_name in topics.items():
            heard[topic] = await stalled.reader(topic, type_name, depth=1000)
        odometry = await other.reader("rt/odom", ODOMETRY)
        await other.writer("rt/cmd_vel", TWIST)
        await until(lambda: heard["rt/odom"] and odometry)
        stalled.stall()
        before, began = memory(robot.node.process.pid), time.monotonic()
        await until(lambda: time.monotonic() - began > STALLED)
        times = [message.at for message in odometry if message.at > began]
        gaps = [later - at for at, later in pairwise(times)]
        assert len(times) > 5 * STALLED
        assert max(gaps) < LONGEST_GAP
        slow = {"linear": {"x": 0.2}}
        await other.send_until(partial(moves, robot), "rt/cmd_vel", fields=slow)
        await until(partial(stands, robot))
        assert memory(robot.node.process.pid) - before < MEGABYTES
        count = len(heard["rt/odom"])
        stalled.resume()
        await until(lambda: len(heard["rt/odom"]) > count + 5)


async def test_large_messages_go_on_beside_a_stalled_subscriber() -> None:
    grid, cells = "nav_msgs/OccupancyGrid", 300_000
    async with (
        network_of(BackendName.DDS) as network,
        program_on(network) as stalled,
        program_on(network) as other,
        network.peer("ours") as peer,
    ):
        publisher = peer.publisher("/map", grid)
        message = peer.types.make(grid)
        message.data = bytes(cells)
        cdr = peer.types.encode(message)
        there = [
            await each.reader("rt/map", "nav_msgs/msg/OccupancyGrid") for each in (stalled, other)
        ]

        def arrived() -> bool:
            publisher.write(cdr)
            return all(there)

        await until(arrived)
        stalled.stall()
        longest, before = 0.0, len(there[1])
        for _ in range(40):
            began = time.monotonic()
            publisher.write(cdr)
            longest = max(longest, time.monotonic() - began)
            await asyncio.sleep(0.05)
        assert longest < LONGEST_GAP
        await until(lambda: len(there[1]) > before + 30)
