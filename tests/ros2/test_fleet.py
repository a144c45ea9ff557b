"""The fleet's commands with robots on real networks of ROS 2, beside robots at ports."""

import asyncio
import os
import signal
from contextlib import AsyncExitStack
from functools import partial
from pathlib import Path

import pytest

from pioneer3.fleet.members import Reached
from pioneer3.fleet.network import FleetNetwork
from tests.e2e.processes import running, until
from tests.ros2.conftest import Robot, robot_on
from tests.ros2.fleets import (
    EMERGENCY,
    RESET,
    UP,
    answers_of,
    at_terminal,
    driving,
    row,
    table_of,
    write_fleet,
)
from tests.ros2.networks import Peer, Ros2

pytestmark = [pytest.mark.realtime]
EXPIRY = 0.7
"""A robot whose operator is gone stands within this time [s]: a velocity lasts for 0.5 s."""
BUSY = 1.0
"""Allowance for a machine that is busy with other work [s]."""
LOST = 3.0
"""A node is sure after this time [s] that its robot is lost."""


async def driven_by(peer: Peer, number: int, robot: Robot, *, again: bool = False) -> None:
    """Drive a robot from another program, once or for ever."""
    publisher = peer.publisher(f"/r{number}/cmd_vel", "geometry_msgs/Twist")
    await until(lambda: publisher.matched)
    while again or robot.tap.now.is_zero:
        publisher.write(peer.twist(0.2))
        await asyncio.sleep(0.1)


async def test_each_robot_is_listed_with_its_state(ros2: Ros2, tmp_path: Path) -> None:
    path = write_fleet(tmp_path / "fleet.toml", (table_of(ros2),), row(1), row(2))
    words = ("fleet", "list", "--fleet", str(path))
    async with robot_on(ros2, "--namespace", "r1") as robot:
        _, answers = await answers_of(*words)
        live, missing = answers["r1"]["live"], answers["r2"]["live"]
        assert live["driver"] == {"ok": True, "said": "r1/pioneer3"}
        assert live["ros"]["ok"]
        assert 10 < live["battery"] < 14
        assert (live["motors"], live["stopped"]) == (False, False)
        assert abs(live["age"]) < BUSY
        assert missing["driver"] == {"ok": False, "said": "no node"}
        assert "no node /r2/pioneer3" in missing["ros"]["said"]
        assert "there are /r1/pioneer3" in missing["ros"]["said"]
        robot.simulator.process.kill()
        await asyncio.sleep(LOST)
        _, answers = await answers_of(*words)
    live = answers["r1"]["live"]
    assert live["driver"] == {"ok": False, "said": "silent"}
    assert (live["motors"], live["stopped"], live["age"]) == (False, True, None)


async def test_all_are_stopped_at_once_however_they_are_reached(ros2: Ros2, tmp_path: Path) -> None:
    for_ever = ("--ros-args", "-p", "cmd_vel_timeout:=0.0")
    async with AsyncExitStack() as stack:
        peer = await stack.enter_async_context(ros2.peer())
        robots = {
            number: await stack.enter_async_context(
                robot_on(ros2, "--namespace", f"r{number}", *for_ever)
            )
            for number in (1, 2)
        }
        sim = await stack.enter_async_context(running("sim", "--nomap", "--port", "0"))
        port = (await sim.line()).split()[-1]
        rows = (row(1), row(2), row(3), row(4, port=port))
        path = write_fleet(tmp_path / "fleet.toml", (table_of(ros2),), *rows)
        for number, robot in robots.items():
            await driven_by(peer, number, robot)
        code, answers = await answers_of("fleet", "stop", "--fleet", str(path), "--timeout", "6")
        assert all(robot.tap.now.is_zero for robot in robots.values())
    assert code == 1
    assert [answers[name]["ok"] for name in ("r1", "r2", "r4")] == [True] * 3, answers
    assert "no node /r3/pioneer3" in answers["r3"]["why"]
    assert not answers["r3"]["reached"]
    waited = answers["r3"]["seconds"]
    assert all(answers[name]["seconds"] < waited for name in ("r1", "r2", "r4"))


async def test_an_emergency_stop_holds_whoever_drives_until_it_is_released(
    ros2: Ros2, tmp_path: Path
) -> None:
    path = write_fleet(tmp_path / "fleet.toml", (table_of(ros2),), row(1))
    async with robot_on(ros2, "--namespace", "r1") as robot, ros2.peer() as peer:
        other = asyncio.create_task(driven_by(peer, 1, robot, again=True))
        await until(lambda: not robot.tap.now.is_zero)
        code, answers = await answers_of("fleet", "stop", "--emergency", "--fleet", str(path))
        assert (code, answers["r1"]["ok"]) == (0, True), answers
        _, answers = await answers_of("fleet", "list", "--fleet", str(path))
        live = answers["r1"]["live"]
        assert (live["stopped"], live["motors"]) == (True, False)
        assert robot.tap.now.is_zero  # the other program has gone on all the time
        other.cancel()
        async with driving(path) as person:
            await person.connected(1)
            person.press(UP)
            await until(lambda: "emergency stop is latched" in _why(person.member(1).told))
            assert robot.tap.now.is_zero
            person.press(RESET)
            await until(lambda: "emergency stop" not in _why(person.member(1).told))
            await person.drives(robot)
            person.press(EMERGENCY)
            await until(lambda: robot.tap.now.is_zero)
            person.press(UP)
        _, answers = await answers_of("fleet", "list", "--fleet", str(path))
        assert answers["r1"]["live"]["stopped"]
        assert robot.tap.now.is_zero


async def test_a_robot_that_has_fallen_silent_is_latched_all_the_same(
    ros2: Ros2, tmp_path: Path
) -> None:
    path = write_fleet(tmp_path / "fleet.toml", (table_of(ros2),), row(1))
    async with robot_on(ros2, "--namespace", "r1") as robot, ros2.peer() as peer:
        simulator = robot.simulator.process.pid
        os.kill(simulator, signal.SIGSTOP)
        await asyncio.sleep(LOST)
        try:
            code, answers = await answers_of("fleet", "stop", "--emergency", "--fleet", str(path))
        finally:
            os.kill(simulator, signal.SIGCONT)
        assert (code, answers["r1"]["reached"], answers["r1"]["ok"]) == (1, True, False), answers
        assert "has it lost its robot?" in answers["r1"]["why"]
        poses = peer.hear("/r1/odom", "nav_msgs/Odometry")
        await until(lambda: len(poses) > 2)
        other = asyncio.create_task(driven_by(peer, 1, robot, again=True))
        await asyncio.sleep(1)
        other.cancel()
        _, answers = await answers_of("fleet", "list", "--fleet", str(path))
        assert answers["r1"]["live"]["stopped"]
        assert robot.tap.now.is_zero


async def test_robots_of_one_name_are_stopped_and_told_and_not_driven(
    ros2: Ros2, tmp_path: Path
) -> None:
    path = write_fleet(tmp_path / "fleet.toml", (table_of(ros2),), row(1))
    for_ever = ("--namespace", "r1", "--ros-args", "-p", "cmd_vel_timeout:=0.0")
    async with (
        robot_on(ros2, *for_ever) as one,
        robot_on(ros2, *for_ever) as two,
        ros2.peer() as peer,
    ):
        await driven_by(peer, 1, one)
        await driven_by(peer, 1, two)
        code, answers = await answers_of("fleet", "stop", "--fleet", str(path))
        assert (code, answers["r1"]["reached"]) == (1, True), answers
        assert "2 nodes are called /r1/pioneer3" in answers["r1"]["why"]
        assert one.tap.now.is_zero
        assert two.tap.now.is_zero
        _, answers = await answers_of("fleet", "list", "--fleet", str(path))
        assert answers["r1"]["live"]["driver"] == {"ok": False, "said": "2 nodes"}
        async with driving(path) as person:
            await until(lambda: person.member(1).reached is Reached.REFUSED)
            assert "2 nodes are called" in person.member(1).why


def _why(told: object) -> str:
    return str(getattr(told, "stands", "") or "")


async def test_a_robot_that_is_lost_stands_and_the_others_go_on(ros2: Ros2, tmp_path: Path) -> None:
    async with AsyncExitStack() as stack:
        robots = [
            await stack.enter_async_context(robot_on(ros2, "--namespace", f"r{number}"))
            for number in (1, 2)
        ]
        sim = await stack.enter_async_context(running("sim", "--nomap", "--port", "0"))
        port = (await sim.line()).split()[-1]
        rows = (row(1), row(2), row(3, port=port))
        path = write_fleet(tmp_path / "fleet.toml", (table_of(ros2),), *rows)
        person = await stack.enter_async_context(driving(path))
        await person.connected(1, 2, 3)
        person.press("a", UP)
        await until(lambda: not any(robot.tap.now.is_zero for robot in robots))
        os.kill(robots[0].node.process.pid, signal.SIGSTOP)
        await until(lambda: person.member(1).reached is Reached.LOST)
        assert "silent" in person.member(1).why
        changes = len(robots[1].tap.velocities)
        told = person.member(3).told
        assert told is not None
        assert told.speed > 0.1
        os.kill(robots[0].node.process.pid, signal.SIGCONT)
        await until(lambda: robots[0].tap.now.is_zero)  # the commands on the way are old
        await person.connected(1)
        assert len(robots[1].tap.velocities) == changes
        assert robots[0].tap.now.is_zero
        await person.drives(robots[0])
        person.press(" ")
        await until(lambda: all(robot.tap.now.is_zero for robot in robots))


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM])
async def test_all_stand_whichever_way_the_program_ends(
    ros2: Ros2, tmp_path: Path, number: signal.Signals
) -> None:
    path = write_fleet(tmp_path / "fleet.toml", (table_of(ros2),), row(1))
    async with robot_on(ros2, "--namespace", "r1") as robot:
        words = ("fleet", "drive", "--fleet", str(path), "--latch")
        async with at_terminal(*words) as screen:
            await screen.sees(b"1 connected")
            screen.type(UP)
            await until(lambda: not robot.tap.now.is_zero)
            screen.process.send_signal(number)
            assert await until(lambda: robot.tap.now.is_zero) < EXPIRY + BUSY
            await screen.process.wait()


async def test_a_network_that_cannot_be_joined_delays_no_other_one(
    ros2: Ros2, tmp_path: Path
) -> None:
    for name in ("ca.pem", "laptop.pem", "laptop.key"):
        (tmp_path / name).write_text("not read")
        (tmp_path / name).chmod(0o644)
    far = FleetNetwork(
        name="far",
        backend="zenoh",
        connect=("tls/localhost:1",),
        ca="ca.pem",
        certificate="laptop.pem",
        key="laptop.key",
    )
    rows = (row(1), row(2, network="far"))
    path = write_fleet(tmp_path / "fleet.toml", (table_of(ros2), far), *rows)
    async with robot_on(ros2, "--namespace", "r1"):
        code, answers = await answers_of("fleet", "stop", "--fleet", str(path))
    assert (code, answers["r1"]["ok"], answers["r2"]["reached"]) == (1, True, False)
    assert f"others may read it: chmod 600 {tmp_path / 'laptop.key'}" in answers["r2"]["why"]


async def test_endpoints_of_one_type_are_made_in_many_threads_at_once(ros2: Ros2) -> None:
    async with ros2.peer() as peer, ros2.peer("other") as other:
        names = [f"/r{number}/odom" for number in range(24)]
        await asyncio.gather(
            *(asyncio.to_thread(peer.publisher, name, "nav_msgs/Odometry") for name in names)
        )
        for name in names:
            await until(partial(other.endpoint, name))
