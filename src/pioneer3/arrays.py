"""Types of numpy's arrays, by their elements; docstrings tell the shapes."""

import mmap
import sys
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

Float = NDArray[np.float64]
Float32 = NDArray[np.float32]
Int = NDArray[np.int64]
Int32 = NDArray[np.int32]
UInt8 = NDArray[np.uint8]
UInt16 = NDArray[np.uint16]
Bool = NDArray[np.bool_]


def sparse(shape: tuple[int, ...], kind: type[np.generic]) -> NDArray[Any]:
    """Return zeros that take memory where they are written, to the nearest pages.

    With numpy's own a write takes 2 MB where the system has huge pages, with all that is beside it.
    """
    if sys.platform != "linux":
        return np.zeros(shape, dtype=kind)
    count = prod(shape)
    private = mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS  # what is shared takes memory where it is read
    memory = mmap.mmap(-1, max(1, count * np.dtype(kind).itemsize), private)
    memory.madvise(mmap.MADV_NOHUGEPAGE)
    return np.frombuffer(memory, dtype=kind, count=count).reshape(shape)
