"""The user's logs on a page of robots: their list, an excerpt that is kept, replays beside it."""

import asyncio
from collections.abc import AsyncIterator, Callable, Sequence
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Final

from pioneer3.errors import CommandError, ConfigError
from pioneer3.log.excerpt import NOTE, save_excerpt
from pioneer3.log.folder import logs_folder, user_logs
from pioneer3.log.index import LogIndex
from pioneer3.log.reader import LogInfo, open_log, whole_log, whole_logs
from pioneer3.log.writer import CHUNK_PERIOD
from pioneer3.names import printable
from pioneer3.web.api.types import LoggedRun
from pioneer3.web.clients import Clients

MOST_LISTED: Final = 50
"""The newest logs, which are listed."""
MOST_REPLAYS: Final = 4
"""Replays that are open at once beside driven robots."""
SAVED_TIME: Final = 300.0
"""Length of what is saved [s]."""


class PageLogs:
    """The logs in the user's folder, and the runs that were `handed_in`; nothing else is found."""

    def __init__(
        self,
        clients: Clients,
        folder: Path | None = None,
        handed_in: Callable[[str], Path | None] = lambda name: None,
    ) -> None:
        self._clients, self._handed_in = clients, handed_in
        self._folder = logs_folder() if folder is None else folder
        self._replays = 0

    def find(self, name: str) -> Path:
        """Return the log whose whole name this is; CommandError if there is none."""
        for path in user_logs(self._folder):
            if path.name == name:
                return path
        if (run := self._handed_in(name)) is not None:
            return run
        raise CommandError(f"there is no log {printable(name[:80])}")

    async def listed(self) -> list[LoggedRun]:
        """Return the facts of the newest logs, the newest first."""
        return await asyncio.to_thread(self._listed)

    def _listed(self) -> list[LoggedRun]:
        newest = user_logs(self._folder)[-MOST_LISTED:]
        return [*map(_facts, whole_logs(reversed(newest)))]

    async def save(self, note: str, by: str) -> LoggedRun:
        """Keep the last minutes of the log that is written, with a note.

        Raises:
            CommandError: Nothing is recorded, or it cannot be saved.
        """
        writer = self._clients.log
        if writer is None or writer.failure:
            why = f": {writer.failure}" if writer else ""
            raise CommandError(f"nothing is recorded here{why}")
        until = writer.now_ns
        await asyncio.sleep(2 * CHUNK_PERIOD)  # the last second is not in the file yet
        about = {"text": printable(note), "by": printable(by), "of": Path(writer.path).name}
        try:
            return await asyncio.to_thread(self._save, writer.files, until, about)
        except ConfigError as error:
            raise CommandError(str(error)) from None

    def _save(self, files: Sequence[Path], until: int, about: dict[str, str]) -> LoggedRun:
        log = LogIndex(*(each for each in files if each.exists()))  # the oldest go for want of room
        begin = until - round(SAVED_TIME * 1e9)
        return _facts(open_log(save_excerpt(log, self._folder, begin, until, about)).info())

    @asynccontextmanager
    async def opened(self, name: str) -> AsyncIterator[LogIndex]:
        """Open a log for a replay beside the robots, which ends with the block.

        Raises:
            CommandError: There is none of that name, or there are too many replays.
            ConfigError: It cannot be read.
        """
        path = self.find(name)
        if self._replays >= MOST_REPLAYS:
            raise CommandError(f"{MOST_REPLAYS} replays are open here: close one of them first")
        self._replays += 1
        try:
            log = await asyncio.to_thread(whole_log, path)
            yield await asyncio.to_thread(LogIndex, *log.files)
        finally:
            self._replays -= 1


def _facts(info: LogInfo) -> LoggedRun:
    """Return the facts of a log, for the page."""
    return LoggedRun(
        file=info.path.name,
        more=tuple(each.name for each in info.files[1:]),
        began=info.began / 1e9,
        seconds=info.seconds,
        size=info.size,
        robot=printable(info.robot),
        end=printable(info.end),
        note=printable(info.texts.get(NOTE, {}).get("text", "")),
        pinned=info.pinned,
        goes_on=info.being_written,
    )
