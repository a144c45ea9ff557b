"""Messages of one distribution: empty ones to fill, and their serialized form.

Definitions of messages are those of rosbags, definitions of services those of `services.toml`.
"""

import tomllib
from collections.abc import Callable, Iterable, Mapping
from copy import copy
from functools import cache
from importlib.resources import files
from math import inf
from typing import Any, Final

from pioneer3.distribution import how_to_get
from pioneer3.errors import ConfigError
from pioneer3.ros.encoding import CDR, encoder
from pioneer3.ros.encoding import LARGEST as LARGEST_NUMBER
from pioneer3.ros.ros2.backend import MessageType, ServiceType
from pioneer3.ros.ros2.distros import Distro
from pioneer3.ros.typestore import BASE, NAME, MessageStore, full_name

EVENT_INFO: Final = "service_msgs/msg/ServiceEventInfo"
HEADER: Final = 4
"""Bytes before a serialized message that tell how it is serialized."""
LONGEST_TEXT: Final = 2**20
"""Longest text in a message without sequences that is taken [B]."""
SEQUENCE: Final = 4
"""Kind of a field that is a sequence in rosbags' definitions."""


class MessageTypes(MessageStore):
    """The types of one distribution; ConfigError if rosbags is not installed."""

    def __init__(self, distro: Distro) -> None:
        try:
            from rosbags.serde import SerdeError
            from rosbags.typesys import Stores, get_types_from_msg, get_typestore
        except ImportError as error:
            advice = how_to_get("zenoh")
            raise ConfigError(f"ROS 2 without ROS needs rosbags: {advice}") from error
        self.distro = distro
        super().__init__(get_typestore(Stores(f"ros2_{distro.name}")))
        self._services = _service_definitions()
        for name, parts in self._services.items():
            for part, text in parts.items():
                part_name = f"{name}_{part.title()}"
                (fields,) = get_types_from_msg(text, part_name).values()
                self._store.register({part_name: fields})
        self._hashes = copy(self._store)
        self._hashes.fielddefs = _hashed(self._store.fielddefs, self._services)
        self._broken = (SerdeError, AssertionError, IndexError)
        self._known: dict[str, tuple[str, float]] = {}
        self._encoders: dict[str, Callable[[Any], bytes]] = {}

    def message_type(self, name: str) -> MessageType:
        """Return the type `nav_msgs/msg/Odometry`, or `nav_msgs/Odometry`; else ConfigError."""
        full = full_name(name)
        if full not in self._store.fielddefs:
            raise ConfigError(f"ROS 2 {self.distro.name} has no message type {full}")
        return MessageType(full, self._hash(full))

    def text(self, name: str) -> str:
        """Return the definition of a message type, with the types in it, as bags hold it."""
        text, _ = self._store.generate_msgdef(full_name(name), ros_version=2)
        return str(text)

    def service_type(self, name: str) -> ServiceType:
        """Return a type of services such as `std_srvs/SetBool`; ConfigError if there is none."""
        full = full_name(name, "srv")
        if full not in self._services:
            raise ConfigError(f"no definition of the service type {full} is here")
        return ServiceType(
            full,
            self._hash(full),
            MessageType(f"{full}_Request", self._hash(f"{full}_Request")),
            MessageType(f"{full}_Response", self._hash(f"{full}_Response")),
        )

    def encode(self, message: Any) -> bytes:
        """Return the serialized form: little-endian CDR with its header of 4 bytes.

        Lists of numbers may stand for arrays, and `bytes` for arrays of bytes.
        """
        name = message.__msgtype__
        if name not in self._encoders:
            self._encoders[name] = encoder(name, self._store.fielddefs, CDR)
        return self._encoders[name](message)

    def decode(self, cdr: bytes, name: str) -> Any:
        """Return the message of a type such as `nav_msgs/msg/Odometry` in `cdr`.

        Raises:
            ValueError: `cdr` is none of this type, or longer than one of it can be.
        """
        if name not in self._known:
            full = full_name(name)
            self._known[name] = full, HEADER + largest(full, self._store.fielddefs)
        full, most = self._known[name]
        if len(cdr) > most:
            raise ValueError(f"{len(cdr)} bytes, of {most:.0f} at most")
        try:
            return self._store.deserialize_cdr(cdr, full)
        except self._broken as error:
            raise ValueError(str(error)) from error

    def trimmed(self, cdr: bytes, name: str) -> bytes:
        """Return a serialized message without the bytes behind it.

        rmw_fastrtps serializes into as many bytes as a message of that length may take at most.
        """
        definition = self._store.get_msgdef(full_name(name))
        _, end = definition.deserialize_cdr_le(cdr[HEADER:], 0, definition.cls, self._store)
        return cdr[: HEADER + end]

    def _hash(self, name: str) -> str:
        return str(self._hashes.hash_rihs01(name)) if self.distro.type_hashes else ""


def largest(name: str, fields: Mapping[str, Any]) -> float:
    """Return the most bytes that a message may have; `inf` if it has sequences without a bound."""

    def size(kind: int, what: Any) -> float:
        if kind == NAME:
            return largest(what, fields)
        if kind == BASE:
            base, limit = what
            return LARGEST_NUMBER + (limit or LONGEST_TEXT if base == "string" else 0)
        item, length = what
        return LARGEST_NUMBER + (length or inf) * size(*item)

    return sum((size(*desc) for _, desc in fields[name][1]), LARGEST_NUMBER)


def _hashed(fields: Mapping[str, Any], services: Iterable[str]) -> Mapping[str, Any]:
    """Return the fields that hashes are of, as REP 2016 defines them, also those of services."""
    hashed = {
        name: (constants, [(field, _counted(desc)) for field, desc in own])
        for name, (constants, own) in fields.items()
    }
    for name in services:
        request, response, event = (
            (NAME, f"{name}_{part}") for part in ("Request", "Response", "Event")
        )
        own = [("request_message", request), ("response_message", response)]
        hashed[name] = ([], [*own, ("event_message", event)])
        optional = [("request", (SEQUENCE, (request, 1))), ("response", (SEQUENCE, (response, 1)))]
        hashed[event[1]] = ([], [("info", (NAME, EVENT_INFO)), *optional])
    return hashed


def _counted(desc: Any) -> Any:
    """Return the kind of a field as rosidl counts it, which turns `char` into `uint8` before."""
    kind, what = desc
    if kind == BASE:
        return (kind, ("uint8", 0)) if what[0] == "char" else desc
    return desc if kind == NAME else (kind, (_counted(what[0]), what[1]))


@cache
def _service_definitions() -> dict[str, dict[str, str]]:
    text = files("pioneer3.ros.ros2").joinpath("services.toml").read_text()
    return tomllib.loads(text)
