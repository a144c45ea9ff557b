"""Opens logs of scans, whatever their names are, and names files that are none."""

import bz2
import gzip
import lzma
import os
import re
import zlib
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from io import BufferedIOBase, TextIOWrapper
from itertools import chain, islice
from pathlib import Path
from typing import BinaryIO, Protocol, cast

from pioneer3.errors import ConfigError
from pioneer3.nav.carmen import WORDS, carmen_sources, read_carmen
from pioneer3.nav.logged import Entry, LoggedDamage, LoggedScan, Sources
from pioneer3.nav.scan_log import FIRST_LINE, read_scan_log, scan_log_sources
from pioneer3.navigation.bag_frames import mounted
from pioneer3.navigation.bag_logs import FOLDER, MCAP, ROS_1, SQLITE, Bag, BagFormat
from pioneer3.robot.lasers.mounting import Mounting
from pioneer3.text import one_line, shown, wrong

RECORDING = rb"# pioneer3|\x89MCAP0\r\n\x01.{8}\x08\0{3}pioneer3"
"""Begins of our own recordings, older ones first."""
READ = (
    "read are logs of CARMEN, scan logs of ARIA (.2d), rosbags of ROS 1 and 2, MCAP files, and "
    "what --record wrote"
)
"""End of the errors about other files."""
HEAD = 2048
"""Bytes by which a file is known."""
LOOKED_AT = 20_000
"""Lines by which a text is known, and what is in it."""
LONGEST_LINE = 1 << 20
"""A longer line is no log's [characters]."""
METADATA = "metadata.yaml"
"""File in the folder of a rosbag of ROS 2."""
PACKED: dict[bytes, Callable[[BinaryIO], BufferedIOBase]] = {
    b"\x1f\x8b": lambda raw: gzip.GzipFile(fileobj=raw),
    b"BZh": bz2.BZ2File,
    b"\xfd7zXZ\0": lzma.LZMAFile,
}
"""First bytes of packed files, and how they are unpacked."""
BAGS = {
    rb"#ROSBAG V2\.0": ROS_1,
    rb"\x89MCAP0\r\n\x01.{8}\x04\x00{3}ros2": MCAP,
    rb"SQLite format 3\0": SQLITE,
}
"""Begins of rosbags."""
OTHERS: tuple[tuple[bytes, str], ...] = (
    (rb"#ROS(BAG|RECORD) V", "a rosbag of a format before 2.0: `rosbag fix` makes a newer one"),
    (rb"\x89MCAP", "an MCAP file that is not of ROS 2"),
    (rb"\x28\xb5\x2f\xfd", "packed by zstd: unpack it, or name the folder with its metadata.yaml"),
    (rb"(PK\x03\x04|7z\xbc\xaf|Rar!|.{257}ustar)", "an archive: unpack it first"),
    (rb"version https://git-lfs", "a pointer of Git LFS, not the file: run `git lfs pull`"),
    (
        rb"(\x89PNG|\xff\xd8\xff|GIF8|BM.{4}\0\0\0\0|II\*\0|MM\0\*|P[1-6]\s|RIFF.{4}WEBP)",
        "a picture",
    ),
    (rb"(RIFF|\x1aE\xdf\xa3|.{4}ftyp)", "a film or sound"),
    (rb"%PDF", "a document (PDF)"),
    (rb"(\x7fELF|MZ)", "a program"),
    (
        rb"(\xd4\xc3\xb2\xa1|\xa1\xb2[\xc3\x3c]|\x0a\x0d\x0d\x0a|\x4d\x3c\xb2\xa1)",
        "a network capture",
    ),
    (rb"(\x93NUMPY|\x89HDF)", "arrays of another program"),
    (rb"(# \.PCD|ply\r?\n|LASF)", "a point cloud"),
    (rb"2D-Map", "a map of ARIA already"),
    (rb"(?i)\s*<(!doctype )?html", "a web page: the file was not what was downloaded"),
    (rb"\s*<(\?xml|sdf|launch|robot|world)", "XML, such as a world or a launch file"),
    (rb"## Player version", "a log of Player"),
    (rb"rosbag2_bagfile_information:", "the list of a rosbag: name its folder"),
    (rb".{0,1500}\bimage:\s*\S+\.(pgm|png|bmp|jpg)", "the YAML of a map with its picture"),
    (rb".{0,1500}\b(floorplan|position)\b[^\n]*\n?\s*\(", "a world of Stage"),
    (rb".{0,4000}\bC(Action|Observation|SensoryFrame)", "a rawlog of MRPT"),
    (rb"\s*[\[{]\s*[\"{\[]", "JSON"),
)
"""Begins of other files, and their names for people."""


class Log(Protocol):
    """A log that is open: the name of its format, and warnings, once its entries are read."""

    name: str
    notes: list[str]

    @property
    def share(self) -> float:
        """Part that is read, 0 to 1."""

    @property
    def sources(self) -> Sources:
        """The sources that may be chosen."""

    def entries(self, laser: str, odometry: str) -> Iterator[Entry]:
        """Yield the readings of a laser and of odometry, in their order."""


@dataclass(frozen=True, slots=True)
class SourceChoice:
    """The names of the laser and odometry that are read of a log that has several.

    `None` stands for the one that is taken first, and for the mounting that the log tells.
    """

    laser: str | None = None
    odometry: str | None = None
    mounting: Mounting | None = None


FIRST = SourceChoice()
"""The first laser and odometry of a log."""


class ChosenLog:
    """A log that is open, and the laser and odometry that are read of it.

    `source` tells people its format, and what is read of it.
    """

    def __init__(self, path: Path, log: Log, choice: SourceChoice) -> None:
        self.path, self._log = path, log
        sources = log.sources
        self._laser = self._chosen("scans", choice.laser, sources.lasers)
        self._odometry = self._chosen("odometry", choice.odometry, sources.odometry)
        self.source = f"{log.name}: scans of {self._laser}, odometry of {self._odometry}"
        also = {*sources.lasers, *sources.odometry} - {self._laser, self._odometry}
        if also:
            self.source += f"; also there, for --scans and --odometry: {', '.join(sorted(also))}"

    @property
    def notes(self) -> Sequence[str]:
        """Warnings, once its entries are read."""
        return self._log.notes

    @property
    def share(self) -> float:
        """Part that is read, 0 to 1."""
        return min(1.0, self._log.share)

    def entries(self) -> Iterator[Entry]:
        """Yield the readings in their order."""
        return self._log.entries(self._laser, self._odometry)

    def _chosen(self, what: str, wanted: str | None, names: Sequence[str]) -> str:
        if not names:
            raise wrong(self.path, f" is {self._log.name} without {what}")
        found = [name for name in names if not wanted or name.strip("/") == wanted.strip("/")]
        if not found:
            raise ConfigError(f"--{what} {wanted}: {self.path.name} has {', '.join(names)}")
        return found[0]


@contextmanager
def chosen_log(path: Path, choice: SourceChoice = FIRST) -> Iterator[ChosenLog]:
    """Open a log of scans to read a laser and odometry of it.

    Raises:
        ConfigError: It cannot be read, is no such log, or lacks what is chosen.
    """
    with opened_log(path, choice.mounting) as log:
        yield ChosenLog(path, log, choice)


@dataclass(frozen=True, slots=True)
class _TextFormat:
    """A format of texts: its name, a search of the first lines, and a reader of all."""

    name: str
    sources: Callable[[Iterable[str]], Sources]
    read: Callable[[Iterable[str], str, str], Iterator[Entry | LoggedDamage]]


CARMEN = _TextFormat(
    "a log of CARMEN", carmen_sources, lambda lines, laser, _: read_carmen(lines, laser)
)
SCAN_LOG = _TextFormat("a scan log of ARIA", scan_log_sources, read_scan_log)


class _TextLog:
    """A text as a log; the place in the `raw` file shows progress.

    `sources` are those of the first lines, `given` is where the laser is, if somebody says so.
    """

    def __init__(
        self,
        text: _TextFormat,
        lines: Iterable[str],
        sources: Sources,
        raw: BinaryIO,
        given: Mounting | None,
    ) -> None:
        self.name, self.notes, self.sources = text.name, list[str](), sources
        self._read, self._lines, self._raw, self._given = text.read, lines, raw, given
        self._size = max(1, os.fstat(raw.fileno()).st_size)

    @property
    def share(self) -> float:
        """Part that is read, 0 to 1."""
        return self._raw.tell() / self._size

    def entries(self, laser: str, odometry: str) -> Iterator[Entry]:
        """Yield the readings of a laser and of odometry, in their order."""
        damaged: list[int] = []
        for entry in self._read(self._lines, laser, odometry):
            if isinstance(entry, LoggedDamage):
                damaged.append(entry.line)
            elif self._given is not None and isinstance(entry, LoggedScan):
                yield LoggedScan(mounted(entry.scan, self._given), entry.corrected)
            else:
                yield entry
        if damaged:
            more = f", and {len(damaged) - 1} more" if damaged[1:] else ""
            self.notes.append(f"line {damaged[0]} is damaged and left out{more}")


@contextmanager
def opened_log(path: Path, given: Mounting | None = None) -> Iterator[Log]:
    """Open a log of scans: a file, packed or not if it is a text, or the folder of a rosbag.

    `given` is where the laser is, in place of what the log tells.

    Raises:
        ConfigError: It cannot be read, or is no such log: the error names what it is.
    """
    found = _bag(path)
    if found is not None:
        with Bag(*found, given) as bag:
            yield bag
        return
    with _opened(path) as (lines, raw):
        head = list(_first(lines))
        text_format = _text_format(head)
        if text_format is None:
            raise wrong(path, f" is {_kind(path)}; {READ}")
        yield _TextLog(text_format, chain(head, lines), text_format.sources(head), raw, given)


def is_recording(path: Path) -> bool:
    """Whether a file is a recording of this program."""
    return not path.is_dir() and re.match(RECORDING, _unpacked(path), re.DOTALL) is not None


def _bag(path: Path) -> tuple[Path, BagFormat] | None:
    """Return path and format of a rosbag; `None` for another file.

    A file that is all of the bag in its folder is read with what the folder tells of it, unless
    that is told of files with other names.
    """
    whole = path.is_dir() or path.name == METADATA
    form = None if whole else _bag_format(path)
    if not whole and form in (None, ROS_1):
        return (path, form) if form else None
    folder = path if path.is_dir() else path.parent
    files = sorted(each for each in folder.iterdir() if each.is_file() and each.suffix != ".yaml")
    inside = [(each, of) for each in files if (of := _bag_format(each))]
    if (folder / METADATA).is_file() and (whole or [path] == [each for each, _ in inside]):
        told = _begin(folder / METADATA, LONGEST_LINE)
        if not inside or any(each.name.encode() in told for each, _ in inside):
            return folder, FOLDER
    if form is not None:
        return path, form
    if len(inside) != 1:
        names = ", ".join(each.name for each, _ in inside) or "no rosbag"
        raise wrong(path, f" is a folder without {METADATA}, with {names} in it; {READ}")
    return inside[0]


def _bag_format(path: Path) -> BagFormat | None:
    begin = _begin(path)
    return next((form for each, form in BAGS.items() if re.match(each, begin, re.DOTALL)), None)


def _text_format(head: list[str]) -> _TextFormat | None:
    """Return the format of a text by its first lines."""
    sources = scan_log_sources(head)
    if any(line.lstrip("\ufeff").startswith(FIRST_LINE) for line in head[:10]) or (
        sources.lasers and sources.odometry
    ):
        return SCAN_LOG
    words = {line.split(maxsplit=1)[0] for line in head if line.strip()}
    return CARMEN if words & WORDS else None


def _kind(path: Path) -> str:
    """Return the kind of a file that is no log, for an error."""
    begin = _unpacked(path)
    if not begin:
        return "empty"
    if any(re.match(each, begin, re.DOTALL) for each in BAGS):
        return "a rosbag that is packed: unpack it first"
    for pattern, name in OTHERS:
        if re.match(pattern, begin, re.DOTALL):
            return name
    if b"\0" in begin:
        return "of a format that is not known"
    first = next(iter(begin.decode("utf-8", "replace").strip().splitlines()), "").strip()
    return f"a text that is no log of scans: it begins with {shown(first)}"


def _first(lines: Iterable[str]) -> Iterator[str]:
    """Yield the lines by which a text is known."""
    size = 0
    for line in islice(lines, LOOKED_AT):
        yield line
        size += len(line)
        if size > LOOKED_AT * HEAD // 10:
            return


def _begin(path: Path, size: int = HEAD) -> bytes:
    """Return the first bytes of a file as they are."""
    with _raw(path) as raw:
        return raw.read(size)


def _unpacked(path: Path) -> bytes:
    """Return the first bytes in a file that may be packed."""
    with _raw(path) as raw:
        return _plain(raw).read(HEAD)


def _plain(raw: BinaryIO) -> BufferedIOBase | BinaryIO:
    """Return the content of a file that may be packed."""
    begin = raw.read(HEAD)
    raw.seek(0)
    return next((unpack(raw) for magic, unpack in PACKED.items() if begin.startswith(magic)), raw)


@contextmanager
def _raw(path: Path) -> Iterator[BinaryIO]:
    try:
        if path.exists() and not path.is_file():
            raise wrong(path, f" is not a file; {READ}")
        with path.open("rb") as raw:
            yield raw
    except (OSError, EOFError, zlib.error, lzma.LZMAError, ValueError) as error:
        if isinstance(error, ConfigError):
            raise
        reason = (
            error.strerror if isinstance(error, OSError) and error.strerror else one_line(error)
        )
        raise ConfigError(f"{path}: cannot be read: {reason}") from None


@contextmanager
def _opened(path: Path) -> Iterator[tuple[Iterator[str], BinaryIO]]:
    """Open a text, packed or not; yield its lines, and the file whose place shows progress."""
    with (
        _raw(path) as raw,
        TextIOWrapper(cast("BinaryIO", _plain(raw)), encoding="utf-8", errors="replace") as text,
    ):
        yield iter(partial(text.readline, LONGEST_LINE), ""), raw
