"""How much smaller calibration makes errors: run as `python -m benchmarks.calibration`.

Each simulated robot has errors of 1 to 3 % of its own in each of the three ratios. It is measured
by a tape (3 mm, 1 degree) and its sonars, by its laser against a map, or by its laser alone. Then
it drives a square of 4 m both ways, with and without the correction, in simulated time.
"""

import argparse
import asyncio
from collections.abc import Coroutine, Mapping
from dataclasses import replace
from functools import cache
from math import degrees, hypot, pi, radians
from statistics import median
from typing import Any, TypeVar

import numpy as np

from pioneer3.calibration.calibration import Calibration
from pioneer3.calibration.course import drive
from pioneer3.calibration.steps import CalibrationStep, plan, usual_side
from pioneer3.errors import PioneerError
from pioneer3.geometry import ORIGIN, Pose2, wrap
from pioneer3.maps import LineMap
from pioneer3.models import OdometryCorrection, RobotModel, load_model
from pioneer3.models.odometry import UNCORRECTED
from pioneer3.robot.lasers.mounting import Mounting
from pioneer3.runtime.connect import connect_robot
from pioneer3.runtime.robot import Robot
from pioneer3.sim.realism import OdometryErrors, Realism
from pioneer3.tasks import FastTimeLoop
from tests.lasers import LaserUnit
from tests.support import SimulatedRobot

Result = TypeVar("Result")

SIDE = 4.0
"""Side of the square that judges [m]."""
TAPE = 0.003
"""Error of a tape [m]."""
ANGLE = radians(1)
"""Error of an angle by eye [rad]."""
OFF = 0.05
"""Error of the place of a laser that is to be found [m]."""
TURNED = radians(3)
"""Error of its heading [rad]."""
LATE = 0.05
"""Its delay [s]."""
CARRIED = 5.0
"""Time that somebody takes to put a robot back [s]; sonars see the walls anew meanwhile."""
CORNERS = (
    (-1.2, -1.0),
    (3.4, -1.0),
    (3.4, 3.2),
    (1.9, 3.2),
    (1.9, 2.6),
    (0.6, 2.6),
    (0.6, 3.2),
    (-1.2, 3.2),
)
"""Corners of the room in which robots are measured [m]."""


def room() -> LineMap:
    """Return the room."""
    ends = zip(CORNERS, (*CORNERS[1:], CORNERS[0]), strict=True)
    return LineMap(name="room", walls=np.array([(*a, *b) for a, b in ends]))


def errors_of(rng: np.random.Generator) -> Realism:
    """Return the errors of a robot: 1 to 3 % each, either way."""
    ratios = np.exp(rng.choice([-1, 1], 3) * np.log(rng.uniform(1.01, 1.03, 3))).tolist()
    wheel, base, scale = ratios
    return Realism(
        odometry=OdometryErrors(mode="constant", wheel_ratio=wheel, base_ratio=base, scale=scale)
    )


def simulated(
    model: str, realism: Realism, seed: int, *, mass: bool, walls: bool
) -> SimulatedRobot:
    """Return a robot in the room, or where nothing is."""
    return SimulatedRobot(
        room() if walls else None,
        model=model,
        realism=realism,
        seed=seed,
        physics="mujoco" if mass else None,
    )


async def calibrated(sim: SimulatedRobot, by: str, rng: np.random.Generator) -> Calibration:
    """Return the calibration of a robot."""
    async with sim, connect_robot(sim.open, record=False) as robot:
        by_laser, model = by != "tape", robot.info.model
        laser = Pose2(model.laser.x, model.laser.y, model.laser.theta) if model.laser else ORIGIN
        if not by_laser:
            robot.arbiter.lasers = ()
        told = Calibration(model, laser, room() if by == "map" else None)
        side = usual_side(model)
        for step in plan(model, side, side, 2, by_laser=by_laser, by_sonar=True):
            begin = sim.body.robot_in_world
            try:
                run = await drive(robot, step.legs, step.room, by_laser=by_laser)
                end = begin.inverse() @ sim.body.robot_in_world
                told.take(step, run, answers_of(step, end, rng))
            except PioneerError as error:  # a person would repeat it
                print(f"{step.name}: {error}")
            if not by_laser:  # put it back on the mark
                sim.body.robot_in_world = ORIGIN
                await asyncio.sleep(CARRIED)
        return told


def answers_of(step: CalibrationStep, end: Pose2, rng: np.random.Generator) -> Mapping[str, float]:
    """Return what a person measures."""
    x, y = end.x + rng.normal() * TAPE, end.y + rng.normal() * TAPE
    turned = wrap(end.theta) + rng.normal() * ANGLE
    # the robot was not quite set on its mark
    askew = rng.normal() * ANGLE
    x, y = x - y * askew, y + x * askew
    return {"way": x, "aside": y, "ahead": x, "left": y, "turned": turned + askew}


async def return_error(
    sim: SimulatedRobot, model: RobotModel, correction: OdometryCorrection
) -> float:
    """Return the return error of a square as UMBmark has it, the larger of both ways [m].

    It is the place in truth, less that by odometry.
    """
    errors = []
    async with (
        sim,
        connect_robot(sim.open, model=replace(model, odometry=correction), record=False) as robot,
    ):
        for sign in (1, -1):
            begin, said = sim.body.robot_in_world, odometry(robot)
            for _ in range(4):
                await robot.move(SIDE, 0.4)
                await robot.turn(sign * pi / 2, radians(45))
            await asyncio.sleep(1.0)
            end = begin.inverse() @ sim.body.robot_in_world
            told = said.inverse() @ odometry(robot)
            errors.append(hypot(end.x - told.x, end.y - told.y))
    return max(errors)


def odometry(robot: Robot) -> Pose2:
    """Return where a robot is by its odometry."""
    assert robot.snapshot is not None
    return robot.snapshot.odometry.robot_in_odom


def in_simulated_time(run: Coroutine[Any, Any, Result]) -> Result:
    """Return the result of what runs as fast as it can be simulated."""
    loop = FastTimeLoop()
    try:
        return loop.run_until_complete(run)
    finally:
        loop.close()


@cache
def uncorrected(model: str, seed: int, *, mass: bool) -> float:
    """Return the error of a robot without a correction [m], by whatever it is measured then."""
    sim = simulated(model, errors_of(np.random.default_rng(seed)), seed, mass=mass, walls=False)
    return in_simulated_time(return_error(sim, load_model(model), UNCORRECTED))


def measured(model: str, by: str, seed: int, *, mass: bool) -> tuple[float, float]:
    """Return the error before and after of a robot [m]."""
    rng = np.random.default_rng(seed)
    realism = errors_of(rng)

    async def after() -> float:
        told = await calibrated(simulated(model, realism, seed, mass=mass, walls=True), by, rng)
        found = told.estimate()
        assert found is not None
        sim = simulated(model, realism, seed, mass=mass, walls=False)
        return await return_error(sim, load_model(model), found.correction)

    return uncorrected(model, seed, mass=mass), in_simulated_time(after())


async def laser_errors(model: str, seed: int) -> tuple[float, float, float]:
    """Return how wrong a laser's place [m], heading [rad] and delay [s] are found.

    It is said to be up to 5 cm and 3 degrees from where it is, and its scans are 50 ms late.
    """
    rng = np.random.default_rng(seed)
    true = load_model(model).laser
    assert true is not None
    x, y = rng.choice([-1, 1], 2) * (OFF, OFF) / np.sqrt(2)
    wrong = Mounting(sensor_in_robot=Pose2(true.x + x, true.y + y, rng.choice([-1, 1]) * TURNED))
    sim = simulated(model, errors_of(rng), seed, mass=False, walls=True)
    async with sim, LaserUnit(sim, "urg-04lx") as unit:
        spec = unit.spec(wrong, time_offset=LATE)
        async with connect_robot(sim.open, lasers=[spec], record=False) as robot:
            await robot.laser.reading()
            told = Calibration(robot.info.model, wrong.sensor_in_robot)
            side = usual_side(robot.info.model)
            for step in plan(robot.info.model, side, side, 2, by_laser=True, by_sonar=True):
                try:
                    told.take(step, await drive(robot, step.legs, step.room, by_laser=True))
                except PioneerError as error:
                    print(f"{step.name}: {error}")
    found, late = told.estimate(), told.delay()
    assert found is not None
    assert found.laser is not None
    assert late is not None
    off = hypot(found.laser.x - true.x, found.laser.y - true.y)
    return off, abs(wrap(found.laser.theta - true.theta)), abs(late[0] - LATE)


HEADER = "| robot | moves by | measured by | before | after | times smaller | at least |"
"""Heads of the columns; all numbers but the last are medians."""


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robots", type=int, default=20)
    parser.add_argument("--models", nargs="*", default=["p3dx-sh", "p3at-sh"])
    parser.add_argument("--by", nargs="*", default=["tape", "map", "laser"])
    parser.add_argument("--mass", nargs="*", type=int, default=[0, 1])
    parser.add_argument("--laser", action="store_true", help="the place and delay of lasers alone")
    options = parser.parse_args()
    for model in options.models if options.laser else ():
        for seed in range(options.robots):
            off, turned, late = in_simulated_time(laser_errors(model, seed))
            told = f"{1000 * off:.1f} mm, {degrees(turned):.2f} degrees, {1000 * late:.1f} ms"
            print(f"{model} {seed}: wrong by {told}", flush=True)
    if options.laser:
        return
    print(HEADER)
    print("|---|---|---|---|---|---|---|", flush=True)
    for model in options.models:
        for mass in options.mass:
            for by in options.by:
                rows = [
                    measured(model, by, seed, mass=bool(mass)) for seed in range(options.robots)
                ]
                ratios = [before / after for before, after in rows]
                before, after = (median(row[i] for row in rows) for i in (0, 1))
                print(
                    f"| {model} | {'mass' if mass else 'plane'} | {by} | {100 * before:.0f} cm | "
                    f"{100 * after:.1f} cm | {median(ratios):.0f} | {min(ratios):.1f} |",
                    flush=True,
                )


if __name__ == "__main__":
    main()
