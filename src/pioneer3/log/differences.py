"""Bytes as differences and in planes, which take less room: neighbouring readings are alike.

Each byte is told by its difference to the one `step` bytes before, modulo 256. Planes have the
first bytes of all readings, then the second ones. Bytes of a link and the scans made of them are
alike this way, too, and a chunk has them side by side.
"""

from typing import Final

STEPS: Final = (2, 3)
"""Sizes of a reading of lasers [bytes]."""
WIDEST: Final = 8
"""Largest size of a reading [bytes]."""
SAMPLE: Final = 16384
"""So many bytes show which step saves most."""


def differences(data: bytes, step: int) -> bytes:
    """Return bytes as differences."""
    import numpy as np  # loads slowly, and a robot without a laser needs none of it

    whole = np.frombuffer(data, np.uint8)
    result = whole.copy()
    result[step:] -= whole[:-step]
    return result.tobytes()


def sums(data: bytes, step: int) -> bytes:
    """Return the bytes of differences.

    Raises:
        ValueError: The step is none.
    """
    if step < 1:
        raise ValueError(f"differences over {step} bytes")
    import numpy as np

    rows = -(-len(data) // step)
    padded = np.zeros((rows, step), np.uint8)
    padded.reshape(-1)[: len(data)] = np.frombuffer(data, np.uint8)
    return np.add.accumulate(padded, axis=0, dtype=np.uint8).tobytes()[: len(data)]


def planes(data: bytes, size: int) -> bytes:
    """Return the bytes of readings of a size in planes."""
    return b"".join(data[place::size] for place in range(size))


def joined_planes(data: bytes, size: int) -> bytes:
    """Return the bytes of planes.

    Raises:
        ValueError: The size is none.
    """
    if not 1 <= size <= WIDEST:
        raise ValueError(f"planes of {size} bytes")
    joined, at = bytearray(len(data)), 0
    for place in range(size):
        length = len(range(place, len(data), size))
        joined[place::size] = data[at : at + length]
        at += length
    return bytes(joined)


def best_step(data: bytes) -> int:
    """Return the step whose differences take the least room; 0 where that is the bytes as such."""
    import zstandard

    packer, sample = zstandard.ZstdCompressor(level=1), data[:SAMPLE]
    packed = {0: sample} | {step: planes(differences(sample, step), step) for step in STEPS}
    return min(packed, key=lambda step: len(packer.compress(packed[step])))
