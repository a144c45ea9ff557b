"""The packets of a laser's sweep, 0x60 and 0x61 (arcos.md 5.13).

:func:`packets` tells what they are. :class:`SweepFrames` gives the same bytes, many times faster:
all frames of a sweep lie in one buffer, of which only readings, pose and checksums change.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from pioneer3.arcos.packet import encode
from pioneer3.arcos.reports import LaserReading, SimLaser, SimLaserExtended, to_payload

Words = NDArray[np.uint16]

PER_PACKET = 32
"""Readings in a packet; so 181 make six, as from AMRISim."""
NOTHING_MM = 0x7FFF
"""Hosts take this and more for "nothing there"."""
POSE = 3
"""Numbers of the robot's pose in a packet 0x60: x, y [mm], heading [deg]."""


def packets(
    pose: Sequence[int], ranges_mm: Sequence[int], *, extended: bool
) -> list[SimLaser] | list[SimLaserExtended]:
    """Return the packets of one sweep.

    Args:
        pose: The robot's x, y [mm] and heading [deg], each within 16 bits; 0x61 has none.
        ranges_mm: Counter-clockwise, 0 to 0xFFFF.
        extended: 0x61 rather than 0x60.
    """
    total = len(ranges_mm)
    parts = [(at, tuple(ranges_mm[at : at + PER_PACKET])) for at in range(0, total, PER_PACKET)]
    if extended:
        return [
            SimLaserExtended(
                total=total, first=at, readings=tuple(map(LaserReading, part)), laser=0, flags=0
            )
            for at, part in parts
        ]
    x_mm, y_mm, heading_deg = pose
    return [
        SimLaser(
            x_mm=x_mm, y_mm=y_mm, heading_deg=heading_deg, total=total, first=at, ranges_mm=part
        )
        for at, part in parts
    ]


class SweepFrames:
    """The frames of sweeps of `total` readings: call :meth:`fill` for each.

    Where readings and pose lie is taken from :func:`packets`. The checksum adds up big-endian
    words, so a byte that changes from 0 to b adds b, or 256 b in front of a word.
    """

    def __init__(self, total: int, *, extended: bool) -> None:
        blank = [encode(to_payload(p)) for p in packets((0, 0, 0), (0,) * total, extended=extended)]
        places = [_places(len(frame), extended=extended) for frame in blank]
        starts = np.cumsum([0, *(len(frame) for frame in blank)])
        self._buffer = np.frombuffer(b"".join(blank), dtype=np.uint8).copy()
        self._words = np.zeros(POSE + total, dtype="<u2")
        self._source = np.concatenate(
            [_source(number, len(at), extended=extended) for number, at in enumerate(places)]
        )
        low = np.concatenate([start + at for start, at in zip(starts, places, strict=False)])
        self._at = np.stack([low, low + 1], axis=1).ravel()
        # payloads begin at byte 3 of a frame: there, odd places in a frame are the fronts of words
        inside = np.concatenate(places)
        front = np.stack([inside, inside + 1], axis=1).ravel() % 2 == 1
        self._weights = np.where(front, 256, 1).astype(np.uint16)
        self._firsts = np.cumsum([0, *(2 * len(at) for at in places[:-1])])
        ends = starts[1:]
        self._checks = np.stack([ends - 2, ends - 1], axis=1).ravel()
        self._sums = self._buffer[self._checks].view(">u2").astype(np.uint16)

    def fill(self, pose: Sequence[int], ranges_mm: Words) -> bytes:
        """Return the frames of one sweep, as :func:`packets` would have them.

        Args:
            pose: The robot's x, y [mm] and heading [deg], each as 16 bits without sign.
            ranges_mm: Counter-clockwise, shape (total,).
        """
        self._words[:POSE] = pose
        self._words[POSE:] = ranges_mm
        changed = self._words[self._source].view(np.uint8)
        self._buffer[self._at] = changed
        # no byte is XORed: the odd last one of a payload is a flag that stays 0
        added = np.add.reduceat(changed * self._weights, self._firsts, dtype=np.uint16)
        self._buffer[self._checks] = (self._sums + added).astype(">u2").view(np.uint8)
        return self._buffer.tobytes()


def _places(size: int, *, extended: bool) -> NDArray[np.intp]:
    """Return where in a frame of `size` bytes its changing 16-bit numbers begin."""
    if extended:
        return np.arange(9, size - 4, 5)
    return np.concatenate([np.arange(4, 10, 2), np.arange(15, size - 2, 2)])


def _source(packet: int, count: int, *, extended: bool) -> NDArray[np.intp]:
    """Return which of pose and readings the `count` changing numbers of one packet are."""
    first = POSE + packet * PER_PACKET
    if extended:
        return np.arange(first, first + count)
    return np.concatenate([np.arange(POSE), np.arange(first, first + count - POSE)])
