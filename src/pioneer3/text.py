"""Text files: reading and writing them, their lines and numbers, and errors with line numbers.

And the folder where the user's state is kept.
"""

import os
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from pioneer3.errors import ConfigError
from pioneer3.names import printable

LARGEST_FILE = 16 * 1024 * 1024
"""Larger files are not maps [bytes]; ARIA's largest has 0.7 MB."""

_LINE = re.compile(r"([^\r\n]*)(?:\r\n|\r|\n|\Z)")
POINTER = b"version https://git-lfs.github.com/spec/"
"""Begins what stands in place of a large file until `git lfs pull` fetches it."""
LARGEST_MM = 1e8
"""Coordinates beyond 100 km are mistakes [mm]."""


def state_folder(environment: Mapping[str, str] = os.environ) -> Path:
    """Return the folder of what we keep for this user: logs, certificates, places, backups."""
    return user_folder("XDG_STATE_HOME", ".local/state", environment)


def user_folder(variable: str, usual: str, environment: Mapping[str, str] = os.environ) -> Path:
    """Return our folder in the one that a variable names, which counts where it is absolute.

    Else it is in the `usual` one, below the user's home. Source: XDG Base Directory Specification.
    """
    base = Path(environment.get(variable, ""))
    return (base if base.is_absolute() else Path.home() / usual) / "pioneer3"


@dataclass(frozen=True, slots=True)
class TextLine:
    """One line of a file, without the blanks around it; counted from 1."""

    path: Path
    number: int
    text: str

    def wrong(self, field: str, problem: str) -> ConfigError:
        """Return the error about `field` on this line."""
        return wrong(self.path, f"{self.number}: {field}: {problem}")

    def numbers(self, field: str, words: Sequence[str]) -> tuple[float, ...]:
        """Return `words` as numbers, unit unchanged.

        Raises:
            ConfigError: One is no number, not finite or beyond 100 km in millimetres.
        """
        try:
            values = tuple(map(float, words))
        except ValueError:
            raise self.wrong(field, f"{shown(' '.join(words))} is not all numbers") from None
        for value, word in zip(values, words, strict=True):
            # written so that NaN fails too
            if not abs(value) <= LARGEST_MM:
                raise self.wrong(field, f"{shown(word)} is not within 100 km of the origin")
        return values


def wrong(path: Path, problem: str) -> ConfigError:
    """Return a one-line error about the file at `path`."""
    return ConfigError(f"{printable(str(path))}:{problem}")


def shown(text: str) -> str:
    """Return `text` as a quoted one-line excerpt for a message."""
    return ascii(text if len(text) <= 40 else text[:37] + "...")


def one_line(problem: object) -> str:
    """Return the message of another library as one printable line, cut short."""
    line = " ".join(str(problem).split())
    return printable(line[:100])


def lines_of(path: Path, text: str, first: int = 1) -> Iterator[TextLine]:
    """Yield the lines of `text` that are neither blank nor comments; `path` is for messages.

    The first line has the number `first`.
    """
    for number, line in numbered(text, first):
        stripped = line.strip()
        if stripped and stripped[0] not in "#;":
            yield TextLine(path, number, stripped)


def numbered(text: str, first: int = 1) -> Iterator[tuple[int, str]]:
    """Yield every line with its number from `first`; any line end counts."""
    for number, line in enumerate(_LINE.finditer(text), first):
        yield number, line[1]


def read_bytes(path: Path, largest: int = LARGEST_FILE, kind: str = "map") -> bytes:
    """Return the contents of a file of at most `largest` bytes; `kind` is for messages.

    Raises:
        ConfigError: The file is missing, not a regular file, unreadable, too large or not fetched.
    """
    try:
        if path.is_dir():
            raise wrong(path, f" is a directory, not a {kind} file")
        if path.exists() and not path.is_file():
            raise wrong(path, " is not a regular file")
        with path.open("rb") as file:
            raw = file.read(largest + 1)
    except (OSError, ValueError) as error:
        if isinstance(error, ConfigError):
            raise
        raise wrong(path, f" cannot read this {kind} file: {_reason(error)}") from None
    if len(raw) > largest:
        raise wrong(path, f" is larger than {largest >> 20} MB, so not a {kind}")
    if raw.startswith(POINTER):
        raise wrong(path, f" is no {kind} yet: fetch it by `git lfs pull` in its folder")
    return raw


def write_bytes(path: Path, data: bytes) -> None:
    """Write a file; one that is there stays whole until the new one is.

    Raises:
        ConfigError: It cannot be written.
    """
    try:
        if path.exists() and not path.is_file():  # a pipe, a terminal
            path.write_bytes(data)
            return
        target = path.resolve()
        beside = target.with_name(f".{target.name}.{os.getpid()}")
        try:
            with beside.open("wb") as file:
                file.write(data)
                file.flush()
                os.fsync(file.fileno())
            beside.replace(target)
        finally:
            beside.unlink(missing_ok=True)
    except (OSError, ValueError) as error:
        raise wrong(path, f" cannot be written: {_reason(error)}") from None


def decoded(raw: bytes) -> str:
    """Return the text in `raw`: UTF-8 with or without its mark, else Latin-1."""
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        return raw.decode("latin-1")


def _reason(error: OSError | ValueError) -> str:
    return (error.strerror if isinstance(error, OSError) else None) or str(error)
