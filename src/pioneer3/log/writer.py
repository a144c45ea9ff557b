"""Takes messages from the event loop, and writes them in a thread of its own.

Rules:

1. Whoever puts a message waits for nothing: it joins a queue, and the thread does all the rest.
2. Each second the thread takes what waits and writes one chunk, the messages of a topic side by
   side, which takes less room: a program that is killed loses the last second.
3. A disk that takes no more ends the log, with one line; the driver goes on. One that is too slow
   loses the oldest messages of the queue, which are counted, and told in the log too.
4. Times are those of the event loop's clock, put on the wall clock's time of the beginning. Where
   that clock is set later, the log has an event, and its own times go on evenly.
"""

import atexit
import logging
import sys
import threading
import time
from collections import deque
from collections.abc import Callable, Mapping
from contextlib import suppress
from datetime import UTC, datetime
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from pioneer3 import __version__
from pioneer3.clock import Clock
from pioneer3.errors import ConfigError
from pioneer3.log.command_line import started, without_secrets
from pioneer3.log.folder import is_recording_off, logs_folder, room_for_logs
from pioneer3.log.target import LogTarget, NamedFile, UserFolder
from pioneer3.log.topics import EVENT, GOES_ON, PROGRAM, LogEvent, LogTopic

if TYPE_CHECKING:
    from pioneer3.log.mcap import McapFile

log = logging.getLogger(__name__)

CHUNK_PERIOD: Final = 0.9
"""A chunk is written this often [s]."""
SYNC_PERIOD: Final = 5.0
"""While robots stand, the file is brought to the disk this often [s], as ext4 does."""
JUST_MOVED: Final = 2.0
"""Each chunk is brought to the disk until no robot has moved for this long [s].

That writes 20 MB an hour more than every 5 s, mostly of the file system's journal: an SD card bears
it, and a loss of power costs the last second of what was done.
"""
TIDY_PERIOD: Final = 60.0
"""Room is looked for this often [s]."""
MOST_WAITING: Final = 32 * 1024 * 1024
"""Memory that messages may take which wait for the disk [bytes], about: a minute of a laser."""
FEW: Final = 256
"""So many messages may wait before somebody looks how much memory they take."""
CLOCK_JUMP: Final = 0.5
"""A wall clock that is off by more than before was set [s]."""
LAST_PATIENCE: Final = 2.0
"""Longest wait for the last chunk and the index when the program ends [s]."""
MOST_TEXTS: Final = 1000
"""Descriptions that are repeated in each file of a log."""


class LogWriter:
    """Writes a log; it begins at once, and ends by :meth:`close`.

    Args:
        target: Opens its files.
        clock: Of the event loop, which threads may read.
        wall: Returns the time since 1970 [ns].

    Raises:
        OSError: The file that is named cannot be written; another target is told instead.

    Attributes:
        clock: Of the event loop.
        failure: The reason why it has ended by itself; empty if it has not.
        dropped: Messages that were lost because the disk was too slow.
        moved_at: When a robot was seen to move last [s].
        files: That were begun.
    """

    def __init__(
        self,
        target: LogTarget,
        clock: Clock,
        *,
        wall: Callable[[], int] = time.time_ns,
    ) -> None:
        self.failure = ""
        self.dropped = 0
        self.moved_at = -inf
        self.files: list[Path] = []
        self._target, self.clock, self._wall = target, clock, wall
        self._began, self._began_ns = clock(), wall()
        self._set_by = 0.0
        self._taken = self._began_ns
        self._queue: deque[tuple[float, LogTopic[Any], Any]] = deque()
        self._few = FEW
        self._told = 0
        self._wake = threading.Event()
        self._ended = False
        self._why = ""
        self._file: McapFile | None = None
        self._texts: dict[str, dict[str, str]] = {}
        self._repeated: dict[str, tuple[LogTopic[Any], Any]] = {}
        self._new_texts: deque[tuple[str, dict[str, str]]] = deque()
        self.describe(
            PROGRAM,
            {
                "version": __version__,
                "command": started(sys.argv)[1],
                "began": datetime.fromtimestamp(self._began_ns / 1e9, UTC).isoformat(),
                "began_ns": str(self._began_ns),
                "clock": f"{self._began!r}",
                "python": sys.version.split()[0],
                "system": sys.platform,
            },
        )
        if isinstance(target, NamedFile):
            self._open()
        self._thread = threading.Thread(target=self._run, name="log", daemon=True)
        self._thread.start()
        atexit.register(self._leave)

    @property
    def path(self) -> str:
        """The file that is being written."""
        return str(self._target.path)

    @property
    def now_ns(self) -> int:
        """The time of a message of now [ns since 1970]: it goes on evenly."""
        return self._ns(self.clock())

    def put(self, topic: LogTopic[Any], message: Any, now: float | None = None) -> None:
        """Take a message of `now` [s, of the clock], which must not change any more."""
        if self._ended:
            return
        self._queue.append((self.clock() if now is None else now, topic, message))
        if len(self._queue) > self._few:
            self._look()

    def event(self, kind: str, text: str) -> None:
        """Take an event of now, in words, which are told without secrets."""
        self.put(EVENT, LogEvent(kind, without_secrets(text)))

    def describe(self, name: str, texts: Mapping[str, str]) -> None:
        """Take a description, such as that of a robot; a later one of the same name counts."""
        self._new_texts.append((name, dict(texts)))

    def close(self, why: str, patience: float | None = None) -> None:
        """End the log for a reason, and wait for the disk a moment [s]; it may hang."""
        self._end(why, self._target.patience if patience is None else patience)
        if not self._thread.is_alive():
            atexit.unregister(self._leave)

    def _leave(self) -> None:
        self._end("the program ended", LAST_PATIENCE)

    def _end(self, why: str, patience: float) -> None:
        if not self._ended:
            self._why, self._ended = without_secrets(why), True
        self._wake.set()
        self._thread.join(patience)

    def _look(self) -> None:
        """Wake the thread if much waits; drop the oldest where it is too slow, and tell it once."""
        sizes = [topic.memory(message) for _, topic, message in self._queue.copy()]
        waiting = sum(sizes)
        if waiting > MOST_WAITING // 4:
            self._wake.set()
        if waiting > MOST_WAITING:
            if not self.dropped:
                log.warning("%s: the disk is too slow to record all: the oldest is lost", self.path)
            with suppress(IndexError):  # the thread has taken all
                while waiting > MOST_WAITING // 2:
                    _, topic, message = self._queue.popleft()
                    waiting -= topic.memory(message)
                    self.dropped += 1
        self._few = len(self._queue) * 5 // 4 + FEW

    # In the thread

    def _run(self) -> None:
        try:
            if self._file is None:
                self._open()
            synced = tidied = self.clock()
            while not self._ended:
                self._wake.wait(CHUNK_PERIOD)
                self._wake.clear()
                self._take()
                self._flush()
                now = self.clock()
                if now - self.moved_at < JUST_MOVED or now - synced >= SYNC_PERIOD:
                    self._sync()
                    synced = now
                if now - tidied >= TIDY_PERIOD:
                    self._target.tidy()
                    tidied = now
            self._finish()
        except Exception as error:  # whatever it is, the robot goes on
            self._fail(error)

    def _open(self) -> None:
        from pioneer3.log.mcap import McapFile  # takes 50 ms, which no start has to wait for

        self._file = McapFile(self._target.open())
        self.files.append(self._target.path)
        for name, texts in self._texts.items():
            self._file.add_metadata(name, texts)
        for topic, message in self._repeated.values():
            self._file.add(topic, [(self._taken, message)])

    def _take(self) -> None:
        """Encode what waits."""
        assert self._file is not None
        while self._new_texts:
            name, texts = self._new_texts.popleft()
            if name in self._texts or len(self._texts) < MOST_TEXTS:
                self._texts[name] = texts
            self._file.add_metadata(name, texts)
        self._look_at_clock()
        if self.dropped > self._told:
            lost, self._told = self.dropped - self._told, self.dropped
            self._note(self.clock(), "dropped", f"{lost} messages: a slow disk")
        by_topic: dict[str, tuple[LogTopic[Any], list[tuple[int, Any]]]] = {}
        with suppress(IndexError):  # the loop has dropped some
            for _ in range(len(self._queue)):
                now, topic, message = self._queue.popleft()
                if topic.is_news(message, now):
                    at = self._ns(now)
                    self._taken = max(self._taken, at)
                    by_topic.setdefault(topic.name, (topic, []))[1].append((at, message))
        self._few = FEW
        for topic, messages in by_topic.values():
            self._file.add(topic, messages)
            if topic.repeated:
                self._repeated[topic.name] = topic, messages[-1][1]

    def _note(self, now: float, kind: str, text: str) -> None:
        assert self._file is not None
        self._file.add(EVENT, [(self._ns(now), LogEvent(kind, text))])

    def _ns(self, now: float) -> int:
        """Return a time of the event loop as time since 1970 [ns]."""
        return self._began_ns + round((now - self._began) * 1e9)

    def _look_at_clock(self) -> None:
        """Note that somebody has set the wall clock."""
        now = self.clock()
        off = (self._wall() - self._began_ns) / 1e9 - (now - self._began)
        if abs(off - self._set_by) > CLOCK_JUMP:
            text = f"the computer's clock was set by {off - self._set_by:+.3f} s"
            self._note(now, "clock", text)
            self._set_by = off

    def _flush(self) -> None:
        """Write a chunk, and begin another file if it is time."""
        assert self._file is not None
        self._file.flush()
        most = self._target.most
        if most is not None and (self._file.size >= most or self._file.is_crowded):
            before = self._file
            self._open()  # where that fails, the file before tells it
            before.finish(GOES_ON)

    def _sync(self) -> None:
        assert self._file is not None
        self._file.sync()

    def _finish(self) -> None:
        assert self._file is not None
        self._take()
        self._file.flush()
        self._file.finish(self._why)

    def _fail(self, error: Exception) -> None:
        reason = (isinstance(error, OSError) and error.strerror) or repr(error)
        self.failure = reason
        self._ended = True
        self._queue.clear()
        if self._file is not None:
            with suppress(OSError):
                self._file.abandon(without_secrets(f"the recording ended: {reason}"))
            log.warning("%s: the recording has ended, and nothing else: %s", self.path, reason)
        else:
            log.warning("%s: nothing is recorded: %s", self.path, reason)
        if not isinstance(error, OSError):
            log.debug("%s", self.path, exc_info=error)


def named_log(path: Path, clock: Clock) -> LogWriter:
    """Return a log in a new file.

    Raises:
        ConfigError: The file cannot be written; one that exists is left alone.
    """
    try:
        return LogWriter(NamedFile(path), clock)
    except OSError as error:
        raise ConfigError(f"{path}: cannot record there: {error.strerror}") from None


def user_log(clock: Clock, *, always: bool = False) -> LogWriter | None:
    """Return a new log in the user's folder; `None` where recording is off, and not asked for.

    Raises:
        ConfigError: The room for logs is no number.
    """
    if is_recording_off() and not always:
        return None
    title, _ = started(sys.argv)
    return LogWriter(UserFolder(logs_folder(), title, room_for_logs(), time.time), clock)
