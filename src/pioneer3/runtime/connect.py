"""Connecting to a robot, and every way of leaving it."""

import asyncio
from collections.abc import AsyncIterator, Callable, Sequence
from contextlib import ExitStack, asynccontextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from pioneer3.arcos.host_events import Timing
from pioneer3.errors import ConfigError, how_to_get
from pioneer3.geometry import Pose2
from pioneer3.limits import Limits
from pioneer3.links import Opener, opener
from pioneer3.links.tap import recorded
from pioneer3.models import GivenModel, load_model
from pioneer3.robot.poses import Poses
from pioneer3.robot.supervisor import Supervisor
from pioneer3.runtime.arbiter import Arbiter
from pioneer3.runtime.robot import Robot
from pioneer3.runtime.signals import StopOnSignals
from pioneer3.tasks import running

if TYPE_CHECKING:
    from pioneer3.maps import LineMap
    from pioneer3.robot.camera_driver import CameraDriver
    from pioneer3.robot.lasers.driver import LaserDriver
    from pioneer3.robot.lasers.mounting import Mounting
    from pioneer3.robot.lasers.spec import LaserSpec
    from pioneer3.runtime.navigator import Navigator

USUAL = "p3at-sh"
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
    record: Path | None = None,
    timing: Timing | None = None,
    lasers: "Sequence[LaserSpec | str]" = (),
    camera: str | None = None,
    line_map: "LineMap | str | Path | None" = None,
    start: Pose2 | str | None = None,
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
        record: New file for every byte on the wire, which `replay:FILE` plays, and for what decided
            the motion, in words.
        timing: How patient to be.
        lasers: Laser range finders at the computer, such as `/dev/ttyACM0`. They may come later,
            and may be lost and found again.
        camera: URL of the MJPEG stream of a camera on the robot; it may come and go too.
        line_map: The map to navigate on, its file, or the name of one that ships; `"simulator"`
            asks the simulator for its own; needs a laser.
        start: Where the robot is on the map: a pose, the name of a place, `"unknown"`, or `None`
            for the map's home; without a home the robot has to be found.

    Raises:
        LinkError: the port does not open.
        NoRobotError: nothing that answers is a robot.
        ConfigError: the URL or an option is wrong, or the extra `nav` is missing.
    """

    def restrict(limits: Limits) -> Limits:
        return limits.lowered_to(max_speed, max_turn_rate)

    if line_map is not None:
        await prepare_navigation()
    remark: Callable[[str], None] | None = None
    open_ = url if callable(url) else opener(url, baud=baud)
    with ExitStack() as stack:
        if record is not None:
            clock = asyncio.get_running_loop().time
            recorder = stack.enter_context(recorded(open_, record, clock))
            open_, remark = recorder.open, recorder.remark
        supervisor = Supervisor(
            open_, model=model, restrict=restrict, auto_enable=auto_enable, timing=timing
        )
        arbiter = Arbiter(supervisor, remark)
        drivers = [_laser(spec, supervisor, stack) for spec in lasers]
        eye = _camera(camera)
        work = [supervisor.run(), *(driver.run() for driver in drivers)]
        work += [eye.run()] if eye else []
        load_model(USUAL)  # the reader of models loads slowly, and a robot that waits is lost
        stack.enter_context(StopOnSignals(asyncio.get_running_loop(), arbiter.stop))
        async with running(*work):
            await _first_snapshot(supervisor)
            robot = Robot(supervisor, arbiter, drivers, eye)
            if line_map is None:
                yield robot
                return
            navigator = robot.navigator = await _navigator(robot, line_map, start)
            async with running(navigator.run()):
                yield robot


@asynccontextmanager
async def connect_laser_async(
    url: "str | LaserSpec", *, record: Path | None = None, patience: float = 10.0
) -> "AsyncIterator[LaserDriver]":
    """Connect to a laser range finder alone, and wait for its first scan.

    It is connected again after every loss.

    Args:
        url: `/dev/ttyACM0`, `tcp://192.168.0.10:10940`, or with a model, `lms-200@/dev/ttyUSB1`.
        record: New file for every byte on the wire, which `replay:FILE` plays.
        patience: Longest wait for the first scan [s].

    Raises:
        DeviceError: no scan came; the message has the reason.
        ConfigError: the URL is wrong.
    """
    from pioneer3.robot.lasers.spec import parse_laser

    spec = parse_laser(url) if isinstance(url, str) else url
    with ExitStack() as stack:
        driver = _laser(replace(spec, record=record or spec.record), None, stack)
        async with running(driver.run()):
            await driver.reading(patience)
            yield driver


async def prepare_navigation() -> None:
    """Load the kernels of navigation before there is a robot that waits.

    Raises:
        ConfigError: The extra `nav` is missing.
    """
    require_navigation()
    from pioneer3.nav.warm_up import warm_up
    from pioneer3.runtime.navigator import compile_kernels

    await compile_kernels()
    warm_up()


def require_navigation() -> None:
    """Make sure that maps can be made and driven on.

    Raises:
        ConfigError: The extra `nav` is missing.
    """
    try:
        from pioneer3.nav import warm_up  # noqa: F401
        from pioneer3.runtime import navigator  # noqa: F401
    except ImportError as error:
        raise ConfigError(f"navigation on a map: {error}: {how_to_get('nav')}") from None


async def _navigator(
    robot: Robot, line_map: "LineMap | str | Path", start: Pose2 | str | None
) -> "Navigator":
    """Return the navigator of a robot that begins at `start`, or at home."""
    from pioneer3.maps import LineMap
    from pioneer3.nav.places import find_place, home
    from pioneer3.runtime.navigator import Navigator
    from pioneer3.runtime.simulator_map import OF_SIMULATOR, map_of_simulator
    from pioneer3.sim.worldfile import load_map

    if isinstance(line_map, LineMap):
        known = line_map
    else:
        known = await map_of_simulator(robot) if line_map == OF_SIMULATOR else load_map(line_map)
    if start == UNKNOWN_START:
        return await Navigator.on(robot, known)
    if not isinstance(start, str):
        return await Navigator.on(robot, known, start=start or home(known))
    place = find_place(known, start)
    here = Pose2(place.x, place.y, place.heading or 0.0)
    navigator = await Navigator.on(robot, known, start=here)
    if place.heading is None:
        navigator.place(here, turn_spread=ANY_HEADING)
    return navigator


def _laser(
    asked: "LaserSpec | str", supervisor: Supervisor | None, stack: ExitStack
) -> "LaserDriver":
    """Return the driver of a laser that looks from the robot of `supervisor`, if there is one."""
    from pioneer3.robot.lasers.driver import LaserDriver  # costs 20 ms that few need
    from pioneer3.robot.lasers.spec import parse_laser

    spec = parse_laser(asked) if isinstance(asked, str) else asked
    config = spec.config()
    if spec.record is not None:
        clock = asyncio.get_running_loop().time
        config = replace(
            config, open=stack.enter_context(recorded(config.open, spec.record, clock)).open
        )

    def mounting() -> "Mounting":
        info = supervisor.info if supervisor else None
        return spec.mounting_on(info.model if info else None)

    poses = supervisor.poses if supervisor else Poses()
    return LaserDriver(config, poses.at, mounting)


def _camera(url: str | None) -> "CameraDriver | None":
    """Return the driver of the camera at this URL, if there is one."""
    if url is None:
        return None
    from pioneer3.robot.camera_driver import CameraDriver  # imports ssl

    return CameraDriver(url)


async def _first_snapshot(supervisor: Supervisor) -> None:
    """Wait for the first snapshot; the end of the supervisor cancels this."""
    if await anext(supervisor.snapshots.values(), None) is None:
        await asyncio.get_running_loop().create_future()
