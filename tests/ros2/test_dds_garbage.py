"""Bytes that are no messages, numbers that are no velocities, and types that are none of ours."""

import random
import signal
import struct
import time
from collections.abc import Iterator
from functools import partial
from itertools import product
from math import inf, nan
from pathlib import Path
from typing import Any

import pytest

from pioneer3.ros.ros2.network import BackendName
from tests.e2e.processes import until
from tests.ros2.conftest import Robot, robot_on
from tests.ros2.dds_network import CMD_VEL, TWIST, Message, Program, program_on
from tests.ros2.networks import network_of

pytestmark = [pytest.mark.realtime]
INFO = "rmw_dds_common/msg/ParticipantEntitiesInfo"
LOG = "rcl_interfaces/msg/Log"
LITTLE = b"\0\1\0\0"
VELOCITY = struct.pack("<6d", 0.3, 0, 0, 0, 0, 0)
ENCAPSULATIONS = (b"\0\3\0\0", b"\0\7\0\0", b"\0\x0b\0\0", b"\1\0\0\0", b"\xff\xff\xff\xff")
HUGE_SIZE = 60_000_000
"""Length of a message [B]."""
HUGE = struct.pack("<I", 0xFFFF_FFFF)
ROUNDS = 200


def no_velocities() -> Iterator[bytes]:
    """Yield bytes that are no Twist: cut, with other encapsulations, too long, random.

    Cyclone DDS itself drops those that are too short, and says nothing.
    """
    dice = random.Random(2)
    yield from (LITTLE + VELOCITY[:length] for length in range(0, 45, 4))
    yield from (header + VELOCITY for header in ENCAPSULATIONS)
    yield LITTLE + VELOCITY * 20
    yield LITTLE + HUGE * 100
    for _ in range(ROUNDS):
        yield LITTLE + dice.randbytes(dice.choice((4, 8, 40, 44, 56, 400, 60_000)))


def no_graphs() -> Iterator[bytes]:
    """Yield bytes that are no message of the graph: as above, and with huge lengths."""
    dice = random.Random(3)
    gid = bytes(16)
    name = struct.pack("<I", 2) + b"/\0\0\0"
    yield LITTLE
    yield LITTLE + gid
    yield LITTLE + gid + HUGE
    yield LITTLE + gid + struct.pack("<I", 1) + HUGE
    yield LITTLE + gid + struct.pack("<I", 1) + name + name + HUGE + HUGE
    yield LITTLE + bytes(24) + struct.pack("<I", 1) + name + name + bytes(8)
    for _ in range(ROUNDS):
        yield LITTLE + dice.randbytes(dice.choice((4, 12, 24, 40, 200, 4000)))


def warnings_in(logs: list[Message], words: str) -> list[str]:
    return [each.fields["msg"] for each in logs if words in each.fields["msg"]]


async def heard_and_obeyed(program: Program, robot: Robot) -> None:
    """Check that the node still takes a velocity, and stands again afterwards."""
    await program.writer(CMD_VEL, TWIST, key="good")
    slow = {"linear": {"x": 0.2}}
    await program.send_until(lambda: not robot.tap.now.is_zero, "good", fields=slow)
    await program.close("good")
    await until(lambda: robot.tap.now.is_zero)


async def test_bytes_that_are_no_velocity_never_drive_and_are_told_once() -> None:
    async with (
        network_of(BackendName.DDS) as network,
        program_on(network) as program,
        robot_on(network) as robot,
    ):
        logs = await program.reader("rt/rosout", LOG, latched=True, depth=100)
        await program.writer(CMD_VEL, TWIST, depth=1000)
        refused = partial(warnings_in, logs, "are no geometry_msgs/msg/Twist")
        await program.send_until(refused, cdr=(LITTLE + VELOCITY * 2).hex())
        for cdr in no_velocities():
            program.do("send_raw", key=CMD_VEL, cdr=cdr.hex())
        await heard_and_obeyed(program, robot)
        assert all(abs(twist.v) < 0.21 and twist.w == 0 for _, twist in robot.tap.velocities)
        assert len(refused()) == 1


def highest_memory(robot: Robot) -> int:
    """Return the most memory that the node has had [B]."""
    status = Path(f"/proc/{robot.node.process.pid}/status").read_text()
    return int(status.partition("VmHWM:")[2].split()[0]) * 1024


async def test_large_messages_take_no_memory_and_are_told_and_counted() -> None:
    async with (
        network_of(BackendName.DDS) as network,
        program_on(network) as program,
        robot_on(network) as robot,
    ):
        logs = await program.reader("rt/rosout", LOG, latched=True, depth=100)
        await program.writer(CMD_VEL, TWIST, depth=1)
        before = highest_memory(robot)
        refused = partial(warnings_in, logs, "1000004 bytes, of 76 at most")
        await program.send_until(refused, cdr=LITTLE.hex(), zeros=1_000_000)
        for _ in range(8):
            program.do("send_raw", key=CMD_VEL, cdr=LITTLE.hex(), zeros=HUGE_SIZE)
        program.do("send_raw", key=CMD_VEL, cdr=LITTLE.hex(), zeros=1_000_000)
        await heard_and_obeyed(program, robot)
        await program.close(CMD_VEL)
        await until(partial(warnings_in, logs, "messages were refused"))
        assert len(refused()) == 1
        assert highest_memory(robot) - before < HUGE_SIZE
        _, errors = await robot.node.end(signal.SIGINT)
        assert "dropping oversize" in errors


async def test_bytes_that_are_no_graph_hide_nobody() -> None:
    async with (
        network_of(BackendName.DDS) as network,
        program_on(network) as program,
        robot_on(network) as robot,
        network.peer("watcher") as peer,
    ):
        await program.writer("ros_discovery_info", INFO, latched=True, depth=1000)
        await until(lambda: len(program.endpoints("ros_discovery_info", "subscription")) == 2)
        for cdr in no_graphs():
            program.do("send_raw", key="ros_discovery_info", cdr=cdr.hex())
        await until(lambda: "/pioneer3" in peer.backend.graph().nodes)
        await heard_and_obeyed(program, robot)
        await until(lambda: peer.backend.graph().nodes == ("/pioneer3", "/watcher"))
        _, errors = await robot.node.end(signal.SIGINT)
        assert errors.count("no program of ROS 2 jazzy does") == 1


async def test_numbers_that_are_not_finite_never_drive() -> None:
    async with (
        network_of(BackendName.DDS) as network,
        program_on(network) as program,
        robot_on(network) as robot,
    ):
        logs = await program.reader("rt/rosout", LOG, latched=True, depth=100)
        await program.writer(CMD_VEL, TWIST)
        ignored = partial(warnings_in, logs, "cmd_vel is ignored")
        await program.send_until(ignored, fields={"linear": {"x": nan}})
        for axis, part, number in product(("linear", "angular"), "xz", (nan, inf, -inf)):
            program.do("send", key=CMD_VEL, fields={axis: {part: number}})
        await heard_and_obeyed(program, robot)
        assert all(abs(twist.v) < 0.21 and twist.w == 0 for _, twist in robot.tap.velocities)


def stamped(age: float) -> dict[str, Any]:
    moment = time.time() - age
    stamp = {"sec": int(moment), "nanosec": int(moment % 1 * 1e9)}
    return {"header": {"stamp": stamp}, "twist": {"linear": {"x": 0.3}}}


async def test_velocities_with_an_old_stamp_never_drive() -> None:
    topic = "rt/cmd_vel_stamped"
    async with (
        network_of(BackendName.DDS) as network,
        program_on(network) as program,
        robot_on(network) as robot,
    ):
        logs = await program.reader("rt/rosout", LOG, latched=True, depth=100)
        await program.writer(topic, "geometry_msgs/msg/TwistStamped")
        old = partial(warnings_in, logs, "s old, more than cmd_vel_timeout")
        await program.send_until(old, topic, fields=stamped(10.0))
        assert all(twist.is_zero for _, twist in robot.tap.velocities)
        await program.send_until(lambda: not robot.tap.now.is_zero, topic, fields=stamped(-1.0))


async def test_a_publisher_of_another_type_is_named_with_its_node() -> None:
    """The program tells the graph of its node itself."""
    async with (
        network_of(BackendName.DDS) as network,
        program_on(network) as program,
        robot_on(network) as robot,
    ):
        logs = await program.reader("rt/rosout", LOG, latched=True, depth=100)
        reports = await program.reader("rt/diagnostics", "diagnostic_msgs/msg/DiagnosticArray")
        await program.writer("ros_discovery_info", INFO, latched=True, depth=1)
        await program.writer(CMD_VEL, "geometry_msgs/msg/TwistStamped")
        gids = [{"data": list(bytes.fromhex(program.guids[CMD_VEL]))}]
        node = {"node_namespace": "/lab", "node_name": "joystick", "writer_gid_seq": gids}
        own = {"gid": {"data": list(bytes.fromhex(program.guid))}, "node_entities_info_seq": [node]}
        program.do("send", key="ros_discovery_info", fields=own)
        sentence = "/lab/joystick on /cmd_vel sends geometry_msgs/msg/TwistStamped"
        await until(lambda: warnings_in(logs, sentence))
        await until(
            lambda: any(
                sentence in status["message"]
                for each in reports
                for status in each.fields["status"]
            )
        )
        for _ in range(20):
            program.do("send", key=CMD_VEL, fields=stamped(0.0))
        assert all(twist.is_zero for _, twist in robot.tap.velocities)
