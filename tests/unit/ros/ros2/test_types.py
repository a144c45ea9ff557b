"""Messages as bytes, beside rosbags' own serialization for each distribution."""

import tomllib
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from rosbags.typesys import Stores, get_typestore

from pioneer3.ros.ros2.distros import distro_of, distros
from pioneer3.ros.ros2.types import HEADER, LONGEST_TEXT, MessageTypes, largest
from pioneer3.ros.typestore import full_name
from tests.combinations import examples
from tests.unit.ros.ros2.messages import for_rosbags, leaves, put, type_names, values

HASHES = Path(__file__).with_name("type_hashes.toml")
KNOWN = [
    (source, name, f"RIHS01_{digest}")
    for source, hashes in tomllib.loads(HASHES.read_text()).items()
    for name, digest in hashes.items()
]
OLDEST, *BETWEEN, NEWEST = distros()
each_distro = pytest.mark.parametrize("distro", [OLDEST, NEWEST])
each_type = pytest.mark.parametrize("type_name", type_names())


@cache
def types_of(distro: str) -> MessageTypes:
    return MessageTypes(distro_of(distro))


@cache
def store_of(distro: str) -> Any:
    return get_typestore(Stores(f"ros2_{distro}"))


@pytest.mark.parametrize("distro", BETWEEN)
def test_each_definition_is_that_of_the_oldest_distribution_or_of_the_newest(distro: str) -> None:
    """So these two stand for all of them below."""
    old, new = types_of(OLDEST).fields, types_of(NEWEST).fields
    for name, fields in types_of(distro).fields.items():
        assert fields in (old.get(name), new.get(name)), name


@each_distro
@each_type
@settings(max_examples=examples(12), suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_messages_are_the_bytes_of_rosbags(
    distro: str, type_name: str, data: st.DataObject
) -> None:
    types, store, full = types_of(distro), store_of(distro), full_name(type_name)
    content = data.draw(values(full, store.fielddefs))
    expected = bytes(store.serialize_cdr(for_rosbags(content, store), full, little_endian=True))
    assert len(expected) <= HEADER + largest(full, store.fielddefs)
    ours = types.encode(put(content, types.make))
    assert ours == expected
    decoded = types.decode(expected, full)
    assert list(leaves(decoded)) == list(leaves(store.deserialize_cdr(expected, full)))
    assert types.encode(decoded) == expected


@pytest.mark.parametrize(
    ("name", "most"),
    [
        ("geometry_msgs/msg/Twist", 2 * 6 * 8),
        ("geometry_msgs/msg/TwistStamped", 2 * LONGEST_TEXT),
        ("rmw_dds_common/msg/Gid", 2 * 16 * 8),
    ],
)
def test_messages_that_are_longer_than_their_type_can_be_are_refused(name: str, most: int) -> None:
    types = types_of("jazzy")
    with pytest.raises(ValueError, match=f"{most + HEADER} bytes, of .* at most"):
        types.decode(bytes((0, 1, 0, 0)) + bytes(most), name)


@each_distro
@each_type
def test_empty_messages_can_be_sent(distro: str, type_name: str) -> None:
    types, store, full = types_of(distro), store_of(distro), full_name(type_name)
    cdr = types.encode(types.make(type_name))
    assert cdr == bytes(store.serialize_cdr(store.deserialize_cdr(cdr, full), full))


@pytest.mark.parametrize(("distro", "size"), [("humble", 24), ("jazzy", 16), ("lyrical", 16)])
def test_the_graph_has_the_size_of_identities_of_its_distribution(distro: str, size: int) -> None:
    types = types_of(distro)
    gid = types.make("rmw_dds_common/Gid")
    assert len(types.encode(gid)) == 4 + size
    assert types.distro.gid_bytes == size


@pytest.mark.parametrize("distro", [name for name, each in distros().items() if each.type_hashes])
@pytest.mark.parametrize(("source", "name", "known"), KNOWN)
def test_hashes_are_those_of_others(distro: str, source: str, name: str, known: str) -> None:
    types = types_of(distro)
    own = types.service_type(name) if "/srv/" in name else types.message_type(name)
    assert own.hash == known, source


def test_transitions_have_another_hash_since_their_stamp_is_a_time() -> None:
    """Of Lyrical's installed descriptions; before, the stamp was a number."""
    lyrical = "RIHS01_78b19e2be41a797fc009c96bda68944182edabec7852cccd928a40bc06f6f9d7"
    name = "lifecycle_msgs/TransitionEvent"
    assert types_of("lyrical").message_type(name).hash == lyrical
    assert types_of("jazzy").message_type(name).hash != lyrical


def test_all_types_of_the_table_but_one_have_a_known_hash() -> None:
    known = {name for _, name, _ in KNOWN}
    missing = {full_name(name) for name in type_names()} - known
    assert missing == {
        "diagnostic_msgs/msg/DiagnosticArray",
        "lifecycle_msgs/msg/TransitionEvent",
        "rcl_interfaces/msg/Log",
    }


def test_humble_has_no_hashes() -> None:
    assert types_of("humble").message_type("nav_msgs/Odometry").hash == ""


@each_distro
@settings(max_examples=examples(300))
@given(cdr=st.binary(max_size=120), data=st.data())
def test_any_bytes_are_a_message_or_a_value_error(
    distro: str, cdr: bytes, data: st.DataObject
) -> None:
    types = types_of(distro)
    name = full_name(data.draw(st.sampled_from(type_names())))
    header = data.draw(st.sampled_from([b"", b"\0\1\0\0", b"\0\0\0\0", b"\0\7\0\0"]))
    with suppress(ValueError):
        types.decode(header + cdr, name)


@each_distro
@each_type
@settings(max_examples=examples(20), suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_broken_messages_are_value_errors_or_messages(
    distro: str, type_name: str, data: st.DataObject
) -> None:
    types, full = types_of(distro), full_name(type_name)
    whole = bytearray(types.encode(put(data.draw(values(full, types.fields)), types.make)))
    at = data.draw(st.integers(0, len(whole) - 1))
    whole[at : at + 4] = data.draw(st.sampled_from([b"\xff\xff\xff\xff", b"\xff\xff\xff\x7f"]))
    cut = data.draw(st.integers(0, len(whole)))
    for cdr in (bytes(whole), bytes(whole[:cut])):
        with suppress(ValueError):
            types.decode(cdr, full)
