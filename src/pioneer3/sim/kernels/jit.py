"""numba's decorator, typed."""

from collections.abc import Callable
from typing import ParamSpec, TypeVar

import numba  # type: ignore[import-not-found, import-untyped, unused-ignore]

P = ParamSpec("P")
R = TypeVar("R")


def compiled(function: Callable[P, R]) -> Callable[P, R]:
    """Compile `function` at its first call, keep the result on disk, and run without the GIL."""
    jit = numba.njit(cache=True, nogil=True, error_model="numpy")
    result: Callable[P, R] = jit(function)
    return result


def inlined(function: Callable[P, R]) -> Callable[P, R]:
    """Paste `function` into its callers: passing many arrays costs more than a short loop."""
    jit = numba.njit(inline="always", nogil=True, error_model="numpy")
    result: Callable[P, R] = jit(function)
    return result
