"""Serial ports, real and pseudo, and the reasons for a failure to open."""

import errno
import os
from array import array
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from stat import S_IRGRP
from typing import Final

from pioneer3.errors import LinkError, PortBusyError, PortNotFoundError, PortPermissionError
from pioneer3.links.stream import StreamLink
from pioneer3.text import state_folder

try:
    import fcntl
    import grp
    import termios
    import tty
    from termios import error as TerminalError  # noqa: N812
except ImportError:  # Windows
    fcntl = grp = termios = tty = None  # type: ignore[assignment]
    TerminalError = OSError  # type: ignore[misc, assignment]

SPEEDS: Final = (9600, 19200, 38400, 57600, 115200)
"""Speeds of ARCOS robots [baud] (protocol.md 1.1)."""


async def open_serial(path: str, first_speed: int | None = None) -> StreamLink:
    """Open the serial port at `path`, at `first_speed` [baud] or the last working speed.

    Raises:
        PortNotFoundError, PortPermissionError, PortBusyError, LinkError: with a remedy.
    """
    import serialx  # costs 100 ms

    first = first_speed or remembered_speed(path) or SPEEDS[0]
    speeds = (first, *(s for s in SPEEDS if s != first))
    try:
        reader, writer = await serialx.open_serial_connection(path, baudrate=first, exclusive=True)
    except (OSError, serialx.SerialException) as error:
        raise explain_open_error(path, error) from None

    async def change_speed(baud: int) -> None:
        try:
            await writer.transport.reconfigure_port(baudrate=baud)
        except (OSError, ValueError, TerminalError, serialx.SerialException) as error:
            raise LinkError(f"{path}: cannot be set to {baud} baud: {error}") from None

    return StreamLink(f"serial:{path}", reader, writer, speeds=speeds, change_speed=change_speed)


def explain_open_error(path: str, error: Exception) -> LinkError:
    """Return `error` of the operating system as a link error with a remedy."""
    code = error.errno if isinstance(error, OSError) else None
    is_file = os.name == "posix"  # COM3 is no file
    if code in {errno.ENOENT, errno.ENXIO, errno.ENODEV} or (is_file and not Path(path).exists()):
        return PortNotFoundError(
            f"{path}: no such port; is the cable plugged in? `pioneer3 find-port` lists what is"
        )
    if code in {errno.EACCES, errno.EPERM}:
        return PortPermissionError(f"{path}: permission denied; {how_to_get_permission(path)}")
    if code in {errno.EBUSY, errno.EAGAIN, errno.EWOULDBLOCK}:
        return PortBusyError(f"{path}: busy; another program has it open (see: fuser {path})")
    if code in {errno.ENOTTY, errno.EINVAL} or (is_file and not Path(path).is_char_device()):
        return LinkError(f"{path}: not a serial port")
    return LinkError(f"{path}: {error}")


def how_to_get_permission(path: str) -> str:
    """Return the command that gives this user the right to open `path`."""
    if grp is None:
        return "another program may have it open"
    group = "dialout"
    with suppress(OSError, KeyError):
        status = os.stat(path)  # noqa: PTH116
        group = grp.getgrgid(status.st_gid).gr_name
        if group == "root" or not status.st_mode & S_IRGRP:
            return "only root may open it; is this the robot's port? See: pioneer3 find-port"
    return f"run: sudo usermod -aG {group} $USER, then log out and in again"


def state_file(environment: Mapping[str, str] = os.environ) -> Path:
    """Return the file of the last working speeds."""
    return state_folder(environment) / "speeds"


def remembered_speed(path: str) -> int | None:
    """Return the last working speed of `path` [baud], if any.

    A robot keeps its speed after its host has crashed (facts.md 14.1).
    """
    try:
        lines = state_file().read_text("utf-8").splitlines()
    except (OSError, UnicodeDecodeError):
        return None
    known = dict(line.rsplit(" ", 1) for line in lines if " " in line)
    text = known.get(path, "")
    return int(text) if text.isdecimal() and int(text) in SPEEDS else None


def remember_speed(path: str, baud: int) -> None:
    """Store `baud` as the working speed of `path`; a read-only home is no error."""
    if remembered_speed(path) == baud:
        return
    file = state_file()
    try:
        old = file.read_text("utf-8").splitlines() if file.exists() else []
        lines = [line for line in old if line.rsplit(" ", 1)[0] != path]
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text("\n".join([*lines, f"{path} {baud}"]) + "\n", "utf-8")
    except (OSError, UnicodeDecodeError):
        return


@dataclass(frozen=True, slots=True)
class PtyPair:
    """Both ends of a pseudo terminal in raw mode, as file descriptors, and the path of the port.

    The end of the host, `slave`, is kept open, so that the port outlives a host.
    """

    master: int
    slave: int
    path: str


def make_pty() -> PtyPair:
    """Make a pseudo terminal, whose ends the caller closes; LinkError if none is to be had."""
    if tty is None:
        raise LinkError("this system has no pseudo terminals; use TCP")
    try:
        master, slave = os.openpty()
    except OSError as error:
        raise LinkError(f"cannot make a pseudo terminal: {error.strerror}") from None
    tty.setraw(slave)
    return PtyPair(master, slave, os.ttyname(slave))


def terminal_speed(terminal: int) -> int | None:
    """Return the output speed of an open terminal [baud]; `None` for 0, or if it is closed."""
    try:
        code = termios.tcgetattr(terminal)[5]
    except (OSError, TerminalError):
        return None
    return _speeds_by_code().get(code) or None


def unread(terminal: int) -> int:
    """Return the number of bytes that have come to an open terminal and wait to be read."""
    count = array("i", [0])
    fcntl.ioctl(terminal, termios.FIONREAD, count)
    return count[0]


def forget_unread(terminal: int) -> None:
    """Drop the bytes that have come to an open terminal and wait to be read."""
    termios.tcflush(terminal, termios.TCIFLUSH)


@cache
def _speeds_by_code() -> Mapping[int, int]:
    names = (name for name in dir(termios) if name[0] == "B" and name[1:].isdecimal())
    return {getattr(termios, name): int(name[1:]) for name in names}
