"""`pioneer3 run`: robots or an embedded simulator, their drivers, and the page, in one loop."""

import asyncio
from collections.abc import Awaitable, Callable, Iterator, Sequence
from contextlib import AbstractAsyncContextManager, AsyncExitStack
from dataclasses import dataclass, replace
from math import inf
from pathlib import Path

from pioneer3.arcos.host_events import Timing
from pioneer3.errors import ConfigError, PortBusyError
from pioneer3.jit import numba_version
from pioneer3.links.hosts import is_loopback
from pioneer3.nav.settings import AS_SHIPPED, NavigationSettings
from pioneer3.robot.lasers.spec import LaserSpec
from pioneer3.runtime.recording import Record
from pioneer3.sim.equipment import EquipmentOptions
from pioneer3.sim.kernels import CACHE
from pioneer3.sim.realism import Realism
from pioneer3.sim.server.laser import SimulatedLaser
from pioneer3.sim.server.running import RunningSimulation
from pioneer3.sim.server.start import simulator
from pioneer3.sim.worldfile import RobotSpec, load_world
from pioneer3.sim.worldfile.arguments import NO_OVERRIDES, WorldOverrides
from pioneer3.web.access.certificate import certificate_for, digest
from pioneer3.web.access.invitations import invitation_lines
from pioneer3.web.hosting import ConnectTarget, hosted
from pioneer3.web.page import Page
from pioneer3.web.scene import RobotScene
from pioneer3.web.server import Served, serve


async def no_lasers() -> Sequence[LaserSpec]:
    """Return no lasers."""
    return ()


USUAL_LASER = "lms-200"
"""Laser of the robot that is simulated where nobody asks for another one."""
PATIENT = Timing(silence=inf)
"""For a simulator in this program: it may be paused, and when it ends, so does the link."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RunOptions:
    """Options of `pioneer3 run`, as `pioneer3 run --help` explains them.

    Without `remote` robots it simulates: `robots` are the models and names then, and `settings`
    those of their navigation. TCP ports of 0 take free ones. Without a certificate one is made
    where others are let in. With `show_tokens` the output of `tell` is not stored, and may show
    them. `record` is where the log of all is, as for :func:`connect_async`. `lasers` looks for
    those of the only robot, and `camera` is its; several robots leave that out or refuse it. With
    `shadow` each has a twin. `announced` lets others find the page in the network while the block
    lasts; it is not called for one on loopback.
    """

    remote: tuple[ConnectTarget, ...] = ()
    baud: int | None = None
    map_name: str | None = None
    robots: tuple[RobotSpec, ...] = ()
    overrides: WorldOverrides = NO_OVERRIDES
    ideal: bool = False
    sim_port: int = 8101
    web_port: int = 8080
    host: str = "127.0.0.1"
    cert: Path | None = None
    key: Path | None = None
    show_tokens: bool = False
    max_speed: float | None = None
    record: Record = None
    lasers: Callable[[], Awaitable[Sequence[LaserSpec]]] = no_lasers
    camera: str | None = None
    camera_if_one: bool = False
    shadow: bool = False
    settings: NavigationSettings = AS_SHIPPED
    announced: Callable[[Served], AbstractAsyncContextManager[None]] | None = None


async def live(options: RunOptions, tell: Callable[[str], None]) -> int:
    """Run until cancelled; `tell` is called with each line of output.

    Raises:
        PioneerError: something could not be started; the message says what to do.
    """
    async with AsyncExitStack() as stack:
        taken: list[int] = []
        if options.remote:
            known = load_world(options.map_name).line_map() if options.map_name else None
            targets = [replace(each, scene=RobotScene(known)) for each in options.remote]
        else:
            simulation = await _simulation(options, stack, tell)
            targets = _simulated(simulation, options.settings)
            taken = simulation.tcp_ports
        lasers = await options.lasers()
        page = Page()
        certificate = certificate_for(options.host, options.cert, options.key)
        serving = serve(
            page, host=options.host, port=options.web_port, certificate=certificate, taken=taken
        )
        served = await stack.enter_async_context(serving)
        # the page waits for the robots, so that a port in use is reported first
        told = _with_options(targets, options, lasers)
        await stack.enter_async_context(hosted(page, told, tell, options.record))
        it = "it" if len(targets) == 1 else "them"
        tell(f"Drive {it} at {served.http}   (Ctrl-C ends)")
        for line in pairing_lines(page, options.host, show_tokens=options.show_tokens):
            tell(line)
        if options.announced is not None and not is_loopback(options.host):
            await stack.enter_async_context(options.announced(served))
        await asyncio.get_running_loop().create_future()
    return 0


async def _simulation(
    options: RunOptions, stack: AsyncExitStack, tell: Callable[[str], None]
) -> RunningSimulation:
    world = load_world(options.map_name or "office")
    robots = options.robots or options.overrides.robots or world.robots or (usual_robot(),)
    overrides = replace(options.overrides, robots=robots)
    simulation = simulator(
        map_name=world,
        port=options.sim_port,
        overrides=overrides,
        realism=Realism.ideal() if options.ideal else Realism(),
    )
    try:
        running = await stack.enter_async_context(simulation)
    except PortBusyError as error:
        raise PortBusyError(f"{error} for simulated robots with --sim-port") from None
    for note in running.notes:
        tell(f"WARNING: {note}")
    if running.progress:
        tell(running.progress)
    return running


def usual_robot() -> RobotSpec:
    """Return the simulated robot where nobody asks for another one.

    It has a laser if kernels are compiled by now: else its readings take longer than they may.
    """
    fast = numba_version() is not None and (CACHE.is_complete or not CACHE.can_keep)
    return RobotSpec(equipment=EquipmentOptions(laser=USUAL_LASER if fast else None))


def _simulated(running: RunningSimulation, settings: NavigationSettings) -> list[ConnectTarget]:
    several = len(running.robots) > 1
    return [
        ConnectTarget(
            url=robot.url,
            scene=RobotScene.of(running, robot),
            name=robot.name if several or robot.name != robot.model.name else "",
            model=robot.model,
            timing=PATIENT,
            lasers=(_laser_of(robot.laser),) if robot.laser else (),
            camera=robot.camera.url if robot.camera else None,
            settings=settings,
        )
        for robot in running.robots
    ]


def _laser_of(laser: SimulatedLaser) -> LaserSpec:
    """Return the driver's way to a simulated laser: a serial line is quicker where it has one."""
    serial = laser.pty if laser.model.speeds else None
    return LaserSpec(url=serial or laser.url, protocol=laser.model.protocol)


def _with_options(
    targets: Sequence[ConnectTarget], options: RunOptions, lasers: Sequence[LaserSpec]
) -> list[ConnectTarget]:
    """Return `targets` with the options of all; ConfigError for one camera of several robots."""
    camera = options.camera
    if camera is not None and len(targets) > 1:
        if not options.camera_if_one:
            raise ConfigError("--camera: of one robot only; run one `pioneer3 run` for each robot")
        camera = None
    return [
        replace(
            target,
            baud=options.baud,
            max_speed=options.max_speed,
            shadow=options.shadow,
            lasers=(*lasers, *target.lasers),
            camera=camera or target.camera,
        )
        for target in targets
    ]


def pairing_lines(page: Page, host: str, *, show_tokens: bool) -> Iterator[str]:
    """Yield instructions for other devices, or the reason why they cannot connect."""
    if is_loopback(host):
        return
    if not page.access.urls:
        yield (
            "No other device can connect: this computer has no address in a network. Connect it "
            "(see `ip address`), then start this again"
        )
        return
    yield f"For other devices, after pairing: {'  '.join(page.access.urls)}"
    if page.access.authority is not None:
        yield f"The https certificate's authority: SHA-256 {digest(page.access.authority)}"
    if show_tokens:
        yield from invitation_lines(page.access.urls[0], page.access.invitations)
    yield "To list devices, invite more and revoke them: pioneer3 access --help"
