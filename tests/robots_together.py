"""Robots in one simulated world, and how near they come to each other."""

import asyncio
from collections.abc import AsyncIterator, Callable, Sequence
from contextlib import AsyncExitStack, asynccontextmanager
from dataclasses import dataclass, field
from itertools import combinations
from math import hypot, inf

import numpy as np

from pioneer3.errors import PortNotFoundError
from pioneer3.geometry import Pose2
from pioneer3.links import Link
from pioneer3.links.memory import Fault, MemoryLink, clean, null_modem
from pioneer3.models import load_model
from pioneer3.navigation.connect import connect_async
from pioneer3.runtime.robot import Robot
from pioneer3.sim.body import Body
from pioneer3.sim.firmware import Firmware
from pioneer3.sim.kernels import CACHE, Kernels
from pioneer3.sim.server import Simulation
from pioneer3.sim.server.running import RunningSimulation
from pioneer3.sim.server.running import SimulatedRobot as RobotHere
from pioneer3.sim.world import World
from pioneer3.sim.worldfile import ClientMaps
from pioneer3.tasks import running

LOOK = 0.1


def near(one: Body, other: Body) -> float:
    """Return the distance between the outlines of two robots [m]; 0 where they overlap."""
    mine, theirs = one.robot_in_world, other.robot_in_world
    return min(
        _from_corners(theirs.inverse() @ mine, one, other),
        _from_corners(mine.inverse() @ theirs, other, one),
    )


def _from_corners(seen: Pose2, one: Body, other: Body) -> float:
    """Return the distance of the points on the outline of `one` from the rectangle of `other`."""
    least, model = inf, other.model
    for x, y in _points(one):
        at = seen @ Pose2(x, y)
        ahead = max(0.0, at.x - model.length_front, -model.length_rear - at.x)
        least = min(least, hypot(ahead, max(0.0, abs(at.y) - model.width / 2)))
    return least


def _points(body: Body) -> list[tuple[float, float]]:
    """Return points on the outline of a robot, 5 cm apart or less, in its frame [m]."""
    model, side = body.model, body.model.width / 2
    xs = np.linspace(-model.length_rear, model.length_front, 14)
    ys = np.linspace(-side, side, 12)
    ends = (-model.length_rear, model.length_front)
    return [(x, y) for x in xs for y in (-side, side)] + [(x, y) for x in ends for y in ys]


@dataclass
class Together:
    """Robots in one world.

    Attributes:
        simulation: Of all.
        robots: Their drivers.
        cables: The robots' ends of the cables.
        gap: Least distance between the outlines of two of them so far [m].
        dead: Numbers of robots that nobody can connect to.
        looked: Called at each look.
    """

    simulation: RunningSimulation
    robots: list[Robot] = field(default_factory=list)
    cables: list[MemoryLink] = field(default_factory=list)
    gap: float = inf
    dead: set[int] = field(default_factory=set)
    looked: Callable[[], None] = lambda: None

    @property
    def bodies(self) -> list[Body]:
        """The robots as they are."""
        return [robot.body for robot in self.simulation.robots]

    @property
    def speeds(self) -> list[float]:
        """How fast each really goes [m/s]."""
        return [body.speeds[0] for body in self.bodies]

    def pose(self, number: int) -> Pose2:
        """Return where a robot is in the world."""
        return self.bodies[number].robot_in_world

    async def kill(self, number: int) -> None:
        """Pull the cable out of a robot; it stays out."""
        self.dead.add(number)
        await self.cables[number].close()

    async def watch(self) -> None:
        """Look again and again how near they come."""
        while True:
            for one, other in combinations(self.bodies, 2):
                here, there = one.robot_in_world, other.robot_in_world
                corners = one.model.corner + other.model.corner
                if hypot(here.x - there.x, here.y - there.y) - corners < self.gap:
                    self.gap = min(self.gap, near(one, other))
            self.looked()
            await asyncio.sleep(LOOK)


@asynccontextmanager
async def together(
    *poses: Pose2, model: str = "p3at-sh", faults: Sequence[Fault] = ()
) -> AsyncIterator[Together]:
    """Connect to a robot at each pose of an empty world; `faults` spoil what each tells."""
    bodies = [Body(load_model(model), pose) for pose in poses]
    world = World(None, bodies, Kernels(compiled=CACHE.is_complete))
    simulation = Simulation(world, [Firmware(world, body) for body in bodies])
    here = [
        RobotHere(
            name=f"robot-{number}",
            body=body,
            firmware=port.firmware,
            port=port,
            url=f"memory:{number}",
        )
        for number, (body, port) in enumerate(zip(bodies, simulation.ports, strict=True), 1)
    ]
    all_ = Together(RunningSimulation(simulation, here, np.random.default_rng(0), ClientMaps()))
    serving: list[asyncio.Task[None]] = []
    async with running(simulation.run(), all_.watch()), AsyncExitStack() as stack:
        for number, one in enumerate(here):
            fault = faults[number] if faults else clean

            async def plug_in(
                one: RobotHere = one, fault: Fault = fault, number: int = number
            ) -> Link:
                if number in all_.dead:
                    raise PortNotFoundError("memory: no such port")
                ours, theirs = null_modem()
                theirs.fault = fault
                all_.cables.append(theirs)
                serving.append(asyncio.ensure_future(one.port.serve(theirs)))
                return ours

            all_.robots.append(await stack.enter_async_context(connect_async(plug_in)))
        yield all_
    await asyncio.gather(*serving)
