"""Several inputs of one driver: who goes first; nothing goes on by itself. Virtual time."""

import asyncio
from typing import get_args

import pytest

from pioneer3.geometry import STILL, Twist2
from pioneer3.web.control import EXPIRY, INPUTS
from pioneer3.web.requests import Input
from tests.support import STAYED
from tests.unit.web.browser import Browser, Product, product
from tests.unit.web.test_page import ANN

BRAKING = 0.3
"""From 0.3 m/s to a stand, with a cycle of reports before it [s]."""


class Grip:
    """One input of a page that is held, renewed as pages do."""

    def __init__(self, ann: Browser, source: Input, v: float) -> None:
        self.ann, self.source, self.v = ann, source, v
        self.task = asyncio.ensure_future(self._hold())

    async def _hold(self) -> None:
        while True:
            self.ann.say("drive", v=self.v, w=0.0, input=self.source)
            await asyncio.sleep(0.066)

    async def let_go(self) -> None:
        self.task.cancel()
        await asyncio.gather(self.task, return_exceptions=True)
        for _ in range(3):
            self.ann.say("drive", v=0.0, w=0.0, input=self.source)
        await asyncio.sleep(0.01)


def wanted(the: Product) -> float:
    """Return the speed that was decided [m/s]."""
    return the.robot.arbiter.decision.twist.v if the.robot.arbiter.driving_action else 0.0


@pytest.mark.parametrize("source", get_args(Input))
async def test_each_input_drives_at_its_priority(source: Input) -> None:
    async with product() as the, Browser(the.app) as ann:
        grip = Grip(ann, source, 0.3)
        await asyncio.sleep(1.5)
        assert the.speed == pytest.approx(0.3, abs=0.01)
        assert the.robot.arbiter.driving_action == INPUTS[source][0]
        assert ann.driver == "you"
        await grip.let_go()
        await asyncio.sleep(BRAKING)
        assert the.speed == 0.0


def test_priorities_are_those_of_twist_mux() -> None:
    assert {source: rank for source, (_, rank) in INPUTS.items()} == {
        "gamepad": 100,
        "keyboard": 90,
        "touch": 80,
        "tilt": 80,
    }


@pytest.mark.parametrize(
    ("higher", "lower"), [("gamepad", "keyboard"), ("gamepad", "tilt"), ("keyboard", "touch")]
)
@pytest.mark.parametrize("higher_first", [True, False])
async def test_the_higher_decides_and_letting_it_go_leaves_none(
    higher: Input, lower: Input, higher_first: bool
) -> None:
    async with product() as the, Browser(the.app) as ann:
        order = ((higher, 0.2), (lower, -0.3)) if higher_first else ((lower, -0.3), (higher, 0.2))
        grips = {}
        for source, v in order:
            grips[source] = Grip(ann, source, v)
            await asyncio.sleep(0.3)
        assert wanted(the) == pytest.approx(0.2)
        await grips[higher].let_go()
        for _ in range(20):  # the lower one is still held
            await asyncio.sleep(0.1)
            assert wanted(the) == 0.0
        assert the.speed == 0.0
        assert "let go" in ann.latest("refused")["message"]
        await grips[lower].let_go()
        fresh = Grip(ann, lower, -0.3)
        await asyncio.sleep(0.3)
        assert wanted(the) == pytest.approx(-0.3)
        await fresh.let_go()


async def test_letting_go_of_the_lower_leaves_the_higher_alone() -> None:
    async with product() as the, Browser(the.app) as ann:
        keys, pad = Grip(ann, "keyboard", -0.3), Grip(ann, "gamepad", 0.2)
        await asyncio.sleep(0.3)
        await keys.let_go()
        await asyncio.sleep(0.3)
        assert wanted(the) == pytest.approx(0.2)
        await pad.let_go()


async def test_a_higher_input_that_falls_silent_hands_nothing_to_a_lower_one() -> None:
    async with product() as the, Browser(the.app) as ann:
        keys, pad = Grip(ann, "keyboard", -0.3), Grip(ann, "gamepad", 0.2)
        await asyncio.sleep(0.3)
        pad.task.cancel()
        await asyncio.sleep(EXPIRY + 0.1)
        assert wanted(the) == 0.0
        await asyncio.sleep(1.0)
        assert wanted(the) == 0.0
        await keys.let_go()


async def test_somebodys_stop_mutes_every_input_until_it_is_let_go() -> None:
    async with product() as the, Browser(the.app) as ann, Browser(the.app) as bob:
        pad = Grip(ann, "gamepad", 0.3)
        await asyncio.sleep(1.0)
        bob.say("stop")
        await asyncio.sleep(1.0)
        assert the.speed == wanted(the) == 0.0
        await pad.let_go()
        pad = Grip(ann, "gamepad", 0.3)
        await asyncio.sleep(0.3)
        assert wanted(the) == pytest.approx(0.3)
        await pad.let_go()


@pytest.mark.parametrize("source", get_args(Input))
async def test_a_press_right_after_a_reset_drives(source: Input) -> None:
    async with product() as the, Browser(the.app) as ann, Browser(the.app) as bob:
        grip = Grip(ann, source, 0.3)
        await asyncio.sleep(1.0)
        bob.say("emergency_stop")
        await asyncio.sleep(0.3)
        await grip.let_go()
        ann.say("reset_emergency_stop")
        grip = Grip(ann, source, 0.3)
        await asyncio.sleep(0.3)
        assert wanted(the) == pytest.approx(0.3)
        await grip.let_go()


@pytest.mark.parametrize("source", get_args(Input))
async def test_control_lost_in_the_middle_ends_every_input(source: Input) -> None:
    async with product() as the, Browser(the.app) as ann, Browser(the.app) as bob:
        grip = Grip(ann, source, 0.3)
        await asyncio.sleep(1.0)
        bob.say("take_over")
        await asyncio.sleep(1.0)
        assert the.speed == wanted(the) == 0.0
        assert ann.latest("refused")["message"].endswith("has control")
        await grip.let_go()


async def test_who_leaves_lets_go_of_all_inputs() -> None:
    async with product() as the:
        control = the.control
        async with Browser(the.app) as ann:
            grips = [Grip(ann, "touch", 0.3), Grip(ann, "gamepad", 0.2)]
            await asyncio.sleep(0.3)
            for grip in grips:
                grip.task.cancel()
            await asyncio.sleep(0)
        assert control.holder is None
        assert wanted(the) == 0.0


async def test_scripts_count_as_touch() -> None:
    async with product() as the:
        assert the.control.drive(ANN, Twist2(0.2, 0.0)) is None
        assert the.robot.arbiter.driving_action == "web"
        the.control.drive(ANN, STILL)
        assert the.robot.arbiter.driving_action is None


async def test_an_unknown_input_is_refused_and_moves_nothing() -> None:
    async with product() as the, Browser(the.app) as ann:
        ann.say("drive", v=0.3, w=0.0, input="mind")
        await asyncio.sleep(0.5)
        assert ann.latest("refused")["message"].startswith("not understood: ")
        assert the.travelled < STAYED
