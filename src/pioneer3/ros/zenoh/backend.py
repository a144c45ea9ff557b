"""A node of ROS 2 over Zenoh, for peers with rmw_zenoh_cpp."""

import time
from collections.abc import Callable
from importlib.metadata import version
from itertools import count
from threading import Lock, Thread
from typing import TYPE_CHECKING, Final

from pioneer3.errors import ConfigError, LinkError
from pioneer3.ros.ros2.backend import (
    EndpointKind,
    Failed,
    Graph,
    MessageType,
    NodeName,
    Qos,
    Received,
    ServiceType,
)
from pioneer3.ros.ros2.backend import Left as LeftCallback
from pioneer3.ros.ros2.types import MessageTypes
from pioneer3.ros.zenoh.endpoints import ZenohReader, ZenohServer, ZenohWriter, attachment, matching
from pioneer3.ros.zenoh.graph import TokenGraph
from pioneer3.ros.zenoh.keys import SERVICES, KeyTopic, LivelinessToken
from pioneer3.ros.zenoh.presence import RouterWatch, connected, refusal
from pioneer3.ros.zenoh.settings import (
    FIX,
    ZenohOptions,
    endpoints_of,
    load_zenoh,
    reason,
    session_config,
    shown,
)

if TYPE_CHECKING:
    import zenoh

LACKS: Final = (
    "there are no actions; Humble and newer distributions do not exchange messages, for Humble has"
    " no hashes of types"
)
LOOK: Final = 0.02
"""Between two looks for the server of a service [s]."""
ENDING: Final = 5.0
"""Longest time to leave the network [s]."""


class ZenohBackend:
    """A node of ROS 2 in a Zenoh session of its own; `types` are those of all who take part.

    Raises:
        ConfigError: Zenoh is not installed, a setting is wrong, or the router refuses us.
        LinkError: a client finds no router.
    """

    serves = True
    strict = False
    lacks = LACKS

    def __init__(self, node: NodeName, types: MessageTypes, options: ZenohOptions) -> None:
        load_zenoh()
        import zenoh

        self._node = node
        self._domain = options.domain
        self._hashes = types.distro.type_hashes
        config = session_config(options)
        endpoints = endpoints_of(config)
        where = ", ".join(map(shown, endpoints)) or "nobody"
        self.title = f"Zenoh {version('eclipse-zenoh')}, domain {options.domain}, by {where}"
        try:
            self._session = zenoh.open(config)
        except zenoh.ZError as error:
            if refused := refusal(options, endpoints):
                raise ConfigError(refused) from None
            raise LinkError(f"Zenoh cannot start: {reason(error)}; {FIX}") from None
        if not connected(self._session) and (refused := refusal(options, endpoints)):
            self._session.close()
            raise ConfigError(refused)
        self._lock = Lock()
        self._numbers = count()
        self._zid = str(self._session.zid())
        self._tokens: dict[str, zenoh.LivelinessToken] = {}
        self._clients: dict[KeyTopic, _Client] = {}
        self._ends: list[ZenohWriter | ZenohReader | ZenohServer] = []
        self._open = True
        self._graph = TokenGraph(self._session, self._domain)
        self._declare(self._token(None, None))
        self._watch = RouterWatch(self._session, options, endpoints)

    def advertise(self, name: str, type_: MessageType, qos: Qos) -> ZenohWriter:
        """Publish on a topic."""
        token = self._token(EndpointKind.PUBLISHER, self._topic(name, type_), qos)
        key, release = self._key(token), self._release(token)
        writer = ZenohWriter(self._session, key, qos, token.gid, release)
        self._declare(token)
        self._keep(writer)
        return writer

    def subscribe(
        self, name: str, type_: MessageType, qos: Qos, received: Received, left: LeftCallback
    ) -> ZenohReader:
        """Subscribe to a topic."""
        topic = self._topic(name, type_)
        token = self._token(EndpointKind.SUBSCRIBER, topic, qos)
        reader = ZenohReader(received, left)
        releases = [self._graph.listen(topic, reader.gone), self._release(token)]
        reader.start(self._session, self._key(token), qos, releases)
        self._declare(token)
        self._keep(reader)
        return reader

    def serve(
        self, name: str, type_: ServiceType, respond: Callable[[bytes], bytes]
    ) -> ZenohServer:
        """Offer a service."""
        token = self._token(EndpointKind.SERVER, self._topic(name, type_), SERVICES)
        server = ZenohServer(self._session, self._key(token), respond, self._release(token))
        self._declare(token)
        self._keep(server)
        return server

    def call(self, name: str, type_: ServiceType, request: bytes, timeout: float) -> bytes:
        """Call a service once, when its server is there; TimeoutError after `timeout` [s]."""
        import zenoh

        end = time.monotonic() + timeout
        client = self._client(self._topic(name, type_))
        while not matching(client.querier):
            if not self._open or time.monotonic() > end:
                raise TimeoutError(f"nobody offers {name} as {type_.name}")
            time.sleep(LOOK)
        replies = self._session.get(
            client.key,
            payload=request,
            attachment=attachment(next(client.numbers), client.gid),
            target=zenoh.QueryTarget.ALL_COMPLETE,
            consolidation=zenoh.ConsolidationMode.NONE,
            timeout=max(end - time.monotonic(), LOOK),
        )
        for reply in replies:
            if reply.ok is not None:
                return reply.ok.payload.to_bytes()
        raise TimeoutError(f"the server of {name} has not responded within {timeout:g} s")

    def graph(self) -> Graph:
        """Return the nodes and endpoints that are known now."""
        return self._graph.now()

    def on_failure(self, call: Failed) -> None:
        """Do nothing: Zenoh connects again by itself."""

    def close(self) -> None:
        """Leave the network."""
        with self._lock:
            if not self._open:
                return
            self._open = False
            ends = list(self._ends)
        self._watch.close()
        self._graph.close()
        # a link that hangs must not hold up the end of the program
        leaving = Thread(target=self._leave, args=(ends,), name="zenoh-close", daemon=True)
        leaving.start()
        leaving.join(ENDING)

    def _leave(self, ends: "list[ZenohWriter | ZenohReader | ZenohServer]") -> None:
        for end in ends:
            end.close()
        self._session.close()

    def _client(self, topic: KeyTopic) -> "_Client":
        with self._lock:
            if not self._open:
                raise TimeoutError(f"nobody answers {topic.name}: this node has left the network")
            client = self._clients.get(topic)
            if client is None:
                token = self._token(EndpointKind.CLIENT, topic, SERVICES)
                client = self._clients[topic] = _Client(self._session, self._key(token), token.gid)
                self._declare(token)
            return client

    def _topic(self, name: str, type_: MessageType | ServiceType) -> KeyTopic:
        return KeyTopic(
            name=name, type_name=type_.name, type_hash=type_.hash if self._hashes else ""
        )

    def _token(
        self, kind: EndpointKind | None, topic: KeyTopic | None, qos: Qos | None = None
    ) -> LivelinessToken:
        return LivelinessToken(
            domain=self._domain,
            session=self._zid,
            node_id=0,
            entity_id=next(self._numbers),
            node=self._node,
            kind=kind,
            topic=topic,
            qos=qos or Qos(),
        )

    def _key(self, token: LivelinessToken) -> str:
        assert token.topic is not None
        return token.topic.key(self._domain)

    def _declare(self, token: LivelinessToken) -> None:
        self._tokens[token.text] = self._session.liveliness().declare_token(token.text)
        self._graph.add_own(token)

    def _release(self, token: LivelinessToken) -> Callable[[], None]:
        """Return the function that takes a token back."""

        def release() -> None:
            declared = self._tokens.pop(token.text, None)
            if declared is not None:
                declared.undeclare()
                self._graph.remove(token.text)

        return release

    def _keep(self, end: ZenohWriter | ZenohReader | ZenohServer) -> None:
        with self._lock:
            self._ends = [*(each for each in self._ends if each.is_open), end]


class _Client:
    """A client of a service, with a key and the identity that comes with its requests."""

    def __init__(self, session: "zenoh.Session", key: str, gid: bytes) -> None:
        import zenoh

        self.key = key
        self.gid = gid
        self.numbers = count(1)
        self.querier = session.declare_querier(key, target=zenoh.QueryTarget.ALL_COMPLETE)
