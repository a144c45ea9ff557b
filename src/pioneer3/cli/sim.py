"""`pioneer3 sim`."""

import logging
import sys
from collections.abc import Iterator
from contextlib import AsyncExitStack
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from pioneer3.cli.loop import run_until_told_to_leave
from pioneer3.cli.options import WorldOptions
from pioneer3.cli.sim_options import (
    ErrorOptions,
    MapOptions,
    MobileSimOptions,
    PortOptions,
    TimeOptions,
)
from pioneer3.errors import PortBusyError

if TYPE_CHECKING:
    from contextlib import AbstractAsyncContextManager

    from pioneer3.sim.server.running import RunningSimulation

MAP, WORLD, PORTS, TIME = MapOptions(), WorldOptions(), PortOptions(), TimeOptions()
ERRORS, MOBILESIM = ErrorOptions(), MobileSimOptions()
MANY = Parameter(negative=(), show_default=False)


def sim(
    *,
    robot: Annotated[tuple[str, ...], Parameter(name=["--robot", "-r"]), MANY] = (),
    robot_factory: Annotated[str, Parameter(name=["--robot-factory", "-R"]), MANY] = "",
    map_: MapOptions = MAP,
    world: WorldOptions = WORLD,
    ports: PortOptions = PORTS,
    time: TimeOptions = TIME,
    errors: ErrorOptions = ERRORS,
    mobilesim: MobileSimOptions = MOBILESIM,
    verbose: Annotated[
        bool, Parameter(name=["--verbose", "-v"], negative="", show_default=False)
    ] = False,
) -> int:
    """Run the simulator alone, without a window: robots in a map, each on a TCP port.

    Programs connect to it as to a robot: ours, ARIA's, Player's. They may come and
    go. MobileSim's options work. Names are for people: to programs every robot is
    MobileSim, by which ARIA knows a simulator.

    Example: pioneer3 sim -m lab -r p3at -r p3dx:bob --start random

    Args:
        robot: MODEL[:NAME], such as p3dx:bob; once for each. MODEL may be a .toml or .p file.
        robot_factory: MODEL of which each client of the first port gets a robot while it stays.
        map_: What stands there.
        world: How it begins.
        ports: Where robots are met.
        time: How time passes.
        errors: What goes wrong.
        mobilesim: What scripts for MobileSim pass.
        verbose: Tell who connects and leaves.
    """
    _log(mobilesim, verbose=verbose)
    for note in mobilesim.notes():
        _warn(note)
    if ports.warning:
        _warn(ports.warning)
    from pioneer3.sim.server.start import simulator  # noqa: PLC0415

    simulation = simulator(
        map_name=map_.name(),
        overrides=world.overrides(robot, factory=robot_factory, own_ports=ports.port is None),
        port=ports.first,
        host=ports.bind,
        ptys=ports.pty,
        acts=ports.acts,
        realism=errors.realism(),
        pace=time.pace(),
        faults=errors.faults(),
    )
    return run_until_told_to_leave(_simulate(simulation))


async def _simulate(simulation: "AbstractAsyncContextManager[RunningSimulation]") -> int:
    import asyncio  # noqa: PLC0415

    async with AsyncExitStack() as stack:
        try:
            running = await stack.enter_async_context(simulation)
        except PortBusyError as error:
            raise PortBusyError(f"{error} with -p, or --acts for colour trackers") from None
        for note in running.notes:
            _warn(note)
        if running.progress:
            print(running.progress, file=sys.stderr, flush=True)  # noqa: T201
        print("\n".join(_greeting(running)), flush=True)  # noqa: T201
        await asyncio.get_running_loop().create_future()
    return 0


def _greeting(running: "RunningSimulation") -> Iterator[str]:
    """Yield a line for each robot, that ends in its URL, and how to drive."""
    robots, where = running.robots, running.world.map.name
    named = len(robots) > 1 or any(robot.name != robot.model.name for robot in robots)
    width = max((len(robot.name) for robot in robots), default=0)
    for robot in robots:
        who = f"{robot.name:{width}}  " if named else ""
        pty = f"{robot.pty} and " if robot.pty else ""
        model = robot.model
        yield f"SIMULATOR: {who}{model.title} ({model.name}) in {where} on {pty}{robot.url}"
    if running.factory_url:
        yield f"SIMULATOR: a robot for every client in {where} on {running.factory_url}"
    for robot, url in zip(robots, running.acts_urls, strict=False):
        yield f"ACTS: what {robot.name} sees on {url}"
    yield f"Ctrl-C ends it. Another terminal drives it: pioneer3 drive --port {running.url}"


def _log(options: MobileSimOptions, *, verbose: bool) -> None:
    """Let the package's own log be seen, on the terminal or in a file."""
    log = logging.getLogger("pioneer3")
    if verbose or options.log_file:
        log.setLevel(logging.INFO)
    if options.log_file:
        log.addHandler(options.log_handler())
        log.propagate = verbose


def _warn(text: str) -> None:
    print(f"WARNING: {text}", file=sys.stderr, flush=True)  # noqa: T201
