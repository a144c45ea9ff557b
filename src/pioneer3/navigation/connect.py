"""Connecting to a robot, with or without a map."""

import asyncio
import logging
import sys
from collections.abc import AsyncIterator, Callable, Sequence
from contextlib import asynccontextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from pioneer3.arcos.host_events import Timing
from pioneer3.distribution import how_to_get
from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.links import Opener
from pioneer3.models import GivenModel
from pioneer3.nav.settings import AS_SHIPPED, NavigationSettings
from pioneer3.navigation.blocking import BlockingRobot
from pioneer3.robot.supervisor import is_simulator
from pioneer3.runtime.connect import connect_robot
from pioneer3.runtime.recording import Record, RobotLog
from pioneer3.runtime.robot import Robot
from pioneer3.tasks import running

if TYPE_CHECKING:
    from pioneer3.maps import LineMap
    from pioneer3.navigation.localization import InThread
    from pioneer3.navigation.navigator import Navigator
    from pioneer3.robot.lasers.spec import LaserSpec

log = logging.getLogger(__name__)

UNKNOWN_START = "unknown"
"""Tells that nobody knows where the robot is."""
ANY_HEADING = 2.0
"""Standard deviation of a heading that nobody has told [rad]."""


@asynccontextmanager
async def connect_async(
    url: str | Opener,
    *,
    baud: int | None = None,
    model: GivenModel = None,
    max_speed: float | None = None,
    max_turn_rate: float | None = None,
    auto_enable: bool = True,
    record: Record = None,
    timing: Timing | None = None,
    lasers: "Sequence[LaserSpec | str]" = (),
    camera: str | None = None,
    shadow: bool = False,
    line_map: "LineMap | str | Path | None" = None,
    start: Pose2 | str | None = None,
    settings: NavigationSettings = AS_SHIPPED,
) -> AsyncIterator[Robot]:
    """Connect to a robot or simulator; stop it and close the session on every way out.

    In the main thread the signals to leave are ways out too: :mod:`pioneer3.runtime.signals`.

    Args:
        url: `/dev/ttyUSB0`, `tcp://localhost:8101`, `replay:FILE`; or a function that opens a link.
        baud: Serial speed to try first.
        model: Use this model, not the one that the robot names: a shipped one by its name, or
            that of a `.toml` or ARIA `.p` file. Without one a robot of a type that is not known
            is read, and not driven.
        max_speed: Keep below this [m/s]; never above the robot's own limit.
        max_turn_rate: Keep below this [rad/s].
        auto_enable: Whether a fresh command switches the motors on.
        record: New file for the log of all that comes from the robot and is asked of it, which
            `replay:FILE` plays. Without one it is the next in the user's folder of logs, unless
            `PIONEER3_RECORD=0` is in the environment; `True` records in any case, `False` never.
        timing: How patient to be.
        lasers: Laser range finders at the computer, such as `/dev/ttyACM0`. They may come later,
            and may be lost and found again.
        camera: URL of the MJPEG stream of a camera on the robot; it may come and go too.
        shadow: Whether a simulated twin gets the same commands: `robot.shadow.parting` tells where
            the robot differs from it, and why.
        line_map: The map to navigate on, its file, or the name of one that ships; `"simulator"`
            asks the simulator for its own; needs a laser.
        start: Where the robot is on the map: a pose, the name of a place, `"unknown"`, or `None`
            for where it was when a program ended, or else the map's home; its laser confirms that.
        settings: Of its navigation.

    Raises:
        LinkError: the port does not open.
        NoRobotError: nothing that answers is a robot.
        ConfigError: the URL or an option is wrong, or the extra `nav` is missing.
    """
    if line_map is not None:
        await prepare_navigation()
    connection = connect_robot(
        url,
        baud=baud,
        model=model,
        max_speed=max_speed,
        max_turn_rate=max_turn_rate,
        auto_enable=auto_enable,
        record=record,
        timing=timing,
        lasers=lasers,
        camera=camera,
        shadow=shadow,
    )
    async with connection as robot, _truth_recorded(robot, record):
        robot.settings = settings
        if line_map is None:
            yield robot
            return
        navigator = robot.navigator = await _navigator(robot, line_map, start)
        if robot.shadow is not None:
            robot.shadow.odom_in_map = lambda: navigator.sure_odom_in_map
        async with running(navigator.run()):
            yield robot


@asynccontextmanager
async def _truth_recorded(robot: Robot, record: Record) -> AsyncIterator[None]:
    """Record where a robot of another program's simulator truly is, in a log of its own."""
    log = robot.arbiter.log
    if log is None or isinstance(record, RobotLog) or not is_simulator(robot.info):
        yield
        return
    from pioneer3.navigation.simulator import TruePose

    async with running(TruePose(robot, told=log.truth).follow()):
        yield


def connect(
    url: str,
    *,
    baud: int | None = None,
    model: GivenModel = None,
    max_speed: float | None = None,
    max_turn_rate: float | None = None,
    auto_enable: bool = True,
    record: Record = None,
    lasers: "Sequence[LaserSpec | str]" = (),
    camera: str | None = None,
    shadow: bool = False,
    line_map: "LineMap | str | Path | None" = None,
    start: Pose2 | str | None = None,
    settings: NavigationSettings = AS_SHIPPED,
) -> "BlockingRobot":
    """Connect to a robot or simulator, and wait until it says something.

    Use it in a `with` block: every way out of the block stops the robot. In a notebook, call
    :meth:`BlockingRobot.close` at the end; a cell that runs again closes the robot that it had
    connected to `url` before. Arguments and errors are those of
    :func:`pioneer3.connect_async`.
    """
    return BlockingRobot(
        connect_async(
            url,
            baud=baud,
            model=model,
            max_speed=max_speed,
            max_turn_rate=max_turn_rate,
            auto_enable=auto_enable,
            record=record,
            lasers=lasers,
            camera=camera,
            shadow=shadow,
            line_map=line_map,
            start=start,
            settings=settings,
        ),
        url,
    )


async def prepare_navigation(
    in_thread: "InThread" = asyncio.to_thread, tell: Callable[[str], None] = log.warning
) -> None:
    """Import and compile navigation while the event loop goes on.

    Kernels are compiled in a process of their own, once after each installation; where nothing can
    be kept, in a thread. If they are, `tell` is told.

    Raises:
        ConfigError: The extra `nav` is missing.
    """
    await in_thread(require_navigation)
    from pioneer3.nav.kernels import CACHE
    from pioneer3.nav.warm_up import warm_up

    if CACHE.is_missing:
        tell("compiling navigation, once: it takes about half a minute")
        process = await asyncio.create_subprocess_exec(sys.executable, "-m", "pioneer3.nav")
        await process.wait()
    await in_thread(warm_up)


def require_navigation() -> None:
    """Make sure that maps can be made and driven on.

    Raises:
        ConfigError: The extra `nav` is missing.
    """
    try:
        from pioneer3.nav import warm_up  # noqa: F401
        from pioneer3.navigation import navigator  # noqa: F401
    except ImportError as error:
        raise ConfigError(f"navigation on a map: {error}: {how_to_get('nav')}") from None


async def _navigator(
    robot: Robot, line_map: "LineMap | str | Path", start: Pose2 | str | None
) -> "Navigator":
    """Return the navigator of a robot that begins at `start`, or where it was last, or at home."""
    from pioneer3.maps import LineMap
    from pioneer3.nav.places import find_place, home
    from pioneer3.navigation.navigator import Navigator
    from pioneer3.navigation.simulator import OF_SIMULATOR, map_of_simulator
    from pioneer3.sim.worldfile import load_map

    if isinstance(line_map, LineMap):
        known = line_map
    else:
        known = await map_of_simulator(robot) if line_map == OF_SIMULATOR else load_map(line_map)
    if start == UNKNOWN_START:
        return await Navigator.on(robot, known)
    if start is None:
        navigator = await Navigator.on(robot, known)
        navigator.place_as_remembered(home(known))
        return navigator
    if not isinstance(start, str):
        return await Navigator.on(robot, known, start=start)
    place = find_place(known, start)
    here = Pose2(place.x, place.y, place.heading or 0.0)
    navigator = await Navigator.on(robot, known, start=here)
    if place.heading is None:
        navigator.place(here, turn_spread=ANY_HEADING)
    return navigator
