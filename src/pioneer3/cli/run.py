"""`pioneer3 run`."""

import os
import sys
from contextlib import AbstractAsyncContextManager
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from pioneer3.cli.options import (
    AS_SET,
    CAMERA_VARIABLE,
    MODEL_VARIABLE,
    NAVIGATION,
    NO_LASERS,
    PORT,
    PORT_VARIABLE,
    WORLD,
    Baud,
    CameraUrl,
    Flag,
    FleetFile,
    LaserOptions,
    LogOptions,
    MaxSpeed,
    Model,
    NavigationOptions,
    RobotNumber,
    Robots,
    TcpPort,
    WorldOptions,
    repeated,
    robots_of,
)
from pioneer3.cli.process import run_until_told_to_leave, write_line, write_warning
from pioneer3.errors import ConfigError

if TYPE_CHECKING:
    from pioneer3.sim.worldfile import RobotSpec
    from pioneer3.web.hosting import ConnectTarget
    from pioneer3.web.server import Served

AS_USUAL = WorldOptions()
MANY = Parameter(negative=(), show_default=False)


def run(
    *,
    port: Annotated[tuple[str, ...], PORT, MANY] = (),
    baud: Baud = None,
    map_: Annotated[str | None, Parameter(name=["--map", "-m"])] = None,
    robot: Robots = (),
    number: RobotNumber = None,
    fleet: FleetFile = None,
    model: Model = None,
    ideal: Annotated[Flag, Parameter(group=WORLD)] = False,
    world: WorldOptions = AS_USUAL,
    lasers: LaserOptions = NO_LASERS,
    camera: CameraUrl = None,
    shadow: Flag = False,
    sim_port: TcpPort = 8101,
    web_port: TcpPort = 8080,
    lan: Flag = False,
    host: str = "127.0.0.1",
    no_announce: Flag = False,
    cert: Path | None = None,
    key: Path | None = None,
    max_speed: MaxSpeed | None = None,
    log: LogOptions = AS_SET,
    navigation: NavigationOptions = NAVIGATION,
) -> int:
    """Serve the live page of robots; without --port, of simulated ones of its own.

    Example: pioneer3 run --port /dev/ttyUSB0
    Example: pioneer3 run -r p3at -r p3dx:bob
    Example: pioneer3 run --port /dev/ttyUSB0 --laser auto

    Args:
        port: A robot: /dev/ttyUSB0, tcp://192.168.0.160:8101, replay:FILE; once for each.
        map_: A shipped map or world (office, lab), a .map, map_server .yaml, world .toml, or .world
            or .sdf file of Stage or Gazebo.
        robot: MODEL[:NAME], such as p3dx:bob, once for each; with --port: what those really are.
            Or the name of a robot or group in the fleet file, in place of its port.
        number: So many of each simulated --robot, or of the usual one, such as 10.
        model: What the robots at --port really are: p3dx-sh, a .toml or ARIA .p file.
        ideal: Simulate without noise and slip: robots do exactly what they are told.
        camera: Of the robot: http://HOST[:PORT]/PATH of an MJPEG stream.
        shadow: Beside each robot at --port drives a simulated twin; the page shows where they
            part, and why.
        sim_port: TCP port of the first simulated robot, the others have the next; 0: free ones.
        web_port: TCP port of the page; https takes the next free one with --lan; 0: any free.
        lan: Let other devices in, who must pair first: shows a QR code to scan.
        host: Address the page is served on: 127.0.0.1 this computer only, others as --lan.
        no_announce: Do not announce the page to other computers (zeroconf).
        cert: Certificate for https in PEM, instead of one made on first use.
        key: Its private key, a file that only you may read.
    """
    from pioneer3.nav.settings import AS_SHIPPED
    from pioneer3.sim.worldfile.arguments import parse_robot
    from pioneer3.web.live import RunOptions, live

    remote = robots_of(robot, fleet)
    if number is not None and (port or remote):
        raise ConfigError(f"--number {number}: of simulated robots only, without --port")
    if remote and port and port != (os.environ.get(PORT_VARIABLE),):
        raise ConfigError(f"--port {port[0]} and --robot {robot[0]}: give one of them")
    robots = () if remote else tuple(map(parse_robot, repeated(robot, number)))
    port = tuple(each.url for each in remote) or port
    if not port and model not in {None, os.environ.get(MODEL_VARIABLE)}:
        raise ConfigError(f"--model {model}: of a robot at --port; simulate one with -r {model}")
    _refuse_nonsense(port, robots, simulated=ideal or world != AS_USUAL)
    if port and not remote:
        remote = _at_ports(port, robots, model)
    elif model is not None:
        remote = tuple(replace(each, model=model) for each in remote)
    if len(port) > 1 and lasers != NO_LASERS:
        raise ConfigError("--laser: of one robot only; run one `pioneer3 run` for each robot")
    if shadow and not port:
        raise ConfigError("--shadow: of robots at --port only; a simulated robot is its own twin")
    served_at = "0.0.0.0" if lan and host == "127.0.0.1" else host
    options = RunOptions(
        remote=tuple(
            replace(each, settings=each.settings.with_texts(navigation.set_)) for each in remote
        ),
        baud=baud,
        map_name=map_,
        robots=robots,
        overrides=world.overrides(),
        ideal=ideal,
        sim_port=sim_port,
        web_port=web_port,
        host=served_at,
        cert=cert,
        key=key,
        show_tokens=sys.stdout.isatty(),
        max_speed=max_speed,
        record=log.where(),
        lasers=lambda: lasers.specs(port),
        camera=camera,
        shadow=shadow,
        camera_if_one=camera == os.environ.get(CAMERA_VARIABLE),
        settings=AS_SHIPPED.with_texts(navigation.set_),
        announced=None if no_announce else partial(_announced, served_at),
    )
    return run_until_told_to_leave(live(options, write_line))


def _at_ports(
    ports: tuple[str, ...], robots: "tuple[RobotSpec, ...]", model: str | None
) -> "tuple[ConnectTarget, ...]":
    """Return the robots at ports; `robots` are one for all, or one for each, else `model` is."""
    from pioneer3.sim.worldfile import RobotSpec
    from pioneer3.web.hosting import ConnectTarget

    if len(robots) <= 1:
        robots = (robots or (RobotSpec(model=""),)) * len(ports)
    return tuple(
        ConnectTarget(url=url, name=spec.name, model=spec.model or model)
        for url, spec in zip(ports, robots, strict=True)
    )


def _announced(host: str, served: "Served") -> "AbstractAsyncContextManager[None]":
    """Let `pioneer3 fleet discover` find the page where other computers reach it."""
    from pioneer3.fleet.announce import announced, of_page

    return announced(of_page(host, served.https or served.http), write_warning)


def _refuse_nonsense(
    ports: tuple[str, ...], robots: "tuple[RobotSpec, ...]", *, simulated: bool
) -> None:
    """Refuse options that do not go together; the ConfigError says which and why."""
    if ports and simulated:
        raise ConfigError(
            "--start, --fit, --seed, --keep-session, --physics, --ideal: "
            "simulated robots only, without --port"
        )
    twice = next((url for url in ports if ports.count(url) > 1), None)
    if twice:
        raise ConfigError(f"--port {twice}: given twice")
    if ports and len(robots) not in {0, 1, len(ports)}:
        raise ConfigError(
            f"--robot: {len(robots)} given, but ports: {len(ports)}; "
            "give one for all, or one for each"
        )
