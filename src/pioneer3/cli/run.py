"""`pioneer3 run`."""

import sys
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from pioneer3.cli.loop import run_until_told_to_leave
from pioneer3.cli.options import WORLD, TcpPort, WorldOptions
from pioneer3.errors import ConfigError

AS_USUAL = WorldOptions()


def run(
    *,
    port: Annotated[str | None, Parameter(name=["--port", "-p"], env_var="PIONEER3_PORT")] = None,
    baud: Annotated[int | None, Parameter(name=["--baud", "-b"], env_var="PIONEER3_BAUD")] = None,
    map_: Annotated[str | None, Parameter(name=["--map", "-m"])] = None,
    robot: Annotated[str | None, Parameter(name=["--robot", "-r"])] = None,
    ideal: Annotated[bool, Parameter(negative=(), group=WORLD)] = False,
    world: WorldOptions = AS_USUAL,
    sim_port: TcpPort = 8101,
    web_port: TcpPort = 8080,
    host: str = "127.0.0.1",
    max_speed: float | None = None,
    record: Path | None = None,
) -> int:
    """Connect to a robot and serve the live page; without --port, to a simulated one of its own.

    Example: pioneer3 run --port /dev/ttyUSB0

    Args:
        port: The robot: /dev/ttyUSB0, tcp://192.168.0.160:8101, replay:FILE.
        baud: Serial speed to try first.
        map_: A shipped map or world (office, lab), a .map, map_server .yaml or world .toml file.
        robot: Simulated model, such as p3dx-sh; with --port: used whatever the robot says it is.
        ideal: Simulate without noise and slip: the robot does exactly what it is told.
        world: How the simulated world begins.
        sim_port: TCP port of the simulator; 0 takes a free one.
        web_port: TCP port of the page; 0 takes a free one.
        host: Address the page is served on. Anything but 127.0.0.1 lets the network drive.
        max_speed: Keep below this speed [m/s].
        record: New file for every byte on the wire; --port replay:FILE plays it.
    """
    if port is not None and (ideal or world != AS_USUAL):
        raise ConfigError("--start, --fit, --seed, --ideal: simulated robots only, without --port")
    from pioneer3.web.live import Options, live  # noqa: PLC0415

    options = Options(
        port=port,
        baud=baud,
        map_name=map_,
        robot=robot,
        wishes=world.wishes(),
        ideal=ideal,
        sim_port=sim_port,
        web_port=web_port,
        host=host,
        max_speed=max_speed,
        record=record,
    )
    return run_until_told_to_leave(live(options, _tell))


def _tell(message: str) -> None:
    print(message, file=sys.stdout, flush=True)  # noqa: T201
