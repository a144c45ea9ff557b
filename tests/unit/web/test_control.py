"""Control: taken, kept, handed over, taken over, lost. Virtual time."""

import asyncio
from math import inf

import pytest

from pioneer3.behaviors.modes import wander
from pioneer3.geometry import STILL, Twist2
from pioneer3.web.control import EXPIRY, KEPT, SILENCE, STOPPING, TERM
from tests.unit.web.browser import Browser, Product, product
from tests.unit.web.test_page import ANN, BOB

FORWARD, BACK = Twist2(0.3, 0.0), Twist2(-0.3, 0.0)


async def hold(the: Product, who: object, twist: Twist2, seconds: float) -> None:
    """Let `who` hold `twist` for so long."""
    end = asyncio.get_running_loop().time() + seconds
    while asyncio.get_running_loop().time() < end:
        the.control.drive(ANN if who is ANN else BOB, twist)
        await asyncio.sleep(0.066)


async def test_who_asks_for_control_keeps_it_while_they_are_heard_of() -> None:
    async with product() as the:
        control = the.control
        assert control.take(ANN, keep=True) is None
        for _ in range(10):
            await asyncio.sleep(KEPT - 0.1)
            assert str(control.drive(BOB, FORWARD)) == "ann has control"
            control.keep_alive(ANN)
        await asyncio.sleep(KEPT)
        assert control.holder is None
        assert control.drive(BOB, FORWARD) is None


async def test_being_heard_of_is_not_enough_without_asking() -> None:
    async with product() as the:
        control = the.control
        control.drive(ANN, FORWARD)
        control.drive(ANN, STILL)
        await asyncio.sleep(TERM / 2)
        control.keep_alive(ANN)
        await asyncio.sleep(TERM / 2 + 0.001)
        assert control.holder is None


async def test_a_take_over_stops_the_robot_first() -> None:
    async with product() as the:
        await hold(the, ANN, FORWARD, 2.0)
        assert the.speed == pytest.approx(0.3, abs=0.01)
        the.control.take_over(BOB)
        assert the.control.holder is BOB
        assert str(the.control.drive(BOB, BACK)) == "the robot is still stopping"
        assert str(the.control.drive(ANN, FORWARD)) == "bob has control"
        await asyncio.sleep(EXPIRY)
        assert the.speed == 0.0
        await hold(the, BOB, BACK, 1.5)
        assert the.sim.body.speeds[0] == pytest.approx(-0.3, abs=0.01)


async def test_a_robot_that_somebody_pushes_is_not_waited_for_for_ever() -> None:
    async with product() as the:
        the.control.take(ANN, keep=True)
        the.control.take_over(BOB)
        await hold(the, BOB, FORWARD, 0.5)
        the.control.drive(BOB, STILL)
        the.control._stopping_until = asyncio.get_running_loop().time() + STOPPING
        await asyncio.sleep(STOPPING)
        assert the.control.drive(BOB, FORWARD) is None


async def test_taking_over_what_is_yours_changes_nothing() -> None:
    async with product() as the:
        await hold(the, ANN, FORWARD, 1.5)
        the.control.take_over(ANN)
        await asyncio.sleep(0.2)
        assert the.speed == pytest.approx(0.3, abs=0.01)


async def test_handing_over_stops_the_robot_and_passes_control() -> None:
    async with product() as the:
        await hold(the, ANN, FORWARD, 1.5)
        assert str(the.control.hand_over(BOB, ANN)) == "you do not have control"
        assert the.control.hand_over(ANN, BOB) is None
        assert the.control.holder is BOB
        await asyncio.sleep(EXPIRY)
        assert the.speed == 0.0
        assert str(the.control.drive(ANN, FORWARD)) == "bob has control"


async def test_a_mode_keeps_control_for_who_started_it() -> None:
    async with product() as the:
        control = the.control
        assert control.start(ANN, wander(), 20.0, patience=inf) is None
        await asyncio.sleep(10.0)
        assert the.travelled > 0.3
        assert control.holder is control.who_drives() is ANN
        assert str(control.start(BOB, wander(), 20.0, patience=inf)) == "ann has control"
        assert str(control.end_mode(BOB)) == "ann has control"
        await asyncio.sleep(10.1)
        assert control.holder is None
        assert the.robot.arbiter.ended is not None
        assert the.robot.arbiter.ended.why == "its time was over"


async def test_a_mode_does_not_begin_for_a_page_that_fell_silent_meanwhile() -> None:
    async with product() as the:
        the.control.keep_alive(ANN)
        await asyncio.sleep(SILENCE + 0.1)
        why = f"nothing was heard of ann for {SILENCE:g} s"
        assert str(the.control.start(ANN, wander(), 20.0)) == why
        the.control.keep_alive(ANN)
        assert the.control.start(ANN, wander(), 20.0) is None


async def test_a_mode_does_not_begin_for_a_page_that_left_meanwhile() -> None:
    async with product() as the:
        the.control.keep_alive(ANN)
        the.control.release(ANN)
        assert the.control.start(ANN, wander(), 20.0) is not None
        assert the.robot.arbiter.mode is None


async def test_the_time_of_a_mode_ends_no_other() -> None:
    async with product() as the:
        the.control.start(ANN, wander(), 1.0, patience=inf)
        the.control.start(ANN, wander(), 20.0, patience=inf)
        await asyncio.sleep(5.0)
        assert the.robot.arbiter.mode is not None


@pytest.mark.parametrize(
    ("how", "why"),
    [
        ("release", "ann let go"),
        ("take_over", "bob took over"),
        ("stop", "ann stopped the robot"),
        ("end_mode", "ann ended it"),
    ],
)
async def test_a_mode_ends_with_who_started_it_and_says_who_ended_it(how: str, why: str) -> None:
    async with product() as the:
        the.control.start(ANN, wander(), 100.0, patience=inf)
        await asyncio.sleep(3.0)
        getattr(the.control, how)(BOB if how == "take_over" else ANN)
        assert the.robot.arbiter.mode is None
        assert the.robot.arbiter.ended is not None
        assert the.robot.arbiter.ended.why == why
        await asyncio.sleep(EXPIRY)
        assert the.speed == 0.0


async def test_pages_take_hand_over_and_release_control_openly() -> None:
    async with (
        product() as the,
        Browser(the.app, user_agent="Mozilla (iPhone; Mobile)") as ann,
        Browser(the.app, user_agent="Mozilla (X11)") as bob,
    ):
        assert (ann.latest("people")["name"], bob.latest("people")["name"]) == ("phone", "laptop")
        ann.say("take_control")
        await asyncio.sleep(0.2)
        (holder,) = bob.latest("people")["control"]
        assert holder == {"robot": 1, "id": ann.latest("people")["id"], "name": "phone"}
        bob.say("take_control")
        bob.say("hand_over", to=ann.latest("people")["id"])
        await asyncio.sleep(0.2)
        reasons = [message["message"] for message in bob.all("refused")]
        assert reasons == ["phone has control", "you do not have control"]
        ann.say("hand_over", to=bob.latest("people")["id"])
        await asyncio.sleep(0.2)
        assert bob.latest("told")["message"] == "phone has handed control to you"
        ann.say("take_over")
        await asyncio.sleep(0.2)
        assert bob.latest("told")["message"] == "phone took over; you watch now"
        ann.say("release_control")
        await asyncio.sleep(0.2)
        assert bob.latest("people")["control"] == []


async def test_a_page_that_only_lies_open_keeps_control_by_its_pings() -> None:
    async with product() as the, Browser(the.app) as ann, Browser(the.app) as bob:
        ann.say("take_control")
        for _ in range(20):
            ann.say("ping", t=0)
            await asyncio.sleep(1.0)
        bob.drive(0.3)
        await asyncio.sleep(0.1)
        assert bob.latest("refused")["message"] == "script has control"
        await ann.leave()
        assert the.control.holder is None


async def test_nobody_is_handed_control_who_is_not_here() -> None:
    async with product() as the, Browser(the.app) as ann:
        ann.say("take_control")
        ann.say("hand_over", to=99)
        await asyncio.sleep(0.1)
        assert "nobody of that number" in ann.latest("refused")["message"]
