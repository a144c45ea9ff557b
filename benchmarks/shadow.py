"""Whether a digital shadow names faults and keeps quiet: run as `python -m benchmarks.shadow`.

Robots with mass drive at random, in simulated time, and their place on a map is known to
centimetres. After a while a side drags, the wheels slip, or a person holds the robot.
"""

import argparse
import asyncio
from collections.abc import Callable, Sequence
from contextlib import AbstractAsyncContextManager
from functools import partial
from math import inf, radians
from random import Random
from statistics import median
from typing import Any

from benchmarks.calibration import in_simulated_time
from pioneer3.errors import MotionError
from pioneer3.geometry import Pose2, wrap
from pioneer3.models import physics_of
from pioneer3.runtime.connect import connect_robot
from pioneer3.runtime.parting import Cause
from pioneer3.runtime.robot import Robot
from pioneer3.sim.realism import Realism
from tests.support import SimulatedRobot

SPEEDS = (0.2, 0.7)
"""Speeds of drives with a fault [m/s]."""
USUAL_SPEEDS = (-0.2, 0.7)
"""Speeds of normal driving [m/s]."""
MOST_TURN = 0.5
"""Turn rate to each side at most [rad/s]."""
SOUND = 8.0
"""Time before the fault [s]."""
WITHIN = 5.0
"""Time within which it is to be named [s]."""
HOUR = 3600.0
"""Time of normal driving [s]."""
PLACE_NOISE = 0.003
"""Standard deviation of what a report adds to the error of the place on the map [m]."""
HEADING_NOISE = radians(0.1)
"""The same of the heading on it [rad]."""
KEPT = 0.9
"""Share of the error that the next report has, too; it is 7 mm and 0.2 degrees altogether."""
SLIP = 0.05
"""Share of the way that slips away."""
GRIP = 4000.0
"""Stiffness of the hands of a person who holds the robot [N/m]; damped, and not in a turn."""
GRIP_TURN = 40.0
"""The same about the upright axis [Nm/rad]."""
STRENGTH = 400.0
"""Force of a person at most [N]."""

Fault = Callable[[SimulatedRobot], Callable[[], None]]


def scene_of(sim: SimulatedRobot) -> Any:
    """Return the compiled world of a robot with mass."""
    return sim.world.dynamics.scene  # type: ignore[attr-defined]


def drags(share: float, side: int) -> Fault:
    """Return the fault of a side that drags with a share of the torque of its motor."""

    def begin(sim: SimulatedRobot) -> Callable[[], None]:
        scene = scene_of(sim)
        wheels = scene.wheel_speeds[side, 0]
        torque = share * physics_of(sim.body.model).side_torque
        scene.model.dof_frictionloss[wheels] += torque / len(wheels)
        return lambda: None

    return begin


def slips(sim: SimulatedRobot) -> Callable[[], None]:
    """Let the robot come less far than its wheels tell, from now on."""
    last = sim.body.robot_in_world

    def step() -> None:
        nonlocal last
        moved = last.inverse() @ sim.body.robot_in_world
        back = Pose2(-SLIP * moved.x, -SLIP * moved.y)
        last = sim.body.robot_in_world @ back
        data, at = scene_of(sim).data, scene_of(sim).base[0]
        data.qpos[at], data.qpos[at + 1] = last.x, last.y

    return step


def holds(sim: SimulatedRobot) -> Callable[[], None]:
    """Let a person hold the robot from now on."""
    scene, there = scene_of(sim), sim.body.robot_in_world
    first = scene.base_speed[0]

    def step() -> None:
        here, (vx, vy, *_, w) = sim.body.robot_in_world, scene.data.qvel[first : first + 6].tolist()
        damping, damping_turn = GRIP / 30, GRIP_TURN / 15
        forces = [
            GRIP * (there.x - here.x) - damping * vx,
            GRIP * (there.y - here.y) - damping * vy,
        ]
        torque = GRIP_TURN * wrap(there.theta - here.theta) - damping_turn * w
        scene.data.xfrc_applied[scene.bodies[0]] = (
            *(max(-STRENGTH, min(STRENGTH, force)) for force in forces),
            *(0.0, 0.0, 0.0),
            torque,
        )

    return step


HELD = {Cause.HELD, Cause.SPINS}
DRAGS = ({Cause.LEFT_DRAGS, Cause.SLOW}, {Cause.RIGHT_DRAGS, Cause.SLOW})
"""Right names for the left side, and for the right one."""


class Drive:
    """A drive of one robot with mass beside its twin."""

    def __init__(self, model: str, seed: int) -> None:
        self.random = Random(seed)
        self.sim = SimulatedRobot(model=model, realism=Realism(), seed=seed, physics="mujoco")
        self.told: list[tuple[float, Cause]] = []
        self._off = (0.0, 0.0, 0.0)

    def connected(self) -> AbstractAsyncContextManager[Robot]:
        """Return the connection to the robot, whose shadow knows its place."""
        return connect_robot(self.sim.open, record=False, shadow=True)

    def odom_in_map(self, robot: Robot) -> Pose2:
        """Return where odometry's frame is, as well as a localizer knows it."""
        assert robot.snapshot is not None
        new = map(self.random.gauss, (0.0,) * 3, (PLACE_NOISE, PLACE_NOISE, HEADING_NOISE))
        x, y, theta = (KEPT * old + each for old, each in zip(self._off, new, strict=True))
        self._off = x, y, theta
        seen = self.sim.body.robot_in_world @ Pose2(x, y, theta)
        return seen @ robot.snapshot.odometry.robot_in_odom.inverse()

    async def go(self, robot: Robot, seconds: float, speeds: tuple[float, float]) -> None:
        """Drive at random; note what is told, and when [s]."""
        assert robot.shadow is not None
        left = 0
        speed = turn = 0.0
        for tick in range(round(10 * seconds)):
            if not left:
                left = self.random.randint(10, 40)
                speed = self.random.uniform(*speeds)
                turn = self.random.choice((0.0, self.random.uniform(-MOST_TURN, MOST_TURN)))
            left -= 1
            try:
                robot.drive(speed, turn)
            except MotionError:
                robot.drive(0.0)  # let go, and ask again
            await asyncio.sleep(0.1)
            if robot.shadow.parting is not None:
                self.told.append(((tick + 1) / 10, robot.shadow.parting.cause))


Told = Sequence[tuple[float, Cause]]


async def named(model: str, seed: int, fault: Fault) -> Told:
    """Return what is told of a fault, and when [s]; negative if that is before it was there."""
    drive = Drive(model, seed)
    async with drive.sim, drive.connected() as robot:
        assert robot.shadow is not None
        robot.shadow.odom_in_map = partial(drive.odom_in_map, robot)
        await drive.go(robot, SOUND, SPEEDS)
        if drive.told:
            return [(at - SOUND, cause) for at, cause in drive.told]
        drive.sim.stepped = fault(drive.sim)
        await drive.go(robot, WITHIN, SPEEDS)
    return drive.told


async def false_alarms(model: str, seed: int) -> list[Cause]:
    """Return what is told in an hour of normal driving."""
    drive = Drive(model, seed)
    async with drive.sim, drive.connected() as robot:
        assert robot.shadow is not None
        robot.shadow.odom_in_map = partial(drive.odom_in_map, robot)
        await drive.go(robot, HOUR, USUAL_SPEEDS)
    return [cause for _, cause in drive.told]


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--drives", type=int, default=10)
    parser.add_argument("--models", nargs="*", default=["p3dx-sh", "p3at-sh"])
    parser.add_argument("--shares", nargs="*", type=float, default=[0.1, 0.95, 1.0, 1.25])
    parser.add_argument("--no-hour", action="store_true")
    options = parser.parse_args()
    print("| robot | fault | named within 5 s | when, median | what else is told |", flush=True)
    for model in options.models:
        rows: list[tuple[str, list[tuple[Fault, set[Cause]]]]] = [
            ("5 % slip", [(slips, {Cause.SLIPS})]),
            ("a person holds it", [(holds, HELD)]),
        ]
        for share in options.shares:
            sides = [(drags(share, side), DRAGS[side]) for side in range(2)]
            rows.append((f"a side drags with {100 * share:g} % of its torque", sides))
        for words, faults in rows:
            found: list[float] = []
            others = []
            for number in range(options.drives):
                begin, causes = faults[number % len(faults)]
                told = in_simulated_time(named(model, number, begin))
                right = min((at for at, cause in told if cause in causes), default=inf)
                if 0 <= right < inf:
                    found.append(right)
                wrong = {cause: at for at, cause in reversed(told) if cause not in causes}
                others += [f"{at:.1f} s: {cause}" for cause, at in wrong.items()]
            when = f"{median(found):.1f} s" if found else ""
            row = f"{len(found)} of {options.drives} | {when} | {'; '.join(others)}"
            print(f"| {model} | {words} | {row} |", flush=True)
        if not options.no_hour:
            alarms = in_simulated_time(false_alarms(model, seed=1000))
            words = ", ".join(sorted(set(alarms))) or "nothing"
            print(f"| {model} | none, for an hour | | | {words} |", flush=True)


if __name__ == "__main__":
    main()
