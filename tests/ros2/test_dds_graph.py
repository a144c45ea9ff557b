"""The graph over DDS as another program reads it, byte for byte."""

import signal
import struct
from functools import partial
from typing import Any

import pytest

from pioneer3.ros.ros2.distros import distro_of
from pioneer3.ros.ros2.network import BackendName
from pioneer3.ros.ros2.types import MessageTypes
from tests.e2e.processes import until
from tests.ros2.conftest import robot_on
from tests.ros2.dds_network import Message, program_on
from tests.ros2.networks import network_of

pytestmark = [pytest.mark.realtime]
INFO = "rmw_dds_common/msg/ParticipantEntitiesInfo"
GRAPH: dict[str, Any] = {"latched": True, "depth": 100}
WIRE_TYPES = {
    "rt/odom": "nav_msgs::msg::dds_::Odometry_",
    "rt/tf": "tf2_msgs::msg::dds_::TFMessage_",
    "rt/diagnostics": "diagnostic_msgs::msg::dds_::DiagnosticArray_",
    "rt/sonar/range_0": "sensor_msgs::msg::dds_::Range_",
    "rt/rosout": "rcl_interfaces::msg::dds_::Log_",
}


def text(value: str) -> bytes:
    """Return a string in CDR, padded for what follows."""
    data = struct.pack("<I", len(value) + 1) + value.encode() + b"\0"
    return data + bytes(-len(data) % 4)


def graph_bytes(participant: bytes, message: Message, gid_bytes: int) -> bytes:
    """Return a message of the graph as ROS 2 lays it out: one node, its readers, its writers."""
    (node,) = message.fields["node_entities_info_seq"]
    parts = [b"\0\1\0\0", participant.ljust(gid_bytes, b"\0"), struct.pack("<I", 1)]
    parts += [text(node["node_namespace"]), text(node["node_name"])]
    for kind in ("reader_gid_seq", "writer_gid_seq"):
        gids = [bytes(gid["data"]) for gid in node[kind]]
        parts += [struct.pack("<I", len(gids)), *gids]
    return b"".join(parts)


def of_node(messages: list[Message], name: str) -> list[Message]:
    return [
        message
        for message in messages
        if any(node["node_name"] == name for node in message.fields["node_entities_info_seq"])
    ]


def gids(message: Message, kind: str) -> set[bytes]:
    (node,) = message.fields["node_entities_info_seq"]
    return {bytes(gid["data"]) for gid in node[f"{kind}_gid_seq"]}


@pytest.mark.parametrize("distro", ["humble", "jazzy"])
async def test_the_graph_is_as_ros_2_has_it(distro: str) -> None:
    known = distro_of(distro)
    size, types = known.gid_bytes, MessageTypes(known)
    async with (
        network_of(BackendName.DDS) as network,
        program_on(network, size) as program,
        robot_on(network, "--namespace", "robot1", "--distro", distro) as robot,
    ):
        infos = await program.reader("ros_discovery_info", INFO, **GRAPH)
        await until(lambda: len(of_node(infos, "pioneer3")) > 0)

        def is_complete() -> bool:
            there = {bytes.fromhex(guid).ljust(size, b"\0") for guid in own("publication")}
            return gids(infos[-1], "writer") == there and len(there) > 20

        def own(kind: str) -> dict[str, dict[str, Any]]:
            prefix = bytes(infos[-1].fields["gid"]["data"])[:12].hex()
            return {
                guid: each
                for guid, each in program.found.items()
                if guid.startswith(prefix) and each["found"] == kind and each["topic"][:4] != "DCPS"
            }

        await until(is_complete)
        message = infos[-1]
        assert {node["node_namespace"] for node in message.fields["node_entities_info_seq"]} == {
            "/robot1"
        }
        participant = bytes(message.fields["gid"]["data"])[:16]
        assert program.found[participant.hex()]["data"] == "enclave=/;"
        assert message.cdr == graph_bytes(participant, message, size)
        readers = {bytes.fromhex(guid).ljust(size, b"\0") for guid in own("subscription")}
        assert gids(message, "reader") == readers
        for each in (*own("publication").values(), *own("subscription").values()):
            type_name = each["type"].replace("::", "/").replace("/dds_", "").removesuffix("_")
            expected = types.message_type(type_name).hash
            assert each["data"] == (f"typehash={expected};" if expected else "")
            assert each["topic"] == "ros_discovery_info" or each["topic"].startswith("rt/")
        (about,) = [
            each for each in own("publication").values() if each["topic"] == "ros_discovery_info"
        ]
        assert about["type"] == "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_"
        assert (about["Reliability"], about["Durability"], about["depth"]) == (
            "Reliability.Reliable",
            "Durability.TransientLocal",
            1,
        )
        code, _ = await robot.node.end(signal.SIGINT)
        assert code == 130
        await until(lambda: participant.hex() not in program.found)
        assert not program.endpoints("rt/robot1/odom")


async def test_endpoints_leave_the_graph_when_they_are_closed() -> None:
    async with (
        network_of(BackendName.DDS) as network,
        program_on(network) as program,
        network.peer("short") as peer,
    ):
        infos = await program.reader("ros_discovery_info", INFO, **GRAPH)
        publisher = peer.publisher("/chat", "std_msgs/String")
        await until(lambda: program.endpoints("rt/chat"))
        guid = bytes.fromhex(program.endpoints("rt/chat")[0]["guid"])
        await until(lambda: infos and guid in gids(infos[-1], "writer"))
        publisher.close()
        await until(lambda: guid not in gids(infos[-1], "writer"))
        await until(lambda: not program.endpoints("rt/chat"))


async def test_names_on_the_wire_have_ros_2s_prefixes() -> None:
    """`rt/` topics, `rq/` requests, `rr/` replies; services only where somebody asks for them."""
    async with (
        network_of(BackendName.DDS) as network,
        program_on(network) as program,
        robot_on(network, "--dds-services"),
    ):
        for topic, type_name in WIRE_TYPES.items():
            await until(partial(program.endpoints, topic))
            assert program.endpoints(topic)[0]["type"] == type_name
        await until(lambda: program.endpoints("rq/sonar/enableRequest", "subscription"))
        await until(lambda: program.endpoints("rr/sonar/enableReply"))
        (request,) = program.endpoints("rq/sonar/enableRequest", "subscription")
        (reply,) = program.endpoints("rr/sonar/enableReply")
        assert request["type"] == "std_srvs::srv::dds_::SetBool_Request_"
        assert reply["type"] == "std_srvs::srv::dds_::SetBool_Response_"
