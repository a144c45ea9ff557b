"""Who drives when several want to, and what a stop ends. Virtual time."""

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import ExitStack, asynccontextmanager
from dataclasses import dataclass

import pytest

from pioneer3 import MotionError, Robot, connect_async
from pioneer3.arcos.commands import Sonar
from pioneer3.behaviors.action import MODE, Action, Desire, Situation, Stack
from pioneer3.behaviors.actions import Hold
from pioneer3.behaviors.modes import follow, goto, wander
from pioneer3.geometry import STILL, Twist2
from pioneer3.runtime.arbiter import GAMEPAD, KEYBOARD, PROGRAM, WEB, Arbiter
from tests.support import SimulatedRobot, is_at, wall_at

LONG = 0.5
FORTH, BACK, TURNING = Twist2(0.3, 0.0), Twist2(-0.2, 0.0), Twist2(0.0, 0.5)
STOPPED = "somebody stopped the robot; let go, then ask again"


@dataclass(frozen=True)
class Bridge:
    """A robot, and everybody who could drive it."""

    sim: SimulatedRobot
    robot: Robot
    keyboard: Hold
    web: Hold
    program: Hold

    @property
    def arbiter(self) -> Arbiter:
        return self.robot.arbiter

    @property
    def asked(self) -> Twist2:
        """What the robot is asked to do now."""
        return self.robot.supervisor.pilot.asked(asyncio.get_running_loop().time())

    async def keep(self, held: Hold, twist: Twist2, seconds: float) -> None:
        """Hold `twist` as a key does."""
        for _ in range(round(seconds / 0.1)):
            self.arbiter.hold(held, twist, LONG)
            await asyncio.sleep(0.1)


@asynccontextmanager
async def bridge() -> AsyncIterator[Bridge]:
    """Man the bridge."""
    async with SimulatedRobot() as sim, connect_async(sim.open) as robot:
        the = Bridge(sim, robot, Hold("keyboard"), Hold("web"), Hold("program"))
        robot.arbiter.add(the.program, PROGRAM)
        robot.arbiter.add(the.web, WEB)
        robot.arbiter.add(the.keyboard, KEYBOARD)
        yield the


def test_hands_come_before_programs_and_near_before_far() -> None:
    assert GAMEPAD > KEYBOARD > WEB > PROGRAM


async def test_nobody_drives_to_begin_with() -> None:
    async with bridge() as the:
        assert the.arbiter.driving_action is None
        assert the.asked == STILL


async def test_the_keyboard_wins_over_the_page_and_the_page_over_a_program() -> None:
    async with bridge() as the:
        the.arbiter.hold(the.program, TURNING, LONG)
        assert (the.arbiter.driving_action, the.asked) == ("program", TURNING)
        the.arbiter.hold(the.web, BACK, LONG)
        assert (the.arbiter.driving_action, the.asked) == ("web", BACK)
        the.arbiter.hold(the.keyboard, FORTH, LONG)
        assert (the.arbiter.driving_action, the.asked) == ("keyboard", FORTH)
        the.arbiter.hold(the.program, TURNING, LONG)
        the.arbiter.hold(the.web, BACK, LONG)
        assert (the.arbiter.driving_action, the.asked) == ("keyboard", FORTH)


async def test_who_lets_go_leaves_the_robot_to_the_next() -> None:
    async with bridge() as the:
        the.arbiter.hold(the.program, TURNING, LONG)
        the.arbiter.hold(the.keyboard, FORTH, LONG)
        the.arbiter.release(the.keyboard)
        assert (the.arbiter.driving_action, the.asked) == ("program", TURNING)
        the.arbiter.release(the.program)
        assert (the.arbiter.driving_action, the.asked) == (None, STILL)


async def test_letting_go_without_holding_disturbs_nobody() -> None:
    async with bridge() as the:
        the.arbiter.hold(the.web, FORTH, LONG)
        the.arbiter.release(the.keyboard)
        the.arbiter.release(the.program)
        assert (the.arbiter.driving_action, the.asked) == ("web", FORTH)


async def test_a_wish_expires_to_the_moment_and_the_next_takes_over_within_a_cycle() -> None:
    async with bridge() as the:
        the.arbiter.hold(the.program, TURNING, LONG)
        the.arbiter.hold(the.keyboard, FORTH, 0.25)
        await asyncio.sleep(0.249)
        assert (the.arbiter.driving_action, the.asked) == ("keyboard", FORTH)
        await asyncio.sleep(0.001 + 1e-9)
        assert the.arbiter.driving_action != "keyboard"
        assert the.asked != FORTH
        await asyncio.sleep(0.1)
        assert (the.arbiter.driving_action, the.asked) == ("program", TURNING)


async def test_a_wish_that_is_renewed_lasts_from_then_on_and_is_resolved_once() -> None:
    async with bridge() as the:
        the.arbiter.hold(the.program, FORTH, LONG)
        first = the.arbiter.decision
        await asyncio.sleep(0.2)
        assert the.arbiter.decision is first
        the.arbiter.hold(the.program, FORTH, LONG)
        assert the.arbiter.decision.until == pytest.approx(first.until + 0.2)
        assert the.arbiter.decision.contributions is first.contributions
        the.arbiter.hold(the.program, BACK, LONG)
        assert the.arbiter.decision.twist == BACK


async def test_a_wish_of_zero_is_a_wish_and_holds_the_robot_back() -> None:
    async with bridge() as the:
        the.arbiter.hold(the.program, FORTH, LONG)
        the.arbiter.hold(the.keyboard, STILL, LONG)
        assert (the.arbiter.driving_action, the.asked) == ("keyboard", STILL)


async def test_an_action_that_is_taken_out_ends_at_once() -> None:
    async with bridge() as the:
        the.arbiter.hold(the.keyboard, FORTH, LONG)
        the.arbiter.remove(the.keyboard)
        assert the.keyboard not in the.arbiter
        assert (the.arbiter.driving_action, the.asked) == (None, STILL)
        the.arbiter.remove(the.keyboard)


async def test_actions_are_known_by_identity_not_by_name() -> None:
    async with bridge() as the:
        assert the.keyboard in the.arbiter
        assert Hold("keyboard") not in the.arbiter


async def test_a_stop_ends_what_everybody_wants() -> None:
    async with bridge() as the:
        for held in (the.keyboard, the.web, the.program):
            the.arbiter.hold(held, FORTH, LONG)
        the.arbiter.stop()
        assert (the.arbiter.driving_action, the.asked) == (None, STILL)
        await asyncio.sleep(1.0)
        assert the.sim.body.robot_in_world.x < 0.01


async def test_what_was_held_during_a_stop_stays_muted_while_it_is_renewed() -> None:
    async with bridge() as the:
        the.arbiter.hold(the.web, FORTH, LONG)
        the.arbiter.stop(by=the.keyboard)
        for _ in range(20):
            assert str(the.arbiter.hold(the.web, FORTH, LONG)) == STOPPED
            assert the.arbiter.driving_action is None
            await asyncio.sleep(0.1)
        assert the.sim.speed == 0.0


async def test_a_muted_hold_counts_again_once_released() -> None:
    async with bridge() as the:
        the.arbiter.hold(the.web, FORTH, LONG)
        the.arbiter.stop()
        the.arbiter.release(the.web)
        assert the.arbiter.hold(the.web, FORTH, LONG) is None
        assert the.arbiter.driving_action == "web"


async def test_a_muted_hold_counts_again_after_it_has_run_out() -> None:
    async with bridge() as the:
        the.arbiter.hold(the.web, FORTH, LONG)
        the.arbiter.stop()
        await asyncio.sleep(LONG - 0.01)
        assert str(the.arbiter.hold(the.web, FORTH, LONG)) == STOPPED
        await asyncio.sleep(LONG)
        assert the.arbiter.hold(the.web, FORTH, LONG) is None
        assert the.arbiter.driving_action == "web"


async def test_what_was_not_held_during_a_stop_is_not_muted() -> None:
    async with bridge() as the:
        the.arbiter.hold(the.web, FORTH, 0.1)
        await asyncio.sleep(0.11)
        the.arbiter.stop()
        assert the.arbiter.hold(the.web, FORTH, LONG) is None
        assert the.arbiter.hold(the.keyboard, BACK, LONG) is None


async def test_who_stops_may_drive_again_at_once_and_the_others_may_not() -> None:
    async with bridge() as the:
        the.arbiter.hold(the.web, FORTH, LONG)
        the.arbiter.hold(the.keyboard, BACK, LONG)
        the.arbiter.stop(by=the.keyboard)
        assert str(the.arbiter.hold(the.web, FORTH, LONG)) == STOPPED
        assert the.arbiter.hold(the.keyboard, BACK, LONG) is None
        assert (the.arbiter.driving_action, the.asked) == ("keyboard", BACK)


async def test_a_stop_by_somebody_ends_a_move() -> None:
    async with bridge() as the:
        moving = asyncio.ensure_future(the.robot.move(5.0))
        await asyncio.sleep(2.0)
        assert the.sim.speed > 0.2
        the.arbiter.stop(by=the.web)
        with pytest.raises(MotionError, match="somebody stopped the robot"):
            await moving
        await asyncio.sleep(1.0)
        assert the.sim.speed == 0.0
        assert the.sim.body.robot_in_world.x < 2.0


async def test_a_key_interrupts_a_move_which_goes_on_afterwards() -> None:
    async with bridge() as the:
        moving = asyncio.ensure_future(the.robot.move(1.0))
        await asyncio.sleep(1.0)
        await the.keep(the.keyboard, BACK, 1.5)
        assert the.sim.speed < 0
        assert the.arbiter.driving_action == "keyboard"
        the.arbiter.release(the.keyboard)
        await moving
        assert the.sim.body.robot_in_world.x == pytest.approx(1.0, abs=0.02)


async def test_an_emergency_stop_mutes_everybody_and_takes_the_power() -> None:
    async with bridge() as the:
        await the.keep(the.keyboard, FORTH, 1.5)
        assert the.sim.speed == pytest.approx(0.3, abs=0.01)
        the.arbiter.emergency_stop()
        await the.keep(the.keyboard, FORTH, 1.0)
        assert the.sim.speed == 0.0
        assert not the.sim.powered
        the.robot.reset_emergency_stop()
        await the.keep(the.keyboard, FORTH, 1.0)
        assert not the.sim.powered


async def test_who_lets_go_and_asks_again_at_once_drives_after_a_reset() -> None:
    async with bridge() as the:
        await the.keep(the.keyboard, FORTH, 1.0)
        the.arbiter.emergency_stop()
        await the.keep(the.keyboard, FORTH, 0.3)
        the.robot.reset_emergency_stop()
        assert the.arbiter.hold(the.keyboard, FORTH, LONG) is not None
        the.arbiter.release(the.keyboard)
        assert the.arbiter.hold(the.keyboard, FORTH, LONG) is None
        assert (the.arbiter.driving_action, the.asked) == ("keyboard", FORTH)


async def test_letting_go_answers_no_block_for_somebody_else_who_holds_on() -> None:
    async with bridge() as the:
        await the.keep(the.program, FORTH, 1.0)
        the.sim.body.stop_button = True
        await the.keep(the.program, FORTH, 0.5)
        the.sim.body.stop_button = False
        the.arbiter.release(the.keyboard)
        await the.keep(the.program, FORTH, 1.0)
        assert the.asked == STILL
        assert the.sim.speed == 0.0


@dataclass
class Waiting(Action):
    """Stands until there is something to go to, as following does."""

    name: str = "waiting"
    goes: bool = False
    lacks: bool = False

    def decide(self, situation: Situation) -> Desire:
        v = 0.3 if self.goes else 0.0
        return Desire(v=v, w=0.0, reason="waits", lacks=self.lacks)


async def _press_the_button(the: Bridge) -> None:
    the.sim.body.stop_button = True
    await asyncio.sleep(1.0)
    the.sim.body.stop_button = False


async def _lose_the_link(the: Bridge) -> None:
    the.sim.silent = True
    await asyncio.sleep(15.0)
    the.sim.silent = False
    await asyncio.sleep(10.0)


@pytest.mark.parametrize("happens", [_press_the_button, _lose_the_link])
async def test_a_mode_that_waits_ends_as_one_that_drives(
    happens: Callable[[Bridge], Awaitable[None]],
) -> None:
    async with bridge() as the:
        waiting = Waiting()
        assert the.arbiter.start(Stack.alone(waiting, MODE)) is None
        await asyncio.sleep(1.0)
        await happens(the)
        assert the.arbiter.mode is None
        waiting.goes = True
        await the.keep(the.keyboard, BACK, 1.0)  # somebody's fresh press
        the.arbiter.release(the.keyboard)
        await asyncio.sleep(2.0)
        assert the.sim.speed == 0.0


@pytest.mark.parametrize(
    ("lacks", "seconds", "goes_on"), [(True, 1.5, True), (True, 2.5, False), (False, 5.0, True)]
)
async def test_a_mode_that_does_not_know_enough_goes_on_by_itself_only_after_a_moment(
    lacks: bool, seconds: float, goes_on: bool
) -> None:
    async with bridge() as the:
        waiting = Waiting(lacks=lacks)
        the.arbiter.start(Stack.alone(waiting, MODE))
        await asyncio.sleep(seconds)
        waiting.goes = True
        await asyncio.sleep(1.0)
        assert (the.sim.speed > 0) is goes_on
        if not goes_on:
            assert the.arbiter.ended is not None
            assert the.arbiter.ended.why == "waits; start it again when that is mended"


@dataclass
class Forbidding(Action):
    """Lets no mode move ahead."""

    name: str = "forbidding"

    def decide(self, situation: Situation) -> Desire:
        return Desire(v_max=0.0, reason="a wall")


async def test_each_last_check_holds_until_its_own_end_whichever_began_first() -> None:
    async with bridge() as the:
        before, after = ExitStack(), ExitStack()
        before.enter_context(the.arbiter.checking(Forbidding()))
        after.enter_context(the.arbiter.checking(Forbidding()))
        before.close()  # as a map takes the place of the one before
        the.arbiter.start(Stack.alone(Waiting(goes=True), MODE))
        await asyncio.sleep(1.0)
        assert the.asked == STILL
        after.close()
        await asyncio.sleep(1.0)
        assert the.asked.v == 0.3


MODES_BY_SONAR = {
    **{f"wander {each}": wander(preset=each) for each in ("lab", "aria", "explore")},
    "goto": goto(8.0, 0.0),
    "follow": follow("tracking"),
    "follow by the lab's rule": follow("lab"),
}


@pytest.mark.parametrize("name", MODES_BY_SONAR)
async def test_a_robot_whose_sonars_come_back_after_a_moment_stands(name: str) -> None:
    async with SimulatedRobot(wall_at(1.6)) as sim, connect_async(sim.open) as robot:
        robot.send(Sonar(on=False))
        robot.arbiter.start(MODES_BY_SONAR[name])
        await asyncio.sleep(4.0)
        robot.send(Sonar(on=True))
        stood = sim.body.robot_in_world
        await asyncio.sleep(3.0)
        assert is_at(sim.body.robot_in_world, stood)
        assert robot.arbiter.ended is not None
        assert robot.arbiter.ended.why.endswith("; start it again when that is mended")


async def test_a_mode_that_is_started_while_latched_does_not_begin_with_the_reset() -> None:
    async with bridge() as the:
        the.arbiter.emergency_stop()
        waiting = Waiting()
        why = the.arbiter.start(Stack.alone(waiting, MODE))
        assert str(why) == "the emergency stop is latched"
        the.robot.reset_emergency_stop()
        waiting.goes = True
        await asyncio.sleep(2.0)
        assert the.sim.speed == 0.0
        assert not the.sim.powered


async def test_motors_switched_off_stay_off_whatever_is_held() -> None:
    async with bridge() as the:
        await the.keep(the.web, FORTH, 1.5)
        assert the.arbiter.set_motors(on=False) is None
        await the.keep(the.web, FORTH, 1.0)
        assert not the.sim.powered


async def test_motors_refused_say_why() -> None:
    async with bridge() as the:
        the.arbiter.emergency_stop()
        assert str(the.arbiter.set_motors(on=True)) == "the emergency stop is latched"


async def test_a_wish_without_a_robot_is_refused_and_not_kept_for_later() -> None:
    async with bridge() as the:
        await the.sim.unplug()
        await asyncio.sleep(0.5)
        assert the.arbiter.hold(the.keyboard, FORTH, LONG) is not None
        the.arbiter.release(the.keyboard)
        the.sim.plugged = True
        await asyncio.sleep(8.0)
        assert the.robot.snapshot is not None
        assert is_at(the.sim.body.robot_in_world, the.sim.body.home)


async def test_a_key_held_through_an_outage_must_be_let_go_first() -> None:
    async with bridge() as the:
        await the.keep(the.keyboard, FORTH, 1.5)
        await the.sim.unplug()
        await the.keep(the.keyboard, FORTH, 1.0)
        the.sim.plugged = True
        await the.keep(the.keyboard, FORTH, 8.0)
        assert the.robot.snapshot is not None
        assert the.sim.speed == 0.0
        await asyncio.sleep(1.0)
        await the.keep(the.keyboard, FORTH, 1.5)
        assert the.sim.speed == pytest.approx(0.3, abs=0.01)


async def test_what_was_sensed_is_kept_from_the_first_mode_on_where_only_inputs_drive() -> None:
    class Looks(Action):
        name = "looks"
        seen = 0

        def decide(self, situation: Situation) -> Desire | None:
            self.seen = max(self.seen, len(situation.around.points()))
            return None

    async with SimulatedRobot(wall_at(1.0)) as sim, connect_async(sim.open) as robot:
        robot.arbiter.remembers = False
        robot.arbiter.add(Hold("keyboard"), KEYBOARD)
        await asyncio.sleep(2)
        situation = robot.arbiter.situation()
        assert situation is not None
        assert not situation.around.points()
        assert not robot.arbiter.remembers
        looks = Looks()
        robot.arbiter.start(Stack.alone(looks, MODE))
        assert robot.arbiter.remembers
        await asyncio.sleep(2)
        assert looks.seen > 0
