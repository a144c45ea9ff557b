"""Quality of service over DDS, beside a program that has none of this project's code."""

import asyncio
from itertools import product
from typing import Any

import pytest

from pioneer3.ros.ros2.backend import LATCHED, EndpointKind, Qos
from pioneer3.ros.ros2.mismatches import Own, OwnKey, mismatches
from pioneer3.ros.ros2.network import BackendName
from tests.e2e.processes import until
from tests.ros2.conftest import robot_on
from tests.ros2.dds_network import CMD_VEL, TWIST, Message, Program, program_on
from tests.ros2.networks import network_of

pytestmark = [pytest.mark.realtime]
STRING = "std_msgs/msg/String"
GRID = "nav_msgs/msg/OccupancyGrid"
PARTS = [(reliable, latched) for reliable in (True, False) for latched in (True, False)]
CELLS = 1_000_000


def fits(publisher: tuple[bool, bool], subscriber: tuple[bool, bool]) -> bool:
    """Return whether the publisher offers all that the subscriber asks for."""
    return all(offered >= asked for offered, asked in zip(publisher, subscriber, strict=True))


def name(kind: str, own: tuple[bool, bool], other: tuple[bool, bool]) -> str:
    return f"{kind}_{'_'.join(str(int(part)) for part in (*own, *other))}"


def qos(parts: tuple[bool, bool]) -> dict[str, Any]:
    return {"reliable": parts[0], "latched": parts[1]}


def own_qos(parts: tuple[bool, bool]) -> Qos:
    return Qos(reliable=parts[0], transient_local=parts[1])


async def test_what_fits_is_delivered_and_what_does_not_is_named() -> None:
    """All sixteen combinations of reliability and durability, each way."""
    every = list(product(PARTS, PARTS))
    async with (
        network_of(BackendName.DDS) as network,
        program_on(network) as program,
        network.peer("ours") as peer,
    ):
        text = peer.types.make("std_msgs/String")
        text.data = "hello"
        hello = peer.types.encode(text)
        type_ = peer.types.message_type("std_msgs/String")
        own: dict[OwnKey, Own] = {}
        heard, writers, readers = {}, {}, {}
        for ours, theirs in every:
            out, back = name("out", ours, theirs), name("back", ours, theirs)
            own[EndpointKind.PUBLISHER, f"/{out}"] = Own(
                EndpointKind.PUBLISHER, type_, own_qos(ours)
            )
            own[EndpointKind.SUBSCRIBER, f"/{back}"] = Own(
                EndpointKind.SUBSCRIBER, type_, own_qos(ours)
            )
            writers[out] = peer.publisher(f"/{out}", "std_msgs/String", own_qos(ours))
            readers[out] = await program.reader(f"rt/{out}", STRING, **qos(theirs))
            heard[back] = peer.hear(f"/{back}", "std_msgs/String", own_qos(ours))
            await program.writer(f"rt/{back}", STRING, **qos(theirs))
        fitting = [pair for pair in every if fits(*pair)]
        answered = [pair for pair in every if fits(pair[1], pair[0])]

        def all_there() -> bool:
            for ours, theirs in every:
                writers[name("out", ours, theirs)].write(hello)
                key = f"rt/{name('back', ours, theirs)}"
                program.do("send", key=key, fields={"data": "hello"})
            return all(readers[name("out", *pair)] for pair in fitting) and all(
                heard[name("back", *pair)] for pair in answered
            )

        await until(all_there)
        for pair in every:
            assert bool(readers[name("out", *pair)]) is fits(*pair), pair
            assert bool(heard[name("back", *pair)]) is fits(pair[1], pair[0]), pair
        told = "\n".join(mismatches(own, peer.backend.graph(), "/ours", strict=True))
        for ours, theirs in every:
            assert (f"/{name('out', ours, theirs)} " in told) is not fits(ours, theirs)
            assert (f"/{name('back', ours, theirs)} " in told) is not fits(theirs, ours)


async def test_a_deadline_that_nobody_keeps_is_named() -> None:
    async with (
        network_of(BackendName.DDS) as network,
        program_on(network) as program,
        robot_on(network),
    ):
        odometry = await program.reader("rt/odom", "nav_msgs/msg/Odometry", deadline=0.2)
        logs = await program.reader("rt/rosout", "rcl_interfaces/msg/Log", latched=True)
        await until(lambda: any("deadline" in message.fields["msg"] for message in logs))
        assert odometry == []


async def test_the_nodes_own_topics_are_named_in_log_and_diagnostics() -> None:
    """Of a reader that wants more than is offered, and of a best effort publisher."""
    wanted = {
        "/cmd_vel and this node do not match: the publisher is best effort",
        "/odom and this node do not match: the publisher is volatile",
        "on /scan expects std_msgs/msg/Empty",
    }
    async with (
        network_of(BackendName.DDS) as network,
        program_on(network) as program,
        robot_on(network) as robot,
    ):
        logs = await program.reader("rt/rosout", "rcl_interfaces/msg/Log", latched=True, depth=100)
        reports = await program.reader("rt/diagnostics", "diagnostic_msgs/msg/DiagnosticArray")
        await program.writer(CMD_VEL, TWIST, reliable=False)
        odometry = await program.reader("rt/odom", "nav_msgs/msg/Odometry", latched=True)
        await program.reader("rt/scan", "std_msgs/msg/Empty")

        def said(sentence: str) -> bool:
            return sentence in topics_part(reports) and any(
                sentence in message.fields["msg"] for message in logs
            )

        await until(lambda: all(said(sentence) for sentence in wanted))
        await program.drive(0.3, 0.5)
        assert all(twist.is_zero for _, twist in robot.tap.velocities)
        assert odometry == []
        await program.close(CMD_VEL)
        await until(lambda: "best effort" not in topics_part(reports[-1:]))


def topics_part(reports: list[Message]) -> str:
    """Return the diagnosis of topics in reports."""
    statuses = [status for report in reports for status in report.fields["status"]]
    return "\n".join(each["message"] for each in statuses if each["name"].endswith("Topics"))


async def grids(program: Program) -> None:
    await program.writer("rt/map", GRID, latched=True, depth=1)
    program.do("send", key="rt/map", fields={}, fill=CELLS)


async def test_late_joiners_get_what_is_latched() -> None:
    async with network_of(BackendName.DDS) as network, robot_on(network):
        await asyncio.sleep(1.0)
        async with program_on(network) as program:
            fixed = await program.reader("rt/tf_static", "tf2_msgs/msg/TFMessage", latched=True)
            urdf = await program.reader("rt/robot_description", STRING, latched=True)
            motors = await program.reader("rt/motors_state", "std_msgs/msg/Bool", latched=True)
            await until(lambda: fixed and urdf and motors)
            frames = [each["child_frame_id"] for each in fixed[0].fields["transforms"]]
            assert "sonar_0" in frames
            assert len(fixed) == len(urdf) == 1


async def test_a_large_map_reaches_late_joiners_whole_each_way() -> None:
    """1 MB in fragments, larger than the buffers of sockets."""
    async with (
        network_of(BackendName.DDS) as network,
        program_on(network) as program,
        network.peer("ours") as peer,
    ):
        await grids(program)
        message = peer.types.make("nav_msgs/OccupancyGrid")
        message.data = bytes(number % 101 for number in range(CELLS))
        publisher = peer.publisher("/own_map", "nav_msgs/OccupancyGrid", LATCHED)
        publisher.write(peer.types.encode(message))
        await asyncio.sleep(0.5)
        maps = peer.hear("/map", "nav_msgs/OccupancyGrid", LATCHED)
        own = await program.reader("rt/own_map", GRID, latched=True, depth=1)
        await until(lambda: maps and own)
        assert bytes(maps[0][1].data.view("uint8")) == message.data
        assert own[0].fields["data"]["length"] == CELLS
        async with program_on(network) as late:
            theirs = await late.reader("rt/own_map", GRID, latched=True, depth=1)
            await until(lambda: theirs)
            assert theirs[0].fields["data"] == own[0].fields["data"]


async def test_messages_older_than_their_lifespan_reach_no_late_subscriber() -> None:
    async with (
        network_of(BackendName.DDS) as network,
        network.peer("ours") as ours,
        network.peer("late") as late,
    ):
        type_ = ours.types.message_type(STRING)
        hello = ours.types.encode(ours.types.make(STRING))
        kept = ours.backend.advertise("/kept", type_, LATCHED)
        logs = ours.backend.advertise("/logs", type_, Qos(transient_local=True, lifespan=0.2))
        for writer in (kept, logs):
            writer.write(hello)
        await asyncio.sleep(0.5)
        of_kept, of_logs = (late.hear(name, STRING, LATCHED) for name in ("/kept", "/logs"))
        await until(lambda: bool(of_kept) and logs.matched)
        logs.write(hello)
        await until(lambda: bool(of_logs))
        assert (len(of_kept), len(of_logs)) == (1, 1)
        found = [each for each in late.backend.graph().endpoints if each.name == "/logs"]
        assert {each.kind: each.qos.lifespan for each in found}[EndpointKind.PUBLISHER] == 0.2
