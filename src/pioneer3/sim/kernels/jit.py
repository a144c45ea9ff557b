"""Compiles kernels with numba, where it is installed.

A kernel is written once and marked with :func:`kernel` or :func:`inlined`. :func:`plain` returns
it for Python to run; :func:`fast` returns it compiled. Both give the same numbers to the last bit,
because kernels keep to what Python and numba compute alike: they divide no Python number by zero,
pass no NaN to `min` or `max`, and take a square root where `hypot` would do, as Python has a
`hypot` of its own. Compiled code is kept on disk until a file of the kernels changes.
"""

import os
import sys
from collections.abc import Callable
from functools import cache, wraps
from hashlib import sha256
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from types import FunctionType
from typing import Any, Final, ParamSpec, TypeVar

import numpy as np

P = ParamSpec("P")
R = TypeVar("R")

USED: Final = ("collision.py", "raycast.py")
"""Files beside this folder that kernels take constants from."""

INLINE: Final = "kernel_inline"
"""The attribute of a marked function: numba's option `inline`."""

COMPLETE: Final = "complete"
"""A file in the cache of which all kernels are there."""


def kernel(function: Callable[P, R]) -> Callable[P, R]:
    """Mark a function that :func:`fast` can compile."""
    setattr(function, INLINE, "never")
    return function


def inlined(function: Callable[P, R]) -> Callable[P, R]:
    """Mark one that is pasted into its callers: passing arrays costs more than a short loop."""
    setattr(function, INLINE, "always")
    return function


def plain(function: Callable[P, R]) -> Callable[P, R]:
    """Return a kernel for Python to run, without numpy's warnings, as compiled code gives none."""

    @wraps(function)
    def run(*args: P.args, **kwargs: P.kwargs) -> R:
        with np.errstate(all="ignore"):
            return function(*args, **kwargs)

    return run


def fast(function: Callable[P, R]) -> Callable[P, R]:
    """Return a kernel compiled, or plain where numba is not installed.

    It is compiled, or loaded from the cache, at its first call, and runs without the GIL.
    """
    result: Callable[P, R] = _compiled(function) if numba_version() else plain(function)
    return result


@cache
def numba_version() -> str:
    """Return the version of numba, empty where it is not installed; without importing it."""
    try:
        return version("numba")
    except PackageNotFoundError:
        return ""


@cache
def cache_directory() -> Path:
    """Return a directory of its own for these sources, where they are, this Python and this numba.

    Left alone, numba compiles anew when the file of the function called has changed or moved, and
    does not notice a change in the file of one that it calls.
    """
    here = Path(__file__).parent
    digest = sha256(f"{here} {sys.implementation.cache_tag} {numba_version()}".encode())
    for source in (*sorted(here.glob("*.py")), *(here.parent / name for name in USED)):
        digest.update(source.read_bytes())
    caches = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    chosen = os.environ.get("NUMBA_CACHE_DIR") or caches / "pioneer3"
    return Path(chosen) / digest.hexdigest()[:16]


def is_cached() -> bool:
    """Return whether all kernels have been compiled before."""
    return (cache_directory() / COMPLETE).exists()


@cache
def _compiled(function: Any) -> Any:
    """Return a copy of `function` that calls compiled kernels only, compiled."""
    import numba  # type: ignore[import-not-found, import-untyped, unused-ignore]

    names = function.__globals__
    called = {name: names[name] for name in function.__code__.co_names if name in names}
    kernels = {name: _compiled(value) for name, value in called.items() if hasattr(value, INLINE)}
    copy = FunctionType(function.__code__, names | kernels, function.__name__)
    copy.__module__, copy.__qualname__ = function.__module__, function.__qualname__
    inline = getattr(function, INLINE)
    config: Any = numba.config
    before, config.CACHE_DIR = config.CACHE_DIR, str(cache_directory())
    try:
        options = {"inline": inline, "cache": inline == "never", "error_model": "numpy"}
        return numba.njit(nogil=True, **options)(copy)
    finally:
        config.CACHE_DIR = before
