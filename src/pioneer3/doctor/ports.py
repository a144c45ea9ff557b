"""Serial ports of this computer, from /sys, /proc and udev, without sending a byte."""

import os
import re
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

from pioneer3.errors import ConfigError
from pioneer3.links.urls import split_url

DEV, SYS, PROC = Path("/dev"), Path("/sys"), Path("/proc")

_VENDORS: Final[Mapping[int, str]] = {
    0x0403: "FTDI",
    0x0557: "ATEN",
    0x067B: "Prolific",
    0x10C4: "Silicon Labs",
    0x15D1: "Hokuyo",
    0x1A86: "WCH",
    0x9710: "MosChip",
}
_CHIPS: Final[Mapping[tuple[int, int], str]] = {
    (0x0403, 0x6001): "FTDI FT232R",
    (0x0403, 0x6010): "FTDI FT2232",
    (0x0403, 0x6011): "FTDI FT4232",
    (0x0403, 0x6014): "FTDI FT232H",
    (0x0403, 0x6015): "FTDI FT-X",
    (0x0557, 0x2008): "ATEN UC-232A",
    (0x067B, 0x2303): "Prolific PL2303",
    (0x10C4, 0xEA60): "Silicon Labs CP210x",
    (0x15D1, 0x0000): "Hokuyo URG laser",
    (0x1A86, 0x5523): "WCH CH341",
    (0x1A86, 0x55D4): "WCH CH9102",
    (0x1A86, 0x7523): "WCH CH340",
    (0x9710, 0x7720): "MosChip MCS7720",
}
HOKUYO: Final = 0x15D1


@dataclass(frozen=True, slots=True)
class PortHolder:
    """A process that has a port open."""

    pid: int
    name: str


@dataclass(frozen=True, slots=True, kw_only=True)
class SerialPort:
    """One serial port as the system knows it.

    `path` is the name to use, the stable one of /dev/serial/by-id where there is one; `device` is
    the present device file, such as `/dev/ttyUSB0`. Ports that are no USB device have no
    `vendor_id` and `product_id`. `socket` is the USB port it is plugged into, as udev's ID_PATH,
    empty where udev has none; `latency_ms` the time for which an FTDI adapter holds bytes back.
    This user may open it if it is `allowed`, and sees some of its `holders`; the kernel prints its
    messages on a `console`.
    """

    path: str
    device: str
    product: str = ""
    manufacturer: str = ""
    vendor_id: int | None = None
    product_id: int | None = None
    serial_number: str = ""
    socket: str = ""
    latency_ms: int | None = None
    allowed: bool = True
    holders: tuple[PortHolder, ...] = ()
    console: bool = False

    @property
    def chip(self) -> str | None:
        """Name of the adapter's chip; `None` for ports that are no USB device."""
        if self.vendor_id is None or self.product_id is None:
            return None
        vendor = _VENDORS.get(self.vendor_id, self.manufacturer or "unknown maker")
        named = f"{vendor} {self.vendor_id:04x}:{self.product_id:04x}"
        return _CHIPS.get((self.vendor_id, self.product_id), named)

    @property
    def is_hokuyo(self) -> bool:
        """Whether this is a Hokuyo laser and not an adapter."""
        return self.vendor_id == HOKUYO


def list_ports() -> tuple[SerialPort, ...]:
    """Return the serial ports of this computer, USB adapters first."""
    import serialx  # costs 100 ms

    ports = [
        _examined(
            SerialPort(
                path=found.device,
                device=found.resolved_device,
                product=found.product or "",
                manufacturer=found.manufacturer or "",
                vendor_id=found.vid,
                product_id=found.pid,
                serial_number=found.serial_number or "",
            )
        )
        for found in serialx.list_serial_ports()
    ]
    return tuple(sorted(ports, key=lambda port: (port.vendor_id is None, port.device)))


def find_port(url: str) -> SerialPort | None:
    """Return the serial port of `url`, `None` for other links; ConfigError if it names no port."""
    scheme, path = split_url(url)
    if scheme != "serial":
        return None
    device = os.path.realpath(path)
    known = next((port for port in list_ports() if port.device == device), None)
    return known or _examined(SerialPort(path=path, device=device))


def is_serial(url: str) -> bool:
    """Return whether `url` names a serial port; false for an invalid URL."""
    try:
        return split_url(url)[0] == "serial"
    except ConfigError:
        return False


def _examined(port: SerialPort) -> SerialPort:
    return replace(
        port,
        socket=socket_of(port.device),
        latency_ms=latency_of(port.device),
        allowed=not Path(port.device).exists() or os.access(port.device, os.R_OK | os.W_OK),
        holders=tuple(holders_of(port.device)),
        console=is_console(port.device),
    )


def latency_of(device: str, sys: Path = SYS) -> int | None:
    """Return an FTDI adapter's latency timer [ms]; `None` for other ports."""
    text = _text_of(latency_file(device, sys)).strip()
    return int(text) if text.isdecimal() else None


def latency_file(device: str, sys: Path = SYS) -> Path:
    """Return the file in which the latency timer of `device` is read and set."""
    return sys / "bus/usb-serial/devices" / Path(device).name / "latency_timer"


def socket_of(device: str) -> str:
    """Return the ID_PATH that udev knows `device` by, such as `pci-0000:00:14.0-usb-0:2:1.0`."""
    with suppress(OSError):
        for link in sorted((DEV / "serial/by-path").iterdir()):
            if os.path.realpath(link) == device:
                return re.sub(r"-port\d+$", "", link.name)
    return ""


def is_console(device: str, sys: Path = SYS) -> bool:
    """Return whether the kernel prints its messages on `device`."""
    active = _text_of(sys / "class/tty/console/active").split()
    return Path(device).parent == DEV and Path(device).name in active


def holders_of(device: str, proc: Path = PROC, me: int | None = None) -> Iterator[PortHolder]:
    """Yield the other processes that have `device` open, as far as this user may see.

    A process at the far end of a pseudo terminal is the device, not another user of it.
    """
    me = os.getpid() if me is None else me
    processes: list[int] = []
    with suppress(OSError):
        processes += (int(entry.name) for entry in proc.iterdir() if entry.name.isdecimal())
    for process in sorted(processes):
        if process != me and _holds(proc / str(process), device):
            yield PortHolder(process, _name_of(proc / str(process)))


def _holds(process: Path, device: str) -> bool:
    open_files = dict(_open_files(process))
    if device not in open_files.values():
        return False
    masters = (fd for fd, path in open_files.items() if path.endswith("/ptmx"))
    return not any(_is_far_end(process / "fdinfo" / fd, device) for fd in masters)


def _open_files(process: Path) -> Iterator[tuple[str, str]]:
    """Yield number and path of each open file of a process, as far as they can be read."""
    try:
        numbers = [entry.name for entry in (process / "fd").iterdir()]
    except OSError:
        return
    for number in numbers:
        with suppress(OSError):
            yield number, str((process / "fd" / number).readlink())


def _is_far_end(fdinfo: Path, device: str) -> bool:
    wanted, lines = ["tty-index:", Path(device).name], _text_of(fdinfo).splitlines()
    return device.startswith("/dev/pts/") and any(line.split() == wanted for line in lines)


def _text_of(path: Path) -> str:
    """Return the text of a file of the kernel's, empty where it cannot be read."""
    try:
        return path.read_text("ascii")
    except (OSError, UnicodeDecodeError):
        return ""


def _name_of(process: Path) -> str:
    try:
        return (process / "comm").read_text("utf-8", errors="replace").strip()
    except OSError:
        return "?"
