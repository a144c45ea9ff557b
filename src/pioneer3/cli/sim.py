"""`pioneer3 sim`.

Options that are wrong, or contradict each other, raise :exc:`ConfigError`.
"""

import logging
import os
from collections.abc import Iterator, Sequence
from contextlib import AbstractAsyncContextManager, AsyncExitStack, ExitStack
from dataclasses import dataclass
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Group, Parameter

from pioneer3.cli.options import WORLD, Flag, RobotNumber, Robots, TcpPort, WorldOptions, repeated
from pioneer3.cli.process import (
    LogFormatter,
    run_until_told_to_leave,
    write_error,
    write_line,
    write_warning,
)
from pioneer3.errors import ConfigError, PortBusyError

if TYPE_CHECKING:
    from pioneer3.sim.realism import Realism
    from pioneer3.sim.server.faults import LinkFaults
    from pioneer3.sim.server.pacer import Pacer
    from pioneer3.sim.server.running import RunningSimulation
    from pioneer3.sim.worldfile import RobotSpec


PORTS = Group.create_ordered("Ports")
TIME = Group.create_ordered("Time")
ERRORS = Group.create_ordered("Errors")
MOBILESIM = Group.create_ordered("Accepted as MobileSim's")

LOOPBACK = {"127.0.0.1", "localhost", "::1"}
Unset = Parameter(show_default=False)
OdometryMode = Literal["none", "constant", "random_init", "random_each_update", "all"]


@Parameter(name="*", group=WORLD)
@dataclass(frozen=True, slots=True, kw_only=True)
class MapOptions:
    """The map and the robots in it.

    Attributes:
        map_: A shipped map or world (office, lab, ramps, ...), or a .map, map_server .yaml,
            world .toml, or .world or .sdf file of Stage or Gazebo.
        stageworld: A world of Stage, as --map takes it, too.
        nomap: An empty plane in place of a map.
    """

    map_: Annotated[str | None, Parameter(name=["--map", "-m"])] = None
    stageworld: Annotated[str | None, Parameter(name=["--stageworld", "-W"])] = None
    nomap: Flag = False

    def name(self) -> str:
        """Return the map to load."""
        given = self.map_ or self.stageworld
        if self.nomap and given:
            raise ConfigError("--map and --nomap: give one of them")
        return "empty" if self.nomap else given or "office"


@Parameter(name="*", group=PORTS)
@dataclass(frozen=True, slots=True, kw_only=True)
class PortOptions:
    """Ports of the robots.

    Attributes:
        port: TCP port of the first robot (8101), the others have the next ones; 0 takes free ones.
        bind: Address to listen on, such as 0.0.0.0; not 127.0.0.1 lets the network drive.
        no_announce: Do not announce robots that listen beyond this computer (zeroconf).
        pty: A pseudo terminal for each robot besides, for programs that want a serial port.
        acts: TCP port of an ACTS server (5001) that sees people, boxes and robots in channels 1,
            2 and 3; further robots' have the next ones.
    """

    port: Annotated[TcpPort | None, Parameter(name=["--port", "-p"])] = None
    bind: Annotated[str, Parameter(name=["--bind", "--bind-to-address"])] = "127.0.0.1"
    no_announce: Annotated[Flag, Parameter(name=["--no-announce", "--no-network-discovery"])] = (
        False
    )
    pty: Flag = False
    acts: Annotated[TcpPort | None, Parameter(show_default=False)] = None

    @property
    def first(self) -> int:
        """TCP port of the first robot."""
        return 8101 if self.port is None else self.port

    @property
    def warning(self) -> str:
        """A warning about the address; empty on loopback."""
        if self.bind in LOOPBACK:
            return ""
        return f"there is no password: whoever reaches {self.bind} can drive these robots"


@Parameter(name="*", group=TIME)
@dataclass(frozen=True, slots=True, kw_only=True)
class TimeOptions:
    """How time passes.

    Attributes:
        speed: Simulated seconds per real one, such as 10.
        fast: As fast as possible.
        lock_step: Time waits for the clients: one packet from each for every report.
    """

    speed: float = 1.0
    fast: Flag = False
    lock_step: Flag = False

    def pace(self) -> "Pacer":
        """Return the pace."""
        from pioneer3.sim.server.pacer import Pacer

        if self.fast and self.speed != 1.0:
            raise ConfigError("--speed and --fast: give one of them")
        return Pacer(inf if self.fast else self.speed, lock_step=self.lock_step)


@Parameter(name="*", group=ERRORS)
@dataclass(frozen=True, slots=True, kw_only=True)
class ErrorOptions:
    """Errors of the robots.

    Attributes:
        ideal: No noise, no slip, sonar as thin rays: robots do exactly what they are told.
        odom_error_mode: Where the odometry's error comes from; all of it if not given.
        no_error: The same as --odom-error-mode none.
        fault: What is wrong with the cables: shares and seconds as in drop=0.01,delay=0.2.
    """

    ideal: Flag = False
    odom_error_mode: OdometryMode | None = None
    no_error: Flag = False
    fault: Annotated[str, Unset] = ""

    def realism(self) -> "Realism":
        """Return how like real robots they are."""
        from pioneer3.sim.realism import Realism

        mode = self.odom_error_mode
        if self.no_error and mode not in {None, "none"}:
            raise ConfigError("--no-error and --odom-error-mode: give one of them")
        realism = Realism.ideal() if self.ideal else Realism()
        mode = "none" if self.no_error else mode
        return realism.with_odometry(mode) if mode else realism

    def faults(self) -> "LinkFaults":
        """Return the faults of the cables."""
        from pioneer3.sim.server.faults import LinkFaults

        return LinkFaults.parse(self.fault)


@Parameter(name="*", group=MOBILESIM)
@dataclass(frozen=True, slots=True, kw_only=True)
class MobileSimOptions:
    """Options of scripts for MobileSim.

    Attributes:
        cwd: Folder to change to first: maps are found there.
        log_file: File that gets a line when somebody connects or leaves.
    """

    cwd: Path | None = None
    log_file: Annotated[Path | None, Parameter(name=["--log-file", "-l"])] = None

    def enter_folder(self) -> None:
        """Change to the folder of `--cwd`."""
        if self.cwd is not None:
            try:
                os.chdir(self.cwd)
            except OSError as error:
                raise ConfigError(f"--cwd {self.cwd}: {error.strerror}") from None

    def log_handler(self) -> logging.Handler:
        """Return the handler that writes the log file."""
        assert self.log_file is not None
        try:
            handler = logging.FileHandler(self.log_file)
        except OSError as error:
            raise ConfigError(f"--log-file {self.log_file}: {error.strerror}") from None
        handler.setFormatter(LogFormatter("%(asctime)s %(levelname)s %(message)s"))
        return handler


MAP, DEFAULT_WORLD, DEFAULT_PORTS, DEFAULT_TIME = (
    MapOptions(),
    WorldOptions(),
    PortOptions(),
    TimeOptions(),
)
DEFAULT_ERRORS, DEFAULT_MOBILESIM = ErrorOptions(), MobileSimOptions()
MANY = Parameter(negative=(), show_default=False)
LikeOption = Annotated[str | None, Parameter(name="--like", metavar="FILE")]
AgainstOption = Annotated[str | None, Parameter(name="--against", metavar="LOG")]
FleetOption = Annotated[Path | None, Parameter(name="--fleet", metavar="FILE")]


def sim(
    *,
    robot: Robots = (),
    number: RobotNumber = None,
    robot_factory: Annotated[str, Parameter(name=["--robot-factory", "-R"]), MANY] = "",
    fleet: FleetOption = None,
    like: LikeOption = None,
    against: AgainstOption = None,
    map_: MapOptions = MAP,
    world: WorldOptions = DEFAULT_WORLD,
    ports: PortOptions = DEFAULT_PORTS,
    time: TimeOptions = DEFAULT_TIME,
    errors: ErrorOptions = DEFAULT_ERRORS,
    mobilesim: MobileSimOptions = DEFAULT_MOBILESIM,
    verbose: Annotated[
        bool, Parameter(name=["--verbose", "-v"], negative="", show_default=False)
    ] = False,
) -> int:
    """Run the simulator alone, without a window: robots in a map, each on a TCP port.

    Programs connect to it as to a robot: ours, ARIA's, Player's. They may come and
    go. MobileSim's options are taken. Names are for people: to programs a robot is
    MobileSim, by which ARIA knows a simulator. With --fit laser=MODEL it tells its
    own name: ARIA takes it for a real robot, and opens the port of its laser.

    Example: pioneer3 sim -m lab -r p3at -r p3dx:bob --start random
    Example: pioneer3 sim --like rosie

    Args:
        robot: MODEL[:NAME], such as p3dx:bob; once for each. MODEL may be a .toml or .p file.
        number: So many of each --robot, or of the usual one, such as 10.
        robot_factory: MODEL of which each client of the first port gets a robot while it stays.
        fleet: File of a fleet: a robot for each row, with its name, model and TCP port.
        like: A real robot's own file or name, or a log of it: a robot with its measured errors.
        against: With a log at --like: another log of it, which the twin is compared with.
        verbose: Tell who connects and leaves.
    """
    _log(mobilesim, verbose=verbose)
    mobilesim.enter_folder()
    if ports.warning:
        write_warning(ports.warning)
    from pioneer3.sim.server.start import simulator

    robots: Sequence[str | RobotSpec] = repeated(robot, number)
    if fleet is not None:
        if robots or robot_factory:
            raise ConfigError("--fleet gives the robots; leave --robot, -n and --robot-factory out")
        from pioneer3.fleet.inventory import read_fleet
        from pioneer3.fleet.simulated import simulated

        robots = simulated(read_fleet(fleet), ports.bind, network=ports.bind not in LOOPBACK)
    realism, faults = errors.realism(), errors.faults()
    with ExitStack() as stack:
        if against is not None and like is None:
            raise ConfigError(f"--against {against}: give the log that tells the twin with --like")
        if like is not None:
            if robots or robot_factory:
                raise ConfigError("--like gives the robot; leave the other robots out")
            from pioneer3.cli.sim_like import robot_like

            found = stack.enter_context(robot_like(like, realism, against))
            robots, realism = [found.robot], found.realism
            faults.delay = faults.delay or found.delay / 2
        simulation = simulator(
            map_name=map_.name(),
            overrides=world.overrides(robots, factory=robot_factory, own_ports=ports.port is None),
            port=ports.first,
            host=ports.bind,
            ptys=ports.pty,
            acts=ports.acts,
            realism=realism,
            pace=time.pace(),
            faults=faults,
        )
        return run_until_told_to_leave(_simulate(simulation, announce=not ports.no_announce))


async def _simulate(
    simulation: "AbstractAsyncContextManager[RunningSimulation]", *, announce: bool
) -> int:
    import asyncio

    async with AsyncExitStack() as stack:
        try:
            running = await stack.enter_async_context(simulation)
        except PortBusyError as error:
            raise PortBusyError(f"{error} with -p, or --acts for colour trackers") from None
        for note in running.notes:
            write_warning(note)
        if running.progress:
            write_error(running.progress)
        write_line("\n".join(greeting(running)))
        if announce:
            from pioneer3.fleet.announce import announced, of_simulation

            await stack.enter_async_context(announced(of_simulation(running), write_warning))
        await asyncio.get_running_loop().create_future()
    return 0


def greeting(running: "RunningSimulation") -> Iterator[str]:
    """Yield a line for each robot, that ends in its URL, and how to drive."""
    robots, where = running.robots, running.world.map.name
    named = len(robots) > 1 or any(robot.name != robot.model.name for robot in robots)
    width = max((len(robot.name) for robot in robots), default=0)
    for robot in robots:
        who = f"{robot.name:{width}}  " if named else ""
        pty = f"{robot.pty} and " if robot.pty else ""
        model = robot.model
        yield f"SIMULATOR: {who}{model.title} ({model.name}) in {where} on {pty}{robot.url}"
    for robot in robots:
        if robot.laser is not None:
            laser = robot.laser
            pty = f" and {laser.pty}" if laser.pty else ""
            yield f"LASER: {laser.model.title} on {robot.name}: laser at {laser.url}{pty}"
    for robot in robots:
        if robot.camera is not None:
            camera = robot.camera
            yield f"CAMERA: {camera.model.title} on {robot.name}: pictures at {camera.url}"
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
