"""The graph of ROS 2 over DDS: `ros_discovery_info`, and the endpoints that DDS itself finds."""

import threading
from collections.abc import Iterable, Mapping
from dataclasses import replace
from math import inf
from typing import Any, Final

from pioneer3.names import printable
from pioneer3.ros.ros2.backend import Endpoint, EndpointKind, Graph, NodeName, Qos, from_dds
from pioneer3.ros.ros2.types import MessageTypes

TOPIC: Final = "ros_discovery_info"
INFO: Final = "rmw_dds_common/msg/ParticipantEntitiesInfo"
NODE_INFO: Final = "rmw_dds_common/msg/NodeEntitiesInfo"
GID: Final = "rmw_dds_common/msg/Gid"
GUID_BYTES: Final = 16
FOREVER: Final = (1 << 63) - 1
"""A duration without end [ns]."""
KINDS: Final = {
    ("rt/", False): EndpointKind.PUBLISHER,
    ("rt/", True): EndpointKind.SUBSCRIBER,
    ("rq/", False): EndpointKind.CLIENT,
    ("rq/", True): EndpointKind.SERVER,
}
"""Kind of an endpoint by its topic's prefix, and whether it reads; `rr/` would be there twice."""


class Discovery:
    """The nodes and endpoints that are known; `participant` is our identity. For any thread."""

    def __init__(self, types: MessageTypes, node: NodeName, participant: bytes) -> None:
        self._types, self._node, self._participant = types, node, participant
        self._readers: list[bytes] = []
        self._writers: list[bytes] = []
        self._nodes: dict[bytes, list[str]] = {}
        self._owners: dict[bytes, dict[bytes, str]] = {}
        self._owner: dict[bytes, str] = {}
        self._endpoints: dict[bytes, Endpoint] = {}
        self._lock = threading.Lock()

    def add(self, guid: bytes, *, reads: bool) -> None:
        """Take note of an endpoint of ours."""
        with self._lock:
            (self._readers if reads else self._writers).append(guid)

    def remove(self, guid: bytes) -> None:
        """Forget an endpoint of ours."""
        with self._lock:
            for known in (self._readers, self._writers):
                if guid in known:
                    known.remove(guid)

    def own_info(self) -> bytes:
        """Return the message that tells the others of our node."""
        info, node = self._types.make(INFO), self._types.make(NODE_INFO)
        node.node_namespace, node.node_name = self._node.namespace, self._node.name
        with self._lock:
            node.reader_gid_seq = list(map(self._gid, self._readers))
            node.writer_gid_seq = list(map(self._gid, self._writers))
        info.gid, info.node_entities_info_seq = self._gid(self._participant), [node]
        return self._types.encode(info)

    def take_info(self, cdr: bytes) -> None:
        """Take such a message of anybody; ValueError if it is none of this distribution."""
        info = self._types.decode(cdr, INFO)
        nodes = {
            printable(NodeName(node.node_name, node.node_namespace).full): [
                bytes(gid.data[:GUID_BYTES]) for gid in (*node.reader_gid_seq, *node.writer_gid_seq)
            ]
            for node in info.node_entities_info_seq
        }
        self._own(bytes(info.gid.data[:GUID_BYTES]), nodes)

    def take_endpoint(self, found: Any, *, reads: bool) -> None:
        """Take an endpoint that DDS has found; not one of another kind of topic than ROS 2's."""
        name = found.topic_name or ""
        kind = KINDS.get((name[:3], reads))
        if kind is None:
            return
        guid, qos = found.key.bytes, found.qos
        topic, type_name = f"/{name[3:]}", from_dds(found.type_name)
        if kind in {EndpointKind.CLIENT, EndpointKind.SERVER}:
            topic, type_name = topic.removesuffix("Request"), type_name.removesuffix("_Request")
        endpoint = Endpoint(
            kind=kind,
            node="",
            name=printable(topic),
            type_name=printable(type_name),
            type_hash=printable(_type_hash(qos)),
            qos=_qos(qos),
            gid=guid,
        )
        with self._lock:
            self._endpoints[guid] = replace(endpoint, node=self._owner.get(guid, ""))

    def lose_endpoint(self, guid: bytes) -> Endpoint | None:
        """Forget an endpoint; return it, or `None` if it was not known."""
        with self._lock:
            return self._endpoints.pop(guid, None)

    def lose_participant(self, guid: bytes) -> None:
        """Forget the nodes of a participant."""
        self._own(guid, {})

    def graph(self) -> Graph:
        """Return all that is known; it is asked for often, and must cost little."""
        with self._lock:
            return Graph(
                tuple(sorted(name for names in self._nodes.values() for name in names)),
                tuple(self._endpoints.values()),
            )

    def _own(self, participant: bytes, nodes: Mapping[str, Iterable[bytes]]) -> None:
        """Take note of the nodes of a participant, and of their endpoints."""
        after = {gid: name for name, gids in nodes.items() for gid in gids}
        with self._lock:
            before = self._owners.pop(participant, {})
            self._nodes.pop(participant, None)
            if nodes:
                self._owners[participant], self._nodes[participant] = after, list(nodes)
            for gid in before.keys() - after.keys():
                self._owner.pop(gid, None)
            self._owner |= after
            for gid in before.keys() | after.keys():
                known, name = self._endpoints.get(gid), after.get(gid, "")
                if known is not None and known.node != name:
                    self._endpoints[gid] = replace(known, node=name)

    def _gid(self, guid: bytes) -> Any:
        gid = self._types.make(GID)
        gid.data = guid.ljust(self._types.distro.gid_bytes, b"\0")
        return gid


def _type_hash(qos: Iterable[Any]) -> str:
    """Return the hash in the user data of an endpoint, `typehash=RIHS01_...;`."""
    for policy in qos:
        if policy.__scope__ == "Userdata":
            for pair in bytes(policy.data).decode("utf-8", "replace").split(";"):
                key, _, value = pair.partition("=")
                if key == "typehash":
                    return value
    return ""


def _qos(qos: Iterable[Any]) -> Qos:
    by_scope = {policy.__scope__: policy for policy in qos}
    name = {scope: type(policy).__name__.rpartition(".")[2] for scope, policy in by_scope.items()}
    liveliness = by_scope.get("Liveliness")
    return Qos(
        reliable=name.get("Reliability") == "Reliable",
        transient_local=name.get("Durability") == "TransientLocal",
        depth=getattr(by_scope.get("History"), "depth", 0),
        lifespan=_seconds(getattr(by_scope.get("Lifespan"), "lifespan", FOREVER)),
        deadline=_seconds(getattr(by_scope.get("Deadline"), "deadline", FOREVER)),
        lease=_seconds(getattr(liveliness, "lease_duration", FOREVER)),
        manual=name.get("Liveliness", "Automatic") != "Automatic",
    )


def _seconds(duration: int) -> float:
    """Return a duration of DDS [ns] in seconds."""
    return inf if duration >= FOREVER else duration / 1e9
