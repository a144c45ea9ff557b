"""Makes maps of logs and recordings."""

import asyncio
import gzip
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from io import TextIOWrapper
from pathlib import Path
from typing import Any, BinaryIO, cast

from pioneer3.errors import ConfigError, DeviceError
from pioneer3.links.tap import read_recording
from pioneer3.nav.beams import beams_of
from pioneer3.nav.carmen import LoggedOdometry, read_carmen
from pioneer3.nav.mapper import Mapper
from pioneer3.nav.settings import AS_SHIPPED, NavigationSettings
from pioneer3.navigation.map_builder import MapBuilder
from pioneer3.runtime.connect import connect_robot
from pioneer3.tasks import running
from pioneer3.text import wrong

Tell = Callable[[float], None]
"""Called with the share that is done, 0 to 1."""

IMPROVE = 10
"""Loops are looked for after so many scans."""
GZIP = b"\x1f\x8b"
RECORDING = "# pioneer3"
SILENCE = 5.0
"""A recording is over if no reading comes for so long [s]."""


def is_recording(path: Path) -> bool:
    """Whether a file is a recording of this program; else it may be a log of CARMEN.

    Raises:
        ConfigError: It cannot be read.
    """
    with _opened(path) as (lines, _):
        return next(iter(lines), "").startswith(RECORDING)


def map_log(path: Path, tell: Tell, settings: NavigationSettings = AS_SHIPPED) -> Mapper:
    """Return the map of a log of CARMEN, which may be compressed by gzip.

    Raises:
        ConfigError: The file cannot be read, or has no scans.
    """
    mapper, scans = Mapper(settings=settings.mapper), 0
    size = max(1, path.stat().st_size) if path.exists() else 1
    with _opened(path) as (lines, raw):
        for entry in read_carmen(lines):
            if isinstance(entry, LoggedOdometry):
                mapper.move(entry.robot_in_odom)
                continue
            mapper.add(beams_of(entry.scan))
            scans += 1
            if scans % IMPROVE == 0:
                mapper.apply(mapper.snapshot.improve())
                tell(raw.tell() / size)
    if not scans:
        raise wrong(path, " has no scans: it must be a log of CARMEN, or what --record wrote")
    mapper.apply(mapper.snapshot.improve())
    return mapper


async def map_recording(
    path: Path,
    tell: Tell,
    lasers: Sequence[str] = (),
    settings: NavigationSettings = AS_SHIPPED,
) -> Mapper:
    """Return the map of a recording; for a :class:`.FastTimeLoop`.

    Args:
        path: Of the robot's bytes; those of its laser lie beside it, unless they are in the same.
        tell: Called with the progress.
        lasers: Other recordings of lasers, as `replay:FILE`.
        settings: Of the mapper.

    Raises:
        ConfigError: The file is no recording.
        DeviceError: There are no scans in it.
    """
    chunks = [chunk.time for chunk in read_recording(path)]
    length = max(chunks, default=0.0) or 1.0
    beside = path.with_stem(f"{path.stem}-laser")
    found = lasers or ([f"replay:{beside}"] if beside.exists() else [])

    async def at_once(function: Callable[..., Any], *arguments: Any) -> Any:
        return function(*arguments)

    clock = asyncio.get_running_loop().time
    async with connect_robot(f"replay:{path}", lasers=found) as robot:
        robot.settings = settings
        builder = MapBuilder(robot, in_thread=at_once)

        async def watch() -> None:
            while True:
                tell(min(1.0, clock() / length))
                await asyncio.sleep(1.0)

        async with running(watch()):
            await builder.run()
    if not builder.mapper.survey.frames:
        raise DeviceError(
            f"{path}: no scans of a laser are in this recording; `pioneer3 map build --record` asks"
            " a simulator for them"
        )
    builder.mapper.apply(builder.mapper.snapshot.improve())
    return builder.mapper


@contextmanager
def _opened(path: Path) -> Iterator[tuple[TextIOWrapper, BinaryIO]]:
    """Open a text, compressed or not; yield its lines, and the file whose place shows progress."""
    try:
        with path.open("rb") as raw:
            packed = raw.read(len(GZIP)) == GZIP
            raw.seek(0)
            plain = cast("BinaryIO", gzip.GzipFile(fileobj=raw)) if packed else raw
            with TextIOWrapper(plain, encoding="utf-8", errors="replace") as lines:
                yield lines, raw
    except OSError as error:
        raise ConfigError(f"{path}: cannot be read: {error.strerror or error}") from None
