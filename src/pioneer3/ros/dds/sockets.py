"""Keeps DDS to the network interfaces that were asked for.

Cyclone DDS sends by these only, but it receives by sockets that are open to all interfaces, and has
no setting for it. On Linux a filter in the kernel drops whatever comes in by another interface.
"""

import os
import socket
import struct
import sys
from collections.abc import Iterable, Iterator
from contextlib import closing, suppress
from ctypes import addressof, create_string_buffer
from pathlib import Path
from typing import Final

ANY: Final = "0.0.0.0"
OWN: Final = Path("/proc/self/fd")
LOOPBACK: Final = "lo"
SO_ATTACH_FILTER: Final = 26
"""`asm-generic/socket.h`."""
SIOCGIFADDR: Final = 0x8915
LOAD_INTERFACE: Final = (0x20, 0, 0, 0xFFFF_F008)
"""Load the index of the interface: `SKF_AD_OFF + SKF_AD_IFINDEX` of `linux/filter.h`."""
EQUAL, RETURN = 0x15, 0x06
WHOLE: Final = 0xFFFF_FFFF
INSTRUCTION: Final = struct.Struct("HBBI")
PROGRAM: Final = struct.Struct("HP")
REQUEST: Final = struct.Struct("256s")
ADDRESS: Final = slice(20, 24)


def restrict(ports: range, interfaces: Iterable[str]) -> None:
    """Let the sockets of a domain, which are open at `ports`, receive by some interfaces only.

    These are given by name or address; loopback is always among them. Raises OSError if this system
    cannot, or it has no such interface.
    """
    if sys.platform != "linux":
        raise OSError("only Linux can filter")
    indexes = {index_of(each) for each in (LOOPBACK, *interfaces)}
    for each in open_to_all(ports):
        with closing(each):
            allow(each, indexes)


def allow(receiver: socket.socket, indexes: Iterable[int]) -> None:
    """Let a socket receive by the interfaces with these indexes only; OSError if that cannot be."""
    wanted = sorted(indexes)
    steps = [LOAD_INTERFACE]
    for number, index in enumerate(wanted):
        steps.append((EQUAL, len(wanted) - number, 0, index))
    steps += [(RETURN, 0, 0, 0), (RETURN, 0, 0, WHOLE)]
    code = create_string_buffer(b"".join(INSTRUCTION.pack(*step) for step in steps))
    program = PROGRAM.pack(len(steps), addressof(code))
    receiver.setsockopt(socket.SOL_SOCKET, SO_ATTACH_FILTER, program)


def open_to_all(ports: range) -> Iterator[socket.socket]:
    """Yield duplicates, to be closed, of our sockets that receive at `ports` by all interfaces."""
    for each in list(OWN.iterdir()):
        with suppress(OSError):  # closed meanwhile
            duplicate = os.dup(int(each.name))
            try:
                found = socket.socket(fileno=duplicate)
            except OSError:  # no socket
                os.close(duplicate)
                continue
            if _receives(found, ports):
                yield found
            else:
                found.close()


def index_of(interface: str) -> int:
    """Return the index of a network interface by its name or address; OSError if there is none."""
    for index, name in socket.if_nameindex():
        if interface in {name, address_of(name)}:
            return index
    raise OSError(f"no network interface {interface!r}")


def address_of(name: str) -> str:
    """Return the IPv4 address of an interface; empty without one."""
    from fcntl import ioctl  # Windows has none

    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as any_socket:
        try:
            found = ioctl(any_socket, SIOCGIFADDR, REQUEST.pack(name.encode()))
        except OSError:
            return ""
    return socket.inet_ntoa(found[ADDRESS])


def _receives(found: socket.socket, ports: range) -> bool:
    if (found.family, found.type) != (socket.AF_INET, socket.SOCK_DGRAM):
        return False
    host, port = found.getsockname()
    return host == ANY and port in ports
