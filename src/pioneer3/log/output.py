"""Outputs that are whole or not there: a file, or a folder of files."""

import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from pioneer3.log.folder import PRIVATE
from pioneer3.text import wrong


@contextmanager
def new_output(path: Path) -> Iterator[Path]:
    """Yield a place for a file or folder, which gets its name when the block has ended well.

    Only this user may read it, as logs are. After a failure nothing stays.

    Raises:
        ConfigError: Something has this name already, or cannot be written.
    """
    refuse_taken(path)
    try:
        beside = Path(tempfile.mkdtemp(prefix=f".{path.name}-", dir=path.parent))
        try:
            made = beside / path.name
            yield made
            _move(made, path)
        finally:
            shutil.rmtree(beside, ignore_errors=True)
    except OSError as error:
        raise wrong(path, f" cannot be written: {error.strerror or error}") from None


def refuse_taken(path: Path) -> None:
    """Refuse the name of a file or folder that is there already.

    Raises:
        ConfigError: It is there.
    """
    if os.path.lexists(path):
        raise wrong(path, " is there already, and is left alone: choose another name")


def _move(made: Path, path: Path) -> None:
    """Move a file or folder; neither takes the place of anything."""
    if made.is_dir():
        made.chmod(0o700)
        made.rename(path)
        return
    made.chmod(PRIVATE)
    try:
        path.hardlink_to(made)
    except FileExistsError:
        raise
    except OSError:  # a file system without links, as of USB sticks
        made.rename(path)
