"""numba's decorators, typed; what was compiled is kept until a file of the kernels changes."""

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from hashlib import sha256
from pathlib import Path
from typing import Any, ParamSpec, TypeVar

import numba  # type: ignore[import-not-found, import-untyped, unused-ignore]

P = ParamSpec("P")
R = TypeVar("R")

CONFIG: Any = numba.config


def _cache() -> str:
    """Return a directory of its own for these sources.

    Left alone, numba compiles anew when the file of the function called has changed, and does not
    notice a change in the file of one that it calls.
    """
    here = Path(__file__).parent
    digest = sha256()
    for source in sorted([*here.rglob("*.py"), *here.parent.glob("*.py")]):
        digest.update(source.read_bytes())
    usual = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "pioneer3"
    return str(Path(CONFIG.CACHE_DIR or usual) / digest.hexdigest()[:16])


@contextmanager
def _caching_in(directory: str) -> Iterator[None]:
    before, CONFIG.CACHE_DIR = CONFIG.CACHE_DIR, directory
    try:
        yield
    finally:
        CONFIG.CACHE_DIR = before


CACHE = _cache()


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
