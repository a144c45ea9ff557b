"""Keys, tokens and attachments of ROS 2 over Zenoh, as rmw_zenoh_cpp has them.

A message is put on `<domain>/<topic>/<type>/<hash>`. Each node and each endpoint declares a
liveliness token, from which all others make the graph::

    @ros2_lv/<domain>/<session>/<node>/<entity>/NN/<enclave>/<namespace>/<name>
    @ros2_lv/.../<MP|MS|SS|SC>/<enclave>/<namespace>/<name>/<topic>/<type>/<hash>/<qos>

In parts of a token `%` stands for `/`. Sources: rmw_zenoh's page on its design, and
`liveliness_utils.cpp`, `qos.cpp`, `attachment_helpers.cpp` in `rmw_zenoh_cpp/src/detail`.
"""

from dataclasses import dataclass, field
from math import inf, isinf
from struct import Struct
from typing import Final

from pioneer3.names import printable
from pioneer3.ros.ros2.backend import Endpoint, EndpointKind, NodeName, Qos, from_dds, to_dds

SPACE: Final = "@ros2_lv"
NODE: Final = "NN"
NANO: Final = 1_000_000_000
KINDS: Final = {
    "MP": EndpointKind.PUBLISHER,
    "MS": EndpointKind.SUBSCRIBER,
    "SS": EndpointKind.SERVER,
    "SC": EndpointKind.CLIENT,
}
CODES: Final = {kind: code for code, kind in KINDS.items()}
NO_HASH: Final = "TypeHashNotSupported"
"""In the place of a hash in Humble, which has none."""
SERVICES: Final = Qos(depth=10)
"""Quality of services and clients (`rmw_qos_profile_services_default`)."""
DEFAULT_DEPTH: Final = 42
"""Depth that is left out."""
FOREVER: Final = 9_223_372_036
"""Seconds of a duration without end (`RMW_DURATION_INFINITE`), which are left out."""
BEST_EFFORT, TRANSIENT_LOCAL = "2", "1"
NODE_PARTS, ENDPOINT_PARTS = 9, 13
GID_BYTES: Final = 16
NAMES: Final = (b"sequence_number", b"source_timestamp", b"source_gid")
PLAIN: Final = Struct(f"<qqB{GID_BYTES}s")
"""An attachment: the gid has its length first."""
NAMED: Final = Struct(f"<B15sqB16sqB10sB{GID_BYTES}s")
"""An attachment of Jazzy before rmw_zenoh_cpp 0.2.4: before each field its name."""


@dataclass(frozen=True, slots=True, kw_only=True)
class KeyTopic:
    """A topic or service as it is in keys, by its full name, such as `/robot1/odom`.

    The hash, such as `RIHS01_3cc9...`, is empty in Humble.
    """

    name: str
    type_name: str
    type_hash: str = ""

    def key(self, domain: int) -> str:
        """Return the key that its messages are put on, or its requests are made to."""
        name, hashed = self.name.strip("/"), self.type_hash or NO_HASH
        return f"{domain}/{name}/{to_dds(self.type_name)}/{hashed}"


@dataclass(frozen=True, slots=True, kw_only=True)
class LivelinessToken:
    """A liveliness token: that of a node, or that of an endpoint of a node.

    The identity of the Zenoh session is in hexadecimal digits, the other two are numbers in it; a
    node has one number twice, and neither `kind` nor `topic`. `key` is the key expression as
    another program declared it, empty for a token of ours.
    """

    domain: int
    session: str
    node_id: int
    entity_id: int
    node: NodeName
    enclave: str = "/"
    kind: EndpointKind | None = None
    topic: KeyTopic | None = None
    qos: Qos = field(default_factory=Qos)
    key: str = field(default="", compare=False)

    @property
    def text(self) -> str:
        """The key expression of the token."""
        if self.key:
            return self.key
        code = NODE if self.kind is None else CODES[self.kind]
        numbers = (self.domain, self.session, self.node_id, self.entity_id)
        names = (self.enclave, self.node.namespace, self.node.name)
        parts = [SPACE, *map(str, numbers), code, *map(_mangled, names)]
        if self.topic is not None:
            topic = self.topic
            types = (to_dds(topic.type_name), topic.type_hash or NO_HASH)
            parts += [*map(_mangled, (topic.name, *types)), qos_text(self.qos)]
        return "/".join(parts)

    @property
    def gid(self) -> bytes:
        """Identity of the endpoint, which comes with its messages."""
        return gid_of(self.text)

    def endpoint(self) -> Endpoint | None:
        """Return the endpoint as the graph has it; `None` for a node."""
        if self.kind is None or self.topic is None:
            return None
        return Endpoint(
            kind=self.kind,
            node=self.node.full,
            name=self.topic.name,
            type_name=self.topic.type_name,
            type_hash=self.topic.type_hash,
            qos=self.qos,
            gid=self.gid,
        )


@dataclass(frozen=True, slots=True)
class Attachment:
    """The data that goes with each message, request and response.

    It was sent at `stamp` [ns since 1970]. A response has the number of its request and the `gid`
    of the client. Fields that are `named` are for older peers, which understand no others.
    """

    sequence: int
    stamp: int
    gid: bytes
    named: bool = False

    def pack(self) -> bytes:
        """Return the attachment in Zenoh's serialization format."""
        if self.named:
            sequence, stamp, gid = ((len(name), name) for name in NAMES)
            numbers = (*sequence, self.sequence, *stamp, self.stamp)
            return NAMED.pack(*numbers, *gid, len(self.gid), self.gid)
        return PLAIN.pack(self.sequence, self.stamp, len(self.gid), self.gid)


def parse_attachment(data: bytes) -> Attachment:
    """Return the attachment in `data`; ValueError if it is none."""
    if len(data) == NAMED.size:
        _, first, sequence, _, second, stamp, _, third, size, gid = NAMED.unpack(data)
        if (first, second, third) == NAMES and size == GID_BYTES:
            return Attachment(sequence, stamp, gid, named=True)
    if len(data) == PLAIN.size:
        sequence, stamp, size, gid = PLAIN.unpack(data)
        if size == GID_BYTES:
            return Attachment(sequence, stamp, gid)
    raise ValueError(f"an attachment of {len(data)} bytes is none of rmw_zenoh_cpp")


def parse_token(text: str) -> LivelinessToken:
    """Return the token with this key expression; ValueError if it is none.

    Parts that newer versions append are left out; unprintable characters of its names are escaped.
    """
    parts = text.split("/")
    if len(parts) < NODE_PARTS or parts[0] != SPACE or not all(parts):
        raise ValueError(f"{text!r} is no token of rmw_zenoh_cpp")
    domain, session, node_id, entity_id, code = parts[1:6]
    enclave, namespace, name = map(_name, parts[6:NODE_PARTS])
    kind = KINDS.get(code)
    topic, qos = None, Qos()
    if kind is not None and len(parts) >= ENDPOINT_PARTS:
        topic_name, dds_type, hashed = map(_name, parts[NODE_PARTS : ENDPOINT_PARTS - 1])
        topic = KeyTopic(
            name=topic_name,
            type_name=from_dds(dds_type),
            type_hash="" if hashed == NO_HASH else hashed,
        )
        qos = parse_qos(parts[ENDPOINT_PARTS - 1])
    elif code != NODE:
        raise ValueError(f"{text!r} is of no kind of endpoint that is known")
    return LivelinessToken(
        domain=int(domain),
        session=session,
        node_id=int(node_id),
        entity_id=int(entity_id),
        node=NodeName(name, namespace),
        enclave=enclave,
        kind=kind,
        topic=topic,
        qos=qos,
        key=text,
    )


def gid_of(token: str) -> bytes:
    """Return the identity of the endpoint whose token has this key expression."""
    import xxhash

    return xxhash.xxh3_128_digest(token.encode())[::-1]  # low half first, little-endian


def qos_text(qos: Qos) -> str:
    """Return a quality of service as it is in tokens: only the parts that are not the default.

    The parts: reliability, durability, history and depth, deadline, lifespan, liveliness.
    """
    reliability = "" if qos.reliable else BEST_EFFORT
    durability = TRANSIENT_LOCAL if qos.transient_local else ""
    depth = "" if qos.depth == DEFAULT_DEPTH else qos.depth
    lifespan = ","
    if not isinf(qos.lifespan):
        lifespan = ",".join(map(str, divmod(round(qos.lifespan * NANO), NANO)))
    return f"{reliability}:{durability}:,{depth}:,:{lifespan}:,,"


def parse_qos(text: str) -> Qos:
    """Return the quality of service in a token; ValueError if it is none."""
    reliability, durability, history, _, lifespan, *_ = *text.split(":"), *[""] * 4
    _, comma, depth = history.partition(",")
    if not comma:
        raise ValueError(f"{text!r} is no quality of service")
    return Qos(
        reliable=reliability != BEST_EFFORT,
        transient_local=durability == TRANSIENT_LOCAL,
        depth=int(depth or DEFAULT_DEPTH),
        lifespan=_seconds(lifespan),
    )


def _seconds(text: str) -> float:
    """Return a duration in a token [s]: its seconds and nanoseconds, left out if it has no end."""
    seconds, _, rest = text.partition(",")
    whole = int(seconds or FOREVER)
    return inf if whole >= FOREVER else whole + int(rest or 0) / NANO


def _mangled(name: str) -> str:
    return name.replace("/", "%")


def _name(part: str) -> str:
    return printable(part.replace("%", "/"))
