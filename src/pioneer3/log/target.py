"""Opens the files of a log: one that is named, or the next ones of the user's folder."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Protocol

from pioneer3.log.folder import create, create_log, make_room

PARTS: Final = 16
"""A log begins another file when one takes this part of the room for all: the oldest files go."""

NAMED_PATIENCE: Final = 2.0
"""Somebody waits for a file that he has named this long [s]."""
USER_PATIENCE: Final = 0.25
"""Longest wait for the end of a log that nobody named [s]: the program may have other robots."""


class LogTarget(Protocol):
    """Opens the files of a log, one after the other.

    Attributes:
        path: The file that was opened last, or is to be.
        most: Size at which another one begins [bytes]; `None` for never.
        patience: Longest wait for its end [s].
    """

    path: Path
    most: int | None
    patience: float

    def open(self) -> int:
        """Return the next file, open; OSError if it cannot be created."""

    def tidy(self) -> None:
        """Make room where others go on writing, too."""


@dataclass(slots=True)
class NamedFile:
    """A file that somebody names; it grows as it must."""

    path: Path
    most: int | None = None
    patience: float = NAMED_PATIENCE

    def open(self) -> int:
        """Return the new file, open."""
        return create(self.path)

    def tidy(self) -> None:
        """Do nothing."""


@dataclass(slots=True)
class UserFolder:
    """Files in the user's folder, with a title, within the room for all [bytes].

    The clock returns the time since 1970 [s].
    """

    folder: Path
    title: str
    room: int
    clock: Callable[[], float]
    path: Path = Path()
    most: int | None = None
    patience: float = USER_PATIENCE

    def __post_init__(self) -> None:
        self.path = self.folder
        self.most = self.room // PARTS

    def open(self) -> int:
        """Remove the oldest logs if there is no room, and return the next one, open."""
        self.tidy()
        self.path, descriptor = create_log(self.folder, self.title, self.clock())
        return descriptor

    def tidy(self) -> None:
        """Remove the oldest logs if there is no room for another file."""
        make_room(self.folder, self.room - self.room // PARTS)
