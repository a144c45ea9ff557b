"""Questions to a few flags: `any`, `all` and `flatnonzero` take ten times as long as these."""

from typing import Any

import numpy as np
from numpy.typing import NDArray


def any_of(flags: NDArray[Any]) -> bool:
    """Return whether any is set."""
    return int(np.count_nonzero(flags)) > 0


def all_of(flags: NDArray[Any]) -> bool:
    """Return whether every one is set."""
    return int(np.count_nonzero(flags)) == flags.size


def indices_of(flags: NDArray[Any]) -> NDArray[np.int64]:
    """Return where the set ones are, counted through all axes."""
    return flags.ravel().nonzero()[0]
