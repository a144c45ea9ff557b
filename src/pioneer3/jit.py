"""Compiles kernels with numba, where it is installed.

A kernel is written once and marked with :func:`kernel` or :func:`inlined`. :func:`plain` returns
it for Python to run; :func:`fast` returns it compiled. Both give the same numbers to the last bit,
because kernels keep to what Python and numba compute alike: they divide no Python number by zero,
pass no NaN to `min` or `max`, and take a square root where `hypot` would do, as Python has a
`hypot` of its own. Compiled code is kept on disk until a file of the kernels changes.

Kernels lie in folders of their own; :class:`KernelCache` tells where the compiled ones of a folder
are. Where nothing can be kept they are compiled at each start.
"""

import logging
import os
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from functools import cache, cached_property, wraps
from hashlib import sha256
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryFile
from threading import Lock
from types import FunctionType
from typing import Any, Final, ParamSpec, TypeVar

import numpy as np

try:
    import fcntl
except ImportError:  # Windows: two processes that start at once may both compile
    fcntl = None  # type: ignore[assignment]

log = logging.getLogger(__name__)

P = ParamSpec("P")
R = TypeVar("R")

INLINE: Final = "kernel_inline"
"""The attribute of a marked function: numba's option `inline`."""

CACHE_DIR_IS_SET: Final = Lock()
"""Held while numba's setting is ours: kernels are loaded in several threads."""
COMPLETE: Final = "complete"
"""A file in the cache of which all kernels are there."""
LOCK: Final = "lock"
"""A file in the cache that the process locks which compiles."""
ROOM: Final = 8 << 20
"""More than the compiled kernels of one folder take [bytes]."""


HOLDERS: Final = {np.ndarray, tuple}
"""Arguments of kernels that are, or have, arrays."""


def kernel(function: Callable[P, R]) -> Callable[P, R]:
    """Mark a function that :func:`fast` can compile."""
    setattr(function, INLINE, "never")
    return function


def inlined(function: Callable[P, R]) -> Callable[P, R]:
    """Mark one that is pasted into its callers: passing arrays costs more than a short loop."""
    setattr(function, INLINE, "always")
    return function


def plain(function: Callable[P, R], *, scalar: bool = False) -> Callable[P, R]:
    """Return a kernel for Python to run, without numpy's warnings, as compiled code gives none.

    One that is `scalar` reads numbers one by one, and is given memory views in place of arrays:
    Python's own numbers take a third of the time of numpy's.
    """

    @wraps(function)
    def run(*args: P.args, **kwargs: P.kwargs) -> R:
        with np.errstate(all="ignore"):
            return function(*args, **kwargs)

    @wraps(function)
    def run_viewed(*args: P.args, **kwargs: P.kwargs) -> R:
        given: Any = [_viewed(each) if type(each) in HOLDERS else each for each in args]
        return function(*given, **kwargs)

    return run_viewed if scalar else run


def _viewed(argument: Any) -> Any:
    if type(argument) is tuple:
        return tuple([_viewed(each) if type(each) in HOLDERS else each for each in argument])
    return argument.data


class KernelCache:
    """The compiled kernels of one folder, on disk.

    Left alone, numba compiles anew when the file of the function called has changed or moved, and
    does not notice a change in the file of one that it calls.

    Args:
        folder: Of the kernels' sources.
        used: Other files that kernels take constants from.
    """

    def __init__(self, folder: Path, used: Iterable[Path] = ()) -> None:
        self._folder, self._used = folder, tuple(used)

    @cached_property
    def directory(self) -> Path:
        """A directory of its own for these sources, where they are, this Python and this numba."""
        words = f"{self._folder} {sys.implementation.cache_tag} {numba_version()}"
        digest = sha256(words.encode())
        for source in (*sorted(self._folder.glob("*.py")), *self._used):
            digest.update(source.read_bytes())
        caches = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
        chosen = os.environ.get("NUMBA_CACHE_DIR") or caches / "pioneer3"
        return Path(chosen) / digest.hexdigest()[:16]

    @cached_property
    def can_keep(self) -> bool:
        """Whether kernels can be kept: numba ends with a traceback where they cannot."""
        try:
            self.directory.mkdir(parents=True, exist_ok=True)
            with TemporaryFile(dir=self.directory) as file:
                if not self._is_marked:
                    file.write(os.urandom(ROOM))
                    file.flush()
        except OSError as error:
            _warn(self.directory.parent, error.strerror)
            return False
        return True

    @property
    def is_complete(self) -> bool:
        """Whether all kernels have been compiled before, and can be loaded."""
        return self._is_marked and self.can_keep

    @property
    def is_missing(self) -> bool:
        """Whether kernels are still to be compiled, and can be kept."""
        return bool(numba_version()) and self.can_keep and not self._is_marked

    @property
    def _is_marked(self) -> bool:
        return (self.directory / COMPLETE).exists()

    @contextmanager
    def compiling(self, begin: Callable[[], None] = lambda: None) -> Iterator[None]:
        """Call all kernels in this block, which notes in the end that they are there.

        Of several processes one compiles; the others wait for it, and load what it has kept.
        `begin` is called by that one.
        """
        if not self.is_missing:
            yield
            return
        with (self.directory / LOCK).open("w") as file:
            if fcntl is not None:
                with suppress(OSError):  # a file system without locks
                    fcntl.flock(file, fcntl.LOCK_EX)
            if self.is_missing:
                begin()
            yield
            with suppress(OSError):  # full since: they are compiled anew the next time
                (self.directory / COMPLETE).touch()


@cache
def _warn(folder: Path, reason: str | None) -> None:
    """Warn once that nothing can be kept in `folder`."""
    log.warning(
        "%s: %s: compiled code cannot be kept, so each start takes up to a minute longer; "
        "make room there, or set NUMBA_CACHE_DIR to a folder that can be written",
        folder,
        reason,
    )


def fast(function: Callable[P, R], kept: KernelCache) -> Callable[P, R]:
    """Return a kernel compiled, or plain where numba is not installed.

    It is compiled, or loaded from the cache, at its first call, and runs without the GIL.
    """
    if not numba_version():
        return plain(function)
    result: Callable[P, R] = _compiled(function, kept)
    return result


@cache
def numba_version() -> str:
    """Return the version of numba, empty where it is not installed; without importing it."""
    from importlib.metadata import PackageNotFoundError, version  # loads slowly

    try:
        return version("numba")
    except PackageNotFoundError:
        return ""


@cache
def _numba() -> Any:
    """Return numba, without SciPy's linear algebra.

    It looks whether that is there by loading it, 16 MB in a third of a second, and loads it again
    where a function calls it; no kernel does.
    """
    import numba  # type: ignore[import-not-found, import-untyped, unused-ignore]

    with suppress(ImportError, AttributeError):  # another version may look for it otherwise
        linalg: Any = import_module("numba.np.linalg")
        look, linalg.ensure_blas = linalg.ensure_blas, _have_none
        try:
            import_module("numba.np.arraymath")
        finally:
            linalg.ensure_blas = look
    return numba


def _have_none() -> None:
    raise ImportError


@cache
def _compiled(function: Any, kept: KernelCache) -> Any:
    """Return a copy of `function` that calls compiled kernels only, compiled."""
    numba, names = _numba(), function.__globals__
    called = {name: names[name] for name in function.__code__.co_names if name in names}
    kernels = {
        name: _compiled(value, kept) for name, value in called.items() if hasattr(value, INLINE)
    }
    copy = FunctionType(function.__code__, names | kernels, function.__name__)
    copy.__module__, copy.__qualname__ = function.__module__, function.__qualname__
    inline = getattr(function, INLINE)
    config: Any = numba.config
    caches = inline == "never" and kept.can_keep
    options = {"inline": inline, "cache": caches, "error_model": "numpy"}
    with CACHE_DIR_IS_SET:
        before, config.CACHE_DIR = config.CACHE_DIR, str(kept.directory)
        try:
            return numba.njit(nogil=True, **options)(copy)
        finally:
            config.CACHE_DIR = before
