"""Files to and from many computers: whole or not at all.

A file arrives under a temporary name beside its own, is compared by size and SHA-256, and only
then takes its name. Modes are kept. Folders are copied file by file. Names and sizes that a robot
tells are not believed: what it sends stays below its own folder, and within a limit.
"""

import asyncio
import hashlib
import os
import secrets
import shlex
import stat
from collections.abc import AsyncIterator, Iterable, Iterator, Sequence
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Any, Final

from pioneer3.errors import ConfigError, RemoteError
from pioneer3.fleet.run import Done, Outcome, on_each, output_of
from pioneer3.fleet.spec import FleetRobot
from pioneer3.fleet.ssh import LOGIN, Login, asyncssh_module, connect

if TYPE_CHECKING:
    import asyncssh

BLOCK: Final = 1 << 18
"""Piece of a file that is read at once [bytes]."""
MOST: Final = 4e9
"""No robot may send more at once [bytes]."""
MOST_FILES: Final = 100_000
"""Nor more files."""
DEEPEST: Final = 64
"""Nor folders that lie in more others."""


@dataclass(frozen=True, slots=True)
class RemoteFile:
    """A file of a robot: its path there, the parts of its name here, and its size [bytes]."""

    path: str
    parts: tuple[str, ...]
    size: int


@dataclass(frozen=True, slots=True)
class Piece:
    """A file to copy: where it is here, and its name below the destination."""

    path: Path
    name: str


async def push(
    robots: Iterable[FleetRobot], files: Sequence[Path], destination: str, *, login: Login = LOGIN
) -> tuple[Outcome, ...]:
    """Copy files and folders to all computers at once.

    The destination there is relative to the user's home. It is a folder if it ends in a slash, is
    one already, or there are several `files`. Raises ConfigError if a file is missing here.
    """
    pieces = tuple(_pieces(files))
    total = sum(piece.path.stat().st_size for piece in pieces)

    async def work(robot: FleetRobot) -> Done:
        async with connect(robot, login) as connection, _sftp(connection) as sftp:
            into_folder = (
                destination.endswith("/")
                or len(files) > 1
                or files[0].is_dir()
                or await sftp.isdir(_home(destination))
            )
            for piece in pieces:
                name = f"{destination.rstrip('/') or '/'}/{piece.name}"
                target = _home(name if into_folder else destination)
                await _put(connection, sftp, piece.path, target)
        return Done(said=f"{_count(len(pieces))}, {_size(total)}")

    return await on_each(robots, work)


async def put_file(connection: "asyncssh.SSHClientConnection", source: Path, target: str) -> None:
    """Copy one file over an open connection, whole, or else not at all and with a RemoteError."""
    async with _sftp(connection) as sftp:
        await _put(connection, sftp, source, target)


async def pull(
    robots: Iterable[FleetRobot], paths: Sequence[str], folder: Path, *, login: Login = LOGIN
) -> tuple[Outcome, ...]:
    """Copy files and folders from all computers at once, each into a folder of its robot's name.

    `paths` there are relative to the user's home, with `*`, `?`, `[...]`; robots' folders are made
    in `folder` here.
    """

    async def work(robot: FleetRobot) -> Done:
        async with connect(robot, login) as connection, _sftp(connection) as sftp:
            found = await _all(_found(sftp, _home(path)) for path in paths)
            root = folder / robot.name
            placed = [(each, _place(root, each.parts)) for each in found]
            for each, place in placed:
                await _get(connection, sftp, each, place)
        return Done(said=f"{_count(len(found))}, {_size(sum(each.size for each in found))}")

    return await on_each(robots, work)


def _pieces(files: Sequence[Path]) -> Iterator[Piece]:
    if not files:
        raise ConfigError("no file is given")
    for file in files:
        if file.is_file():
            yield Piece(file, file.name)
        elif file.is_dir():
            root = file.resolve()
            inside = sorted(path for path in root.rglob("*") if path.is_file())
            for path in inside:
                yield Piece(path, f"{root.name}/{path.relative_to(root).as_posix()}")
        else:
            raise ConfigError(f"{file}: there is no such file here")


def _home(path: str) -> str:
    """Return `path` for SFTP, for which all that is relative is relative to the home."""
    return path.removeprefix("~/") if path != "~" else "."


@asynccontextmanager
async def _sftp(connection: "asyncssh.SSHClientConnection") -> "AsyncIterator[Any]":
    """Open a file transfer; its errors are told in words."""
    ssh = asyncssh_module()
    try:
        async with connection.start_sftp_client() as client:
            yield client
    except ssh.SFTPError as error:
        if isinstance(error, ssh.SFTPConnectionLost | ssh.SFTPNoConnection):
            raise ConnectionAbortedError(str(error)) from error  # `connect` tells it in words
        raise RemoteError(str(error.reason)) from None
    except ssh.ChannelOpenError as error:
        raise RemoteError(f"its ssh server offers no file transfer: {error}") from None


async def _put(connection: Any, sftp: Any, source: Path, target: str) -> None:
    """Copy one file there; raises as :func:`put_file` does."""
    ssh = asyncssh_module()
    place = PurePosixPath(target)
    temporary = str(place.with_name(f".{place.name}.{secrets.token_hex(4)}.part"))
    digest = hashlib.sha256()
    here = await asyncio.to_thread(source.stat)
    try:
        await sftp.makedirs(str(place.parent), exist_ok=True)
        async with sftp.open(temporary, "wb") as file:
            with source.open("rb") as ours:
                while block := await asyncio.to_thread(ours.read, BLOCK):
                    digest.update(block)
                    await file.write(block)
        await sftp.chmod(temporary, stat.S_IMODE(here.st_mode))
        await _check(connection, temporary, digest.hexdigest(), f"{target}: it was damaged")
        await sftp.posix_rename(temporary, target)
    except (ssh.SFTPError, RemoteError) as error:
        why = await _why(sftp, place, error, here.st_size)
        with suppress(ssh.SFTPError):
            await sftp.remove(temporary)
        raise RemoteError(why) from None
    except asyncio.CancelledError:
        with suppress(ssh.Error, OSError, TimeoutError):
            async with asyncio.timeout(1.0):
                await sftp.remove(temporary)
        raise


async def _why(sftp: Any, place: PurePosixPath, error: Exception, size: int) -> str:
    """Return the reason that a file did not arrive; the protocol has one word for most."""
    ssh = asyncssh_module()
    if isinstance(error, RemoteError):
        return str(error)
    with suppress(ssh.SFTPError, AttributeError):
        disk = await sftp.statvfs(str(place.parent))
        if disk.bavail * disk.frsize < min(size, BLOCK):
            free = _size(disk.bavail * disk.frsize)
            return f"{place}: the disk there is full ({free} free); the old file is unchanged"
    if isinstance(error, ssh.SFTPPermissionDenied):
        return f"{place}: this user may not write there"
    return f"{place}: {getattr(error, 'reason', error)}"


async def _all(findings: Iterable[AsyncIterator[RemoteFile]]) -> list[RemoteFile]:
    """Return all files that are found; RemoteError if they are too many, or too large."""
    found: list[RemoteFile] = []
    total = 0
    for finding in findings:
        async for each in finding:
            found.append(each)
            total += each.size
            if len(found) > MOST_FILES:
                raise RemoteError(f"more than {MOST_FILES} files: name fewer")
    if total > MOST:
        raise RemoteError(f"{_size(total)}, which is more than {_size(MOST)}: name fewer files")
    return found


def _part(name: str) -> str:
    """Return a name that a robot tells, for a path here; RemoteError if it names a place."""
    if name in {"", ".", ".."} or not {"/", os.sep, "\0"}.isdisjoint(name):
        raise RemoteError(f"it tells of a file of the name {name!r}: nothing is copied")
    return name


def _place(root: Path, parts: Sequence[str]) -> Path:
    """Return the place of a robot's file; RemoteError if it would not lie below `root`."""
    place = root.joinpath(*parts)
    if not place.parent.resolve().is_relative_to(root.resolve()):
        raise RemoteError(f"{place}: a link there leads out of {root}: nothing is copied")
    return place


async def _get(connection: Any, sftp: Any, found: RemoteFile, target: Path) -> None:
    """Copy one file here; RemoteError if it did not arrive, and the one before is unchanged."""
    path = found.path
    temporary = target.with_name(f".{target.name}.{secrets.token_hex(4)}.part")
    digest = hashlib.sha256()
    size = 0
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        async with sftp.open(path, "rb") as source:
            with temporary.open("wb") as file:
                while block := await source.read(BLOCK):
                    await asyncio.to_thread(file.write, block)
                    digest.update(block)
                    size += len(block)
                    if size > found.size:
                        raise RemoteError(f"{path}: it grew while it was copied; try again")
            attributes = await source.stat()
        await _check(connection, path, digest.hexdigest(), f"{path}: it changed or was damaged")
        temporary.chmod(stat.S_IMODE(attributes.permissions) & 0o777)
        temporary.replace(target)
    except OSError as error:
        raise RemoteError(f"{target}: cannot be written here: {error.strerror or error}") from None
    finally:
        with suppress(OSError):
            temporary.unlink()


async def _found(sftp: Any, path: str) -> AsyncIterator[RemoteFile]:
    """Yield the files that `path` means there."""
    ssh, matches = asyncssh_module(), [path]
    if any(letter in path for letter in "*?["):
        try:
            matches = await sftp.glob(path)
        except (ssh.SFTPNoSuchFile, ssh.SFTPNoSuchPath):
            raise RemoteError(f"{path}: no such file there") from None
    for match in matches:
        if not await sftp.exists(match):
            raise RemoteError(f"{path}: no such file there")
        name = PurePosixPath(await sftp.realpath(match)).name
        if not name:
            raise RemoteError(f"{path}: that is all of the disk there; name a folder")
        if await sftp.isdir(match):
            async for below in _below(sftp, match, (_part(name),)):
                yield below
        else:
            yield RemoteFile(match, (_part(name),), await sftp.getsize(match) or 0)


async def _below(sftp: Any, folder: str, parts: tuple[str, ...]) -> AsyncIterator[RemoteFile]:
    if len(parts) > DEEPEST:
        raise RemoteError(f"{folder}: more than {DEEPEST} folders in each other")
    async for entry in sftp.scandir(folder):
        if entry.filename in {".", ".."}:
            continue
        path, below = f"{folder}/{entry.filename}", (*parts, _part(entry.filename))
        kind = stat.S_IFMT(entry.attrs.permissions or 0)
        if kind == stat.S_IFDIR:
            async for each in _below(sftp, path, below):
                yield each
        elif kind == stat.S_IFREG:
            yield RemoteFile(path, below, entry.attrs.size or 0)


async def _check(connection: Any, path: str, sha256: str, problem: str) -> None:
    """Compare a file there with the one here; RemoteError if they differ."""
    line = await output_of(connection, f"sha256sum -- {shlex.quote(path)}")
    if line.lstrip("\\").split(" ", 1)[0] != sha256:
        raise RemoteError(f"{problem} while it was copied; try again")


def _count(number: int) -> str:
    return "1 file" if number == 1 else f"{number} files"


def _size(number: float) -> str:
    for unit in ("B", "kB", "MB"):
        if number < 1000:
            return f"{number:.3g} {unit}"
        number /= 1000
    return f"{number:.3g} GB"
