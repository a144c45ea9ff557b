"""numba's decorators, typed; what was compiled is kept until a file of the kernels changes."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, ParamSpec, TypeVar

import numba  # type: ignore[import-not-found, import-untyped, unused-ignore]

from pioneer3.sim.kernels.cache import directory

P = ParamSpec("P")
R = TypeVar("R")

CONFIG: Any = numba.config


@contextmanager
def _caching_in(directory: str) -> Iterator[None]:
    before, CONFIG.CACHE_DIR = CONFIG.CACHE_DIR, directory
    try:
        yield
    finally:
        CONFIG.CACHE_DIR = before


CACHE = str(directory())


def compiled(function: Callable[P, R]) -> Callable[P, R]:
    """Compile `function` at its first call, keep the result on disk, and run without the GIL."""
    with _caching_in(CACHE):
        jit = numba.njit(cache=True, nogil=True, error_model="numpy")
        result: Callable[P, R] = jit(function)
    return result


def inlined(function: Callable[P, R]) -> Callable[P, R]:
    """Paste `function` into its callers: passing many arrays costs more than a short loop."""
    jit = numba.njit(inline="always", nogil=True, error_model="numpy")
    result: Callable[P, R] = jit(function)
    return result
