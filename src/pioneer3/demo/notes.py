"""The log of the package as sentences on the demo's screen: a line on stderr would spoil it."""

import logging
from collections.abc import Callable, Iterator
from contextlib import contextmanager


class _Teller(logging.Handler):
    def __init__(self, say: Callable[[str], None]) -> None:
        super().__init__(logging.WARNING)
        self._say = say

    def emit(self, record: logging.LogRecord) -> None:
        self._say(record.getMessage())


@contextmanager
def log_told_by(say: Callable[[str], None]) -> Iterator[None]:
    """Hand warnings and errors to `say` during the block, and to nobody else."""
    root = logging.getLogger()
    before = root.handlers[:]
    root.handlers[:] = [_Teller(say)]
    try:
        yield
    finally:
        root.handlers[:] = before
