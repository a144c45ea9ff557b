"""Connecting to a robot, and every way of leaving it."""

import asyncio
from collections.abc import AsyncIterator, Coroutine, Iterator, Sequence
from contextlib import ExitStack, asynccontextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from pioneer3.arcos.host_events import Timing
from pioneer3.errors import ConfigError
from pioneer3.limits import Limits
from pioneer3.links import Opener, opener
from pioneer3.links.tap import tapped
from pioneer3.links.urls import split_url
from pioneer3.models import GivenModel, load_model
from pioneer3.models.own import wrong_in_own
from pioneer3.robot.poses import Poses
from pioneer3.robot.supervisor import Supervisor
from pioneer3.runtime.arbiter import Arbiter
from pioneer3.runtime.recording import Record, RobotLog, recorded
from pioneer3.runtime.robot import Robot
from pioneer3.runtime.signals import StopOnSignals
from pioneer3.tasks import running

if TYPE_CHECKING:
    from pioneer3.mjpeg import CameraUrl
    from pioneer3.models.model import OwnFile, RobotModel
    from pioneer3.robot.camera_driver import CameraDriver
    from pioneer3.robot.lasers.driver import LaserDriver
    from pioneer3.robot.lasers.mounting import Mounting
    from pioneer3.robot.lasers.spec import LaserSpec

USUAL = "p3at-sh"


@asynccontextmanager
async def connect_robot(
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
) -> AsyncIterator[Robot]:
    """Connect to a robot or simulator; stop it and close the session on every way out.

    Arguments and errors are those of :func:`pioneer3.connect_async`, which adds a map.
    """

    def restrict(limits: Limits) -> Limits:
        return limits.lowered_to(max_speed, max_turn_rate)

    if record is None and isinstance(url, str) and split_url(url)[0] == "replay":
        record = False
    open_ = url if callable(url) else opener(url, baud=baud)
    twin = None
    if shadow:
        from pioneer3.runtime.shadow import Shadow  # the simulator loads slowly

        twin = Shadow(asyncio.get_running_loop().time)
        open_ = tapped(open_, twin)
    with ExitStack() as stack:
        robot_log = stack.enter_context(recorded(record, asyncio.get_running_loop().time))
        if robot_log is not None:
            open_ = robot_log.opener(open_)
        supervisor = Supervisor(
            open_, model=model, restrict=restrict, auto_enable=auto_enable, timing=timing
        )
        arbiter = Arbiter(supervisor, robot_log)
        ports = [url] if isinstance(url, str) else []
        drivers = [_laser(spec, supervisor, robot_log) for spec in _specs(lasers, ports)]
        eyes = _cameras(camera)
        load_model(USUAL)  # the reader of models loads slowly, and a robot that waits is lost
        stack.enter_context(StopOnSignals(asyncio.get_running_loop(), arbiter.stop))
        notes = [] if robot_log is None else [robot_log.follow(supervisor)]
        if twin is not None:
            notes.append(twin.follow(supervisor, partial(_part, robot_log)))
        async with running(supervisor.run(), *notes, *_runs(drivers, eyes, robot_log)):
            if await anext(supervisor.snapshots.values(), None) is None:
                await asyncio.get_running_loop().create_future()  # its end cancels this
            own = supervisor.info.own if supervisor.info else None
            own_drivers, own_eyes = [], []
            if own is not None and not any(split_url(port)[0] == "replay" for port in ports):
                others = () if lasers else own.lasers
                unseen = own.camera if camera is None else None
                specs, eye = fitted_by(replace(own, lasers=others, camera=unseen), ports)
                own_drivers = [_laser(spec, supervisor, robot_log) for spec in specs]
                own_eyes = _cameras(eye)
            async with running(*_runs(own_drivers, own_eyes, robot_log)):
                robot = Robot(
                    supervisor, arbiter, drivers + own_drivers, next(iter(eyes + own_eyes), None)
                )
                robot.shadow = twin
                with robot.started:
                    yield robot


def _part(robot_log: RobotLog | None, words: str) -> None:
    """Log that a robot parts from its twin."""
    if robot_log is not None:
        robot_log.event("shadow", words)


@asynccontextmanager
async def connect_laser_async(
    url: "str | LaserSpec", *, record: Path | bool = False, patience: float = 10.0
) -> "AsyncIterator[LaserDriver]":
    """Connect to a laser range finder alone, and wait for its first scan.

    It is connected again after every loss.

    Args:
        url: `/dev/ttyACM0`, `tcp://192.168.0.10:10940`, or with a model, `lms-200@/dev/ttyUSB1`.
        record: New file for all that comes from it, which `replay:FILE` plays; if true, one in
            the folder of logs.
        patience: Longest wait for the first scan [s].

    Raises:
        DeviceError: no scan came; the message has the reason.
        ConfigError: the URL is wrong.
    """
    from pioneer3.robot.lasers.spec import parse_laser

    spec = parse_laser(url) if isinstance(url, str) else url
    with recorded(record, asyncio.get_running_loop().time) as log:
        driver = _laser(spec, None, log)
        async with running(driver.run()):
            await driver.reading(patience)
            yield driver


def fitted_by(
    own: "OwnFile", ports: Sequence[str] = ()
) -> "tuple[tuple[LaserSpec, ...], CameraUrl | None]":
    """Return the lasers and the camera that the own file of the robot at `ports` gives it.

    Raises:
        ConfigError: One of them is wrong; names file and line.
    """
    if not own.lasers and own.camera is None:
        return (), None
    from pioneer3.mjpeg import parse_url
    from pioneer3.robot.lasers.spec import own_lasers

    lasers = own_lasers(own, ports)
    try:
        return lasers, parse_url(own.camera) if own.camera is not None else None
    except ConfigError as error:
        raise wrong_in_own(own, "camera", error) from None


def _laser(
    spec: "LaserSpec", supervisor: Supervisor | None, robot_log: RobotLog | None
) -> "LaserDriver":
    """Return the driver of a laser that looks from the robot of `supervisor`, if there is one."""
    from pioneer3.robot.lasers.driver import LaserDriver  # costs 20 ms that few need

    config = spec.config()
    if robot_log is not None:
        config = replace(config, open=robot_log.opener(config.open, spec.name))

    at: tuple[RobotModel | None, Mounting] = None, spec.mounting_on(None)

    def mounting() -> "Mounting":
        nonlocal at
        info = supervisor.info if supervisor else None
        model = info.model if info else None
        if at[0] is not model:  # scans come 40 times a second
            at = model, spec.mounting_on(model)
            if robot_log is not None:
                robot_log.describe_laser(driver)
        return at[1]

    poses = supervisor.poses if supervisor else Poses()
    driver = LaserDriver(config, poses.at, mounting)
    if robot_log is not None:
        driver.scan_taken = robot_log.scan
    return driver


def _runs(
    drivers: "Sequence[LaserDriver]", eyes: "Sequence[CameraDriver]", robot_log: RobotLog | None
) -> Iterator[Coroutine[None, None, None]]:
    """Yield the work of drivers."""
    yield from (driver.run() for driver in drivers)
    yield from (eye.run() for eye in eyes)
    if robot_log is not None:
        yield from (robot_log.follow_laser(driver) for driver in drivers)


def _specs(asked: "Sequence[LaserSpec | str]", ports: Sequence[str]) -> "tuple[LaserSpec, ...]":
    """Return the lasers that are asked for beside the robot at `ports`."""
    if not asked:
        return ()
    from pioneer3.robot.lasers.spec import parse_laser, refuse_robots

    specs = tuple(parse_laser(each) if isinstance(each, str) else each for each in asked)
    refuse_robots(specs, ports)
    return specs


def _cameras(url: "str | CameraUrl | None") -> "list[CameraDriver]":
    """Return the driver of the camera at this URL, if there is one."""
    if url is None:
        return []
    from pioneer3.robot.camera_driver import CameraDriver  # imports ssl

    return [CameraDriver(url)]
