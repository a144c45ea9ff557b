"""Ten sessions, frame by frame: what the driver says, and when, does not change by accident.

`python -m tests.conformance.test_recorded_sessions` records them anew. Each file in `sessions` has
a line for each piece of bytes that the robot gets: the cable, the time [ms] and the bytes. The last
line is a digest of all answers of the robot. A difference is either meant, and then its commit
gives the reason, or it is a fault.
"""

import asyncio
import hashlib
from collections.abc import Awaitable, Callable
from contextlib import ExitStack
from math import pi
from pathlib import Path

import pytest

from pioneer3.behaviors.modes import goto, wander
from pioneer3.errors import MotionError
from pioneer3.geometry import Pose2
from pioneer3.navigation.connect import connect_async
from pioneer3.runtime.robot import Robot
from pioneer3.sim.equipment import Equipment
from pioneer3.sim.worldfile import load_map
from tests.conftest import VirtualTimeLoop
from tests.support import SimulatedRobot, hold, wall_at

FOLDER = Path(__file__).with_name("sessions")
Session = Callable[[Robot, SimulatedRobot], Awaitable[None]]
EVERYTHING = Equipment(gripper=True, compass=True, gyro_type=1, camera="vcc4", camera_port=2)


async def idle(driver: Robot, robot: SimulatedRobot) -> None:
    """Connect, listen, leave."""
    await asyncio.sleep(3)


async def stick(driver: Robot, robot: SimulatedRobot) -> None:
    """A stick that is held, turned, let go of, and held again; the last command expires."""
    await hold(driver, 0.3, 0.0, 2)
    await hold(driver, 0.2, 0.5, 2)
    await hold(driver, -0.3, -0.2, 1)
    driver.stop()
    await asyncio.sleep(1)
    await hold(driver, 9.0, -9.0, 2)
    await asyncio.sleep(2)


async def square(driver: Robot, robot: SimulatedRobot) -> None:
    """Moves and turns, each to its end."""
    for _ in range(4):
        await driver.move(0.6)
        await driver.turn(pi / 2)


async def emergency(driver: Robot, robot: SimulatedRobot) -> None:
    """An emergency stop while driving, a command against it, its reset, and on."""
    await hold(driver, 0.5, 0.0, 2)
    driver.emergency_stop()
    await hold(driver, 0.5, 0.0, 1)
    driver.reset_emergency_stop()
    await asyncio.sleep(1)
    await driver.motors(True)
    await hold(driver, 0.4, 0.3, 2)
    await driver.motors(False)


async def stall(driver: Robot, robot: SimulatedRobot) -> None:
    """Into a wall, held against it, back, and again."""
    await hold(driver, 0.4, 0.0, 4)
    await hold(driver, -0.3, 0.0, 2)
    await asyncio.sleep(1)
    await hold(driver, 0.4, 0.0, 3)


async def lost(driver: Robot, robot: SimulatedRobot) -> None:
    """The cable is pulled while driving and comes back; then the robot falls silent."""
    await hold(driver, 0.4, 0.0, 1)
    await robot.unplug()
    await asyncio.sleep(3)
    robot.plugged = True
    await asyncio.sleep(3)
    await hold(driver, 0.4, 0.0, 1)
    robot.silent = True
    await asyncio.sleep(4)
    robot.silent = False
    await asyncio.sleep(4)
    await hold(driver, -0.2, 0.4, 1)


async def stop_button(driver: Robot, robot: SimulatedRobot) -> None:
    """The button on the robot is pressed and released while a stick is held."""
    held = asyncio.ensure_future(hold(driver, 0.3, 0.1, 6))
    await asyncio.sleep(2)
    robot.body.stop_button = True
    await asyncio.sleep(2)
    robot.body.stop_button = False
    await held
    await asyncio.sleep(1)
    await hold(driver, 0.3, 0.1, 1)


async def wandering(driver: Robot, robot: SimulatedRobot) -> None:
    """Half a minute of wandering through an office, with all errors."""
    await driver.run(wander(), 30)


async def goals(driver: Robot, robot: SimulatedRobot) -> None:
    """To two points, the second behind a wall."""
    await driver.goto(1.0, 0.5, pi / 2)
    try:
        await driver.run(goto(9.0, 0.0, None, speed=0.5), 20)
    except MotionError:
        await asyncio.sleep(1)


async def devices(driver: Robot, robot: SimulatedRobot) -> None:
    """Everything that the robot carries is asked, moved and let go of."""
    await asyncio.sleep(1)
    gripper, camera = driver.devices.gripper, driver.devices.camera("vcc4", port=2)
    gripper.close()
    await camera.connect()
    camera.look(0.5, 0.1)
    sensors = (
        driver.devices.lines,
        driver.devices.compass,
        driver.devices.gyro,
        driver.devices.laser,
    )
    with ExitStack() as asked:
        for sensor in sensors:
            asked.enter_context(sensor.wanted())
        await hold(driver, 0.2, 0.4, 2)
    camera.zoom(0.5)
    gripper.open()
    gripper.lift_up()
    await asyncio.sleep(2)


SESSIONS: dict[str, Session] = {
    session.__name__: session
    for session in (
        idle, stick, square, emergency, stall, lost, stop_button, wandering, goals, devices
    )
}  # fmt: skip
PLACES: dict[str, Callable[[], SimulatedRobot]] = {
    "idle": lambda: SimulatedRobot(model="p3dx-sh"),
    "stall": lambda: SimulatedRobot(wall_at(1.2)),
    "wandering": lambda: SimulatedRobot(load_map("office"), home=Pose2(1, 1, 0), seed=3),
    "goals": lambda: SimulatedRobot(wall_at(2.5)),
    "devices": lambda: SimulatedRobot(wall_at(2.5), equipment=EVERYTHING),
}


async def record(name: str) -> list[str]:
    """Return the lines of the session `name`."""
    answered = hashlib.sha256()
    async with PLACES.get(name, SimulatedRobot)() as robot:

        def note(data: bytes) -> tuple[bytes, ...]:
            answered.update(data)
            return (data,)

        robot.to_host = note
        async with connect_async(robot.open) as driver:
            await SESSIONS[name](driver, robot)
        await asyncio.sleep(1)
        lines = [
            f"{cable} {at * 1000:8.0f} {data.hex(' ')}"
            for cable, wire in enumerate(robot.wires)
            for at, data in wire.chunks
        ]
    return [*lines, f"answers {answered.hexdigest()}"]


@pytest.mark.planar("frames are recorded to the last bit of the plane")
@pytest.mark.parametrize("name", SESSIONS)
async def test_the_same_frames_as_ever(name: str) -> None:
    assert await record(name) == (FOLDER / f"{name}.txt").read_text().splitlines()


if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    for each in SESSIONS:
        with asyncio.Runner(loop_factory=VirtualTimeLoop) as runner:
            (FOLDER / f"{each}.txt").write_text("\n".join(runner.run(record(each))) + "\n")
