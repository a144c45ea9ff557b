"""The user's logs: their names, which go first, which are pinned or being written.

A log that is write-protected is pinned. One that is being written is locked, which ends with its
program whatever ends that.
"""

import logging
import os
import re
import stat
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from datetime import UTC, datetime
from itertools import count
from pathlib import Path
from typing import Final

from pioneer3.errors import ConfigError
from pioneer3.log.cut import CHUNK, MESSAGE, data_records
from pioneer3.names import printable
from pioneer3.text import state_folder

try:
    import fcntl
except ImportError:  # Windows: a file that is open cannot be removed there
    fcntl = None  # type: ignore[assignment]

log = logging.getLogger(__name__)

SWITCH: Final = "PIONEER3_RECORD"
"""Variable of the environment that is 0 where nothing is recorded unless it is asked for."""
ROOM: Final = "PIONEER3_LOG_ROOM"
"""Variable of the environment with the room for logs [GiB]."""
USUAL_ROOM: Final = 2.0
"""Room for logs [GiB]."""
GIB: Final = 1 << 30
"""Gibibyte [bytes]."""
SUFFIX: Final = ".mcap"
"""End of the names of logs."""
NAME: Final = re.compile(r"\d{4}-\d\d-\d\dT\d\d-\d\d-\d\dZ-[\w-]{1,40}(\.\d{1,6})?\.mcap", re.ASCII)
"""Form of the names: time (UTC), what was started, number if there are several."""
CLOCK_CORRECTED: Final = 60.0
"""A log may have begun later than now by that [s]: a clock is set back a little now and then."""
PRIVATE: Final = 0o600
"""Mode of a log."""
PINNED: Final = 0o400
"""Mode of a log that is pinned."""


def logs_folder(environment: Mapping[str, str] = os.environ) -> Path:
    """Return the folder of the user's logs, which may not be there yet."""
    return state_folder(environment) / "logs"


def is_recording_off(environment: Mapping[str, str] = os.environ) -> bool:
    """Whether nothing is to be recorded unless it is asked for."""
    return environment.get(SWITCH, "").strip().lower() in {"0", "no", "off", "false"}


def room_for_logs(environment: Mapping[str, str] = os.environ) -> int:
    """Return the room for the user's logs [bytes].

    Raises:
        ConfigError: The environment has no number for it.
    """
    text = environment.get(ROOM) or str(USUAL_ROOM)
    with suppress(ValueError, OverflowError):
        if (size := int(float(text) * GIB)) > 0:
            return size
    raise ConfigError(f"{ROOM}={printable(text)}: a number of GiB is expected, such as 2 or 0.5")


def create_log(folder: Path, title: str, now: float) -> tuple[Path, int]:
    """Create the next log of the user; return its path, and the open file, which is locked.

    The time is in seconds since 1970.

    Raises:
        OSError: It cannot be created.
    """
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    when = _time_of(now)
    words = "-".join(re.findall(r"\w+", title, re.ASCII))[:40].strip("-") or "program"
    for number in count(1):
        path = folder / f"{when}-{words}{f'.{number}' if number > 1 else ''}{SUFFIX}"
        with suppress(FileExistsError):
            return path, create(path)
    raise AssertionError


def create(path: Path) -> int:
    """Create a file that only this user may read; return it open, and locked.

    Raises:
        OSError: It cannot be created, or is there already.
    """
    while True:
        descriptor = os.open(path, os.O_CREAT | os.O_EXCL | os.O_WRONLY | _BINARY, PRIVATE)
        if fcntl is None:
            return descriptor
        with suppress(OSError):  # a file system without locks
            fcntl.flock(descriptor, fcntl.LOCK_EX)
        if os.fstat(descriptor).st_nlink:
            return descriptor
        os.close(descriptor)  # before it was locked, another program made room


_BINARY = getattr(os, "O_BINARY", 0)


def user_logs(folder: Path) -> list[Path]:
    """Return the user's logs, the oldest first; none where the folder cannot be read."""
    try:
        names = [each.name for each in os.scandir(folder) if each.is_file(follow_symlinks=False)]
    except OSError:
        return []
    return [folder / name for name in sorted(filter(NAME.fullmatch, names), key=_age)]


def find_log(folder: Path, name: str, wall: Callable[[], float] = time.time) -> Path:
    """Return the user's log of a name, or the newest with such a part; the newest for no name.

    Nothing leaves the folder: it is one of those that are there. Logs without messages, as a loss
    of power leaves them, and those of a clock that was ahead are passed over where others are
    there, with a line. `wall` returns the time since 1970 [s].

    Raises:
        ConfigError: There is none.
    """
    logs = user_logs(folder)
    if found := [path for path in logs if name in path.name]:
        named = (path for path in found if name in {path.name, path.stem})
        return next(named, None) or _newest(_until(found, wall()))
    if not name:
        raise ConfigError(f"{printable(str(folder))}: there are no logs yet")
    raise ConfigError(f"{printable(name)}: names no log; `pioneer3 log list` shows them")


def has_messages(path: Path) -> bool:
    """Whether a log has messages; one that cannot be read may have some."""
    try:
        with path.open("rb") as file:
            return any(kind in {CHUNK, MESSAGE} for kind, *_ in data_records(file))
    except OSError:
        return True


def _until(logs: Sequence[Path], now: float) -> Sequence[Path]:
    """Return the logs that began until now [s since 1970], or go on; all where none did."""
    last = _time_of(now + CLOCK_CORRECTED)
    past = [each for each in logs if each.name[: len(last)] <= last or is_being_written(each)]
    if past and past[-1] != logs[-1]:
        log.warning("%s: passed over: it began when the clock was ahead", logs[-1].name)
    return past or logs


def _newest(logs: Sequence[Path]) -> Path:
    """Return the newest log that has messages, else the newest."""
    for path in reversed(logs):
        if has_messages(path):
            if path != logs[-1]:
                log.warning("%s: passed over: it is newer, but has no messages", logs[-1].name)
            return path
    return logs[-1]


def named_log_path(name: str | Path) -> Path:
    """Return the log of a name: a file that is there, or else as :func:`find_log` does.

    Raises:
        ConfigError: There is none.
    """
    return Path(name) if Path(name).is_file() else find_log(logs_folder(), str(name))


def is_pinned(path: Path) -> bool:
    """Whether a log is kept until somebody removes it."""
    return not path.stat().st_mode & stat.S_IWUSR


def pin(path: Path, *, on: bool) -> None:
    """Pin a log, or let it go when room is needed.

    Raises:
        OSError: It is not there, or another user's.
    """
    path.chmod(PINNED if on else PRIVATE)


@contextmanager
def _unused(path: Path) -> Iterator[bool]:
    """Whether nobody writes a log; nobody can begin to during the block."""
    if fcntl is None:
        yield True
        return
    descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        yield True
    except BlockingIOError:
        yield False
    finally:
        os.close(descriptor)


def is_being_written(path: Path) -> bool:
    """Whether a program writes a log."""
    with suppress(OSError), _unused(path) as unused:
        return not unused
    return False


def make_room(folder: Path, room: int) -> None:
    """Remove the oldest logs until the others take `room` [bytes]; neither pinned ones nor open.

    Several programs may do that at once. What cannot be removed stays.
    """
    sizes = {}
    for path in user_logs(folder):
        with suppress(OSError):
            sizes[path] = path.stat().st_size
    over = sum(sizes.values()) - room
    for path, size in sizes.items():
        if over <= 0:
            return
        with suppress(OSError):
            if is_pinned(path):
                continue
            with _unused(path) as unused:
                if unused:
                    path.unlink()
                    over -= size


def _time_of(now: float) -> str:
    """Return the begin of the names of logs of a time [s since 1970]."""
    return datetime.fromtimestamp(now, UTC).strftime("%Y-%m-%dT%H-%M-%SZ")


def _age(name: str) -> tuple[str, int, str]:
    """Return the key that sorts the names of logs by their age."""
    stem, _, number = name.removesuffix(SUFFIX).partition(".")
    return stem[:20], int(number or 1), stem
