"""`pioneer3 map build`: make a map while somebody drives, or while the robot explores."""

import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import AbstractAsyncContextManager, contextmanager, suppress
from dataclasses import dataclass
from datetime import datetime
from functools import partial
from math import inf, radians
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from pioneer3.cli.live import announce, how_to_stop, line, rewrite, show_while, tell_cuts
from pioneer3.cli.options import (
    LINK,
    NAVIGATION,
    Flag,
    LinkOptions,
    MaxSpeed,
    NavigationOptions,
    Speed,
)
from pioneer3.cli.process import ask, busy_sign, run_until_told_to_leave, write_line, write_warning
from pioneer3.errors import ConfigError, DeviceError
from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.nav.place_text import pose_of
from pioneer3.runtime.signals import LEAVE

if TYPE_CHECKING:
    from pioneer3.maps import LineMap
    from pioneer3.maps.line_map import MapObject
    from pioneer3.nav.exploring import GivenUp
    from pioneer3.nav.mapper import Mapper
    from pioneer3.nav.settings import NavigationSettings
    from pioneer3.navigation.map_builder import MapBuilder
    from pioneer3.navigation.map_logs import LogMap
    from pioneer3.navigation.map_update import ContinuedMap
    from pioneer3.runtime.driven import Driven
    from pioneer3.runtime.robot import Robot

    Connect = Callable[[], AbstractAsyncContextManager[Robot]]

SPEED = 0.4
"""Speed of the keys [m/s]."""
TURN_RATE = radians(30)
"""Turn rate of the keys [rad/s]."""
KEEP_EVERY = 30.0
"""The survey is saved so often while it grows [s]."""
ROOM = 0.3
"""A robot of a log had so much free ground around it [m]."""
KEYS = "arrows: drive   + -: speed   space: stop   k: emergency stop   q: save the map and quit"


def build(
    *,
    link: LinkOptions = LINK,
    output: Annotated[Path | None, Parameter(name=["--output", "-o"], metavar="FILE")] = None,
    explore: Flag = False,
    continue_: Annotated[Path | None, Parameter(name="--continue", metavar="FILE")] = None,
    from_: Annotated[Path | None, Parameter(name="--from", metavar="FILE")] = None,
    scans: Annotated[str | None, Parameter(metavar="NAME")] = None,
    odometry: Annotated[str | None, Parameter(metavar="NAME")] = None,
    repair_odometry: Flag = False,
    start: Annotated[str | None, Parameter(metavar="PLACE", allow_leading_hyphen=True)] = None,
    speed: Speed = SPEED,
    max_speed: MaxSpeed | None = None,
    force: Flag = False,
    yes: Flag = False,
    navigation: NavigationOptions = NAVIGATION,
) -> int:
    """Make a map with the laser while you drive by the keys, or the robot explores.

    It is saved at the end, whatever ends it: for ARIA (.map), ROS (.yaml with a
    picture), or as a world (.toml). With the .survey.npz beside it, --continue
    goes on with it another day.

    With --explore the robot MOVES by itself until the map has no open edges: stand
    by its stop button. Any key stops it, k is the emergency stop.

    Example: pioneer3 map build -o lab.map
    Example: pioneer3 map build -o lab.map --explore --port /dev/ttyUSB0
    Example: pioneer3 map build -o lab.map --from lab.2d
    Example: pioneer3 map build -o lab.map --from lab.bag

    Args:
        output: The new map: .map, .yaml or .toml. Without it a .map named after the time.
        explore: The robot drives by itself to where the map ends.
        continue_: Go on with this map, and save there unless -o says otherwise.
        from_: Make it without a robot: of a scan log of ARIA (.2d), a rosbag of ROS 1 or 2, MCAP,
            a log of CARMEN, or what --record has written; --laser-pose tells where its laser is.
        scans: Of this laser in a log that has several: a topic, ROBOTLASER2, scan2.
        odometry: By this of a log that has several: a topic, tf, robotGlobal.
        repair_odometry: Trust the scans of a log where its odometry contradicts them.
        start: Where the robot is on the map that is continued: a name, or x,y,heading; without
            it at the map's home, or else it is looked for while you drive.
        speed: Of the forward key, or at most.
        force: Write over files that are there.
        yes: Ask nothing before a map that is continued is replaced.
    """
    from pioneer3.navigation.connect import require_navigation

    if from_ is not None:
        target = _target(output, continue_, force=force)
        settings, sources = navigation.settings(link), (scans, odometry)
        return _from_file(from_, target, link, settings, sources, repair=repair_odometry)
    require_navigation()
    target = _target(output, continue_, force=force)
    if scans is not None or odometry is not None or repair_odometry:
        raise ConfigError("--scans, --odometry and --repair-odometry are of logs: only with --from")
    begin = _Begin.of(continue_, start)
    asks = not yes and sys.stdin is not None and sys.stdin.isatty()
    keeper = _Keeper(target, begin.update, asks=asks)
    connect = partial(link.connect, max_speed=max_speed, navigation=navigation)
    with keeper.saved_at_the_end():
        return run_until_told_to_leave(
            _explore(keeper, begin, connect, speed)
            if explore
            else _drive(keeper, begin, connect, speed)
        )


@dataclass(frozen=True, slots=True)
class _Begin:
    """A beginning: the map that is continued, and where the robot is on it, if that is told."""

    update: "ContinuedMap | None" = None
    start: "Pose2 | None" = None

    @classmethod
    def of(cls, old: Path | None, start: str | None) -> "_Begin":
        from pioneer3.nav.places import find_place
        from pioneer3.navigation.map_update import ContinuedMap

        if old is None:
            if start is not None:
                raise ConfigError(
                    "--start: a new map begins where the robot is; only with --continue"
                )
            return cls()
        update = ContinuedMap(old)
        told = pose_of(start, "map build") if start is not None else None
        if isinstance(told, str):
            place = find_place(update.line_map, told)
            told = Pose2(place.x, place.y, place.heading or 0.0)
        return cls(update, told)

    @property
    def objects(self) -> "tuple[MapObject, ...]":
        """The places of the map: those of the old one, or a home where the robot begins."""
        from pioneer3.maps import MapObject

        if self.update is not None:
            return tuple(self.update.objects)
        return (MapObject(kind="RobotHome", name="Home", pose=ORIGIN),)

    async def builder(self, robot: "Robot", patience: float) -> "MapBuilder":
        """Return the builder, once the robot is found on the map that is continued.

        Raises:
            MotionError: It was not found within `patience` [s].
        """
        from pioneer3.navigation.map_builder import MapBuilder, whereabouts

        mapper = None
        if self.update is not None:
            here = self.start or await whereabouts(robot, self.update.line_map, patience)
            mapper = self.update.mapper(here, robot.settings.mapper)
        return MapBuilder(robot, mapper, objects=self.objects)


class _Keeper:
    """Saves a map on every way out; `builder` is `None` before the robot is connected and found.

    Before a map that is continued is replaced, somebody at the terminal is asked, if it `asks`.
    """

    def __init__(self, target: Path, update: "ContinuedMap | None", *, asks: bool) -> None:
        self.builder: MapBuilder | None = None
        self._target, self._told, self._update = target, set[str](), update
        self._replaces = update if update is not None and update.path == target else None
        self._asks = asks

    async def keep(self) -> None:
        """Save the survey now and then: a computer may lose its power."""
        import asyncio

        from pioneer3.navigation.map_files import save_survey

        while True:
            await asyncio.sleep(KEEP_EVERY)
            if self.builder is None or not self.builder.mapper.survey.frames:
                continue
            if self._replaces is not None:
                await asyncio.to_thread(self._replaces.keep, self.builder.mapper)
            else:
                await asyncio.to_thread(save_survey, self.builder.mapper, self._target)

    @contextmanager
    def saved_at_the_end(self) -> Iterator[None]:
        """Save the map at the end of the block, whatever ends it."""
        try:
            yield
        finally:
            if self.builder is not None:
                self._save(self.builder)

    def _save(self, builder: "MapBuilder") -> None:
        if not builder.mapper.survey.frames:
            write_warning("no scan has come: there is no map to save")
            return
        with suppress(OSError):  # the terminal may be gone
            write_line(f"saving {self._target} ...")
        with _deaf():
            line_map = builder.finished()
            if self._replaces is None:
                if _save(line_map, builder.mapper, self._target) and self._update is not None:
                    _tell_changes(self._update, line_map)
                return
            beside = self._replaces.write(line_map, builder.mapper) if self._asks else None
        _tell_changes(self._replaces, line_map)
        answer = self._asked() if beside else "yes"
        with _deaf():
            if answer.startswith("y"):
                _, before = self._replaces.replace(line_map, builder.mapper)
                _tell_saved(line_map, builder.mapper, self._target)
                write_line(f"the map as it was before is {before}")
                return
            if answer.startswith("n"):
                self._replaces.discard()
                beside = None
        write_line(f"{self._target} stays as it is{f'; the new map is {beside}' if beside else ''}")

    def _asked(self) -> str:
        """Return the answer of somebody at the terminal, or nothing if none comes."""
        with suppress(KeyboardInterrupt, OSError):
            return ask(f"Replace {self._target}? yes or no", "")
        return ""

    def words(self) -> str:
        """Return how far the map is, in a few words."""
        state = self.builder.state.latest if self.builder else None
        if state is None:
            return "looks for itself on the map: drive a metre  "
        for remark in state.remarks:
            if remark not in self._told:
                self._told.add(remark)
                rewrite("")
                write_warning(remark)
        edges = f", {state.edges} edges" if state.exploring and state.edges is not None else ""
        return f"{state.driven:.0f} m, {state.area:.0f} m², {state.loops} loops{edges}  "


async def _drive(keeper: _Keeper, begin: _Begin, connect: "Connect", speed: float) -> None:
    from pioneer3.navigation.connect import prepare_navigation
    from pioneer3.tasks import running
    from pioneer3.teleop.keyboard import Manner
    from pioneer3.teleop.keyboard_drive import KeyboardDriver
    from pioneer3.teleop.terminal import keys, raw_terminal

    await prepare_navigation()
    with raw_terminal() as terminal:
        async with connect() as robot:
            _require_laser(robot)
            limits = robot.info.limits
            tell_cuts(limits, speed, None)
            keyboard = Manner(speed=speed, turn_rate=TURN_RATE).keyboard(limits)
            announce(robot, "makes a map while you drive")
            write_line(KEYS)

            async def making() -> None:
                keeper.builder = await begin.builder(robot, inf)
                await keeper.builder.run()

            driver = KeyboardDriver(robot, keyboard, lambda text: rewrite(keeper.words() + text))
            async with running(making(), keeper.keep()):
                await driver.run(keys(terminal))
    write_line("")


async def _explore(keeper: _Keeper, begin: _Begin, connect: "Connect", speed: float) -> None:
    from pioneer3.navigation.connect import prepare_navigation
    from pioneer3.tasks import running

    await prepare_navigation()
    async with connect() as robot:
        _require_laser(robot)
        tell_cuts(robot.info.limits, speed, None)
        announce(robot, f"explores; {how_to_stop()}")
        builder = keeper.builder = await begin.builder(robot, 0.0)
        found: list[GivenUp] = []

        async def exploring() -> None:
            found.extend(await builder.explore(speed))

        def words(robot: "Driven") -> str:
            return keeper.words() + line(robot)

        async with running(builder.run(), keeper.keep()):
            await show_while(robot, exploring(), words=words)
    for each in found:
        x, y = each.frontier.points.mean(axis=0).tolist()
        write_line(f"not explored: ({x:.1f}, {y:.1f}): {each.why}")


def _require_laser(robot: "Robot") -> None:
    if not robot.laser.presence.there:
        raise DeviceError(f"a map needs a laser: {robot.laser.presence}")


def _from_file(
    source: Path,
    target: Path,
    link: LinkOptions,
    settings: "NavigationSettings",
    sources: tuple[str | None, str | None],
    *,
    repair: bool,
) -> int:
    from pioneer3.navigation.connect import require_navigation
    from pioneer3.navigation.log_files import SourceChoice, chosen_log, is_recording
    from pioneer3.robot.lasers.spec import parse_mounting

    choice = SourceChoice(*sources, *map(parse_mounting, link.lasers.laser_pose[:1]))
    made: list[LogMap] = []
    with busy_sign(f"reading {source}") as tell:

        def progress(share: float) -> None:
            tell(f"making a map of {source}: {100 * share:.0f} %")

        if is_recording(source):
            if any(sources):
                raise ConfigError("--scans, --odometry: not of a recording; --laser names others")
            code = _play(source, progress, link, settings, made, repair=repair)
            if code:
                return code
        else:
            # what is no log is refused before navigation is imported, which takes seconds
            with chosen_log(source, choice) as log:
                require_navigation()
                from pioneer3.navigation.map_logs import map_log

                made.append(map_log(log, progress, settings, repair=repair))
        (log_map,) = made
        tell("drawing the map")
        from pioneer3.nav.changes import drawn

        mapper, objects = log_map.mapper, (*_Begin().objects, *log_map.places)
        line_map = drawn(mapper.survey, ROOM, settings.mapper.cell, objects=objects)
    write_line(f"{source} is {log_map.source}")
    for note in log_map.notes:
        write_warning(note)
    return 0 if _save(line_map, mapper, target) else 1


def _play(
    source: Path,
    progress: "Callable[[float], None]",
    link: LinkOptions,
    settings: "NavigationSettings",
    made: "list[LogMap]",
    *,
    repair: bool,
) -> int:
    """Add the map of a recording to `made`; return the exit code."""
    from pioneer3.navigation.connect import prepare_navigation, require_navigation

    require_navigation()
    from pioneer3.navigation.map_logs import map_recording
    from pioneer3.tasks import FastTimeLoop

    async def play() -> None:
        await prepare_navigation()
        lasers = link.lasers.laser
        made.append(await map_recording(source, progress, lasers, settings, repair=repair))

    return run_until_told_to_leave(play(), FastTimeLoop)


def _save(line_map: "LineMap", mapper: "Mapper", target: Path) -> bool:
    """Write a map and its survey, if it has a wall; say which files, and what is in them."""
    from pioneer3.navigation.map_files import save_map, save_survey

    if not len(line_map.walls):
        write_warning(
            f"{target} is not written: it would be empty; a wall is drawn once "
            "the laser has seen it from two places: drive a metre"
        )
        return False
    save_survey(mapper, target)
    save_map(line_map, target)
    _tell_saved(line_map, mapper, target)
    return True


def _tell_saved(line_map: "LineMap", mapper: "Mapper", target: Path) -> None:
    from pioneer3.navigation.map_files import files_of

    bounds, survey = line_map.bounds, mapper.survey
    size = f"{bounds.x_max - bounds.x_min:.1f} x {bounds.y_max - bounds.y_min:.1f} m"
    loops = sum(edge.loop for edge in survey.edges)
    for remark in mapper.remarks():
        write_warning(remark)
    write_line(f"{size}, of {survey.frames[-1].way:.0f} m driven, {loops} loops closed")
    for path in files_of(target):
        write_line(f"wrote {path}")


def _tell_changes(update: "ContinuedMap", line_map: "LineMap") -> None:
    from pioneer3.nav.changes import in_words

    for change in in_words(update.changes(line_map)):
        write_line(change)


def _target(output: Path | None, old: Path | None, *, force: bool) -> Path:
    """Return the name of the new map."""
    from pioneer3.navigation.map_files import files_of

    now = datetime.now().astimezone()
    target = output or old or Path(f"map-{now:%Y-%m-%d-%H%M%S}.map")
    files = files_of(target)
    if not target.parent.is_dir():
        raise ConfigError(f"{target}: there is no folder {target.parent}")
    for path in files:
        if path.exists() and not (force or target == old):
            raise ConfigError(
                f"{path}: is there already; --continue goes on with it, --force writes over it"
            )
    return target


@contextmanager
def _deaf() -> Iterator[None]:
    """Ignore signals that would end the program: a map is being saved."""
    before = {number: signal.signal(number, signal.SIG_IGN) for number in LEAVE}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
