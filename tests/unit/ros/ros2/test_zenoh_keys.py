from dataclasses import replace
from math import inf

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pioneer3.ros.ros2.backend import LATCHED, EndpointKind, NodeName, Qos, from_dds, to_dds
from pioneer3.ros.zenoh.keys import (
    Attachment,
    KeyTopic,
    LivelinessToken,
    gid_of,
    parse_attachment,
    parse_qos,
    parse_token,
    qos_text,
)

CHATTER = (
    "@ros2_lv/2/8b20917502ee955ac4476e0266340d5c/0/10/MP/%/%/talker/%chatter/"
    "std_msgs::msg::dds_::String_/"
    "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18/::,7:,:,:,,"
)
"""The token of a publisher in the documentation of rmw_zenoh_cpp's `liveliness_utils.hpp`."""
STRING = "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"
SENSOR_DATA = Qos(reliable=False, depth=5)
words = st.from_regex(r"[A-Za-z_][A-Za-z0-9_]{0,9}", fullmatch=True)
names = st.lists(words, min_size=1, max_size=3).map(lambda parts: "/" + "/".join(parts))
qualities = st.builds(
    Qos,
    reliable=st.booleans(),
    transient_local=st.booleans(),
    depth=st.integers(1, 10_000),
    lifespan=st.sampled_from((inf, 0.25, 10.0)),
)
topics = st.builds(
    KeyTopic,
    name=names,
    type_name=st.builds("{}/msg/{}".format, words, words),
    type_hash=st.sampled_from(("", STRING)),
)
nodes = st.builds(NodeName, words, st.one_of(st.just("/"), names))


def tokens(kind: EndpointKind | None) -> st.SearchStrategy[LivelinessToken]:
    endpoint = kind is not None
    return st.builds(
        LivelinessToken,
        domain=st.integers(0, 232),
        session=st.from_regex(r"[1-9a-f][0-9a-f]{0,31}", fullmatch=True),
        node_id=st.integers(0, 9),
        entity_id=st.integers(0, 99),
        node=nodes,
        kind=st.just(kind),
        topic=topics if endpoint else st.none(),
        qos=qualities if endpoint else st.just(Qos()),
    )


@given(st.sampled_from([None, *EndpointKind]).flatmap(tokens))
def test_a_token_reads_as_it_was_written(token: LivelinessToken) -> None:
    assert parse_token(token.text) == token
    assert replace(parse_token(token.text), key="").text == token.text
    assert parse_token(f"{token.text}/of/later/versions") == token or token.kind is None


def test_a_token_of_ros_reads_as_its_publisher() -> None:
    token = parse_token(CHATTER)
    endpoint = token.endpoint()
    assert replace(token, key="").text == CHATTER
    assert (token.domain, token.node_id, token.entity_id) == (2, 0, 10)
    assert endpoint is not None
    assert (endpoint.kind, endpoint.node, endpoint.name) == (
        EndpointKind.PUBLISHER,
        "/talker",
        "/chatter",
    )
    assert (endpoint.type_name, endpoint.type_hash) == ("std_msgs/msg/String", STRING)
    assert endpoint.qos == Qos(depth=7)
    assert endpoint.gid == gid_of(CHATTER)


def test_a_token_of_a_later_version_keeps_the_identity_that_its_program_sends() -> None:
    text = f"{CHATTER.replace('::,7:,:,:,,', '1:2:1,7:1,5:10,0:1,7,8')}/of/later/versions"
    token = parse_token(text)
    assert (token.text, token.gid) == (text, gid_of(text))


def test_names_of_a_token_forge_no_lines_of_a_log() -> None:
    text = CHATTER.replace("talker", "x\x1b[2J\nready").replace("chatter", "a\u2028b")
    endpoint = parse_token(text).endpoint()
    assert endpoint is not None
    assert (endpoint.node, endpoint.name) == (r"/x\x1b[2J\nready", r"/a\u2028b")
    assert endpoint.gid == gid_of(text)


def test_a_node_in_a_namespace_has_signs_for_its_slashes() -> None:
    token = LivelinessToken(
        domain=0, session="ab", node_id=0, entity_id=0, node=NodeName("pioneer3", "/lab/robot1")
    )
    assert token.text == "@ros2_lv/0/ab/0/0/NN/%/%lab%robot1/pioneer3"


@pytest.mark.parametrize(
    "text",
    [
        "",
        "@ros2_lv/0/ab/0/0/NN/%/%",
        "@ros2_lv/0/ab/0/0/XX/%/%/node",
        "@ros2_lv/0/ab/0/0/MP/%/%/node",
        "@ros2_lv/zero/ab/0/0/NN/%/%/node",
        "@ros2_lv/0//0/0/NN/%/%/node",
        CHATTER.replace("::,7:,:,:,,", "::7"),
    ],
)
def test_other_keys_are_no_tokens(text: str) -> None:
    with pytest.raises(ValueError, match=r"."):
        parse_token(text)


def test_topics_have_the_keys_of_ros() -> None:
    topic = KeyTopic(name="/robot1/odom", type_name="nav_msgs/msg/Odometry", type_hash="RIHS01_12")
    assert topic.key(7) == "7/robot1/odom/nav_msgs::msg::dds_::Odometry_/RIHS01_12"
    humble = KeyTopic(name="/chatter", type_name="std_msgs/msg/String")
    assert humble.key(0) == "0/chatter/std_msgs::msg::dds_::String_/TypeHashNotSupported"


@pytest.mark.parametrize(
    ("qos", "text"),
    [
        (Qos(), "::,10:,:,:,,"),
        (Qos(depth=42), "::,:,:,:,,"),
        (LATCHED, ":1:,1:,:,:,,"),
        (SENSOR_DATA, "2::,5:,:,:,,"),
        (Qos(transient_local=True, depth=1000, lifespan=10.0), ":1:,1000:,:10,0:,,"),
    ],
)
def test_qualities_of_service_are_written_as_in_ros(qos: Qos, text: str) -> None:
    assert qos_text(qos) == text
    assert parse_qos(text) == qos


def test_all_parts_of_a_quality_of_service_may_be_there() -> None:
    assert parse_qos("1:2:2,100:1,5:2,6:1,7,8") == Qos(depth=100, lifespan=2.000000006)


@given(words, st.sampled_from(("msg", "srv", "action")), words)
def test_names_of_types_read_as_they_were_written(package: str, kind: str, name: str) -> None:
    assert from_dds(to_dds(f"{package}/{kind}/{name}")) == f"{package}/{kind}/{name}"


@given(
    st.integers(-(2**63), 2**63 - 1),
    st.integers(0, 2**63 - 1),
    st.binary(min_size=16, max_size=16),
)
def test_an_attachment_reads_as_it_was_written(sequence: int, stamp: int, gid: bytes) -> None:
    attachment = Attachment(sequence, stamp, gid)
    assert parse_attachment(attachment.pack()) == attachment


def test_attachments_are_as_zenoh_serializes_them() -> None:
    packed = Attachment(1, 2, bytes(range(16))).pack()
    assert packed.hex() == "0100000000000000020000000000000010" + bytes(range(16)).hex()


@given(st.binary(max_size=80))
def test_other_attachments_are_refused(data: bytes) -> None:
    if len(data) == 33 and data[16] == 16:
        return
    with pytest.raises(ValueError, match="attachment"):
        parse_attachment(data)


@pytest.mark.parametrize(
    ("size", "digest"),
    [
        (17, "0850e67d6d4b871540e300daae88f77b"),
        (33, "920558e5507739b2fb0f4e027c65805f"),
        (100, "3f39e28d5f7549cb85d815591f315e9f"),
        (128, "4881418a4401efa9f2d023e4cb129b47"),
        (129, "7637c72625e291de513c00c82a06b286"),
        (200, "b244bd8c1e048e9609ebe5456f9b0e31"),
        (240, "3d2cae5dd7ebf719f21f405939ef59dc"),
        (241, "3eb8c77effc4034c5e2953bf65b81fd3"),
        (1024, "16a2bbc2a0db0b2ee986ef9bf982ccc1"),
        (1025, "a7e209c68d5aaf32a1f36101d60dd6f4"),
        (1100, "cb48519d3a14c7a68d43507430264e2e"),
    ],
)
def test_identities_are_digests_of_128_bits_by_xxh3(size: int, digest: str) -> None:
    """The expected ones are by libxxhash 0.8.1."""
    assert gid_of(("pioneer3/" * 200)[:size]).hex() == digest
