"""Opens MCAP files without an end, which recorders leave that lost their power.

A record is a byte for its kind, its length in 8 bytes, and its content. Behind the data an index
may come, then the footer with its place, 0 for none, and the magic bytes of the beginning.
"""

from collections.abc import Iterator
from io import SEEK_SET, BufferedReader, RawIOBase
from pathlib import Path
from typing import BinaryIO, Final

MAGIC: Final = b"\x89MCAP0\r\n"
"""First and last bytes."""
NO_KIND: Final = 0x00
"""A loss of power may leave zeros at the end of a file."""
MESSAGE: Final = 0x05
"""Kind of a message that is in no chunk."""
CHUNK: Final = 0x06
"""Kind of a chunk of messages."""
DATA_END: Final = 0x0F
"""Kind of the record behind the data."""
HEADER: Final = 9
"""Bytes before the content of a record."""
BEGIN: Final = 16
"""Bytes of the begin of the content of a record, or fewer: times of a chunk, or a message's."""
END: Final = b"\x02" + (20).to_bytes(8, "little") + bytes(20) + MAGIC
"""Footer of a file without an index, and the magic bytes."""


class CutMcap(RawIOBase):
    """A file up to its last whole record, with an end behind it."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self._file = path.open("rb")
        self._data = _end_of_data(self._file)
        self._at = 0

    def readable(self) -> bool:
        """Whether it can be read."""
        return True

    def seekable(self) -> bool:
        """Whether it can be read from any place."""
        return True

    def seek(self, offset: int, whence: int = SEEK_SET) -> int:
        """Go to a place; return it."""
        self._at = offset + (0, self._at, self._data + len(END))[whence]
        return self._at

    def readinto(self, buffer: memoryview) -> int:  # type: ignore[override]
        """Read bytes into a buffer; return how many."""
        if self._at < self._data:
            self._file.seek(self._at)
            read = self._file.read(min(len(buffer), self._data - self._at))
        else:
            behind = self._at - self._data
            read = END[behind : behind + len(buffer)]
        buffer[: len(read)] = read
        self._at += len(read)
        return len(read)

    def close(self) -> None:
        """Close the file."""
        self._file.close()
        super().close()


class CutMcapPath:
    """The path of such a file, as far as a reader needs one."""

    def __init__(self, path: Path) -> None:
        self._path = path

    def open(self, _mode: str) -> BinaryIO:
        """Open the file with an end."""
        return BufferedReader(CutMcap(self._path))


def is_cut(path: Path) -> bool:
    """Whether a file lacks its end."""
    with path.open("rb") as file:
        file.seek(max(0, path.stat().st_size - len(MAGIC)))
        return file.read() != MAGIC


def data_records(file: BinaryIO) -> Iterator[tuple[int, int, int, bytes]]:
    """Yield kind, place, length and begin of the content of each record up to the data's end.

    A file without an end has them up to the last whole one. The reader may move in the file.
    """
    size, at = file.seek(0, 2), len(MAGIC)
    file.seek(0)
    if file.read(at) != MAGIC:
        return
    while True:
        file.seek(at)
        head = file.read(HEADER + BEGIN)
        length = int.from_bytes(head[1:HEADER], "little")
        if len(head) < HEADER or head[0] in {NO_KIND, DATA_END} or at + HEADER + length > size:
            return
        yield head[0], at + HEADER, length, head[HEADER : HEADER + length]
        at += HEADER + length


def _end_of_data(file: BinaryIO) -> int:
    """Return where the last whole record of the data ends."""
    end = len(MAGIC)
    for _, at, length, _ in data_records(file):
        end = at + length
    return end
