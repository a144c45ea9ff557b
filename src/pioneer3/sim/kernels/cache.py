"""Where compiled kernels are kept, and whether they are there; without importing numba."""

import os
from hashlib import sha256
from importlib.util import find_spec
from pathlib import Path

READY = "ready"
USED = ("collision.py", "raycast.py")
"""What kernels take constants from."""


def directory() -> Path:
    """Return a directory of its own for these sources.

    Left alone, numba compiles anew when the file of the function called has changed, and does not
    notice a change in the file of one that it calls.
    """
    here = Path(__file__).parent
    digest = sha256()
    for source in (*sorted(here.rglob("*.py")), *(here.parent / name for name in USED)):
        digest.update(source.read_bytes())
    caches = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    chosen = os.environ.get("NUMBA_CACHE_DIR") or caches / "pioneer3"
    return Path(chosen) / digest.hexdigest()[:16]


def is_ready() -> bool:
    """Whether numba is installed and has compiled all kernels before."""
    return find_spec("numba") is not None and (directory() / READY).exists()


def tell_ready() -> None:
    """Leave a note that everything is compiled."""
    if directory().is_dir():
        (directory() / READY).touch()
