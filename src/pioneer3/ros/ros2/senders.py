"""The publishers of the messages that a node receives."""

import threading
import time
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass
from math import inf
from typing import Final

from pioneer3.ros.node.middleware import Sender
from pioneer3.ros.ros2.backend import EndpointKind, Graph

UNKNOWN: Final = "a publisher of an unknown node"
REMEMBERED: Final = 256
"""Publishers that are remembered; the one that has been silent longest is forgotten first."""
AGAIN: Final = 1.0
"""Between two searches for the node of one publisher [s]."""
FRESH: Final = 0.1
"""So long one look at the graph serves all publishers [s]: it takes milliseconds on large ones."""
Key = tuple[str, bytes]
"""Topic and identity of a publisher; those without an identity are one for each topic."""


@dataclass(slots=True)
class _Known:
    sender: Sender
    looked: float


class Senders:
    """Finds the publisher of each message in the graph; of use in any thread."""

    def __init__(
        self, graph: Callable[[], Graph], now: Callable[[], float] = time.monotonic
    ) -> None:
        self._graph, self._now = graph, now
        self._known: OrderedDict[Key, _Known] = OrderedDict()
        self._nodes: dict[Key, str] = {}
        self._looked = -inf
        self._lock = threading.Lock()

    def of(self, topic: str, gid: bytes) -> Sender:
        """Return the publisher with this identity; its connection is the same each time."""
        key = topic, gid
        with self._lock:
            known = self._known.get(key)
            if known is None:
                known = self._known[key] = _Known(Sender(UNKNOWN, object()), -inf)
                if len(self._known) > REMEMBERED:
                    self._known.popitem(last=False)
            self._known.move_to_end(key)
            now = self._now()
            if not gid or known.sender.node != UNKNOWN or now - known.looked < AGAIN:
                return known.sender
            known.looked = now
        node = self._node(key, now)
        with self._lock:
            if node:
                known.sender = Sender(node, known.sender.connection)
            return known.sender

    def lose(self, topic: str, gid: bytes) -> Sender | None:
        """Forget a publisher; return it, or `None` if it was not known."""
        with self._lock:
            known = self._known.pop((topic, gid), None)
        return known.sender if known else None

    def _node(self, key: Key, now: float) -> str:
        """Return the node of a publisher; empty if it is not known."""
        if now - self._looked >= FRESH:
            self._looked = now
            self._nodes = {
                (each.name, each.gid): each.node
                for each in self._graph().endpoints
                if each.kind is EndpointKind.PUBLISHER and each.gid
            }
        return self._nodes.get(key, "")
