"""`pioneer3 class`: robots with a bridge each, the page, and the class, in one loop."""

import asyncio
import logging
from collections.abc import Callable, Iterator, Sequence
from contextlib import AsyncExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Event
from time import time

from numpy.random import default_rng

from pioneer3.bridge import Bridge
from pioneer3.classroom.downloads import Downloads
from pioneer3.classroom.runs import RunFolder
from pioneer3.classroom.wheel import build_wheel
from pioneer3.classroom.wheelhouse import Wheelhouse
from pioneer3.errors import ConfigError, PortBusyError
from pioneer3.links import Link, Opener, opener
from pioneer3.links.hosts import bracketed, is_loopback
from pioneer3.links.memory import null_modem
from pioneer3.models import load_model
from pioneer3.runtime.recording import Record
from pioneer3.sim.placer import spawn_robots
from pioneer3.sim.realism import Realism
from pioneer3.sim.server.port import RobotPort
from pioneer3.sim.server.running import RunningSimulation, SimulatedRobot
from pioneer3.sim.server.start import simulator
from pioneer3.sim.worldfile import RobotSpec, WorldFile, load_world
from pioneer3.sim.worldfile.arguments import WorldOverrides
from pioneer3.tasks import running
from pioneer3.web.access.certificate import certificate_for
from pioneer3.web.access.hosts import lan_addresses
from pioneer3.web.access.invitations import terminal_lines
from pioneer3.web.audience import Audience
from pioneer3.web.classroom.classroom import Classroom
from pioneer3.web.classroom.robot import PAGE, ClassRobot, StartPlace
from pioneer3.web.hosting import ConnectTarget, hosted
from pioneer3.web.live import PATIENT
from pioneer3.web.page import Page
from pioneer3.web.scene import RobotScene
from pioneer3.web.server import Served, serve

log = logging.getLogger(__name__)

MODEL = "p3dx"
SEED = 1
"""Robots of a class begin at the same places in each lesson."""
UNPLUGGING = 2.0
"""Longest wait for the last host of a robot to leave it [s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ClassOptions:
    """Options of `pioneer3 class`: robots are simulated, one for each student, or of a fleet.

    The map is one that ships, or a file; `None` is the office for a simulator, none for a fleet.
    `sim_port` is the TCP port of the first robot for students' programs; 0 takes free ones, also
    for the page. With `show_tokens` the output of `tell` is not stored, and may show the link.
    The wheelhouse is a folder of wheels for laptops without internet, `None` for none. `record` is
    where the log of all is, as for :func:`connect_async`.
    """

    students: int = 0
    fleet: tuple[ConnectTarget, ...] = ()
    map_name: str | None = None
    model: str = MODEL
    ideal: bool = False
    folder: Path
    sim_port: int = 8101
    web_port: int = 8080
    host: str = "127.0.0.1"
    show_tokens: bool = False
    wheelhouse: Path | None = None
    record: Record = None


class MemoryCables:
    """Cables from bridges to simulated robots that do not listen."""

    def __init__(self) -> None:
        self._serving: set[asyncio.Task[None]] = set()

    def opener(self, port: RobotPort) -> Opener:
        """Return a function that plugs in a new cable at each call, once the last one is out."""
        last: set[asyncio.Task[None]] = set()

        async def open_link() -> Link:
            if last:
                await asyncio.wait(last, timeout=UNPLUGGING)
            ours, theirs = null_modem()
            task = asyncio.ensure_future(port.serve(theirs))
            for tasks in (self._serving, last):
                tasks.add(task)
                task.add_done_callback(tasks.discard)
            return ours

        return open_link

    async def unplug(self) -> None:
        """Unplug all cables."""
        for task in self._serving:
            task.cancel()
        await asyncio.gather(*self._serving, return_exceptions=True)


async def class_live(options: ClassOptions, tell: Callable[[str], None]) -> int:
    """Run until cancelled; `tell` is called with each line of output.

    Raises:
        PioneerError: something could not be started; the message says what to do.
    """
    async with AsyncExitStack() as stack:
        wheels = await _wheelhouse(options.wheelhouse, tell) if options.wheelhouse else None
        folder = stack.enter_context(TemporaryDirectory(prefix="pioneer3-class-"))
        building = asyncio.ensure_future(asyncio.to_thread(build_wheel, Path(folder)))
        stack.push_async_callback(asyncio.wait, [building])
        targets = await _targets(options, stack, tell)
        page = Page()
        certificate = certificate_for(options.host, None, None)
        robots = await _bridged(targets, options, stack)
        page.classroom = classroom = Classroom(page, robots, RunFolder(options.folder), time)
        for number in robots:
            page.add_audience(Audience(number, student=True))
            page.add_audience(Audience(number))
        page.add_audience(Audience(small=True))
        taken = [int(robot.url.rpartition(":")[2]) for robot in robots.values()]
        serving = serve(
            page, host=options.host, port=options.web_port, certificate=certificate, taken=taken
        )
        served = await stack.enter_async_context(serving)
        classroom.join_url = join_url(page.access.urls, served, classroom.token)
        port = int(served.http.rpartition(":")[2])
        classroom.downloads = Downloads(await asyncio.shield(building), port, wheels)
        classroom.lan = bool(page.access.urls)
        classroom.roster.shared = not classroom.lan  # here are the teacher's own browsers only
        over_bridges = [
            replace(target, open=robot.bridge.opener(PAGE, gives_way=True))
            for target, robot in zip(targets, robots.values(), strict=True)
        ]
        hosting = hosted(page, over_bridges, lambda line: log.info("%s", line), options.record)
        await stack.enter_async_context(hosting)
        for robot in robots.values():
            if page.world is not None and robot.start is not None:
                page.world.urls[robot.start.robot] = robot.url
        await stack.enter_async_context(running(classroom.run()))
        for line in _lines(options, classroom, served):
            tell(line)
        for number in robots.keys() - page.robots.keys():
            tell(f"Not there: {robots[number].label}; it is looked for again and again")
        await asyncio.get_running_loop().create_future()
    return 0


async def _wheelhouse(folder: Path, tell: Callable[[str], None]) -> dict[str, Path]:
    """Fill a wheelhouse beside the loop; a cancelled one keeps what it has loaded."""
    stopped, loop = Event(), asyncio.get_running_loop()

    def tell_here(line: str) -> None:
        loop.call_soon_threadsafe(tell, line)

    try:
        return await asyncio.to_thread(Wheelhouse(folder, tell_here, stopped.is_set).open)
    finally:
        stopped.set()


def join_url(urls: Sequence[str], served: Served, token: str) -> str:
    """Return the address for students; browsers send no server the part after the `#`.

    Without other devices it has the name `localhost`: a student's cookie of that name leaves the
    teacher's page at 127.0.0.1 alone.
    """
    base = urls[0] if urls else served.http.replace("127.0.0.1", "localhost")
    return f"{base}/join#{token}"


async def _targets(
    options: ClassOptions, stack: AsyncExitStack, tell: Callable[[str], None]
) -> list[ConnectTarget]:
    """Return the robots of the class, named, as bridges reach them."""
    if not options.fleet:
        return await _simulated(options, stack, tell)
    known = load_world(options.map_name).line_map() if options.map_name else None
    return [replace(robot, scene=RobotScene(known)) for robot in options.fleet]


async def _simulated(
    options: ClassOptions, stack: AsyncExitStack, tell: Callable[[str], None]
) -> list[ConnectTarget]:
    name = options.map_name or "office"
    load_model(options.model)  # a wrong name is no lack of room
    robots = (
        RobotSpec(model=options.model, name=f"Robot {n}") for n in range(1, options.students + 1)
    )
    overrides = WorldOverrides(robots=tuple(robots), starts=("random",), seed=SEED, own_ports=False)
    _check_room(load_world(name), overrides, name)
    realism = Realism.ideal() if options.ideal else Realism()
    simulation = simulator(map_name=name, port=None, overrides=overrides, realism=realism)
    here = await stack.enter_async_context(simulation)
    for line in [f"WARNING: {note}" for note in here.notes] + [here.progress]:
        if line:
            tell(line)
    cables = MemoryCables()
    stack.push_async_callback(cables.unplug)
    return [_target(here, robot, cables) for robot in here.robots]


def _target(here: RunningSimulation, robot: SimulatedRobot, cables: MemoryCables) -> ConnectTarget:
    return ConnectTarget(
        url=robot.url,
        open=cables.opener(robot.port),
        scene=RobotScene.of(here, robot),
        name=robot.name,
        model=robot.model,
        timing=PATIENT,
    )


def _check_room(world: WorldFile, overrides: WorldOverrides, name: str) -> None:
    """Raise ConfigError for more robots than the map has room for; it says how many fit."""
    wanted = len(overrides.robots)
    if _fit(world, overrides, wanted):
        return
    fits, fails = 0, wanted
    while fails - fits > 1:
        tried = (fits + fails) // 2
        fits, fails = (tried, fails) if _fit(world, overrides, tried) else (fits, tried)
    rest = f", or --students {fits}" if fits else ""
    raise ConfigError(
        f"map {name}: there is room for {fits} robots, not for {wanted}; take a larger map with "
        f"--map{rest}"
    )


def _fit(world: WorldFile, overrides: WorldOverrides, count: int) -> bool:
    some = replace(overrides, robots=overrides.robots[:count]).applied_to(world)
    try:
        spawn_robots(some, some.line_map(), default_rng(some.seed))
    except ConfigError:
        return False
    return True


async def _bridged(
    targets: Sequence[ConnectTarget], options: ClassOptions, stack: AsyncExitStack
) -> dict[int, ClassRobot]:
    """Give each robot a bridge that listens; return the robots by number."""
    robots = {}
    address = next(iter(lan_addresses(options.host)), "127.0.0.1")
    for number, target in enumerate(targets, 1):
        bridge = Bridge(target.open or opener(target.url), timing=target.timing)
        await stack.enter_async_context(running(bridge.run()))
        port = options.sim_port + number - 1 if options.sim_port else 0
        try:
            taken = await stack.enter_async_context(bridge.listening(options.host, port))
        except PortBusyError as error:
            raise PortBusyError(f"{error} for students' programs with --sim-port") from None
        robots[number] = ClassRobot(
            number,
            target.name,
            bridge,
            f"tcp://{bracketed(address)}:{taken}",
            start=_start(target.scene),
            clock=time,
        )
    return robots


def _start(scene: RobotScene) -> StartPlace | None:
    """Return where a simulated robot is before anybody drives it, `None` of a real one."""
    if scene.simulated is None:
        return None
    simulation, robot = scene.simulated
    return StartPlace(simulation, robot, robot.body.robot_in_world)


def _lines(options: ClassOptions, classroom: Classroom, served: Served) -> Iterator[str]:
    robots = list(classroom.robots.values())
    kind = "robots" if options.fleet else "simulated robots"
    yield f"A class of {len(robots)} {kind}. The teacher's page: {served.http}/class"
    if options.show_tokens:
        if classroom.lan:
            yield from terminal_lines(classroom.join_url)
        yield f"Students open {classroom.join_url}"
    else:
        yield "The link for students is on that page"
    if is_loopback(options.host):
        yield "Only this computer is let in; add --lan for the students' devices"
    elif not classroom.lan:
        yield "No other device can connect: this computer has no address in a network"
    if classroom.downloads is not None:
        host = bracketed(next(iter(lan_addresses(options.host)), "127.0.0.1"))
        yield f"Students install pioneer3 by: {classroom.downloads.command(host)}"
    yield f"Students' programs connect to {robots[0].url}" + (
        f" (robot 1) to {robots[-1].url} (robot {len(robots)})" if len(robots) > 1 else ""
    )
    yield f"Runs are handed in to {options.folder}/   (Ctrl-C ends)"
