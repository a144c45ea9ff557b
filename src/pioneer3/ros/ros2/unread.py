"""Things that come from others and cannot be read: the log has the first, and how many there were.

Whoever reaches the network can send them without an end, which must not fill the log.
"""

import logging
from threading import Lock

log = logging.getLogger(__name__)


class Unread:
    """Counts things of one kind that cannot be read, and tells of the first; for any thread.

    Args:
        what: Name of the kind, in the plural, such as `requests of /e_stop_reset`.
    """

    def __init__(self, what: str) -> None:
        self._what = what
        self._number = 0
        self._lock = Lock()

    def add(self, error: Exception) -> None:
        """Count one, with the reason."""
        with self._lock:
            self._number += 1
            is_first = self._number == 1
        if is_first:
            log.warning("%s cannot be read: %s; others are only counted", self._what, error)

    def close(self) -> None:
        """Tell how many there were, if the first was not the only one."""
        if self._number > 1:
            log.warning("%d %s could not be read", self._number, self._what)
