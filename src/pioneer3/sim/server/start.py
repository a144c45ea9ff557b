"""Builds a simulator and lets it run beside the caller."""

import asyncio
import logging
import os
import sys
from asyncio.subprocess import DEVNULL, PIPE
from collections.abc import AsyncIterator, Iterator, Sequence
from contextlib import AsyncExitStack, asynccontextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from numpy.random import default_rng

from pioneer3.distribution import how_to_get
from pioneer3.errors import ConfigError, DeviceError, PioneerError
from pioneer3.jit import numba_version
from pioneer3.links.stream import accepted
from pioneer3.maps import LineMap
from pioneer3.models import load_model
from pioneer3.sim.body import Body
from pioneer3.sim.dynamics import dynamics_of
from pioneer3.sim.firmware import Firmware
from pioneer3.sim.kernels import CACHE, WORTH_COMPILING, WORTH_THREADS, compiled_kernels
from pioneer3.sim.placer import SpawnedRobot, spawn_robots
from pioneer3.sim.realism import Realism
from pioneer3.sim.server import Simulation
from pioneer3.sim.server.faults import LinkFaults
from pioneer3.sim.server.laser import SimulatedLaser
from pioneer3.sim.server.listeners import StreamServer
from pioneer3.sim.server.pacer import Pacer
from pioneer3.sim.server.running import RunningSimulation, SimulatedRobot
from pioneer3.sim.server.trackers import colour_trackers
from pioneer3.sim.world import World
from pioneer3.sim.worldfile import ClientMaps, RobotSpec, WorldFile, load_world
from pioneer3.sim.worldfile.arguments import NO_OVERRIDES, WorldOverrides
from pioneer3.sim.worldfile.flattened import flattened
from pioneer3.tasks import running

if TYPE_CHECKING:
    from pioneer3.sim.server.camera import SimulatedCamera

log = logging.getLogger(__name__)


async def _serve(
    running: RunningSimulation,
    factory_robot: RobotSpec,
    reader: asyncio.StreamReader,
    writer: asyncio.StreamWriter,
) -> None:
    """Serve a host of the robot factory, by a robot that also has a free port of its own."""
    peer = writer.get_extra_info("peername") or ("?", 0)
    link = accepted(f"tcp://{peer[0]}:{peer[1]}", reader, writer)
    try:
        robot = await running.add_robot(factory_robot)
    except PioneerError as error:
        log.warning("%s: gets no robot: %s", link.url, error)
        await link.close()
        return
    log.info("%s: gets %s", link.url, robot.name)
    try:
        await robot.port.serve(link)
    finally:
        if robot in running.robots:  # it has not been removed in the meantime
            await running.remove_robot(robot)


LOOPBACK = "127.0.0.1"
FIRST_PORT = 8101
MOST_THREADS = 4
COMPILING = "Compiling the simulator, only this once; it is slower for some 20 seconds ..."
IN_THE_WAY = "begins in a wall or an obstacle and cannot move: choose another start"


@asynccontextmanager
async def simulator(
    *,
    map_name: str | Path | WorldFile = "office",
    robot: str | None = None,
    port: int | None = FIRST_PORT,
    host: str = LOOPBACK,
    overrides: WorldOverrides = NO_OVERRIDES,
    realism: Realism | None = None,
    pace: Pacer | None = None,
    faults: LinkFaults | None = None,
    ptys: bool = False,
    acts: int | None = None,
) -> AsyncIterator[RunningSimulation]:
    """Run a simulator in this event loop.

    Args:
        map_name: A shipped map or world, a map or world file, or a world.
        robot: Model of the only robot, by name or file; `None` for those of `overrides` or of the
            world, or a P3-AT where there is none.
        port: TCP port of the first robot, the others have the next ones; 0 takes free ones. A
            factory comes before the robots. With `None` no robot listens: hosts are given to
            :meth:`RobotPort.serve <pioneer3.sim.server.port.RobotPort.serve>`.
        host: Address of this machine to listen at.
        overrides: Changes of the world before it begins.
        realism: Noise, slip and wide sonar beams; `None` is ideal: without them.
        pace: The speed of time; real time if not given.
        faults: Of every robot's cable and its laser's.
        ptys: Whether each robot has a pseudo terminal besides.
        acts: TCP port of the first robot's ACTS server, the others have the next ones; 0 takes
            free ones, `None` has no such servers.

    Raises:
        ConfigError: The map, a model, a place, a laser or the port of the ACTS servers is wrong, or
            MuJoCo is asked for and not installed.
        LinkError: A port cannot be listened on.
    """
    if robot is not None:
        overrides = replace(overrides, robots=(RobotSpec(model=robot),))
    asked = map_name if isinstance(map_name, WorldFile) else load_world(map_name)
    world_file = overrides.applied_to(asked)
    line_map, rng = world_file.line_map(), default_rng(world_file.seed)
    spawned, client_maps = spawn_robots(world_file, line_map, rng), _client_maps(world_file)
    bodies = [Body(each.model, each.pose) for each in spawned]
    world = _world(world_file, line_map, bodies, realism)
    firmwares = [
        Firmware(
            world,
            body,
            own_name=each.name,
            equipment=each.equipment,
            client_maps=client_maps,
        )
        for each, body in zip(spawned, bodies, strict=True)
    ]
    simulation = Simulation(
        world, firmwares, pace=pace, keep_session=world_file.keep_session, threads=True
    )
    factory_robot = overrides.factory_robot
    if factory_robot:
        load_model(factory_robot.model)  # better now than when the first client comes
    if port is not None:
        await simulation.listen(
            port + 1 if factory_robot and port else port,
            host,
            ports=[each.port for each in spawned],
            hosts=[each.host for each in spawned],
        )
    # connections are accepted from now on; time begins when compiled kernels are loaded
    lasers = await _lasers(spawned, simulation)
    wanted = port is not None and world_file.physics == "mujoco"
    cameras, problems = await _cameras(spawned, simulation, host if wanted else None, free=not port)
    robots = _robots(spawned, simulation, lasers, cameras, ptys=ptys)
    here = RunningSimulation(simulation, robots, rng, client_maps)
    here.notes = [*_notes(world_file, spawned), *problems]
    compiling = False
    if _is_work(simulation) or factory_robot:
        if not numba_version():
            here.notes.append(f"without numba this simulation is slow: {how_to_get('fast')}")
        elif CACHE.is_complete or not CACHE.can_keep:
            await _load_kernels(world)
        else:
            here.progress = COMPILING
            compiling = True
    work = [simulation.run()]
    work += [simulation.cameras.run()] if simulation.cameras else []
    work += [_compile_kernels(world)] if compiling else []
    async with AsyncExitStack() as stack:
        await stack.enter_async_context(running(*work))
        if faults is not None:
            here.set_faults(faults)
        if factory_robot and port is not None:
            factory = StreamServer(partial(_serve, here, factory_robot))
            here.factory_url = await stack.enter_async_context(factory.at(host, port))
        if acts is not None:
            _refuse_robots_ports(acts, here)
            here.watch()
            trackers = colour_trackers(world, here.robots[:], acts, host)
            here.acts_urls = await stack.enter_async_context(trackers)
        yield here


def _world(
    world_file: WorldFile, line_map: LineMap, bodies: Sequence[Body], realism: Realism | None
) -> World:
    """Return the world of a file, with these robots and all that can be moved."""
    world = World(
        line_map,
        bodies,
        seed=world_file.seed,
        realism=realism,
        dynamics=dynamics_of(world_file.physics, world_file.physics_step),
        relief=world_file.relief(line_map),
    )
    world.add_obstacles((*world_file.movable, *world_file.people))
    return world


async def _load_kernels(world: World) -> None:
    """Replace the kernels of `world` by compiled ones, which compute the same."""
    robots = len(world.robots)
    threads = min(MOST_THREADS, os.cpu_count() or 1) if robots >= WORTH_THREADS else 1
    world.kernels = await asyncio.to_thread(compiled_kernels, threads)


async def _compile_kernels(world: World) -> None:
    """Compile the kernels in another process, so that the event loop runs on; then load them."""
    process = await asyncio.create_subprocess_exec(
        sys.executable, "-m", "pioneer3.sim.kernels", stdin=DEVNULL, stdout=DEVNULL, stderr=PIPE
    )
    try:
        _, errors = await process.communicate()
    except asyncio.CancelledError:
        process.terminate()
        await process.wait()
        raise
    if process.returncode:
        reason = errors.decode(errors="replace").strip().rpartition("\n")[2]
        log.warning("numba cannot compile the simulator, which stays slow: %s", reason)
        return
    await _load_kernels(world)


def _refuse_robots_ports(acts: int, here: RunningSimulation) -> None:
    """Refuse colour trackers at a port that is a robot's."""
    wanted = range(acts, acts + len(here.robots)) if acts else ()
    if common := set(wanted) & set(here.tcp_ports):
        raise ConfigError(
            f"ACTS from port {acts} on: {min(common)} is a robot's; choose another port for ACTS"
        )


def _notes(world_file: WorldFile, spawned: Sequence[SpawnedRobot]) -> Iterator[str]:
    """Yield what the person who starts a world should know of it."""
    for each in spawned:
        if each.in_the_way:
            yield f"{each.name} {IN_THE_WAY}"
    if world_file.physics == "planar" and (line := flattened(world_file)):
        yield line


def _robots(
    spawned: Sequence[SpawnedRobot],
    simulation: Simulation,
    lasers: Sequence[SimulatedLaser | None],
    cameras: "Sequence[SimulatedCamera | None]",
    *,
    ptys: bool,
) -> Iterator[SimulatedRobot]:
    names = simulation.open_ptys() if ptys else [None] * len(spawned)
    parts = zip(spawned, simulation.ports, names, lasers, cameras, strict=True)
    for each, port, pty, laser, camera in parts:
        yield SimulatedRobot.at(port, each.name, pty, laser, camera)


async def _lasers(
    spawned: Sequence[SpawnedRobot], simulation: Simulation
) -> list[SimulatedLaser | None]:
    """Fit the lasers of all robots, and return them; `None` for a robot without one."""
    lasers: list[SimulatedLaser | None] = []
    try:
        for each, port in zip(spawned, simulation.ports, strict=True):
            name, number = each.equipment.laser, each.equipment.laser_port
            laser = await simulation.add_laser(port.firmware, name, number) if name else None
            lasers.append(laser)
    except PioneerError:
        simulation.close()
        raise
    return lasers


async def _cameras(
    spawned: Sequence[SpawnedRobot], simulation: Simulation, host: str | None, *, free: bool
) -> "tuple[list[SimulatedCamera | None], list[str]]":
    """Serve the pictures of all robots' cameras at `host`; return these, and the problems."""
    cameras: list[SimulatedCamera | None] = [None] * len(spawned)
    if host is None:
        return cameras, []
    from pioneer3.sim.server.camera_ports import CameraPorts

    simulation.cameras = ports = CameraPorts(simulation.world, host, free=free)
    try:
        for number, each in enumerate(spawned):
            if each.equipment.camera is not None:
                firmware = simulation.ports[number].firmware
                cameras[number] = await ports.add(firmware, each.equipment)
    except DeviceError as error:
        return cameras, [str(error)]
    except PioneerError:
        await ports.close()
        simulation.close()
        raise
    return cameras, []


def _is_work(simulation: Simulation) -> bool:
    """Whether compiled kernels pay: lasers cast thousands of rays for each scan."""
    many = len(simulation.ports) >= WORTH_COMPILING
    return many or simulation.pace.speed > 1 or bool(simulation.lasers.lasers)


def _client_maps(world: WorldFile) -> ClientMaps:
    """Return the maps that clients may load: those beside the one in use, and those here."""
    return ClientMaps(world.map.parent, Path()) if isinstance(world.map, Path) else ClientMaps()
