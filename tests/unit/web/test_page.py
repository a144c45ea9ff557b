"""One operator at a time. Virtual time."""

import asyncio
from dataclasses import dataclass

import pytest

from pioneer3.behaviors.actions import Hold
from pioneer3.geometry import STILL, Pose2, Twist2
from pioneer3.runtime.arbiter import KEYBOARD
from pioneer3.web.broadcast import RetainedChannel
from pioneer3.web.control import EXPIRY
from pioneer3.web.scene import RobotScene
from tests.unit.web.browser import product

SLOW = Twist2(0.3, 0.0)


@dataclass(eq=False)
class Person:
    """Somebody by name."""

    name: str


ANN, BOB = Person("ann"), Person("bob")


async def test_a_drive_expires_after_half_a_second() -> None:
    async with product() as the:
        began = asyncio.get_running_loop().time()
        assert the.control.drive_from_page(ANN, SLOW) is None
        assert the.control.who_drives() == ANN
        await asyncio.sleep(EXPIRY - 0.001)
        assert the.control.who_drives() == ANN
        await asyncio.sleep(0.001 + 1e-9)
        assert asyncio.get_running_loop().time() == pytest.approx(began + 0.5)
        assert the.control.who_drives() is None
        assert the.robot.supervisor.pilot.asked(asyncio.get_running_loop().time()) == STILL


async def test_a_zero_drive_lets_go_but_keeps_control() -> None:
    async with product() as the:
        the.control.drive_from_page(ANN, SLOW)
        the.control.drive_from_page(ANN, STILL)
        assert the.control.who_drives() is None
        assert str(the.control.drive_from_page(BOB, SLOW)) == "ann has control"
        assert the.control.drive_from_page(ANN, SLOW) is None


async def test_even_letting_go_is_refused_to_who_does_not_hold_control() -> None:
    async with product() as the:
        the.control.drive_from_page(ANN, SLOW)
        assert str(the.control.drive_from_page(BOB, STILL)) == "ann has control"
        assert the.control.who_drives() == ANN


async def test_a_driver_who_goes_leaves_nothing_behind() -> None:
    async with product() as the:
        the.control.drive_from_page(ANN, SLOW)
        the.control.release(ANN)
        assert the.control.who_drives() is None
        assert the.control.drive_from_page(BOB, SLOW) is None


async def test_somebody_else_who_goes_changes_nothing() -> None:
    async with product() as the:
        the.control.drive_from_page(ANN, SLOW)
        the.control.release(BOB)
        assert the.control.who_drives() == ANN


async def test_a_stop_by_the_holder_lets_her_drive_again_at_once() -> None:
    async with product() as the:
        the.control.drive_from_page(ANN, SLOW)
        the.control.stop(ANN)
        assert the.control.who_drives() is None
        the.control.drive_from_page(ANN, SLOW)
        assert the.control.who_drives() == ANN


async def test_a_stop_by_another_mutes_the_holder_until_she_lets_go() -> None:
    async with product() as the:
        the.control.drive_from_page(ANN, SLOW)
        the.control.stop(BOB)
        for _ in range(10):
            the.control.drive_from_page(ANN, SLOW)
            assert the.control.who_drives() is None
            await asyncio.sleep(0.1)
        the.control.drive_from_page(ANN, STILL)
        the.control.drive_from_page(ANN, SLOW)
        assert the.control.who_drives() == ANN


async def test_a_keyboard_that_takes_over_is_named_as_the_driver() -> None:
    async with product() as the:
        held = Hold("keyboard")
        the.robot.arbiter.add(held, KEYBOARD)
        the.control.drive_from_page(ANN, SLOW)
        the.robot.arbiter.hold(held, Twist2(-0.2, 0.0), 0.3)
        assert the.control.who_drives() == "keyboard"
        the.robot.arbiter.release(held)
        assert the.control.who_drives() == ANN


async def test_the_robot_is_drawn_where_the_scene_has_it() -> None:
    async with product(RobotScene(odom_in_map=Pose2(3.0, 4.0, 0.0))) as the:
        assert the.robot.snapshot is not None
        drawn = the.view.snapshot(the.robot.snapshot, the.page.clients)
        assert drawn.robot_in_map == Pose2(3.0, 4.0, 0.0)


def test_who_comes_later_is_told_the_robots_before_their_states() -> None:
    kept = RetainedChannel()
    kept.put("hello", "one robot")
    kept.put("mapping 1", "no map yet")
    kept.put("hello", "one robot, with a name")
    assert kept.since(0) == ["one robot, with a name", "no map yet"]
