"""The graph of nodes, from liveliness tokens."""

import logging
from collections.abc import Callable
from threading import Lock
from typing import TYPE_CHECKING

from pioneer3.ros.ros2.backend import Endpoint, EndpointKind, Graph, Left
from pioneer3.ros.zenoh.keys import SPACE, KeyTopic, LivelinessToken, parse_token

if TYPE_CHECKING:
    import zenoh

log = logging.getLogger(__name__)


class TokenGraph:
    """The nodes and endpoints of a domain, kept up to date by Zenoh."""

    def __init__(self, session: "zenoh.Session", domain: int) -> None:
        self._lock = Lock()
        self._nodes: dict[str, str] = {}
        self._endpoints: dict[str, Endpoint] = {}
        self._own: set[str] = set()
        self._listeners: list[tuple[KeyTopic, Left]] = []
        self._subscriber = session.liveliness().declare_subscriber(
            f"{SPACE}/{domain}/**", self._changed, history=True
        )

    def add_own(self, token: LivelinessToken) -> None:
        """Add a token of ours: it is there at once, and until it is removed."""
        with self._lock:
            self._own.add(token.text)
        self.add(token)

    def add(self, token: LivelinessToken) -> None:
        """Add a token."""
        endpoint = token.endpoint()
        with self._lock:
            if endpoint is None:
                self._nodes[token.text] = token.node.full
            else:
                self._endpoints[token.text] = endpoint

    def remove(self, text: str) -> None:
        """Remove the token with this key expression, and tell whom its publisher concerns."""
        with self._lock:
            self._own.discard(text)
            self._nodes.pop(text, None)
            gone = self._endpoints.pop(text, None)
            tell = [] if gone is None else self._concerned(gone)
        if gone is not None:
            for left in tell:
                left(gone.gid)

    def listen(self, topic: KeyTopic, left: Left) -> Callable[[], None]:
        """Call `left` with each publisher of `topic` that leaves, until the result is called."""
        entry = (topic, left)
        with self._lock:
            self._listeners.append(entry)

        def stop() -> None:
            with self._lock:
                if entry in self._listeners:
                    self._listeners.remove(entry)

        return stop

    def now(self) -> Graph:
        """Return all that is known."""
        with self._lock:
            return Graph(tuple(sorted(self._nodes.values())), tuple(self._endpoints.values()))

    def close(self) -> None:
        """Tell nobody any more."""
        with self._lock:
            self._listeners.clear()

    def _concerned(self, gone: Endpoint) -> list[Left]:
        if gone.kind is not EndpointKind.PUBLISHER:
            return []
        topic = KeyTopic(name=gone.name, type_name=gone.type_name, type_hash=gone.type_hash)
        return [left for wanted, left in self._listeners if wanted == topic]

    def _changed(self, sample: "zenoh.Sample") -> None:
        import zenoh

        text = str(sample.key_expr)
        if sample.kind == zenoh.SampleKind.DELETE:
            with self._lock:
                own = text in self._own  # a client hears of its own from the router, while it lasts
            if not own:
                self.remove(text)
            return
        try:
            self.add(parse_token(text))
        except ValueError as error:
            log.debug("%s", error)
