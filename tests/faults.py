"""Faults of the cable in memory, each a `Fault` of `pioneer3.links.memory`."""

from collections.abc import Iterable
from dataclasses import dataclass
from random import Random


def bytewise(data: bytes) -> Iterable[bytes]:
    """Deliver byte by byte."""
    return (data[i : i + 1] for i in range(len(data)))


@dataclass
class Noise:
    """A fault that replaces a share of the bytes by random ones, and drops a share."""

    random: Random
    corrupt: float = 0.0
    drop: float = 0.0

    def __call__(self, data: bytes) -> Iterable[bytes]:
        """Deliver the surviving bytes in one piece."""
        kept = bytearray()
        for byte in data:
            if self.random.random() < self.drop:
                continue
            hit = self.random.random() < self.corrupt
            kept.append(self.random.randrange(256) if hit else byte)
        return (bytes(kept),) if kept else ()
