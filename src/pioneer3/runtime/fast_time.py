"""An event loop that does not wait: it plays recordings as fast as it can."""

import asyncio
import selectors
from typing import Any


class _Jumping(selectors.DefaultSelector):
    """Jumps to the next timer where nothing can be read."""

    now = 0.0

    def select(self, timeout: float | None = None) -> list[Any]:
        """Return the files that are ready now; wait only where no timer is set."""
        ready = super().select(None if timeout is None else 0)
        if not ready and timeout is not None and timeout > 0:
            self.now += timeout
        return ready


class FastTimeLoop(asyncio.SelectorEventLoop):
    """An event loop whose clock jumps from timer to timer."""

    def __init__(self) -> None:
        self._jumping = _Jumping()
        super().__init__(self._jumping)

    def time(self) -> float:
        """Return the time [s]."""
        return self._jumping.now
