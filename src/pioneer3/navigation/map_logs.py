"""Makes maps of logs and recordings."""

import asyncio
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from math import hypot
from pathlib import Path
from typing import Any

from pioneer3.errors import DeviceError
from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.links.tap import read_recording, recorded_links
from pioneer3.maps import MapObject
from pioneer3.nav.beams import beams_of
from pioneer3.nav.contradictions import contradiction_of
from pioneer3.nav.logged import Entry, LoggedOdometry, LoggedPlace
from pioneer3.nav.mapper import Mapper
from pioneer3.nav.settings import AS_SHIPPED, NavigationSettings
from pioneer3.navigation.log_files import ChosenLog
from pioneer3.navigation.map_builder import MapBuilder
from pioneer3.runtime.connect import connect_robot
from pioneer3.tasks import running
from pioneer3.text import wrong

Tell = Callable[[float], None]
"""Called with the share that is done, 0 to 1."""

IMPROVE = 10
"""Loops are looked for after so many scans."""
LASER = "laser"
"""Name of the link of the first laser in a recording."""
LEAP = 5.0
"""Way between two readings of odometry above which it has begun anew, or is damaged [m]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LogMap:
    """The map that was made of a log, the places marked in it, its format, and warnings."""

    mapper: Mapper
    places: tuple[MapObject, ...]
    source: str
    notes: tuple[str, ...]


def map_log(
    log: ChosenLog,
    tell: Tell,
    settings: NavigationSettings = AS_SHIPPED,
    *,
    repair: bool = False,
) -> LogMap:
    """Return the map of a log: of CARMEN, of ARIA, or a rosbag.

    With `repair`, scans tell where odometry is wrong.

    Raises:
        ConfigError: It is damaged, or no scan is in it.
    """
    mapping = _Mapping(Mapper(settings=settings.mapper, repair=repair))
    for entry in log.entries():
        mapping.take(entry)
        if mapping.scans and mapping.scans % IMPROVE == 0:
            mapping.improve()
            tell(log.share)
    if not mapping.scans:
        notes = "".join(f"; {note}" for note in log.notes)
        raise wrong(log.path, f": no scan can be read in {log.source}{notes}")
    mapping.improve()
    askew = set(mapping.mapper.remarks(mapping.laser)) - set(mapping.mapper.remarks())
    return LogMap(
        mapper=mapping.mapper,
        places=mapping.places,
        source=log.source,
        notes=(*log.notes, *askew, *_contradictions(mapping.mapper, settings, repair=repair)),
    )


def _contradictions(mapper: Mapper, settings: NavigationSettings, *, repair: bool) -> Iterator[str]:
    """Yield a sentence about odometry that contradicts the scans, if it does."""
    found = contradiction_of(mapper.survey, settings.mapper)
    cure = "the scans were trusted" if repair else "--repair-odometry trusts the scans instead"
    if found is not None:
        yield f"{found}; {cure}"


class _Mapping:
    """Feeds the readings of a log to a mapper.

    Odometry that leaps has begun anew, if the next reading is near; else one reading is damaged.
    """

    def __init__(self, mapper: Mapper) -> None:
        self.mapper = mapper
        self.scans = 0
        self.laser: Pose2 | None = None
        self._places: list[tuple[int, Pose2, LoggedPlace]] = []
        self._begin = ORIGIN
        self._last: Pose2 | None = None
        self._leapt: Pose2 | None = None

    @property
    def places(self) -> tuple[MapObject, ...]:
        """The places that were marked, where they are on the map now."""
        poses = self.mapper.survey.poses
        return tuple(
            MapObject(kind=each.kind, name=each.name, pose=poses[frame] @ place)
            for frame, place, each in self._places
        )

    def improve(self) -> None:
        """Look for loops."""
        self.mapper.improve()

    def take(self, entry: Entry) -> None:
        """Take a reading."""
        if isinstance(entry, LoggedPlace):
            poses = self.mapper.survey.poses
            here = poses[-1].inverse() @ self.mapper.robot_in_map if poses else ORIGIN
            self._places.append((max(0, len(poses) - 1), here, entry))
        elif isinstance(entry, LoggedOdometry):
            if self._follows(entry.robot_in_odom):
                self.mapper.move(self._begin @ entry.robot_in_odom)
        elif self._follows(entry.scan.robot_in_odom):
            scan, last = entry.scan, entry.scan.last_in_odom
            here = self._begin @ scan.robot_in_odom
            last = self._begin @ last if last and _way(scan.robot_in_odom, last) < LEAP else None
            self.mapper.add(beams_of(replace(scan, robot_in_odom=here, last_in_odom=last)))
            self.scans, self.laser = self.scans + 1, scan.sensor_in_robot

    def _follows(self, pose: Pose2) -> bool:
        """Whether a pose follows the last one; note where odometry begins anew."""
        if self._last is not None and _way(self._last, pose) > LEAP:
            if self._leapt is None or _way(self._leapt, pose) > LEAP:
                self._leapt = pose
                return False
            self._begin = self._begin @ self._last @ pose.inverse()
        self._last, self._leapt = pose, None
        return True


def _way(first: Pose2, second: Pose2) -> float:
    return hypot(second.x - first.x, second.y - first.y)


async def map_recording(
    path: Path,
    tell: Tell,
    lasers: Sequence[str] = (),
    settings: NavigationSettings = AS_SHIPPED,
    *,
    repair: bool = False,
) -> LogMap:
    """Return the map of a recording of the robot's bytes.

    It is for a :class:`~pioneer3.tasks.FastTimeLoop`. Those of its laser lie beside it, unless they
    are in the same file, or in other recordings: the `lasers`, as `replay:FILE`.

    Raises:
        ConfigError: The file is no recording.
        DeviceError: There are no scans in it.
    """
    length = max((chunk.time for chunk in read_recording(path)), default=0.0) or 1.0
    beside = path.with_stem(f"{path.stem}-laser")
    own = [f"replay:{path}#{LASER}"] if LASER in recorded_links(path) else []
    found = lasers or ([f"replay:{beside}"] if beside.exists() else own)

    async def at_once(function: Callable[..., Any], *arguments: Any) -> Any:
        return function(*arguments)

    clock = asyncio.get_running_loop().time
    async with connect_robot(f"replay:{path}", lasers=found) as robot:
        robot.settings = settings
        mapper = Mapper(settings=settings.mapper, repair=repair)
        builder = MapBuilder(robot, mapper, in_thread=at_once)

        async def watch() -> None:
            while True:
                tell(min(1.0, clock() / length))
                await asyncio.sleep(1.0)

        async with running(watch()):
            await builder.run()
    if not mapper.survey.frames:
        raise DeviceError(
            f"{path}: no scans of a laser are in this recording; `pioneer3 map build --record` asks"
            " a simulator for them"
        )
    mapper.improve()
    notes = tuple(_contradictions(mapper, settings, repair=repair))
    return LogMap(mapper=mapper, places=(), source="a recording", notes=notes)
