"""What goes wrong in a lab, and what the node makes of it."""

import asyncio
import os
import signal
from contextlib import suppress
from pathlib import Path

import pytest

from pioneer3.arcos import commands
from pioneer3.geometry import STILL, Twist2
from tests.e2e.processes import free_port, running, until
from tests.ros1.conftest import Lab, laboratory
from tests.ros1.master import ended, environment_of, program, roscore, script

pytestmark = pytest.mark.realtime

FROZEN = 3.0
"""Longer than a driver waits for a report [s]."""


async def test_who_publishes_another_type_is_told_of_and_does_no_harm(lab: Lab) -> None:
    wrong = ("rostopic", "pub", "-r", "10", "/RosAria/cmd_vel", "std_msgs/Float64", "1.0")
    publishing = asyncio.create_task(ended(*wrong, patience=8.0))
    await lab.warns("/RosAria/cmd_vel is IGNORED: it must be geometry_msgs/Twist, but")
    await publishing
    assert lab.tap.now == STILL
    poses = await script("press.py", "0.2", "1.0")
    assert max(speed for _, speed, *_ in poses) > 0.05


async def test_on_ctrl_c_the_robot_is_stopped_and_told_goodbye(ros1: None) -> None:
    async with laboratory("_cmd_vel_timeout:=0") as lab:
        async with program("press.py", "0.3", "60"):
            await until(lambda: lab.tap.now == Twist2(0.3))
            code, _ = await lab.node.end(signal.SIGINT)
        assert code == 130
        assert lab.tap.now == STILL
        assert isinstance(lab.tap.heard[-1][1], commands.Close)


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGKILL, signal.SIGHUP])
async def test_without_a_timeout_a_publisher_that_leaves_stops_the_robot(
    ros1: None, how: signal.Signals
) -> None:
    async with laboratory("_cmd_vel_timeout:=0") as lab, program("press.py", "0.3", "60") as driver:
        await until(lambda: lab.tap.now == Twist2(0.3))
        await asyncio.sleep(1.0)
        assert lab.tap.now == Twist2(0.3)  # one that lives and is silent goes on, as with RosAria
        driver.process.send_signal(how)
        await lab.warns("which drove the robot by cmd_vel, is gone: the robot stops")
        await until(lambda: lab.tap.now == STILL)


async def test_a_publisher_that_pauses_stops_the_robot_and_drives_on(lab: Lab) -> None:
    command = ("rostopic", "pub", "-r", "10", "/RosAria/cmd_vel", "geometry_msgs/Twist")
    publisher = await asyncio.create_subprocess_exec(*command, "{linear: {x: 0.1}}")
    try:
        await until(lambda: not lab.tap.now.is_zero)
        await asyncio.sleep(1.0)
        publisher.send_signal(signal.SIGSTOP)
        await lab.warns("has expired: nothing came for 0.6 s, so the robot stops")
        await until(lambda: lab.tap.now.is_zero)
        publisher.send_signal(signal.SIGCONT)
        await lab.warns("comes steadily again: the robot goes on")
        await until(lambda: lab.tap.now == Twist2(0.1))
    finally:
        publisher.kill()
        await publisher.wait()


async def test_after_a_kill_the_robot_stands_and_a_new_node_takes_over(ros1: None) -> None:
    async with laboratory("_cmd_vel_timeout:=0") as lab:
        async with program("press.py", "0.3", "60"):
            await until(lambda: lab.tap.now == Twist2(0.3))
            await lab.node.end(signal.SIGKILL)
        assert lab.tap.now == Twist2(0.3)  # the last that the robot heard; its watchdog stops it
        async with running("ros1", "--port", lab.tap.url) as node:
            await node.line()
            await node.line()
            poses = await script("press.py", "0.2", "1.0")
            assert poses[0][1] == pytest.approx(0.0, abs=0.05)
            assert max(speed for _, speed, *_ in poses) > 0.05
            await node.end(signal.SIGINT)


async def test_a_subscriber_that_hangs_holds_up_nobody(lab: Lab) -> None:
    async with program("listen.py", "4", "/RosAria/pose", "/RosAria/sonar", "/nobody") as hanging:
        await until(lambda: hanging.process.returncode is None)
        await asyncio.sleep(1.0)
        hanging.process.send_signal(signal.SIGSTOP)
        poses = await script("press.py", "0.2", "2.0")
        hanging.process.send_signal(signal.SIGCONT)
    assert len(poses) > 15
    assert max(speed for _, speed, *_ in poses) > 0.05


async def test_of_a_robot_that_has_frozen_nothing_is_published(lab: Lab) -> None:
    lab.simulator.process.send_signal(signal.SIGSTOP)
    await asyncio.sleep(0.5)  # what was on its way
    frozen = await script("press.py", "0.0", str(FROZEN))
    assert frozen == []
    lab.simulator.process.send_signal(signal.SIGCONT)
    poses = await script("press.py", "0.0", "1.0")
    assert poses
    assert all(0 <= came - stamp < 1 for *_, stamp, came in poses)


async def test_a_master_that_hangs_keeps_nobody_from_stopping_the_robot(
    home: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    port = free_port()
    for name, value in environment_of(port, home).items():
        monkeypatch.setenv(name, value)
    with roscore(port, home):
        async with laboratory() as lab:
            command = ("rostopic", "pub", "-r", "10", "/RosAria/cmd_vel", "geometry_msgs/Twist")
            publisher = await asyncio.create_subprocess_exec(*command, "{linear: {x: 0.1}}")
            (master,) = processes_of(f"rosmaster --core -p {port}")
            try:
                await until(lambda: not lab.tap.now.is_zero)
                os.kill(master, signal.SIGSTOP)
                publisher.kill()
                await until(lambda: lab.tap.now.is_zero)
                await lab.warns("which drove the robot by cmd_vel, is gone")
            finally:
                os.kill(master, signal.SIGCONT)
                await publisher.wait()


def processes_of(words: str) -> list[int]:
    """Return the processes whose command lines contain `words`."""
    found = []
    for process in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):
            line = (process / "cmdline").read_bytes().replace(b"\0", b" ").decode()
            found += [int(process.name)] if words in line else []
    return found
