"""One wheel for all visitors. Virtual time."""

import asyncio

import pytest

from pioneer3.behaviors.actions import Hold
from pioneer3.geometry import STILL, Pose2, Twist2
from pioneer3.runtime.priorities import KEYBOARD
from pioneer3.runtime.scene import Scene
from pioneer3.web.page import EXPIRY
from tests.unit.web.browser import product

SLOW = Twist2(0.3, 0.0)
ANN, BOB = "ann", "bob"


async def test_a_drive_expires_after_half_a_second() -> None:
    async with product() as the:
        began = asyncio.get_running_loop().time()
        assert the.page.drive(ANN, SLOW) is None
        assert the.page.driver() == ANN
        await asyncio.sleep(EXPIRY - 0.001)
        assert the.page.driver() == ANN
        await asyncio.sleep(0.001)
        assert asyncio.get_running_loop().time() == pytest.approx(began + 0.5)
        assert the.page.driver() is None
        assert the.robot.supervisor.pilot.asked(asyncio.get_running_loop().time()) == STILL


async def test_a_zero_drive_lets_go_but_keeps_the_wheel() -> None:
    async with product() as the:
        the.page.drive(ANN, SLOW)
        the.page.drive(ANN, STILL)
        assert the.page.driver() is None
        assert the.page.drive(BOB, SLOW) == "somebody else drives"
        assert the.page.drive(ANN, SLOW) is None


async def test_even_letting_go_is_refused_to_who_does_not_hold_the_wheel() -> None:
    async with product() as the:
        the.page.drive(ANN, SLOW)
        assert the.page.drive(BOB, STILL) == "somebody else drives"
        assert the.page.driver() == ANN


async def test_a_driver_who_goes_leaves_nothing_behind() -> None:
    async with product() as the:
        the.page.drive(ANN, SLOW)
        the.page.let_go(ANN)
        assert the.page.driver() is None
        assert the.page.drive(BOB, SLOW) is None


async def test_somebody_else_who_goes_changes_nothing() -> None:
    async with product() as the:
        the.page.drive(ANN, SLOW)
        the.page.let_go(BOB)
        assert the.page.driver() == ANN


async def test_a_stop_by_the_holder_lets_her_drive_again_at_once() -> None:
    async with product() as the:
        the.page.drive(ANN, SLOW)
        the.page.stop(ANN)
        assert the.page.driver() is None
        the.page.drive(ANN, SLOW)
        assert the.page.driver() == ANN


async def test_a_stop_by_another_mutes_the_holder_until_she_lets_go() -> None:
    async with product() as the:
        the.page.drive(ANN, SLOW)
        the.page.stop(BOB)
        for _ in range(10):
            the.page.drive(ANN, SLOW)
            assert the.page.driver() is None
            await asyncio.sleep(0.1)
        the.page.drive(ANN, STILL)
        the.page.drive(ANN, SLOW)
        assert the.page.driver() == ANN


async def test_a_keyboard_that_takes_over_is_named_as_the_driver() -> None:
    async with product() as the:
        held = Hold("keyboard")
        the.robot.helm.add(held, KEYBOARD)
        the.page.drive(ANN, SLOW)
        the.robot.helm.hold(held, Twist2(-0.2, 0.0), 0.3)
        assert the.page.driver() == "keyboard"
        the.robot.helm.release(held)
        assert the.page.driver() == ANN


async def test_the_robot_is_drawn_where_the_scene_has_it() -> None:
    async with product(Scene(odom_in_map=Pose2(3.0, 4.0, 0.0))) as the:
        assert the.robot.snapshot is not None
        drawn = the.page.snapshot(the.robot.snapshot, None)
        assert drawn["pose"] == {"x": 3.0, "y": 4.0, "theta": 0.0}
