"""Publishers and subscribers of rclpy, whose messages are bytes."""

import logging
import threading
from collections.abc import Callable, Mapping
from typing import Any

from pioneer3.ros.ros2.backend import Left, Received

log = logging.getLogger(__name__)
Present = Callable[[], frozenset[bytes]]
"""Returns the identities of the publishers on a topic."""


class Closing:
    """Something that is destroyed once, by `destroy`."""

    def __init__(self, destroy: Callable[[], object]) -> None:
        self._destroy = destroy
        self._lock = threading.RLock()
        self._closed = False

    def close(self) -> None:
        """Destroy it."""
        with self._lock:
            if not self._closed:
                self._closed = True
                self._destroy()


class RclpyWriter(Closing):
    """A publisher of rclpy; `publisher` and `destroy` are given by the backend."""

    def __init__(self, publisher: Any, destroy: Callable[[], object]) -> None:
        super().__init__(destroy)
        self._publisher = publisher

    @property
    def matched(self) -> bool:
        """Whether anybody subscribes."""
        with self._lock:
            return not self._closed and self._publisher.get_subscription_count() > 0

    def write(self, cdr: bytes) -> None:
        """Send a serialized message."""
        with self._lock:
            if not self._closed:
                self._publisher.publish(bytes(cdr))


class RclpyReader(Closing):
    """A subscriber: finds the publisher of each message, and the publishers that left.

    rclpy tells the publisher of a message since Lyrical (its pull request #1466), and not all
    middlewares then tell the identity that the graph has (rmw_cyclonedds #377). So a message comes
    from the only publisher, where there is one.
    """

    def __init__(
        self, received: Received, left: Left, present: Present, destroy: Callable[[], object]
    ) -> None:
        super().__init__(destroy)
        self._received, self._left, self._present = received, left, present
        self._seen: frozenset[bytes] = frozenset()
        self._others: dict[bytes, bytes] = {}

    def take(self, cdr: bytes, info: Mapping[str, Any]) -> None:
        """Take a message, and what rclpy tells about it."""
        told = bytes((info.get("publisher_gid") or {}).get("data", b""))
        try:
            if not self._closed:
                self._received(cdr, self._publisher(told))
        except Exception:  # it would end the thread
            log.exception("a message is lost")

    def look(self) -> None:
        """Tell of the publishers that are gone since the last look."""
        present = self._present()
        with self._lock:
            if self._closed:
                return
            gone, self._seen = self._seen - present, present
            self._others = {k: v for k, v in self._others.items() if v in present}
        for gid in sorted(gone):
            self._left(gid)

    def _publisher(self, told: bytes) -> bytes:
        """Return the publisher of a message for which rclpy tells the identity `told`, or b""."""
        if told in self._seen:
            return told
        if told in self._others:
            return self._others[told]
        present = self._present()
        with self._lock:
            self._seen |= present
            if told in present or len(present) != 1:
                return told
            (only,) = present
            if told:
                self._others[told] = only
        return only
