"""Programs that behave as the lab's do, none of which knows of this node."""

import asyncio
import random
import re
from collections.abc import AsyncIterator, Iterator
from contextlib import AsyncExitStack, asynccontextmanager

import pytest

from pioneer3.geometry import Twist2
from tests.e2e.processes import until
from tests.ros1.conftest import laboratory
from tests.ros1.master import program
from tests.ros1.tap import Tap

pytestmark = pytest.mark.realtime

PRESSES = 300
SETTLED = 0.06
"""Whoever goes by the wrong one of two messages does so within this time [s]."""
LATE = 3
"""So many zeros to all robots may come 50 ms after their command, on a busy machine; both are on
connections of their own, without a time. Then the robot stands."""
STOP = "."
LAB_NAMES = ("p3at_0_119", "p3at_1_113")


async def test_of_300_presses_for_two_robots_none_is_lost_or_reversed(ros1: None) -> None:
    presses, late = list(random_presses()), 0
    async with AsyncExitStack() as stack:
        taps = [await stack.enter_async_context(robot_of_the_lab(name)) for name in LAB_NAMES]
        keys = await stack.enter_async_context(program("lab/rob_key_multi.py", "2"))
        assert await keys.line() == "ready"
        for chosen, key in presses:
            wanted = [key if robot == chosen else STOP for robot in range(2)]
            await keys.press(f"s{chosen}y{key}")
            await until(lambda: [doing(tap) for tap in taps] == wanted)  # noqa: B023
            await asyncio.sleep(SETTLED)
            if [doing(tap) for tap in taps] != wanted:
                assert [doing(tap) for tap in taps] == [STOP, STOP]
                late += 1
    assert late <= LATE
    for robot, tap in enumerate(taps):
        wanted = [key if chosen == robot else STOP for chosen, key in presses]
        moved = "".join(name(twist) for _, twist in tap.velocities)
        assert re.fullmatch(with_pauses(wanted), moved)


def random_presses() -> Iterator[tuple[int, str]]:
    """Yield robots and keys; each press changes what its robot does."""
    chance = random.Random(1)
    doing, chosen = [STOP, STOP], 0
    for _ in range(PRESSES):
        chosen = 1 - chosen if chance.random() < 0.3 else chosen
        key = chance.choice([key for key in "fblr" if key != doing[chosen]])
        doing = [key if robot == chosen else STOP for robot in range(2)]
        yield chosen, key


def doing(tap: Tap) -> str:
    """Return the key that is pressed for what the robot does now."""
    return name(tap.velocities[-1][1]) if tap.velocities else STOP


def name(twist: Twist2) -> str:
    """Return the key that is pressed for a velocity."""
    if twist.v:
        return "f" if twist.v > 0 else "b"
    return STOP if not twist.w else "l" if twist.w > 0 else "r"


def with_pauses(wanted: list[str]) -> str:
    """Return a pattern: each change in its turn; between two motions the robot may pause."""
    changes = [now for before, now in zip([STOP, *wanted], wanted, strict=False) if now != before]
    return "".join(r"\." if now == STOP else rf"\.?{now}" for now in changes) + r"\.?"


async def test_one_key_press_keeps_the_robot_going_without_a_timeout(ros1: None) -> None:
    async with laboratory("_cmd_vel_timeout:=0") as lab, program("lab/rob_key.py") as keys:
        assert await keys.line() == "ready"
        await keys.press("f")
        await until(lambda: lab.tap.velocities)
        await asyncio.sleep(2.5)
        await keys.press(" ")
        await until(lambda: len(lab.tap.velocities) > 1)
    ((began, ahead), (ended, _), *_) = lab.tap.velocities
    assert ahead == Twist2(0.5)
    assert ended - began > 2.4


async def test_a_command_each_second_drives_in_bursts_with_a_timeout(ros1: None) -> None:
    async with laboratory() as lab, program("lab/cmd.py"):
        await until(lambda: len(lab.tap.velocities) >= 6)
        await lab.warns("cmd_vel of /test_cmd has expired: nothing came for 0.6 s")
    names = "".join(name(twist) for _, twist in lab.tap.velocities[:6])
    assert names == "f.f.f."


async def test_a_command_each_second_drives_on_with_a_longer_timeout(ros1: None) -> None:
    async with laboratory("_cmd_vel_timeout:=1.5") as lab, program("lab/cmd.py"):
        await until(lambda: lab.tap.velocities)
        await asyncio.sleep(3.5)
        assert "".join(name(twist) for _, twist in lab.tap.velocities) == "f"


async def test_a_phone_drives(ros1: None) -> None:
    flicks = ("4 0 0", "0 0 -4", "2.9 2.9 2.9", "0 4 0", "-4 0 0")
    async with (
        laboratory() as lab,
        program("lab/android_teleop.py"),
        program("phone.py") as phone,
    ):
        for flick in flicks:
            before = len(lab.tap.velocities)
            await phone.press(f"{flick}\n")
            if flick != "2.9 2.9 2.9":
                await until(lambda: len(lab.tap.velocities) > before)  # noqa: B023
    assert "".join(name(twist) for _, twist in lab.tap.velocities[:4]) == "fr.b"


async def test_the_sonars_of_a_named_robot_are_shown_and_followed(ros1: None) -> None:
    async with (
        laboratory("_lab_name:=p3at_1_113") as lab,
        program("lab/p3_sonar.py", "follow") as shown,
    ):
        numbers = [int(word) for word in (await shown.line()).split()]
        assert len(numbers) == 8
        assert min(numbers) > 5000  # nothing is near
        await until(lambda: lab.tap.velocities)
        assert lab.tap.velocities[0][1] == Twist2(0.5)


async def test_poses_of_a_local_robot_are_recorded(ros1: None) -> None:
    async with laboratory("_lab_name:=local"), program("lab/record_data.py") as recorded:
        assert await recorded.line() == "0.000 0.000"


@asynccontextmanager
async def robot_of_the_lab(lab_name: str) -> AsyncIterator[Tap]:
    """Run a simulated robot and its node with the lab's settings; yield the tap between them."""
    async with laboratory(f"_lab_name:={lab_name}", "_cmd_vel_timeout:=0") as lab:
        yield lab.tap
