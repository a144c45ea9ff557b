"""A robot driven over topics, without ROS: a simulated one at the far end, its driver between."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import replace

import pytest

from pioneer3.behaviors.actions import Hold
from pioneer3.behaviors.modes import wander
from pioneer3.errors import MotionError
from pioneer3.geometry import STILL, Twist2
from pioneer3.maps import LineMap
from pioneer3.navigation.connect import connect_async
from pioneer3.robot.limits import limits_for
from pioneer3.robot.supervisor import RobotInfo
from pioneer3.ros.client.robot import HELD, SILENT, STUCK, TopicRobot, TopicSupervisor
from pioneer3.ros.client.snapshots import SnapshotBuilder
from pioneer3.ros.messages import motion, sensors
from pioneer3.runtime.arbiter import PROGRAM
from pioneer3.runtime.robot import Robot
from pioneer3.state import Identity, Motors, Snapshot
from pioneer3.tasks import running
from pioneer3.teleop.keyboard import Key, Manner
from pioneer3.teleop.keyboard_drive import KeyboardDriver
from tests.support import SimulatedRobot, until, wall_at
from tests.unit.ros.support import P3AT, Blank, seen, update

NODE_TIMEOUT = 0.6


class Bench:
    """Both ends.

    Attributes:
        sim: The simulated robot.
        near: As its driver has it.
        far: As somebody has it who sees topics only.
        sent: Every velocity that went over the topic.
        talks: Whether its topics say anything.
    """

    def __init__(self, sim: SimulatedRobot, near: Robot, *, latches: bool) -> None:
        self.sim, self.near = sim, near
        latch = self._latch if latches else None
        self.sent: list[Twist2] = []
        self.switched: list[bool] = []
        self.latched: list[bool] = []
        self.talks = True
        self._hold = Hold("cmd_vel")
        near.arbiter.add(self._hold, PROGRAM)
        self._gatherer = SnapshotBuilder(near.info.model, motors_on=False)
        self.supervisor = TopicSupervisor(near.info, self._publish, self._switch, latch)
        self.far = TopicRobot(self.supervisor)

    async def tell(self) -> None:
        """Pass every reading on as messages."""
        async for snapshot in self.near.snapshots():
            if self.talks:
                self.say(snapshot)

    def say(self, snapshot: Snapshot) -> None:
        """Pass a reading on."""
        told, now = update(snapshot), asyncio.get_running_loop().time()
        pose, cloud, bumpers, motors, stop = Blank(), Blank(), Blank(), Blank(), Blank()
        motion.odometry(pose, told)
        stop.data = self.near.supervisor.pilot.emergency
        self._gatherer.emergency_stop(stop)
        sensors.sonar_cloud(cloud, told)
        sensors.bumpers(bumpers, told)
        sensors.motors(motors, told)
        self._gatherer.pose(pose)
        self._gatherer.sonar_cloud(cloud, now)
        self._gatherer.bumpers(bumpers)
        self._gatherer.motors(motors)
        gathered = self._gatherer.snapshot(now)
        assert gathered is not None
        self.supervisor.take(gathered)

    def _publish(self, twist: Twist2) -> None:
        self.sent.append(twist)
        self.near.arbiter.hold(self._hold, twist, NODE_TIMEOUT)

    def _switch(self, on: bool) -> None:
        self.switched.append(on)
        self.near.arbiter.set_motors(on=on)

    def _latch(self, on: bool) -> None:
        self.latched.append(on)
        if on:
            self.near.emergency_stop()
        else:
            self.near.reset_emergency_stop()


@asynccontextmanager
async def bench(line_map: LineMap | None = None, *, latches: bool = False) -> AsyncIterator[Bench]:
    """Join both ends while the block lasts."""
    async with SimulatedRobot(line_map) as sim, connect_async(sim.open) as near:
        the = Bench(sim, near, latches=latches)
        async with running(the.tell(), the.supervisor.run()):
            await until(lambda: the.far.snapshot)
            yield the
        assert the.sent == [] or the.sent[-1].is_zero


async def test_a_node_that_latches_its_emergency_stop_is_released_by_whoever_asks() -> None:
    async with bench(latches=True) as the:
        the.far.emergency_stop()
        await asyncio.sleep(1)
        assert (the.latched, the.switched) == ([True], [])
        assert "is latched" in str(the.far.why_not_moving())
        other = TopicSupervisor(the.near.info, lambda twist: None, the._switch, the._latch)
        snapshot = the.far.snapshot
        assert snapshot is not None
        other.take(snapshot)
        assert other.why_not_moving() == HELD
        other.reset_emergency_stop()
        the.supervisor.reset_emergency_stop()
        await asyncio.sleep(1)
        assert the.latched == [True, False, False]
        assert not the.near.supervisor.pilot.emergency


async def test_an_emergency_stop_is_asked_for_again_when_the_robot_is_back() -> None:
    async with bench(latches=True) as the:
        the.talks = False
        await asyncio.sleep(SILENT + 0.2)
        the.far.emergency_stop()
        the.near.reset_emergency_stop()  # as if that had not reached it
        the.latched.clear()
        the.talks = True
        await until(lambda: the.far.snapshot)
        assert the.latched == [True]
        the.supervisor.reset_emergency_stop()


async def test_an_old_reading_counts_as_silence() -> None:
    async with bench() as the:
        the.talks = False
        await asyncio.sleep(SILENT + 0.2)
        reading = the.near.snapshot
        assert reading is not None
        the.supervisor.take(replace(reading, stamp=reading.stamp - 2 * SILENT))
        assert the.far.snapshot is None
        the.supervisor.take(reading)
        assert the.far.snapshot is not None


async def test_who_only_looks_sends_nothing() -> None:
    async with bench() as the:
        the.near.drive(0.2)
        await asyncio.sleep(3)
        assert the.sent == []


async def test_a_mode_drives_at_the_rate_of_readings_and_stops_at_its_end() -> None:
    async with bench() as the:
        await the.far.run(wander(), 5.0)
        assert the.sim.speed > 0.1
        assert len(the.sent) >= 45
        await asyncio.sleep(2)
        assert the.sim.speed == 0.0


async def test_a_mode_keeps_clear_of_walls() -> None:
    async with bench(wall_at(2.0)) as the:
        await the.far.run(wander(preset="aria"), 20.0)
        assert the.sim.body.drive.powered
        assert {twist.w for twist in the.sent} != {0.0}
        assert not the.near.snapshot or not the.near.snapshot.motors.stalled


async def test_when_the_topics_fall_silent_it_stands_and_the_mode_ends() -> None:
    async with bench() as the:
        running_mode = asyncio.ensure_future(the.far.run(wander()))
        await until(lambda: the.sim.speed > 0.1)
        the.talks = False
        await asyncio.sleep(SILENT + 0.2)
        assert the.sent[-1] == STILL
        assert the.far.snapshot is None
        await until(lambda: the.sim.speed == 0.0)
        the.talks = True
        with pytest.raises(MotionError, match="silent"):
            await running_mode
        await asyncio.sleep(2)
        assert the.sim.speed == 0.0


async def test_motors_that_somebody_switches_off_end_the_mode() -> None:
    async with bench() as the:
        running_mode = asyncio.ensure_future(the.far.run(wander()))
        await until(lambda: the.sim.speed > 0.1)
        await the.near.motors(on=False)
        with pytest.raises(MotionError, match="motors off"):
            await running_mode
        assert the.sim.speed == 0.0
        assert the.sent[-1] == STILL


async def test_a_robot_that_stands_though_told_to_move_gets_itself_free() -> None:
    async with bench() as the:
        running_mode = asyncio.ensure_future(the.far.run(wander()))
        await until(lambda: the.sim.speed > 0.1)
        the.sim.body.drive.halt()
        the.sim.stepped = the.sim.body.drive.halt  # the wheels are held
        await asyncio.sleep(STUCK + 1.0)
        assert "stalled" in "; ".join(the.far.arbiter.told)
        the.sim.stepped = lambda: None
        await until(lambda: the.sim.speed < -0.05)  # the first attempt is to back up
        running_mode.cancel()
        await asyncio.wait([running_mode])


async def test_keys_drive_it_and_its_driver_keeps_the_rules() -> None:
    async with bench() as the:
        pressed: asyncio.Queue[Key] = asyncio.Queue()

        async def keys() -> AsyncIterator[Key]:
            while True:
                yield await pressed.get()

        lines: list[str] = []
        keyboard = Manner(speed=0.5, turn_rate=0.5, latch=True).keyboard(the.far.info.limits)
        driving = asyncio.ensure_future(KeyboardDriver(the.far, keyboard, lines.append).run(keys()))
        pressed.put_nowait(Key.FORWARD)
        await asyncio.sleep(4)
        assert the.sim.speed == pytest.approx(0.5, abs=0.01)
        assert "0.50 m/s" in lines[-1]
        pressed.put_nowait(Key.STOP)
        await asyncio.sleep(2)
        assert the.sim.speed == 0.0
        pressed.put_nowait(Key.EMERGENCY)
        await asyncio.sleep(1)
        assert the.switched == [False]
        assert not the.sim.powered
        pressed.put_nowait(Key.FORWARD)
        await asyncio.sleep(1)
        assert the.sim.speed == 0.0
        assert "emergency" in lines[-1]
        pressed.put_nowait(Key.QUIT)
        await driving


async def test_who_leaves_while_it_moves_stops_it() -> None:
    async with bench() as the:
        the.far.arbiter.add(held := Hold("test"), PROGRAM)
        the.far.arbiter.hold(held, Twist2(0.3), 10.0)
        await until(lambda: the.sim.speed > 0.1)
    assert the.sent[-1] == STILL


@pytest.mark.parametrize("tells_stops", [False, True])
async def test_an_emergency_stop_holds_once_the_node_says_so(tells_stops: bool) -> None:
    info = RobotInfo(
        identity=Identity(name="r1", family="Pioneer", model=P3AT.name),
        model=P3AT,
        limits=limits_for(P3AT, None),
        config=None,
        url="/r1/pioneer3",
        speed=None,
    )
    robot = TopicSupervisor(info, lambda _: None, lambda _: None, tells_stops=tells_stops)
    clock = asyncio.get_running_loop().time
    assert not robot.without_power
    for motors, held in (
        (Motors(enabled=True), False),
        (Motors(enabled=False), not tells_stops),
        (Motors(enabled=True, stop_button=True), False),
        (Motors(enabled=False, stop_button=True), True),
    ):
        robot.take(replace(seen(motors=motors), stamp=clock()))
        assert robot.without_power == held
