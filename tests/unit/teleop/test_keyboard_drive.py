"""The keyboard joined to a robot. Virtual time."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass

import pytest

from pioneer3 import Robot, connect_async
from pioneer3.runtime.arbiter import Arbiter
from pioneer3.teleop.keyboard import HOLD, PATIENCE, Key, Keyboard
from pioneer3.teleop.keyboard_drive import COMMAND_TIMEOUT, KeyboardDriver
from tests.support import SimulatedRobot

BRAKING = 0.45
"""From 0.5 m/s to a stand, with a cycle of reports before it [s]."""


@dataclass(frozen=True)
class Seat:
    """Where somebody sits and types."""

    sim: SimulatedRobot
    robot: Robot
    driver: KeyboardDriver
    typed: asyncio.Queue[Key | None]
    driving: asyncio.Task[None]
    lines: list[str]

    @property
    def arbiter(self) -> Arbiter:
        return self.robot.arbiter

    def press(self, *keys: Key) -> None:
        for key in keys:
            self.typed.put_nowait(key)

    async def hold(self, key: Key, seconds: float) -> None:
        """Hold a key: a press, the pause of a keyboard, then its repeats."""
        end = asyncio.get_running_loop().time() + seconds
        self.press(key)
        await asyncio.sleep(min(0.5, seconds))
        while asyncio.get_running_loop().time() < end:
            self.press(key)
            await asyncio.sleep(0.033)


@asynccontextmanager
async def seat(*, latch: bool = False, patience: float = PATIENCE) -> AsyncIterator[Seat]:
    """Take a seat at the keyboard of a simulated robot."""
    async with SimulatedRobot() as sim, connect_async(sim.open) as robot:
        typed: asyncio.Queue[Key | None] = asyncio.Queue()

        async def keys() -> AsyncIterator[Key]:
            while (key := await typed.get()) is not None:
                yield key

        lines: list[str] = []
        keyboard = Keyboard(latch=latch, patience=patience, max_speed=0.7, max_turn_rate=1.0)
        driver = KeyboardDriver(robot, keyboard, lines.append)
        driving = asyncio.ensure_future(driver.run(keys()))
        yield Seat(sim, robot, driver, typed, driving, lines)
        typed.put_nowait(None)
        await asyncio.wait([driving])


async def test_one_press_moves_and_ends_by_itself() -> None:
    async with seat() as the:
        the.press(Key.FORWARD)
        await asyncio.sleep(HOLD - 0.01)
        assert the.arbiter.driving_action == "keyboard"
        assert the.sim.speed > 0.05
        await asyncio.sleep(0.02)
        assert the.arbiter.driving_action is None
        await asyncio.sleep(BRAKING)
        assert the.sim.speed == 0.0
        assert the.sim.body.robot_in_world.x > 0.02


@pytest.mark.parametrize(("key", "sign"), [(Key.FORWARD, 1), (Key.BACK, -1)])
async def test_a_held_key_drives_without_a_gap(key: Key, sign: int) -> None:
    async with seat() as the:
        await the.hold(key, 2.5)
        assert the.sim.speed == pytest.approx(sign * 0.5)


@pytest.mark.parametrize(("key", "sign"), [(Key.LEFT, 1), (Key.RIGHT, -1)])
async def test_left_turns_counter_clockwise(key: Key, sign: int) -> None:
    async with seat() as the:
        await the.hold(key, 1.5)
        assert the.sim.body.speeds[1] == pytest.approx(sign * 0.5, abs=0.02)


async def test_space_stops_a_held_key_at_once() -> None:
    async with seat() as the:
        await the.hold(Key.FORWARD, 2.0)
        the.press(Key.STOP)
        await asyncio.sleep(BRAKING)
        assert the.sim.speed == 0.0


async def test_a_key_pressed_right_after_the_space_bar_counts() -> None:
    async with seat() as the:
        await the.hold(Key.FORWARD, 1.0)
        the.press(Key.STOP)
        await the.hold(Key.BACK, 2.5)
        assert the.sim.speed == pytest.approx(-0.5, abs=0.01)


async def test_a_latched_key_keeps_moving_after_one_press() -> None:
    async with seat(latch=True) as the:
        the.press(Key.FORWARD)
        await asyncio.sleep(5.0)
        assert the.sim.speed == pytest.approx(0.5, abs=0.01)
        the.press(Key.STOP)
        await asyncio.sleep(2.0)
        assert the.sim.speed == 0.0


@pytest.mark.parametrize("patience", [PATIENCE, 3.0])
async def test_a_latched_key_stops_when_nobody_presses_another(patience: float) -> None:
    async with seat(latch=True, patience=patience) as the:
        the.press(Key.FORWARD)
        await asyncio.sleep(patience - 0.1)
        assert the.sim.speed == pytest.approx(0.5, abs=0.01)
        await asyncio.sleep(0.1 + BRAKING)
        assert the.sim.speed == 0.0
        assert the.lines[-1].startswith(f"No key for {patience:g} s. ")
        where = the.sim.body.robot_in_world.x
        await asyncio.sleep(60.0)
        the.press(Key.FASTER)  # a hand has come back, but the speed does not
        await asyncio.sleep(2.0)
        assert the.sim.body.robot_in_world.x == where
        the.press(Key.FORWARD)
        await asyncio.sleep(2.0)
        assert the.sim.speed > 0.4
        assert "No key" not in the.lines[-1]


async def test_keys_now_and_then_keep_a_latched_robot_going() -> None:
    async with seat(latch=True) as the:
        the.press(Key.LEFT)
        for _ in range(5):
            await asyncio.sleep(PATIENCE - 1.0)
            assert the.sim.body.speeds[1] > 0.4
            the.press(Key.FASTER)
            the.press(Key.SLOWER)


async def test_a_latched_key_does_not_survive_a_lost_link() -> None:
    async with seat(latch=True) as the:
        the.press(Key.FORWARD)
        await asyncio.sleep(2.0)
        await the.sim.unplug()
        await asyncio.sleep(1.0)
        the.sim.plugged = True
        await asyncio.sleep(8.0)
        assert the.robot.snapshot is not None
        assert the.sim.speed == 0.0
        the.press(Key.FORWARD)
        await asyncio.sleep(2.5)
        assert the.sim.speed == pytest.approx(0.5, abs=0.01)


@pytest.mark.parametrize("latch", [False, True])
async def test_motors_switched_off_while_moving_stay_off(*, latch: bool) -> None:
    async with seat(latch=latch) as the:
        await the.hold(Key.FORWARD, 1.5)
        assert the.sim.powered
        the.press(Key.MOTORS)
        await asyncio.sleep(2.0)
        assert not the.sim.powered
        assert not any("the robot switched" in line for line in the.lines)  # a person did


async def test_the_motor_key_switches_on_and_off_and_a_move_switches_on() -> None:
    async with seat() as the:
        for powered in (True, False):
            the.press(Key.MOTORS)
            await asyncio.sleep(1.0)
            assert the.sim.powered is powered
        await the.hold(Key.FORWARD, 1.5)
        assert the.sim.powered


@pytest.mark.parametrize("latch", [False, True])
async def test_the_emergency_key_latches_until_another_key_releases(*, latch: bool) -> None:
    async with seat(latch=latch) as the:
        await the.hold(Key.FORWARD, 1.5)
        the.press(Key.EMERGENCY)
        await asyncio.sleep(0.5)
        await the.hold(Key.FORWARD, 1.5)
        assert the.sim.speed == 0.0
        assert not the.sim.powered
        assert "emergency stop" in the.lines[-1]
        the.press(Key.EMERGENCY)  # pressed twice in a fright, it stays
        await the.hold(Key.FORWARD, 1.5)
        assert the.sim.speed == 0.0
        await asyncio.sleep(1.0)
        the.press(Key.RESET)
        await asyncio.sleep(1.0)
        assert not the.sim.powered
        await the.hold(Key.FORWARD, 2.5)
        assert the.sim.speed == pytest.approx(0.5, abs=0.01)


async def test_the_quit_key_ends_and_stops() -> None:
    async with seat() as the:
        await the.hold(Key.FORWARD, 2.0)
        the.press(Key.QUIT)
        await the.driving
        await asyncio.sleep(BRAKING)
        assert the.sim.speed == 0.0
        assert the.arbiter.driving_action is None


@pytest.mark.parametrize("way", ["end of keys", "cancel"])
async def test_every_other_way_out_stops_too(way: str) -> None:
    async with seat(latch=True) as the:
        the.press(Key.FORWARD)
        await asyncio.sleep(2.0)
        if way == "cancel":
            the.driving.cancel()
        else:
            the.typed.put_nowait(None)
        await asyncio.wait([the.driving])
        await asyncio.sleep(BRAKING)
        assert the.sim.speed == 0.0
        assert the.arbiter.driving_action is None


async def test_a_program_that_hangs_drives_no_longer_than_its_lease() -> None:
    async with seat(latch=True) as the:
        the.press(Key.FORWARD)
        await asyncio.sleep(2.0)
        renewing = [t for t in asyncio.all_tasks() if "_renew" in repr(t.get_coro())]
        assert len(renewing) == 1
        renewing[0].cancel()
        await asyncio.sleep(COMMAND_TIMEOUT + BRAKING)
        assert the.sim.speed == 0.0


async def test_the_live_line_shows_speed_pose_and_the_speeds_set() -> None:
    async with seat() as the:
        await the.hold(Key.FORWARD, 2.5)
        assert "0.50 m/s" in the.lines[-1]
        assert "[0.50 29]" in the.lines[-1]
        the.press(Key.FASTER)
        await asyncio.sleep(0.2)
        assert "[0.55 32]" in the.lines[-1]
        pose = the.sim.body.robot_in_world
        shown = the.lines[-1].partition("  x")[2].split(" y")[0]
        assert float(shown) == pytest.approx(pose.x, abs=0.1)


async def test_80_columns_hold_the_whole_line_while_it_moves() -> None:
    async with seat() as the:
        await the.hold(Key.FORWARD, 1.5)
        assert len(the.lines[-1]) < 80
        assert the.lines[-1].endswith("0°")


async def test_why_the_robot_stands_comes_first_for_narrow_terminals() -> None:
    async with seat() as the:
        await asyncio.sleep(0.3)
        assert the.lines[-1].startswith(
            "Nothing is asked of it, and the motors are off.  [0.50 29]"
        )


async def test_the_live_line_says_why_the_robot_stands() -> None:
    async with seat() as the:
        await asyncio.sleep(0.3)
        assert "Nothing is asked of it" in the.lines[-1]


async def test_the_live_line_tells_of_a_lost_link() -> None:
    async with seat() as the:
        await the.sim.unplug()
        await asyncio.sleep(0.3)
        assert the.lines[-1].split(":")[0] in {"LOST", "CONNECTING"}
