"""Types of Cyclone DDS whose samples are serialized bytes: no codec of the library runs."""

from collections.abc import Mapping
from importlib import import_module
from typing import Any

from pioneer3.ros.ros2.backend import MessageType, to_dds
from pioneer3.ros.ros2.types import MessageTypes
from pioneer3.ros.typestore import ARRAY, BASE, NAME


class SampleTypes:
    """Makes the type of a topic's samples; `sample.cdr` are its bytes."""

    def __init__(self, types: MessageTypes) -> None:
        self._fields = types.fields
        self._made: dict[str, type] = {}
        self._structs: dict[str, type] = {}

    def of(self, type_: MessageType, head: Mapping[str, str] | None = None) -> Any:
        """Return the class of samples; `head` has types of fields before the message, by name."""
        key = f"{type_.name}{'+' if head else ''}"
        if key not in self._made:
            self._made[key] = _of_bytes(self._struct(type_, head or {}))
        return self._made[key]

    def _struct(self, type_: MessageType, head: Mapping[str, str]) -> Any:
        from cyclonedds.idl import make_idl_struct

        types = _idl_types()

        if type_.name in self._structs and not head:
            return self._structs[type_.name]
        fields = {name: getattr(types, kind) for name, kind in head.items()}
        for name, desc in self._fields[type_.name][1]:
            fields[name] = self._field(*desc)
        made = make_idl_struct(type_.name.replace("/", "_"), to_dds(type_.name), fields)
        if not head:
            self._structs[type_.name] = made
        return made

    def _field(self, kind: int, what: Any) -> Any:
        types = _idl_types()

        if kind == BASE:
            return _base(*what)
        if kind == NAME:
            return self._struct(MessageType(what), {})
        (inner, base), length = what
        each = self._field(inner, base)
        if kind == ARRAY:
            return types.array[each, length]
        return types.sequence[each, length] if length else types.sequence[each]


def _idl_types() -> Any:
    return import_module("cyclonedds.idl.types")  # without the types of its stubs


def _base(name: str, limit: int) -> Any:
    types = _idl_types()

    if name == "string":
        return types.bounded_str[limit] if limit else str
    if name == "bool":
        return bool
    return getattr(types, {"byte": "uint8", "char": "uint8"}.get(name, name))


def _of_bytes(struct: Any) -> Any:
    """Return the type `struct` with samples that are bytes; they have its name on the wire."""

    def make(self: Any, cdr: bytes) -> None:
        self.cdr = cdr

    def serialize(self: Any, *_: object, **__: object) -> bytes:
        cdr: bytes = self.cdr
        return cdr

    def deserialize(cls: Any, data: bytes, /, *_: object, **__: object) -> Any:
        return cls(data)

    def deserialize_key(cls: Any, /, *_: object, **__: object) -> Any:
        return cls(b"")

    struct.__init__, struct.serialize = make, serialize
    struct.deserialize, struct.deserialize_key = (
        classmethod(deserialize),
        classmethod(deserialize_key),
    )
    return struct
