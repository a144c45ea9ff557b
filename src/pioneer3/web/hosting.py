"""Connects a page to several robots; a robot that is lost or not there ends none of the others."""

import asyncio
import logging
import re
from collections.abc import AsyncIterator, Callable, Sequence
from contextlib import asynccontextmanager
from dataclasses import dataclass, field, replace

from pioneer3.arcos.host_events import Timing
from pioneer3.errors import LinkError, NoRobotError
from pioneer3.links import Opener
from pioneer3.models import GivenModel
from pioneer3.names import free_name
from pioneer3.nav.settings import AS_SHIPPED, NavigationSettings
from pioneer3.navigation.connect import connect_async
from pioneer3.navigation.recording import use_map
from pioneer3.robot.devices.laser import LaserSource
from pioneer3.robot.lasers.driver import LaserDriver
from pioneer3.robot.lasers.spec import LaserSpec
from pioneer3.robot.supervisor import Connection, kind
from pioneer3.runtime.recording import Record, RobotLog, recorded
from pioneer3.runtime.robot import Robot
from pioneer3.tasks import running
from pioneer3.web.page import Page
from pioneer3.web.scene import RemoteWorld, RobotScene

log = logging.getLogger(__name__)

NEWS = {Connection.CONNECTED, Connection.LOST}
RETRY_PERIOD = 5.0
"""Pause before another attempt to connect to a robot [s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ConnectTarget:
    """A robot to connect to, at a URL or by `open`, in a scene, as :func:`connect_async` does.

    People are shown the name; it is empty for what the robot is called.
    """

    url: str
    scene: RobotScene = field(default_factory=RobotScene)
    open: Opener | None = None
    name: str = ""
    baud: int | None = None
    model: GivenModel = None
    max_speed: float | None = None
    timing: Timing | None = None
    lasers: tuple[LaserSpec, ...] = ()
    camera: str | None = None
    shadow: bool = False
    settings: NavigationSettings = AS_SHIPPED


@asynccontextmanager
async def hosted(
    page: Page, targets: Sequence[ConnectTarget], tell: Callable[[str], None], record: Record = None
) -> AsyncIterator[None]:
    """Show every robot of `targets` at `page` while the block lasts, after one attempt for each.

    They have one log, where `record` tells, as for :func:`connect_async`.

    Of several robots, those that are not there are tried again and again; `tell` says which.

    Raises:
        LinkError, NoRobotError: none of them is there.
        ConfigError: an option is wrong.
    """
    single = len(targets) == 1
    with recorded(record, asyncio.get_running_loop().time) as log:
        page.clients.log = log.log if log else None
        logs = [log.of("" if single else name) if log else None for name in log_names(targets)]
        connections = [
            RobotConnection(page, n, target, tell, log, single=single)
            for n, (target, log) in enumerate(zip(targets, logs, strict=True), 1)
        ]
        async with running(*(connection.keep_open() for connection in connections)):
            for connection in connections:
                await connection.tried.wait()
            failures = [each.failure for each in connections if each.failure is not None]
            if len(failures) == len(connections):
                raise failures[0]
            for failure in failures:
                tell(f"Not there: {failure}; it is looked for every {RETRY_PERIOD:.0f} s")
            yield


def log_names(targets: Sequence[ConnectTarget]) -> list[str]:
    """Return the names of robots in a log, such as `bob`; of one without a name its address."""
    names: list[str] = []
    for target in targets:
        words = re.findall(r"[\w.]+", target.name or target.url.partition(":")[2])
        names.append(free_name("-".join(words) or "robot", set(names)))
    return names


class RobotConnection:
    """Connects to one robot, and again if that fails; `number` is its number on the page.

    After the first attempt `tried` is set, and `failure` is its error, `None` if it succeeded.
    """

    def __init__(
        self,
        page: Page,
        number: int,
        target: ConnectTarget,
        tell: Callable[[str], None],
        robot_log: RobotLog | None,
        *,
        single: bool,
    ) -> None:
        self.tried = asyncio.Event()
        self.failure: Exception | None = None
        self._page = page
        self._number = number
        self._target = target
        self._tell = tell
        self._log = robot_log
        self._single = single

    async def keep_open(self) -> None:
        """Serve the robot until cancelled."""
        while True:
            try:
                await self._serve()
            except (LinkError, NoRobotError) as error:
                if self._single:
                    raise
                self._note(error)
            except Exception as error:
                if self._single or not self.tried.is_set():
                    raise
                log.exception("%s failed", self._target.url)
                self._tell(f"{self._target.url} failed: {error!r}")
            await asyncio.sleep(RETRY_PERIOD)

    async def _serve(self) -> None:
        target = self._target
        async with (
            connect_async(
                target.open or target.url,
                baud=target.baud,
                model=target.model,
                max_speed=target.max_speed,
                record=self._log or False,
                timing=target.timing,
                lasers=target.lasers,
                camera=target.camera,
                shadow=target.shadow,
                settings=target.settings,
            ) as robot,
            self._in_scene(robot) as scene,
            self._page.hosting(robot, scene, target.name, self._number) as view,
        ):
            self._tell(f"Connected to a {kind(robot.info)}: {_title(robot, view.name)}")
            self.tried.set()
            which = "" if self._single else f"{view.name}: "
            lasers = (self._follow_laser(laser, which) for laser in robot.lasers)
            async with running(self._record(robot, scene), *lasers):
                async for status in robot.supervisor.status.values():
                    self._tell(f"{which}{status.connection.value}: {status.message}")
                await asyncio.get_running_loop().create_future()  # the page of a recording stays

    async def _follow_laser(self, laser: LaserSource, which: str) -> None:
        """Tell that a laser at the computer has come, or is lost."""
        if not isinstance(laser, LaserDriver):
            return
        told = None
        async for status in laser.status.values(latest_first=True):
            if status.connection in NEWS and status != told:
                told = status
                self._tell(f"{which}{laser.title} {status.connection.value}: {status.message}")

    async def _record(self, robot: Robot, scene: RobotScene) -> None:
        """Record the map that is used, and where a simulated robot truly is."""
        if self._log is None:
            return
        async for _ in robot.supervisor.snapshots.values(latest_first=True):
            if (known := scene.map_now) is not None:
                use_map(self._log, known)
            if (true := scene.true_pose) is not None:
                self._log.truth(true)

    @asynccontextmanager
    async def _in_scene(self, robot: Robot) -> AsyncIterator[RobotScene]:
        """Yield the surroundings of `robot`; a simulator in another program is asked for them."""
        scene = self._target.scene
        if scene.simulated:
            yield scene
            return
        remote = RemoteWorld(robot, scene.map, self._tell)
        async with running(remote.follow()):
            yield replace(scene, remote=remote)

    def _note(self, error: Exception) -> None:
        if not self.tried.is_set():
            self.failure = error
            self.tried.set()


def _title(robot: Robot, name: str) -> str:
    info = robot.info
    speed = f" at {info.speed} baud" if info.speed else ""
    known = f"{name}, " if name != info.model.title else ""
    return f"{known}{info.model.title} ({info.model.name}), on {info.url}{speed}"
