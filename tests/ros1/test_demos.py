"""The demos as nodes of their own, which know the robot by its topics only."""

import asyncio
import json
import signal
from collections.abc import AsyncIterator
from contextlib import AsyncExitStack
from pathlib import Path

import pytest
import pytest_asyncio

from pioneer3.geometry import STILL, Twist2
from tests.e2e.processes import p3, running, until
from tests.ros1.conftest import Lab, laboratory
from tests.ros1.master import program, ros
from tests.ros1.terminal import terminal

pytestmark = [pytest.mark.realtime, pytest.mark.asyncio(loop_scope="module")]

LEFT, RIGHT = "p3at_0_119", "p3at_1_113"
UP, DOWN = b"\x1b[A", b"\x1b[B"


@pytest_asyncio.fixture(scope="module", loop_scope="module")
async def labs(ros1: None) -> AsyncIterator[list[Lab]]:
    """Run two robots of the lab and their nodes."""
    async with AsyncExitStack() as stack:
        names = (f"_lab_name:={name}" for name in (LEFT, RIGHT))
        yield [await stack.enter_async_context(laboratory(name)) for name in names]


async def test_the_robots_are_listed(labs: list[Lab]) -> None:
    listed = await asyncio.to_thread(p3, "ros1", "robots", "--json")
    found = json.loads(listed.stdout)
    assert [robot["node"] for robot in found] == [f"/RosAria_{LEFT}", f"/RosAria_{RIGHT}"]
    assert found[0]["commands"] == f"/RosAria_{LEFT}/cmd_vel"
    assert found[0]["published"][f"/RosAria_{LEFT}/sonar"] == "sensor_msgs/PointCloud"


async def test_who_does_not_say_which_robot_is_told_the_choice(labs: list[Lab]) -> None:
    done = await asyncio.to_thread(p3, "ros1", "wander")
    assert done.returncode == 2
    assert f"say which with --robot; RosAria_{LEFT}, RosAria_{RIGHT}" in done.stderr
    done = await asyncio.to_thread(p3, "ros1", "follow", "--robot", "nobody")
    assert done.returncode == 3
    assert f"no robot is called 'nobody' on this ROS graph, but RosAria_{LEFT}" in done.stderr


async def test_a_demo_drives_only_its_robot_and_stops_it_on_ctrl_c(labs: list[Lab]) -> None:
    async with running("ros1", "wander", "--robot", RIGHT) as wander:
        assert (await wander.line()).startswith("SIMULATOR: Pioneer 3-AT on /RosAria_p3at_1_113 ")
        await until(lambda: labs[1].tap.now == Twist2(0.15))
        code, _ = await wander.end(signal.SIGINT)
    assert code == 130
    await until(lambda: labs[1].tap.now == STILL)
    assert labs[0].tap.now == STILL


async def test_a_demo_that_is_killed_leaves_a_robot_that_stops(labs: list[Lab]) -> None:
    async with running("ros1", "wander", "--robot", RIGHT) as wander:
        await until(lambda: labs[1].tap.now == Twist2(0.15))
        await wander.end(signal.SIGKILL)
    await until(lambda: labs[1].tap.now == STILL)


async def test_a_demo_that_is_shut_down_by_name_stops_its_robot(labs: list[Lab]) -> None:
    async with running("ros1", "wander", "--robot", RIGHT) as wander:
        await until(lambda: labs[1].tap.now == Twist2(0.15))
        await ros("rosnode", "kill", f"/wander_RosAria_{RIGHT}")
        code, _ = await wander.end()
        assert code == 0
    await until(lambda: labs[1].tap.now == STILL)


async def test_follow_looks_for_somebody_and_says_so(labs: list[Lab]) -> None:
    options = ("--robot", RIGHT, "--seconds", "2", "--json")
    done = await asyncio.to_thread(p3, "ros1", "follow", *options)
    assert done.returncode == 0, done.stderr
    lines = [json.loads(line) for line in done.stdout.splitlines()]
    assert len(lines) > 10
    assert lines[-1]["mode"] == "follow"
    assert "looks for somebody" in lines[-1]["decided"][0]
    assert len(lines[-1]["snapshot"]["sonar"]["ranges"]) == 16


async def test_sonars_are_shown_from_afar(labs: list[Lab]) -> None:
    done = await asyncio.to_thread(p3, "ros1", "p3_sonar", "--robot", RIGHT, "--seconds", "1")
    head, *rows = done.stdout.splitlines()
    assert head.split() == list("01234567")
    assert rows
    assert set(rows[-1].split()) == {"-"}  # nothing is near


async def test_one_key_press_drives_until_the_next(labs: list[Lab]) -> None:
    async with terminal("ros1", "rob_key", "--robot", LEFT) as the:
        await the.shows(b"q: quit")
        the.type(UP)
        await until(lambda: labs[0].tap.now == Twist2(0.5))
        await asyncio.sleep(1.5)
        assert labs[0].tap.now == Twist2(0.5)
        the.type(b" ")
        await until(lambda: labs[0].tap.now == STILL)
        the.type(DOWN)
        await until(lambda: labs[0].tap.now == Twist2(-0.5))
        the.type(b"q")
        assert await the.code() == 0
    await until(lambda: labs[0].tap.now == STILL)


async def test_one_keyboard_drives_several_robots_one_by_one_or_all(labs: list[Lab]) -> None:
    def doing() -> tuple[Twist2, ...]:
        return tuple(lab.tap.now for lab in labs)

    ahead = Twist2(0.1)
    async with terminal("ros1", "rob_key_multi") as the:
        await the.shows(b"Ctrl-D: quit")
        assert b"/RosAria_p3at_0_119 is number 0" in the.screen
        the.type(UP)
        await until(lambda: doing() == (ahead, STILL))
        the.type(b"q")
        await until(lambda: doing() == (STILL, STILL))
        the.type(UP)
        await until(lambda: doing() == (STILL, ahead))
        the.type(b"s0y" + DOWN)
        await until(lambda: doing() == (Twist2(-0.1), STILL))
        the.type(b"a" + UP)
        await until(lambda: doing() == (ahead, ahead))
        the.type(b" ")
        await until(lambda: doing() == (STILL, STILL))
        the.type(UP)
        await until(lambda: doing() == (ahead, ahead))
        the.type(b"\x04")
        assert await the.code() == 0
    await until(lambda: doing() == (STILL, STILL))


async def test_a_phone_drives_and_when_it_is_gone_the_robot_stands(labs: list[Lab]) -> None:
    tap = labs[0].tap
    async with running("ros1", "android_teleop", "--robot", LEFT) as teleop:
        await teleop.line()
        async with program("phone.py") as phone:
            await phone.press("4 0 0\n")
            await until(lambda: tap.now == Twist2(0.2))
            await phone.press("0 4 0\n")
            await until(lambda: tap.now == STILL)
            await phone.press("2.9 2.9 2.9\n-4 0 0\n")
            await until(lambda: tap.now == Twist2(-0.2))
        await until(lambda: tap.now == STILL)
        code, _ = await teleop.end(signal.SIGINT)
        assert code == 130


async def test_without_a_master_it_says_where_it_looked(
    labs: list[Lab], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROS_MASTER_URI", "http://127.0.0.1:1")
    done = await asyncio.to_thread(p3, "ros1", "wander")
    assert done.returncode == 3
    assert "there is no ROS master at http://127.0.0.1:1" in done.stderr
    assert "start roscore, or set ROS_MASTER_URI" in done.stderr


def fleet_file(folder: Path) -> str:
    """Write a fleet of both robots, and of one whose node is not there; return its path."""
    rows = (
        f'[[robot]]\nname = "p3at-{number}"\naddress = "127.0.0.{number + 2}"\nros = "1"\n'
        f'node = "RosAria_{name}"\n'
        for number, name in enumerate((LEFT, RIGHT, "p3at_2_115"))
    )
    (folder / "fleet.toml").write_text("\n".join(rows), "utf-8")
    return str(folder / "fleet.toml")


async def test_the_nodes_of_a_fleet_are_driven_together_though_one_is_missing(
    labs: list[Lab], tmp_path: Path
) -> None:
    ahead = Twist2(0.1)
    async with terminal("fleet", "drive", "--fleet", fleet_file(tmp_path), "--latch") as the:
        await the.shows(b"2 connected")
        await the.shows(b"no node Ros")
        the.type(b"a" + UP)
        await until(lambda: [lab.tap.now for lab in labs] == [ahead, ahead])
        the.type(b" ")
        await until(lambda: [lab.tap.now for lab in labs] == [STILL, STILL])
        the.type(b"1" + UP)
        await until(lambda: [lab.tap.now for lab in labs] == [STILL, ahead])
        the.type(b"\x04")
        assert await the.code() == 0
    await until(lambda: [lab.tap.now for lab in labs] == [STILL, STILL])


async def test_the_nodes_of_a_fleet_are_stopped_and_who_is_missing_is_named(
    labs: list[Lab], tmp_path: Path
) -> None:
    words = ("fleet", "stop", "--emergency", "--timeout", "8", "--json", "--fleet")
    done = await asyncio.to_thread(p3, *words, fleet_file(tmp_path))
    assert done.returncode == 1, done.stderr
    left, right, missing = json.loads(done.stdout)
    assert (left["ok"], right["ok"], missing["ok"]) == (True, True, False), done.stdout
    assert "no node RosAria_p3at_2_115" in missing["why"]
