"""Nodes and endpoints as DDS tells of them, those of programs that mean no good among them."""

from types import SimpleNamespace

import pytest

from pioneer3.names import printable
from pioneer3.ros.dds.discovery import INFO, NODE_INFO, Discovery
from pioneer3.ros.ros2.backend import NodeName
from pioneer3.ros.ros2.distros import distro_of
from pioneer3.ros.ros2.types import MessageTypes

FORGED = "x\x1b[2J\nready; the robot is safe"
TOLD = r"x\x1b[2J\nready; the robot is safe"


def test_names_from_the_network_forge_no_lines_of_a_log() -> None:
    types = MessageTypes(distro_of("jazzy"))
    discovery = Discovery(types, NodeName("pioneer3"), bytes(16))
    info, node = types.make(INFO), types.make(NODE_INFO)
    node.node_name, node.node_namespace = FORGED, "/a"
    info.node_entities_info_seq = [node]
    discovery.take_info(types.encode(info))
    policy = SimpleNamespace(__scope__="Userdata", data=f"typehash={FORGED};".encode())
    found = SimpleNamespace(
        topic_name=f"rt/{FORGED}",
        type_name=f"dds_::{FORGED}_",
        key=SimpleNamespace(bytes=bytes(16)),
        qos=[policy],
    )
    discovery.take_endpoint(found, reads=False)
    graph = discovery.graph()
    (endpoint,) = graph.endpoints
    assert graph.nodes == (f"/a/{TOLD}",)
    assert (endpoint.name, endpoint.type_name) == (f"/{TOLD}", TOLD)
    assert all(text.isprintable() for text in (endpoint.type_hash, *graph.nodes))


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("/robot1/odom", "/robot1/odom"),
        ("робот 1", "робот 1"),
        ("a\r\nb\x1b\x07", r"a\r\nb\x1b\x07"),
        ("\u202e\ud800", r"\u202e\ud800"),
    ],
)
def test_only_characters_that_terminals_act_upon_are_escaped(text: str, shown: str) -> None:
    assert printable(text) == shown
