"""The cost of the ROS 2 node over DDS and Zenoh: latency both ways, processor and memory.

`chrt -r 1 python -m benchmarks ros2` measures it undisturbed.
"""

import asyncio
from bisect import bisect_right
from itertools import pairwise
from math import inf
from random import Random
from statistics import median

from benchmarks.ros1 import processor_seconds, resident
from benchmarks.table import Row, percentile_99
from pioneer3.ros.ros2.backend import EndpointKind, Qos
from pioneer3.ros.ros2.network import BackendName
from tests.e2e.processes import until
from tests.ros2.conftest import Robot, robot_on
from tests.ros2.foreign import environment
from tests.ros2.networks import Peer, network_of
from tests.ros2.rclpy_network import foreign_lab

COMMANDS = 200
LISTENING = 20.0
"""[s]"""
NAME = "/pioneer3"


def rows() -> list[Row]:
    """Measure everything of this file."""
    return [
        row
        for backend in (BackendName.DDS, BackendName.ZENOH)
        for row in asyncio.run(_measure(backend))
    ] + asyncio.run(_measure_rclpy())


async def _measure(backend: BackendName) -> list[Row]:
    async with (
        network_of(backend) as network,
        robot_on(network) as robot,
        network.peer() as peer,
    ):
        await until(lambda: peer.knows("/odom", EndpointKind.PUBLISHER, NAME))
        return [*await _commands(backend, robot, peer), *await _readings(backend, robot, peer)]


async def _measure_rclpy() -> list[Row]:
    """Measure commands to a node by rclpy, from a program with rclpy; where there is a ROS 2."""
    if isinstance(found := environment("jazzy"), str):
        return []
    async with foreign_lab(BackendName.RCLPY, found.distro) as lab:
        lab.peer.publish("/cmd_vel", "geometry_msgs/Twist", {}, rate=0)
        await lab.peer.graph_when(lambda graph: graph.on("/cmd_vel"))
        sent, random = lab.peer.times["/cmd_vel"], Random(1)
        for number in range(COMMANDS):
            lab.peer.do("send", topic="/cmd_vel", fields={"linear": {"x": _speed(number)}})
            await asyncio.sleep(random.uniform(0.03, 0.13))
        await until(lambda: len(sent) == COMMANDS)
        return _delays("rclpy", lab.robot, sent)


async def _commands(backend: BackendName, robot: Robot, peer: Peer) -> list[Row]:
    publisher, random = peer.publisher("/cmd_vel", "geometry_msgs/Twist"), Random(1)
    await until(lambda: publisher.matched)
    clock, sent = asyncio.get_running_loop().time, []
    for number in range(COMMANDS):
        sent.append(clock())
        publisher.write(peer.twist(_speed(number)))
        await asyncio.sleep(random.uniform(0.03, 0.13))
    return _delays(backend, robot, sent)


def _speed(number: int) -> float:
    """Return the speed of a command [m/s]: no two in turn have the same."""
    return 0.1 + number % 100 / 1000


def _delays(backend: str, robot: Robot, sent: list[float]) -> list[Row]:
    """Return the rows of commands that were sent at these times [s]."""
    delays = []
    for number, (asked, end) in enumerate(pairwise([*sent, inf])):
        wanted = _speed(number)
        found = (
            when
            for when, twist in robot.tap.velocities
            if asked < when < end and abs(twist.v - wanted) < 5e-4
        )
        if (when := next(found, None)) is not None:
            delays.append(1000 * (when - asked))
    return [
        Row(f"{backend}: commands on the wire", len(delays), "", COMMANDS, more_is_better=True),
        Row(f"{backend}: cmd_vel to velocity on the wire, median", median(delays), "ms", 2),
        Row("the same, 99th percentile", percentile_99(delays), "ms", 8),
    ]


async def _readings(backend: BackendName, robot: Robot, peer: Peer) -> list[Row]:
    odometry = peer.hear("/odom", "nav_msgs/Odometry")
    topics = [
        each
        for each in peer.backend.graph().endpoints
        if each.kind is EndpointKind.PUBLISHER and each.node == NAME and each.name != "/odom"
    ]
    for each in topics:
        latched = each.qos.transient_local
        peer.hear(each.name, each.type_name, Qos(transient_local=latched))
    await asyncio.sleep(3.0)
    pid = robot.node.process.pid
    before = processor_seconds(pid)
    await asyncio.sleep(LISTENING)
    share = (processor_seconds(pid) - before) / LISTENING
    answered = robot.tap.answered
    delays = [1000 * (at - answered[bisect_right(answered, at) - 1]) for at, _ in odometry[10:]]
    return [
        Row(f"{backend}: SIP to Odometry in a subscriber, median", median(delays), "ms", 2),
        Row(f"{backend}: processor, {len(topics) + 1} topics subscribed to", 100 * share, "%", 2.5),
        Row(f"{backend}: memory of the node", resident(pid), "MiB", 80),
    ]
