"""From options to a running simulator."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass
from pathlib import Path

from pioneer3.geometry import ORIGIN
from pioneer3.models import load_model
from pioneer3.runtime.scene import Scene
from pioneer3.runtime.tasks import running
from pioneer3.sim.body import Body
from pioneer3.sim.firmware import Firmware
from pioneer3.sim.maps import load_map
from pioneer3.sim.server import Simulation
from pioneer3.sim.world import World

LOOPBACK = "127.0.0.1"


@dataclass(frozen=True, slots=True)
class RunningSimulation:
    """A simulator that listens.

    Attributes:
        url: What a host connects to.
        world: What is simulated.
        body: The robot.
        scene: Map and true pose, for people to look at.
    """

    url: str
    world: World
    body: Body
    scene: Scene


@asynccontextmanager
async def simulator(
    *, map_name: str | Path = "office", robot: str = "p3at-sh", port: int = 8101
) -> AsyncIterator[RunningSimulation]:
    """Run a simulator in this event loop: one `robot` in the map, on loopback TCP `port`.

    Args:
        map_name: A shipped map or an ARIA `.map` file.
        robot: A model's name or file.
        port: TCP port; 0 takes a free one.

    Raises:
        ConfigError: the map or the model is wrong.
        LinkError: the port cannot be listened on.
    """
    line_map = load_map(map_name)
    body = Body(load_model(robot), line_map.homes[0] if line_map.homes else ORIGIN)
    world = World(line_map, [body])
    simulation = Simulation(world, [Firmware(world, body)])
    await simulation.listen(port, LOOPBACK)
    host, number = simulation.addresses[0]
    scene = Scene(line_map, body.home, truth=lambda: body.robot_in_world)
    async with running(simulation.run()):
        yield RunningSimulation(f"tcp://{host}:{number}", world, body, scene)
