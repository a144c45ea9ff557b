"""Zenoh with peers of other versions, with sparse files of settings, and as a client."""

import json
import os
from collections.abc import Iterator
from contextlib import ExitStack, closing
from pathlib import Path
from struct import pack

import pytest
import zenoh

from pioneer3.ros.ros2.backend import NodeName, Qos
from pioneer3.ros.ros2.distros import distro_of
from pioneer3.ros.ros2.types import MessageTypes
from pioneer3.ros.zenoh.backend import ZenohBackend
from pioneer3.ros.zenoh.settings import ZenohOptions, session_config
from tests.ros2.zenoh_network import Program, free_port, wait_for
from tests.ros2.zenoh_peer import SETBOOL, STRING, SWITCH, TEXT

pytestmark = pytest.mark.realtime
DOMAIN = 100 + os.getpid() % 100
CLIENT = bytes(range(16))
AS_BEFORE = (
    b"\x0fsequence_number"
    + pack("<q", 7)
    + b"\x10source_timestamp"
    + pack("<q", 8)
    + b"\x0asource_gid\x10"
    + CLIENT
)
"""An attachment of Jazzy before rmw_zenoh_cpp 0.2.4."""


@pytest.fixture
def place() -> str:
    return f"tcp/localhost:{free_port()}"


@pytest.fixture
def open_here() -> Iterator[ExitStack]:
    with ExitStack() as stack:
        yield stack


def route(place: str, open_here: ExitStack) -> Program:
    program = Program("router", mode="router", listen=[place], connect=[])
    open_here.callback(program.kill)
    program.wait_for("Zenoh router")
    return program


def node(place: str, open_here: ExitStack, mode: str = "peer") -> ZenohBackend:
    types = MessageTypes(distro_of("jazzy"))
    options = ZenohOptions(domain=DOMAIN, connect=(place,), mode=mode)
    return open_here.enter_context(closing(ZenohBackend(NodeName("node"), types, options)))


def peer(place: str, open_here: ExitStack) -> "zenoh.Session":
    return open_here.enter_context(
        closing(zenoh.open(session_config(ZenohOptions(connect=(place,)))))
    )


def test_older_peers_get_responses_that_they_understand(place: str, open_here: ExitStack) -> None:
    route(place, open_here)
    node(place, open_here).serve("/switch", SWITCH, lambda request: request)
    older = peer(place, open_here)
    key = f"{DOMAIN}/switch/std_srvs::srv::dds_::SetBool_/{SETBOOL}"
    replies: list[zenoh.Reply] = []

    def answered() -> bool:
        replies.extend(older.get(key, payload=b"on", attachment=AS_BEFORE, timeout=5))
        return bool(replies)

    wait_for(answered, "a response")
    sample = replies[0].ok
    assert sample is not None
    assert sample.attachment is not None
    beside = sample.attachment.to_bytes()
    stamp = slice(41, 49)
    assert sample.payload.to_bytes() == b"on"
    assert beside[: stamp.start] + AS_BEFORE[stamp] + beside[stamp.stop :] == AS_BEFORE
    assert beside[stamp] != AS_BEFORE[stamp]


def test_messages_of_older_peers_have_a_publisher(place: str, open_here: ExitStack) -> None:
    route(place, open_here)
    gids: list[bytes] = []
    backend = node(place, open_here)
    backend.subscribe("/chat", TEXT, Qos(), lambda _, gid: gids.append(gid), lambda _: None)
    older = peer(place, open_here)
    key = f"{DOMAIN}/chat/std_msgs::msg::dds_::String_/{STRING}"

    def heard() -> bool:
        older.put(key, b"\0\1\0\0", attachment=AS_BEFORE)
        return bool(gids)

    wait_for(heard, "a message")
    assert set(gids) == {CLIENT}


def test_a_client_without_its_router_still_knows_itself(place: str, open_here: ExitStack) -> None:
    router = route(place, open_here)
    left: list[bytes] = []
    backend = node(place, open_here, mode="client")
    other = node(place, open_here)
    backend.advertise("/chat", TEXT, Qos())
    backend.subscribe("/chat", TEXT, Qos(), lambda *_: None, left.append)
    wait_for(lambda: len(backend.graph().nodes) == 2, "the other node")
    router.kill()
    wait_for(lambda: len(backend.graph().nodes) == 1, "the end of the other node")
    other.close()
    assert backend.graph().nodes == ("/node",)
    assert len(backend.graph().endpoints) == 2
    assert not left


@pytest.mark.parametrize("text", ["{}", "{transport: {link: {tx: {lease: 9000}}}}"])
def test_a_sparse_file_of_settings_opens_nothing_to_the_network(text: str, tmp_path: Path) -> None:
    file = tmp_path / "session.json5"
    file.write_text(text)
    config = session_config(ZenohOptions(config=file))
    assert json.loads(config.get_json("scouting/multicast/enabled")) is False
    assert json.loads(config.get_json("listen/endpoints")) == ["tcp/localhost:0"]
    assert json.loads(config.get_json("connect/endpoints")) == ["tcp/localhost:7447"]
    if "lease" in text:
        assert json.loads(config.get_json("transport/link/tx/lease")) == 9000


def test_a_file_of_settings_may_open_this_computer_to_the_network(tmp_path: Path) -> None:
    file = tmp_path / "session.json5"
    file.write_text(
        '{mode: "client", listen: {endpoints: ["tcp/0.0.0.0:7448"]},'
        ' connect: {endpoints: ["tcp/robot:7447"]}, scouting: {multicast: {enabled: true}}}'
    )
    config = session_config(ZenohOptions(config=file))
    assert json.loads(config.get_json("mode")) == "client"
    assert json.loads(config.get_json("scouting/multicast/enabled")) is True
    assert json.loads(config.get_json("listen/endpoints")) == ["tcp/0.0.0.0:7448"]
    assert json.loads(config.get_json("connect/endpoints")) == ["tcp/robot:7447"]


def test_zenoh_has_all_that_a_node_asks_of_a_backend() -> None:
    assert ZenohBackend.serves
    assert not ZenohBackend.strict
    assert ZenohBackend.lacks
