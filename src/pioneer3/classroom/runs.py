"""Runs that students record and hand in: files in one folder, `Anna-1.mcap`, `Anna-2.mcap`, ...

A run that is recorded is in a hidden file until it is handed in. Nothing of a student's is ever
part of a path but the letters, digits, `_` and `-` of the name.
"""

import logging
import os
import re
from contextlib import suppress
from dataclasses import dataclass
from itertools import count
from pathlib import Path

from pioneer3.errors import CommandError, ConfigError

log = logging.getLogger(__name__)

MOST_BYTES = 16_000_000
"""Most bytes of one run: some two hours."""
MOST_RUNS = 30
"""That one student can hand in."""
FULL = "it has reached the greatest length"
NOT_WORDS = re.compile(r"[^\w]+")


@dataclass(frozen=True, slots=True, kw_only=True)
class Run:
    """A run of so many seconds and bytes that was handed in `at` a Unix time [s].

    It has the name of the file in the folder, and that of the student then.
    """

    file: str
    student: str
    session: str
    robot: int
    at: float
    seconds: float
    size: int


@dataclass(frozen=True, slots=True)
class Draft:
    """A file for a run that is recorded, and when it began [s, Unix time]."""

    path: Path
    began: float

    @property
    def size(self) -> int:
        """In bytes; 0 if the file is not there."""
        try:
            return self.path.stat().st_size
        except OSError:
            return 0

    def discard(self) -> None:
        """Remove the file."""
        with suppress(OSError):
            self.path.unlink(missing_ok=True)


class RunFolder:
    """The folder that runs are handed in to; it is made when the first run is recorded.

    `runs` are those handed in since the class began, by file name.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.runs: dict[str, Run] = {}
        self._count = count(1)

    def draft(self, robot: int, began: float) -> Draft:
        """Return a file for a run of a robot, which is not there yet.

        Raises:
            ConfigError: The folder cannot be written to.
        """
        name = f".robot-{robot}-{os.getpid()}-{next(self._count)}.part"
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            return Draft(self.folder / name, began)
        except OSError as error:
            raise ConfigError(
                f"{self.folder}: cannot record there: {error.strerror}; choose another folder with "
                "--folder"
            ) from None

    def hand_in(
        self, draft: Draft, *, student: str, session: str, robot: int, at: float, seconds: float
    ) -> Run:
        """Keep a draft under the student's name; return the run.

        Raises:
            CommandError: The student has handed in too many, or the disk does not take it.
        """
        theirs = sum(run.session == session for run in self.runs.values())
        if theirs >= MOST_RUNS:
            raise CommandError(f"you have handed in {theirs} runs already, and no more are taken")
        size = draft.size
        path = None
        try:
            path = self._new_file(student)
            draft.path.replace(path)
        except OSError as error:
            if path is not None:
                path.unlink(missing_ok=True)
            log.warning("%s: cannot keep a run there: %s", self.folder, error.strerror)
            raise CommandError(
                f"the run could not be kept ({error.strerror}): tell your teacher"
            ) from None
        run = Run(
            file=path.name,
            student=student,
            session=session,
            robot=robot,
            at=at,
            seconds=seconds,
            size=size,
        )
        self.runs[run.file] = run
        return run

    def find(self, file: str) -> Path | None:
        """Return the path of a run that was handed in, `None` if there is none of that name."""
        return self.folder / file if file in self.runs else None

    def _new_file(self, student: str) -> Path:
        """Reserve the next free name of a student."""
        for number in count(1):
            path = self.folder / f"{file_stem(student)}-{number}.mcap"
            with suppress(FileExistsError):
                path.open("x").close()
                return path
        raise AssertionError


def file_stem(name: str) -> str:
    """Return a name as the beginning of a file name: letters, digits, `_` and `-`."""
    return NOT_WORDS.sub("-", name).strip("-") or "student"
