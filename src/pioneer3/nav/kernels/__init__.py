"""The inner loops of navigation: written once, compiled by numba where it is installed."""

from pathlib import Path

from pioneer3.jit import KernelCache

CACHE = KernelCache(Path(__file__).parent)
