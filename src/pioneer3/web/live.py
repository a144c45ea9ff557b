"""The main job: a robot or an embedded simulator, the driver, and the page, in one loop."""

import asyncio
from collections.abc import Callable
from contextlib import AsyncExitStack
from dataclasses import dataclass
from math import inf
from pathlib import Path

from pioneer3.arcos.host_events import Timing
from pioneer3.models import load_model
from pioneer3.runtime.connect import connect_async
from pioneer3.runtime.identity import kind
from pioneer3.runtime.robot import Robot
from pioneer3.runtime.scene import Scene
from pioneer3.runtime.simulation import simulator
from pioneer3.sim.realism import Realism
from pioneer3.sim.worldfile import load_world
from pioneer3.sim.worldfile.arguments import AS_IT_IS, Wishes
from pioneer3.web.server import serve_page

LOOPBACK = {"127.0.0.1", "localhost", "::1"}
PATIENT = Timing(silence=inf)
"""Towards a simulator in this program: it may be paused, and when it ends, so does the link."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Options:
    """What to run.

    Attributes:
        port: URL of the robot; `None` starts a simulator.
        baud: Serial speed to try first.
        map_name: Shipped map or file; `None` is the office for a simulator, none for a robot.
        robot: Model to simulate, or to use whatever the robot says it is.
        wishes: What to change in the simulated world before it begins.
        ideal: Simulate a robot without any error.
        sim_port: TCP port of the simulator; 0 takes a free one.
        web_port: TCP port of the page; 0 takes a free one.
        host: Address the page is served on.
        max_speed: Keep below this [m/s].
        record: New file for every byte on the wire.
    """

    port: str | None = None
    baud: int | None = None
    map_name: str | None = None
    robot: str | None = None
    wishes: Wishes = AS_IT_IS
    ideal: bool = False
    sim_port: int = 8101
    web_port: int = 8080
    host: str = "127.0.0.1"
    max_speed: float | None = None
    record: Path | None = None


async def live(options: Options, tell: Callable[[str], None]) -> int:
    """Run until cancelled; `tell` is given each line for the person who started it.

    Raises:
        PioneerError: something could not be started; the message says what to do.
    """
    async with AsyncExitStack() as stack:
        url, scene = await _robot_and_scene(options, stack, tell)
        robot = await stack.enter_async_context(
            connect_async(
                url,
                baud=options.baud,
                model=load_model(options.robot) if options.robot else None,
                max_speed=options.max_speed,
                record=options.record,
                timing=PATIENT if scene.simulated else None,
            )
        )
        address = await stack.enter_async_context(
            serve_page(robot, scene, host=options.host, port=options.web_port)
        )
        tell(f"Connected to a {kind(robot.info)}: {_who(robot)}")
        tell(f"Drive it at {address}   (Ctrl-C ends)")
        if options.host not in LOOPBACK:
            tell(f"WARNING: anybody who reaches {options.host} can drive this robot.")
        await _tell_of_changes(robot, tell)
    return 0


async def _robot_and_scene(
    options: Options, stack: AsyncExitStack, tell: Callable[[str], None]
) -> tuple[str, Scene]:
    if options.port is not None:
        known = load_world(options.map_name).line_map() if options.map_name else None
        return options.port, Scene(known)
    running = await stack.enter_async_context(
        simulator(
            map_name=options.map_name or "office",
            robot=options.robot,
            port=options.sim_port,
            wishes=options.wishes,
            realism=Realism.ideal() if options.ideal else Realism(),
        )
    )
    for other in running.robots[1:]:
        tell(f"Also simulated: {other.name}, {other.model.title}, on {other.url}")
    for note in running.notes:
        tell(f"WARNING: {note}")
    return running.url, running.scene


async def _tell_of_changes(robot: Robot, tell: Callable[[str], None]) -> None:
    """Say when the link is lost and restored, for as long as the robot is served."""
    async for status in robot.supervisor.status.values():
        tell(f"{status.connection.value}: {status.message}")
    await asyncio.sleep(0)


def _who(robot: Robot) -> str:
    info = robot.info
    speed = f" at {info.speed} baud" if info.speed else ""
    return f"{info.identity.name}, {info.model.title} ({info.model.name}), on {info.url}{speed}"
