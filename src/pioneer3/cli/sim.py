"""`pioneer3 sim`."""

import logging
from typing import Annotated

from cyclopts import Parameter

from pioneer3.cli.loop import run_until_told_to_leave
from pioneer3.cli.options import TcpPort


def sim(
    *,
    map_: Annotated[str, Parameter(name=["--map", "-m"])] = "office",
    robot: Annotated[str, Parameter(name=["--robot", "-r"])] = "p3at-sh",
    port: Annotated[TcpPort, Parameter(name=["--port", "-p"])] = 8101,
    verbose: Annotated[bool, Parameter(name=["--verbose", "-v"], negative="")] = False,
) -> int:
    """Run the simulator alone, in real time, without a window: a robot in a map on a TCP port.

    Programs connect to it as to a robot: ours, ARIA's, Player's. It stays up when they come and go.

    Example: pioneer3 sim --map lab.map --robot p3dx-sh -p 8102

    Args:
        map_: A shipped map (office), an ARIA .map, a map_server .yaml or a world .toml file.
        robot: A model (p3at, p3at-sh, p3dx, p3dx-sh, amigo-sh, peoplebot-sh), .toml or .p file.
        port: TCP port on 127.0.0.1; 0 takes a free one.
        verbose: Tell who connects and leaves.
    """
    if verbose:
        logging.getLogger("pioneer3").setLevel(logging.INFO)
    return run_until_told_to_leave(_simulate(map_, robot, port))


async def _simulate(map_name: str, robot: str, port: int) -> int:
    import asyncio  # noqa: PLC0415

    from pioneer3.runtime.simulation import simulator  # noqa: PLC0415

    async with simulator(map_name=map_name, robot=robot, port=port) as running:
        model, line_map = running.body.model, running.world.map
        print(  # noqa: T201
            f"SIMULATOR: {model.title} ({model.name}) in {line_map.name} on {running.url}\n"
            f"Ctrl-C ends it. Another terminal drives it: pioneer3 drive --port {running.url}",
            flush=True,
        )
        await asyncio.get_running_loop().create_future()
    return 0
