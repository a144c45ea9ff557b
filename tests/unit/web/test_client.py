"""What visitors of the page may do, and what happens when they go. Virtual time."""

import asyncio
import json
from typing import Any

import pytest

from pioneer3.web.control import EXPIRY, TERM
from tests.support import STAYED
from tests.unit.web.asking import Script
from tests.unit.web.browser import Browser, product

BRAKING = 0.3
"""From 0.3 m/s to a stand, with a cycle of reports before it [s]."""
AT_ONCE = 0.05


async def test_a_request_that_is_nested_deeply_is_answered_and_the_page_stays() -> None:
    async with product() as the, Browser(the.app) as ann:
        ann.say_text('{"a":' * 800)
        ann.say_text('{"a":' * 800 + "1" + "}" * 800)
        ann.say("ping", t=3)
        await asyncio.sleep(0.1)
        assert len(ann.all("refused")) == 2
        assert ann.latest("pong")["t"] == 3
        answer = await Script(the.app).ask("PUT", "/api/robots/1/mode", raw=b'{"a":' * 3000)
        assert (answer.status, answer.detail) == (400, "nested too deeply")


async def test_a_visitor_is_told_who_then_how_then_what() -> None:
    async with product() as the, Browser(the.app) as ann:
        await asyncio.sleep(0.25)
        types = [message["type"] for message in ann.heard]
        assert types[:2] == ["hello", "status"]
        assert types.index("people") < types.index("robots")
        assert ann.latest("status")["state"] == "connected"


async def test_ten_snapshots_arrive_in_a_second() -> None:
    async with product() as the, Browser(the.app) as ann:
        await asyncio.sleep(2.0)
        sequences = [message["sequence"] for message in ann.snapshots()]
        assert 18 <= len(sequences) <= 21
        assert sequences == list(range(sequences[0], sequences[0] + len(sequences)))


async def test_looking_moves_nothing() -> None:
    async with product() as the, Browser(the.app):
        await asyncio.sleep(2.0)
        assert the.travelled < STAYED
        assert not the.sim.powered


async def test_a_held_key_drives_and_letting_go_stops() -> None:
    async with product() as the, Browser(the.app) as ann:
        await ann.keep_driving(0.3, 2.0)
        assert the.speed == pytest.approx(0.3, abs=0.01)
        assert ann.driver == "you"
        ann.drive(0.0)
        await asyncio.sleep(BRAKING)
        assert the.speed == 0.0
        assert ann.driver is None


async def test_a_page_that_falls_silent_drives_half_a_second_more() -> None:
    async with product() as the, Browser(the.app) as ann:
        await ann.keep_driving(0.3, 2.0)
        ann.drive(0.3)
        await asyncio.sleep(EXPIRY - 0.05)
        assert the.speed == pytest.approx(0.3, abs=0.01)
        await asyncio.sleep(0.05 + BRAKING)
        assert the.speed == 0.0


async def test_a_visitor_who_vanishes_while_driving_stops_the_robot_at_once() -> None:
    async with product() as the, Browser(the.app) as ann:
        await ann.keep_driving(0.3, 2.0)
        ann.drive(0.3)
        await asyncio.sleep(AT_ONCE)
        await ann.leave()
        await asyncio.sleep(BRAKING)
        assert BRAKING + AT_ONCE < EXPIRY
        assert the.speed == 0.0


async def test_a_visitor_who_only_looked_takes_nothing_along() -> None:
    async with product() as the, Browser(the.app) as ann:
        async with Browser(the.app):
            await ann.keep_driving(0.3, 1.5)
        await ann.keep_driving(0.3, 0.3)
        assert the.speed == pytest.approx(0.3, abs=0.01)


async def test_the_first_drives_and_the_second_is_refused() -> None:
    async with product() as the, Browser(the.app) as ann, Browser(the.app) as bob:
        driving = asyncio.ensure_future(ann.keep_driving(0.3, 2.0))
        await asyncio.sleep(1.0)
        bob.drive(-0.3)
        await driving
        assert the.speed == pytest.approx(0.3, abs=0.01)
        assert bob.all("refused") == [{"type": "refused", "message": "script has control"}]
        assert ann.all("refused") == []
        assert ann.driver == "you"
        assert bob.driver == "script"


@pytest.mark.parametrize("request_", ["stop", "emergency_stop"])
async def test_anybody_may_stop(request_: str) -> None:
    async with product() as the, Browser(the.app) as ann, Browser(the.app) as bob:
        driving = asyncio.ensure_future(ann.keep_driving(0.3, 3.0))
        await asyncio.sleep(1.5)
        bob.say(request_)
        await asyncio.sleep(BRAKING)
        assert the.speed == 0.0
        await driving
        assert the.speed == 0.0


async def test_a_key_held_while_somebody_else_stops_counts_again_once_let_go() -> None:
    async with product() as the, Browser(the.app) as ann, Browser(the.app) as bob:
        driving = asyncio.ensure_future(ann.keep_driving(0.3, 2.5))
        await asyncio.sleep(1.5)
        bob.say("stop")
        await driving
        assert the.speed == 0.0
        ann.drive(0.0)
        await ann.keep_driving(0.3, 1.5)
        assert the.speed == pytest.approx(0.3, abs=0.01)


async def test_who_holds_control_may_press_again_right_after_her_own_stop() -> None:
    async with product() as the, Browser(the.app) as ann:
        await ann.keep_driving(0.3, 1.5)
        ann.say("stop")
        await asyncio.sleep(0.1)
        await ann.keep_driving(0.3, 1.2)
        assert the.speed == pytest.approx(0.3, abs=0.01)


async def test_control_is_free_a_moment_after_it_is_let_go() -> None:
    async with product() as the, Browser(the.app) as ann, Browser(the.app) as bob:
        await ann.keep_driving(0.3, 1.0)
        ann.drive(0.0)
        await asyncio.sleep(TERM - 0.05)
        bob.drive(0.2)
        await asyncio.sleep(0.1)
        assert len(bob.all("refused")) == 1
        await bob.keep_driving(0.2, 1.5)
        assert len(bob.all("refused")) == 1
        assert the.speed == pytest.approx(0.2, abs=0.01)


async def test_control_is_free_at_once_when_the_driver_leaves() -> None:
    async with product() as the, Browser(the.app) as ann, Browser(the.app) as bob:
        await ann.keep_driving(0.3, 1.0)
        await ann.leave()
        await bob.keep_driving(-0.2, 1.5)
        assert bob.all("refused") == []
        assert the.speed == pytest.approx(-0.2, abs=0.01)


async def test_motors_switched_off_while_a_key_is_held_stay_off() -> None:
    async with product() as the, Browser(the.app) as ann, Browser(the.app) as bob:
        for who in (ann, bob):
            await ann.keep_driving(0.3, 1.5)
            assert the.sim.powered
            who.say("motors", on=False)
            await ann.keep_driving(0.3, 1.0)
            assert not the.sim.powered
            assert "the robot switched" not in ann.snapshot["why"]  # people did
            ann.drive(0.0)


async def test_motors_can_be_switched_on_without_moving() -> None:
    async with product() as the, Browser(the.app) as ann:
        ann.say("motors", on=True)
        await asyncio.sleep(1.0)
        assert the.sim.powered
        assert the.travelled < STAYED


async def test_the_emergency_stop_latches_until_it_is_reset() -> None:
    async with product() as the, Browser(the.app) as ann:
        await ann.keep_driving(0.3, 1.5)
        ann.say("emergency_stop")
        await ann.keep_driving(0.3, 1.0)
        assert the.speed == 0.0
        assert not the.sim.powered
        assert ann.snapshot["emergency_stop"] is True
        ann.say("motors", on=True)
        await asyncio.sleep(AT_ONCE)
        assert ann.latest("refused")["message"] == "the emergency stop is latched"
        ann.say("reset_emergency_stop")
        await asyncio.sleep(1.0)
        assert not the.sim.powered
        assert ann.snapshot["emergency_stop"] is False
        ann.drive(0.0, 0.0)
        await ann.keep_driving(0.3, 1.5)
        assert the.speed == pytest.approx(0.3, abs=0.01)


async def test_a_ping_is_answered_with_its_own_time() -> None:
    async with product() as the, Browser(the.app) as ann:
        ann.say("ping", t=123.5)
        await asyncio.sleep(AT_ONCE)
        assert ann.all("pong") == [{"type": "pong", "t": 123.5}]


NONSENSE = {
    "no JSON": "drive!",
    "nothing": "",
    "cut off": '{"type":"drive","v":0.3',
    "NaN": '{"type":"drive","v":NaN,"w":0}',
    "infinity": '{"type":"drive","v":0.3,"w":Infinity}',
    "too large": '{"type":"drive","v":1e999,"w":0}',
    "unknown type": '{"type":"fly","v":0.3,"w":0}',
    "no type": '{"v":0.3,"w":0}',
    "missing field": '{"type":"drive","v":0.3}',
    "unknown field": '{"type":"drive","v":0.3,"w":0,"boost":true}',
    "text for a number": '{"type":"drive","v":"0.3","w":0}',
    "truth for a number": '{"type":"drive","v":true,"w":0}',
    "null for a number": '{"type":"drive","v":null,"w":0}',
    "number for a truth": '{"type":"motors","on":1}',
    "a list": '[{"type":"drive","v":0.3,"w":0}]',
    "deep": "[" * 2000,
}


@pytest.mark.parametrize("text", [*NONSENSE.values()], ids=[*NONSENSE])
async def test_nonsense_is_answered_and_moves_nothing(text: str) -> None:
    async with product() as the, Browser(the.app) as ann:
        ann.say_text(text)
        await asyncio.sleep(1.0)
        (answer,) = ann.all("refused")
        assert answer["message"].startswith("not understood: ")
        assert the.travelled < STAYED
        assert not the.sim.powered
        await ann.keep_driving(0.3, 1.5)
        assert the.speed == pytest.approx(0.3, abs=0.01)


async def test_a_frame_of_bytes_is_answered_like_any_nonsense() -> None:
    async with product() as the, Browser(the.app) as ann:
        ann.say_bytes(b"\x00\x01")
        await asyncio.sleep(AT_ONCE)
        (answer,) = ann.all("refused")
        assert answer["message"].startswith("not understood: ")
        assert ann.closed is None
        await ann.keep_driving(0.3, 1.5)
        assert the.speed == pytest.approx(0.3, abs=0.01)


@pytest.mark.parametrize("text", [NONSENSE["NaN"], NONSENSE["too large"]])
async def test_nonsense_does_not_keep_the_robot_going(text: str) -> None:
    async with product() as the, Browser(the.app) as ann:
        await ann.keep_driving(0.3, 1.5)
        for _ in range(10):
            ann.say_text(text)
            await asyncio.sleep(0.1)
        assert the.speed == 0.0


async def test_speeds_beyond_the_limits_are_cut_to_them() -> None:
    async with product() as the, Browser(the.app) as ann:
        await ann.keep_driving(1e30, 4.0)
        assert the.speed == pytest.approx(the.robot.info.limits.max_speed)


async def test_a_flood_of_requests_delays_no_stop_and_does_not_flood_the_robot() -> None:
    async with product() as the, Browser(the.app) as ann:
        await ann.keep_driving(0.3, 1.5)
        before = len(the.sim.wires[0].data)
        for number in range(1000):
            ann.drive(0.3 + number % 2 / 100)
        ann.say("stop")
        await asyncio.sleep(AT_ONCE)
        burst = len(the.sim.wires[0].data) - before
        await asyncio.sleep(BRAKING)
        assert the.speed == 0.0
        assert burst < 960 * AT_ONCE + 200  # a line of 9600 baud carries 960 bytes a second


async def test_a_lost_link_and_its_return_are_told() -> None:
    async with product() as the, Browser(the.app) as ann:
        await asyncio.sleep(1.0)
        await the.sim.unplug()
        await asyncio.sleep(2.0)
        assert ann.latest("status")["state"] in {"lost", "connecting"}
        silent = len(ann.snapshots())
        the.sim.plugged = True
        await asyncio.sleep(5.0)
        states = [status["state"] for status in ann.all("status")]
        assert states[0] == "connected"
        assert "lost" in states
        assert states[-1] == "connected"
        assert ann.latest("hello")["robots"][0]["shape"]["model"] == "p3at-sh"
        assert len(ann.snapshots()) > silent


async def test_a_key_held_through_a_lost_link_does_not_move_the_robot_again() -> None:
    async with product() as the, Browser(the.app) as ann:
        driving = asyncio.ensure_future(ann.keep_driving(0.3, 10.0))
        await asyncio.sleep(1.5)
        assert the.speed == pytest.approx(0.3, abs=0.01)
        await the.sim.unplug()
        await asyncio.sleep(1.0)
        the.sim.plugged = True
        await asyncio.sleep(6.0)
        assert ann.latest("status")["state"] == "connected"
        assert the.speed == 0.0
        await driving
        ann.drive(0.0)
        await ann.keep_driving(0.3, 2.0)
        assert the.speed == pytest.approx(0.3, abs=0.01)


async def test_a_visitor_during_an_outage_is_told_of_it() -> None:
    async with product() as the:
        await the.sim.unplug()
        await asyncio.sleep(0.5)
        async with Browser(the.app) as ann:
            assert ann.all("status")[0]["state"] in {"lost", "connecting"}
            assert ann.all("hello")[0]["robots"][0]["shape"]["model"] == "p3at-sh"
            ann.drive(0.3)
            await asyncio.sleep(1.0)
            assert ann.snapshots() == []


async def test_visitors_are_let_go_when_the_robot_is_closed() -> None:
    async with product() as the:
        ann = await Browser(the.app).__aenter__()
    async with asyncio.timeout(1.0):
        await ann.task


async def test_every_way_of_leaving_leaves_no_task_behind() -> None:
    async with product() as the:
        before = asyncio.all_tasks()
        async with Browser(the.app) as ann:
            ann.drive(0.2)
            await asyncio.sleep(0.2)
        await asyncio.sleep(0)
        assert asyncio.all_tasks() == before


def test_the_nonsense_is_nonsense_for_a_reason() -> None:
    """All of it, without what is wrong, is fine."""
    from pioneer3.web.requests import VelocityRequest, decode

    fine: dict[str, Any] = {"type": "drive", "v": 0.3, "w": 0}
    assert decode(json.dumps(fine)) == VelocityRequest(0.3, 0.0)


async def test_a_page_that_was_frozen_does_not_drive_on() -> None:
    async with product() as the, Browser(the.app) as ann:
        await ann.keep_driving(0.3, 1.5)
        assert the.speed == pytest.approx(0.3, abs=0.01)
        await asyncio.sleep(4.0)
        await ann.keep_driving(0.3, 1.5)
        assert the.speed == 0.0
        assert "fell silent" in ann.latest("refused")["message"]
        ann.drive(0.0, 0.0)
        await ann.keep_driving(0.3, 1.5)
        assert the.speed == pytest.approx(0.3, abs=0.01)
