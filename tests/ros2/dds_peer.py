"""A program on DDS with none of this project's code: `dds_peer.py DOMAIN GID_BYTES`.

It takes commands as lines of JSON, and prints one for each message and endpoint. Its types are
written here by hand, after ROS 2's definitions; the codec is that of Cyclone DDS.
"""

import json
import os
import select
import sys
import time
import zlib
from array import array
from importlib import import_module
from typing import Any

XML = """<Domain><General><Interfaces><NetworkInterface address="127.0.0.1"/></Interfaces>
<AllowMulticast>false</AllowMulticast></General><Discovery>
<ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>99</MaxAutoParticipantIndex>
<Peers><Peer address="127.0.0.1"/></Peers></Discovery></Domain>"""
PAUSE = 0.004
LARGE = 4096
"""Longer sequences are told by their length and checksum."""
idl = import_module("cyclonedds.idl")
of = import_module("cyclonedds.idl.types")
clayer = import_module("cyclonedds._clayer")
DEFINED: dict[str, Any] = {}


def define(name: str, /, **fields: Any) -> Any:
    """Define a type such as `std_msgs/msg/Bool`."""
    package, kind, last = name.split("/")
    wire = f"{package}::{kind}::dds_::{last}_"
    DEFINED[name] = idl.make_idl_struct(f"{package}_{last}", wire, fields)
    return DEFINED[name]


def define_types(gid_bytes: int) -> None:
    """Define the types; the size of identities depends on the distribution."""
    stamp = define("builtin_interfaces/msg/Time", sec=of.int32, nanosec=of.uint32)
    header = define("std_msgs/msg/Header", stamp=stamp, frame_id=str)
    define("std_msgs/msg/Bool", data=bool)
    define("std_msgs/msg/String", data=str)
    define("std_msgs/msg/Empty", structure_needs_at_least_one_member=of.uint8)
    axes = dict.fromkeys("xyz", of.float64)
    vector = define("geometry_msgs/msg/Vector3", **axes)
    point = define("geometry_msgs/msg/Point", **axes)
    turn = define("geometry_msgs/msg/Quaternion", **axes, w=of.float64)
    pose = define("geometry_msgs/msg/Pose", position=point, orientation=turn)
    covariance = of.array[of.float64, 36]
    posed = define("geometry_msgs/msg/PoseWithCovariance", pose=pose, covariance=covariance)
    twist = define("geometry_msgs/msg/Twist", linear=vector, angular=vector)
    define("geometry_msgs/msg/TwistStamped", header=header, twist=twist)
    moved = define("geometry_msgs/msg/TwistWithCovariance", twist=twist, covariance=covariance)
    define("nav_msgs/msg/Odometry", header=header, child_frame_id=str, pose=posed, twist=moved)
    transform = define("geometry_msgs/msg/Transform", translation=vector, rotation=turn)
    stamped = define(
        "geometry_msgs/msg/TransformStamped", header=header, child_frame_id=str, transform=transform
    )
    define("tf2_msgs/msg/TFMessage", transforms=of.sequence[stamped])
    pair = define("diagnostic_msgs/msg/KeyValue", key=str, value=str)
    status = define(
        "diagnostic_msgs/msg/DiagnosticStatus",
        level=of.uint8,
        name=str,
        message=str,
        hardware_id=str,
        values=of.sequence[pair],
    )
    define("diagnostic_msgs/msg/DiagnosticArray", header=header, status=of.sequence[status])
    texts = {"name": str, "msg": str, "file": str, "function": str}
    define("rcl_interfaces/msg/Log", stamp=stamp, level=of.uint8, **texts, line=of.uint32)
    about = {"resolution": of.float32, "width": of.uint32, "height": of.uint32, "origin": pose}
    info = define("nav_msgs/msg/MapMetaData", map_load_time=stamp, **about)
    define("nav_msgs/msg/OccupancyGrid", header=header, info=info, data=of.sequence[of.int8])
    gid = define("rmw_dds_common/msg/Gid", data=of.array[of.uint8, gid_bytes])
    gids = {f"{kind}_gid_seq": of.sequence[gid] for kind in ("reader", "writer")}
    names = dict.fromkeys(("node_namespace", "node_name"), of.bounded_str[256])
    node = define("rmw_dds_common/msg/NodeEntitiesInfo", **names, **gids)
    define(
        "rmw_dds_common/msg/ParticipantEntitiesInfo",
        gid=gid,
        node_entities_info_seq=of.sequence[node],
    )
    # named as the node names them: rmw_cyclonedds_cpp has no names to compare, this library has
    head = {"client_id": of.uint64, "sequence": of.int64}
    define("std_srvs/srv/SetBool_Request", **head, data=bool)
    define("std_srvs/srv/SetBool_Response", **head, success=bool, message=str)


def made(kind: Any, fields: dict[str, Any]) -> Any:
    """Return a message; fields that are not given are 0."""
    values = {}
    for name, field in kind.__annotations__.items():
        given = fields.get(name)
        if hasattr(field, "__idl__"):
            values[name] = made(field, given or {})
        elif given is None and isinstance(of_field(field), of.sequence | of.array):
            values[name] = []
        elif isinstance(given, list) and given and isinstance(given[0], dict):
            values[name] = [made(of_field(field).subtype, each) for each in given]
        else:
            values[name] = given if given is not None else ("" if field is str else 0)
    return kind(**values)


def of_field(field: Any) -> Any:
    """Return the description of a sequence, an array or a bounded string; else `None`."""
    return next(iter(getattr(field, "__metadata__", ())), None)


def told(value: Any) -> Any:
    """Return a message or a part of it for JSON."""
    if hasattr(value, "__idl__"):
        return {name: told(getattr(value, name)) for name in value.__annotations__}
    if isinstance(value, list | bytes) and len(value) > LARGE:
        return {"length": len(value), "crc": zlib.crc32(array("b", value))}
    return [told(each) for each in value] if isinstance(value, list | bytes) else value


def say(**line: Any) -> None:
    """Print what happened; times are those of the monotonic clock [s]."""
    sys.stdout.write(json.dumps({"at": time.monotonic(), **line}) + "\n")
    sys.stdout.flush()


class Peer:
    """A participant with readers and writers by name."""

    def __init__(self, domain: int) -> None:
        from cyclonedds import builtin
        from cyclonedds.domain import Domain, DomainParticipant

        self.domain = Domain(domain, XML)
        self.participant = DomainParticipant(domain)
        self.entities: dict[str, Any] = {}
        self.kinds: dict[str, Any] = {}
        self.builtin = {
            kind: builtin.BuiltinDataReader(
                self.participant, getattr(builtin, f"BuiltinTopicDcps{kind.title()}")
            )
            for kind in ("participant", "publication", "subscription")
        }
        say(guid=self.participant.guid.bytes.hex())

    def open(self, *, key: str, topic: str, kind: str, reads: bool, **wanted: Any) -> None:
        """Open a reader or a writer."""
        from cyclonedds.pub import DataWriter
        from cyclonedds.sub import DataReader
        from cyclonedds.topic import Topic

        place = Topic(self.participant, topic, DEFINED[kind])
        make = DataReader if reads else DataWriter
        self.entities[key] = make(self.participant, place, qos=qos_of(**wanted))
        self.kinds[key] = DEFINED[kind]
        say(opened=key, guid=self.entities[key].guid.bytes.hex())

    def send(self, *, key: str, fields: dict[str, Any], fill: int = 0) -> None:
        """Send a message; `fill` makes it an occupancy grid of so many cells."""
        message = made(self.kinds[key], fields)
        if fill:
            message.data = [number % 101 for number in range(fill)]
        self.entities[key].write(message)

    def send_raw(self, *, key: str, cdr: str, zeros: int = 0) -> None:
        """Send bytes as they are, four or more, and zeros after them."""
        clayer.ddspy_write(self.entities[key]._ref, bytes.fromhex(cdr) + bytes(zeros))

    def close(self, *, key: str) -> None:
        """Close a reader or a writer."""
        entity = self.entities.pop(key)
        entity._entities.pop(entity._ref)
        entity._delete(entity._ref)
        say(closed=key)

    def take(self) -> None:
        """Tell all that has come."""
        for kind, reader in self.builtin.items():
            for each in reader.take(64):
                self._found(kind, each)
        for key, reader in list(self.entities.items()):
            if not hasattr(reader, "take"):
                continue
            samples = clayer.ddspy_take(reader._ref, 0, 64)
            for data, info in samples if isinstance(samples, list) else ():
                if not info.valid_data:
                    say(key=key, left=True)
                    continue
                message = self.kinds[key].deserialize(data)
                raw = data.hex() if len(data) < LARGE else ""
                say(key=key, message=told(message), cdr=raw)

    def _found(self, kind: str, each: Any) -> None:
        key = each.key.bytes.hex()
        if not each.sample_info.valid_data:
            say(found=kind, guid=key, gone=True)
            return
        by_scope = {policy.__scope__: policy for policy in each.qos}
        data = bytes(by_scope["Userdata"].data) if "Userdata" in by_scope else b""
        names = {scope: type(policy).__name__ for scope, policy in by_scope.items()}
        about = {"topic": each.topic_name, "type": each.type_name} if kind != "participant" else {}
        qos = {scope: names.get(scope, "") for scope in ("Reliability", "Durability")}
        depth = getattr(by_scope.get("History"), "depth", 0)
        say(found=kind, guid=key, data=data.decode(), **about, **qos, depth=depth)


def qos_of(
    *,
    reliable: bool = True,
    latched: bool = False,
    depth: int = 10,
    deadline: float = 0.0,
    data: str = "",
) -> Any:
    """Return a quality of service."""
    from cyclonedds.qos import Policy, Qos
    from cyclonedds.util import duration

    wanted: list[Any] = [
        Policy.Reliability.Reliable(duration(seconds=1))
        if reliable
        else Policy.Reliability.BestEffort,
        Policy.Durability.TransientLocal if latched else Policy.Durability.Volatile,
        Policy.History.KeepLast(depth),
    ]
    if latched:
        wanted.append(Policy.DurabilityService(0, Policy.History.KeepLast(depth), -1, -1, -1))
    if deadline:
        wanted.append(Policy.Deadline(duration(seconds=deadline)))
    if data:
        wanted.append(Policy.Userdata(data.encode()))
    return Qos(*wanted)


def main(domain: int, gid_bytes: int) -> None:
    define_types(gid_bytes)
    peer = Peer(domain)
    rest = b""
    while True:
        peer.take()
        if not select.select([sys.stdin], [], [], PAUSE)[0]:
            continue
        data = os.read(sys.stdin.fileno(), 1 << 20)
        if not data:
            return
        *lines, rest = (rest + data).split(b"\n")
        for line in lines:
            command = json.loads(line)
            getattr(peer, command.pop("do"))(**command)


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]))
