"""Changes of files that belong to people: shown as a diff, kept as a backup, written at once."""

import errno
import os
import re
import shutil
from dataclasses import dataclass
from difflib import unified_diff
from pathlib import Path
from typing import Final

from pioneer3.errors import ConfigError, FilePermissionError

BEGIN: Final = "# BEGIN pioneer3 fleet"
END: Final = "# END pioneer3 fleet"
_BLOCK: Final = re.compile(rf"^{BEGIN}\b[^\n]*\n(?:.*?^{END}\b[^\n]*\n?)", re.DOTALL | re.MULTILINE)


@dataclass(frozen=True, slots=True)
class Change:
    """A file with its old text, empty if there is none, and the new; `mode` is for a new file."""

    path: Path
    old: str
    new: str
    mode: int = 0o644

    @classmethod
    def of(cls, path: Path, new: str, mode: int = 0o644) -> "Change":
        """Return the change of a file to the text `new`."""
        return cls(path, text_of(path), new, mode)

    @property
    def is_needed(self) -> bool:
        """Whether it changes anything."""
        return self.old != self.new

    def diff(self) -> str:
        """Return the change as `diff -u` has it; empty if there is none."""
        before, after = self.old.splitlines(), self.new.splitlines()
        lines = unified_diff(before, after, str(self.path), str(self.path), lineterm="")
        return "\n".join(lines)

    def apply(self) -> Path | None:
        """Write the file; whoever reads it meanwhile finds the old text or the new one.

        Return the backup of the old file; `None` if there was none, or nothing is to change.

        Raises:
            FilePermissionError: This user may not.
            ConfigError: It has changed since it was read, or cannot be written.
        """
        if not self.is_needed:
            return None
        if text_of(self.path) != self.old:
            raise ConfigError(f"{self.path}: somebody else changed it just now; try again")
        try:
            _make_folder(self.path.parent)
            backup = self._kept() if self.path.exists() else None
            _replace(self.path.resolve(), self.new, self.mode)
        except PermissionError:
            raise FilePermissionError(
                f"{self.path}: you may not change it; run the same command with sudo"
            ) from None
        except OSError as error:
            raise ConfigError(f"{self.path}: cannot be written: {error.strerror}") from None
        return backup

    def _kept(self) -> Path:
        """Copy the old file beside it, under a name of its own."""
        number = 1
        while (backup := self.path.with_name(f"{self.path.name}.before-fleet-{number}")).exists():
            number += 1
        shutil.copy2(self.path, backup)
        return backup


def text_of(path: Path) -> str:
    """Return the text of a file; empty if there is none.

    Raises:
        FilePermissionError: This user may not read it.
        ConfigError: It cannot be read.
    """
    try:
        return path.read_text(encoding="utf-8", errors="surrogateescape")
    except FileNotFoundError:
        return ""
    except PermissionError:
        raise FilePermissionError(f"{path}: you may not read it") from None
    except OSError as error:
        raise ConfigError(f"{path}: cannot be read: {error.strerror}") from None


def with_block(text: str, lines: list[str]) -> str:
    """Return `text` with our block, in place of an earlier one; ConfigError if that has no end."""
    block = "".join(f"{line}\n" for line in (BEGIN, *lines, END))
    if found := _BLOCK.search(text):
        rest = _BLOCK.sub("", text[found.end() :])  # one that a hand has doubled
        return text[: found.start()] + block + rest
    if re.search(rf"^{BEGIN}", text, re.MULTILINE):
        raise ConfigError(f"the block that starts with `{BEGIN}` has no line `{END}`; add it")
    gap = "" if not text or text.endswith("\n\n") else "\n" if text.endswith("\n") else "\n\n"
    return text + gap + block


def _make_folder(path: Path) -> None:
    """Make a folder, and those above it, for this user alone; `mkdir` does so for the last only."""
    if not path.exists():
        _make_folder(path.parent)
        path.mkdir(mode=0o700)


def _replace(path: Path, text: str, mode: int) -> None:
    data = text.encode("utf-8", errors="surrogateescape")
    beside = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        with os.fdopen(os.open(beside, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        if path.exists():
            status, own = path.stat(), beside.stat()
            if (status.st_uid, status.st_gid) != (own.st_uid, own.st_gid):
                os.chown(beside, status.st_uid, status.st_gid)
            mode = status.st_mode & 0o7777
        beside.chmod(mode)
        beside.replace(path)
    except OSError as error:
        # a container mounts /etc/hosts, and nobody can rename over that; there is a backup
        if error.errno not in {errno.EBUSY, errno.EXDEV}:
            raise
        path.write_bytes(data)
    finally:
        beside.unlink(missing_ok=True)
