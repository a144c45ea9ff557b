"""A network of namespaces: each host has one, and a switch in this process joins them.

The kernel's own emulation (netem) is a module that many machines lack. The hosts' cards are TAP
devices, whose other ends are files: the switch reads frames from one and writes them to another,
later, or not at all. ARP works, so that a host that is off is told as such.
"""

import ctypes
import fcntl
import heapq
import itertools
import os
import random
import selectors
import struct
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from types import TracebackType
from typing import Final, Self

CARD: Final = "eth0"
LONGEST_FRAME: Final = 65536
_CLONE_NEWNET: Final = 0x40000000
_TUNSETIFF: Final = 0x400454CA
_IFF_TAP, _IFF_NO_PI = 0x0002, 0x1000


@dataclass
class Cable:
    """The connection of one host to the switch; its faults may be changed at any time.

    Attributes:
        delay: Of each frame to and from the host [s].
        loss: Part of the frames that vanish, each way.
        plugged: Whether anything passes.
    """

    file: int
    delay: float = 0.0
    loss: float = 0.0
    plugged: bool = True
    addresses: set[bytes] = field(default_factory=set)

    def passes(self, chance: random.Random) -> bool:
        """Return whether the next frame arrives."""
        return self.plugged and chance.random() >= self.loss


class Switch:
    """Passes Ethernet frames between cables, in a thread of its own."""

    def __init__(self, seed: int = 0) -> None:
        self.cables: list[Cable] = []
        self._chance = random.Random(seed)
        self._waiting: list[tuple[float, int, Cable, bytes]] = []
        self._number = itertools.count()
        self._selector = selectors.DefaultSelector()
        self._wake, self._woken = os.pipe()
        self._selector.register(self._wake, selectors.EVENT_READ)
        self._thread = threading.Thread(target=self._serve, name="switch")

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        os.write(self._woken, b"q")
        self._thread.join()
        for file in (*(cable.file for cable in self.cables), self._wake, self._woken):
            os.close(file)
        self._selector.close()

    def plug_in(self, process: int) -> Cable:
        """Give the namespace of `process` a network card, and return its cable."""
        with ThreadPoolExecutor(1) as pool:  # only that thread enters the namespace
            cable = Cable(pool.submit(_tap, process).result())
        self.cables.append(cable)
        self._selector.register(cable.file, selectors.EVENT_READ, cable)
        os.write(self._woken, b"n")
        return cable

    def _serve(self) -> None:
        while True:
            for key, _ in self._selector.select(self._pause()):
                if key.data is None:
                    if b"q" in os.read(self._wake, 100):
                        return
                else:
                    self._receive(key.data)
            while self._waiting and self._waiting[0][0] <= time.monotonic():
                _, _, cable, frame = heapq.heappop(self._waiting)
                _send(cable, frame)

    def _pause(self) -> float | None:
        return max(self._waiting[0][0] - time.monotonic(), 0.0) if self._waiting else None

    def _receive(self, source: Cable) -> None:
        try:
            frame = os.read(source.file, LONGEST_FRAME)
        except OSError:  # the host is gone
            return
        target, sender = frame[:6], frame[6:12]
        source.addresses.add(sender)
        known = [cable for cable in self.cables if target in cable.addresses]
        for cable in known or self.cables:
            if cable is source or not (source.passes(self._chance) and cable.passes(self._chance)):
                continue
            delay = source.delay + cable.delay
            if delay:
                due = time.monotonic() + delay
                heapq.heappush(self._waiting, (due, next(self._number), cable, frame))
            else:
                _send(cable, frame)


def _send(cable: Cable, frame: bytes) -> None:
    try:
        os.write(cable.file, frame)
    except OSError:  # its host is gone, or its card is down: the frame is lost
        return


def _tap(process: int) -> int:
    """Enter the network of `process` and make its card; return the other end."""
    libc = ctypes.CDLL(None, use_errno=True)
    with open(f"/proc/{process}/ns/net", "rb") as namespace:  # noqa: PTH123  its number is needed
        if libc.setns(namespace.fileno(), _CLONE_NEWNET) != 0:
            raise OSError(ctypes.get_errno(), "cannot enter the host's network")
    file = os.open("/dev/net/tun", os.O_RDWR | os.O_NONBLOCK)
    wanted = struct.pack("16sH22x", CARD.encode(), _IFF_TAP | _IFF_NO_PI)
    fcntl.ioctl(file, _TUNSETIFF, wanted)
    return file
