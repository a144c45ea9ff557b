"""Zenoh on loopback: this process, others, and a router of its own for each test."""

import asyncio
import logging
import os
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest
import zenoh

from pioneer3.errors import ConfigError, LinkError
from pioneer3.ros.ros2.backend import LATCHED, EndpointKind, NodeName, Qos
from pioneer3.ros.ros2.distros import distro_of
from pioneer3.ros.ros2.types import MessageTypes
from pioneer3.ros.zenoh.backend import ZenohBackend
from pioneer3.ros.zenoh.keys import Attachment, gid_of
from pioneer3.ros.zenoh.settings import ZenohOptions, serve_router, session_config
from tests.ros2.zenoh_network import Authority, Cable, Program, free_port, wait_for
from tests.ros2.zenoh_peer import LARGE, SETBOOL, STRING, SWITCH, TEXT

pytestmark = pytest.mark.realtime
DOMAIN = 100 + os.getpid() % 100
TYPE_KEY = f"std_msgs::msg::dds_::String_/{STRING}"
SECRET = "correct-horse"
SENSOR_DATA = Qos(reliable=False, depth=5)
Nodes = Callable[..., ZenohBackend]
Programs = Callable[..., Program]


@dataclass
class Inbox:
    """Everything that a subscriber hears."""

    messages: list[bytes] = field(default_factory=list)
    gids: set[bytes] = field(default_factory=set)
    left: list[bytes] = field(default_factory=list)

    def received(self, cdr: bytes, gid: bytes) -> None:
        self.messages.append(cdr)
        self.gids.add(gid)

    def subscribe(self, backend: ZenohBackend, name: str = "/chat", qos: Qos | None = None) -> Any:
        return backend.subscribe(name, TEXT, qos or Qos(), self.received, self.left.append)


@pytest.fixture
def programs() -> Iterator[Programs]:
    running: list[Program] = []

    def start(role: str, **options: object) -> Program:
        running.append(Program(role, **options))
        return running[-1]

    yield start
    for each in running:
        each.kill()


@pytest.fixture
def router(programs: Programs) -> str:
    place = f"tcp/localhost:{free_port()}"
    start_router(programs, place)
    return place


@pytest.fixture
def nodes(request: pytest.FixtureRequest) -> Iterator[Nodes]:
    running: list[ZenohBackend] = []
    types = MessageTypes(distro_of("jazzy"))

    def start(name: str, connect: str, **options: Any) -> ZenohBackend:
        given = ZenohOptions(**{"domain": DOMAIN, "connect": (connect,), **options})
        running.append(ZenohBackend(NodeName(name, "/test"), types, given))
        return running[-1]

    yield start
    for each in running:
        each.close()


def start_router(programs: Programs, place: str, **options: object) -> Program:
    given = {"mode": "router", "listen": [place], "connect": [], **options}
    program = programs("router", **given)
    program.wait_for("Zenoh router")
    return program


def raw_session(place: str) -> "zenoh.Session":
    return zenoh.open(session_config(ZenohOptions(connect=(place,))))


def heard(writer: Any, inbox: Inbox, text: bytes) -> Callable[[], bool]:
    """Return a condition that sends `text` until it is heard."""

    def condition() -> bool:
        writer.write(text)
        return text in inbox.messages

    return condition


@pytest.mark.parametrize("of_publisher", [Qos(), SENSOR_DATA, LATCHED])
@pytest.mark.parametrize("of_subscriber", [Qos(), SENSOR_DATA, LATCHED])
def test_messages_arrive_whatever_the_quality_of_service(
    router: str, nodes: Nodes, of_publisher: Qos, of_subscriber: Qos
) -> None:
    talker, listener, inbox = nodes("talker", router), nodes("listener", router), Inbox()
    writer = talker.advertise("/chat", TEXT, of_publisher)
    inbox.subscribe(listener, qos=of_subscriber)
    wait_for(heard(writer, inbox, b"hello"), "a message")
    wait_for(lambda: len(listener.graph().endpoints) == 2, "the graph")
    publisher, subscriber = sorted(listener.graph().endpoints, key=lambda each: each.kind)
    assert (publisher.qos, subscriber.qos) == (of_publisher, of_subscriber)
    assert inbox.gids == {publisher.gid}


@pytest.mark.parametrize("qos", [Qos(), LATCHED], ids=["volatile", "latched"])
def test_a_publisher_knows_whether_anybody_subscribes(qos: Qos, router: str, nodes: Nodes) -> None:
    talker, listener, inbox = nodes("talker", router), nodes("listener", router), Inbox()
    writer = talker.advertise("/chat", TEXT, qos)
    assert not writer.matched
    reader = inbox.subscribe(listener, "/chat", qos)
    wait_for(lambda: writer.matched, "matched")
    reader.close()
    wait_for(lambda: not writer.matched, "not matched")


def test_late_subscribers_get_latched_messages_large_ones_too(
    router: str, nodes: Nodes, programs: Programs
) -> None:
    programs("latch", domain=DOMAIN, connect=[router]).wait_for("ready")
    listener, small, large = nodes("listener", router), Inbox(), Inbox()
    small.subscribe(listener, "/small", LATCHED)
    large.subscribe(listener, "/large", LATCHED)
    wait_for(lambda: small.messages and large.messages, "latched messages")
    assert small.messages == [b"latched"]
    assert large.messages == [LARGE]


def test_services_answer_ros_and_peers_with_keys_written_by_hand(
    router: str, nodes: Nodes, programs: Programs
) -> None:
    programs("serve", domain=DOMAIN, connect=[router]).wait_for("ready")
    client = nodes("client", router)
    assert client.call("/switch", SWITCH, b"request", 20) == b"tseuqer"
    raw = raw_session(router)
    gid = bytes(range(16))
    replies: list[zenoh.Reply] = []

    def answered() -> bool:
        key = f"{DOMAIN}/switch/std_srvs::srv::dds_::SetBool_/{SETBOOL}"
        attachment = Attachment(77, 1, gid).pack()
        replies.extend(raw.get(key, payload=b"raw", attachment=attachment, timeout=20))
        return bool(replies)

    wait_for(answered, "a response")
    reply = replies[0]
    assert reply.ok is not None
    assert reply.ok.payload.to_bytes() == b"war"
    assert reply.ok.attachment is not None
    attached = reply.ok.attachment.to_bytes()
    assert attached[:8] == (77).to_bytes(8, "little")
    assert attached[16:] == b"\x10" + gid
    raw.close()


def test_a_service_that_waits_holds_up_neither_messages_nor_others(
    router: str, nodes: Nodes
) -> None:
    server, client, inbox = nodes("server", router), nodes("client", router), Inbox()
    waiting, go = threading.Event(), threading.Event()

    def respond(request: bytes) -> bytes:
        if request == b"wait":
            waiting.set()
            assert go.wait(60)
        return request

    server.serve("/switch", SWITCH, respond)
    inbox.subscribe(server)
    writer = client.advertise("/chat", TEXT, Qos())
    results: list[bytes] = []
    caller = threading.Thread(
        target=lambda: results.append(client.call("/switch", SWITCH, b"wait", 60))
    )
    caller.start()
    assert waiting.wait(40)
    assert client.call("/switch", SWITCH, b"other", 20) == b"other"
    wait_for(heard(writer, inbox, b"hello"), "a message")
    go.set()
    caller.join()
    assert results == [b"wait"]


def test_a_service_that_nobody_offers_or_answers_times_out(
    router: str, nodes: Nodes, caplog: pytest.LogCaptureFixture
) -> None:
    server, client = nodes("server", router), nodes("client", router)
    with pytest.raises(TimeoutError, match="nobody offers /switch"):
        client.call("/switch", SWITCH, b"", 0.2)

    def fail(request: bytes) -> bytes:
        raise ValueError("broken")

    end = server.serve("/switch", SWITCH, fail)
    with pytest.raises(TimeoutError, match="has not responded"):
        client.call("/switch", SWITCH, b"", 20)
    assert "broken" in caplog.text
    end.close()
    with pytest.raises(TimeoutError, match="/switch"):  # it may not be known yet that it is gone
        client.call("/switch", SWITCH, b"", 0.5)


def test_requests_that_are_none_are_told_once_and_counted(
    router: str, nodes: Nodes, caplog: pytest.LogCaptureFixture
) -> None:
    server, raw = nodes("server", router), raw_session(router)
    types = MessageTypes(distro_of("jazzy"))

    def respond(request: bytes) -> bytes:
        types.decode(request, f"{SWITCH.name}_Request")
        return b"done"

    end = server.serve("/switch", SWITCH, respond)
    key = f"{DOMAIN}/switch/std_srvs::srv::dds_::SetBool_/{SETBOOL}"

    def response_to(request: bytes) -> "zenoh.Reply | None":
        return next(iter(raw.get(key, payload=request, timeout=20)), None)

    wait_for(lambda: response_to(b"\0\1\0\0\1"), "a response")
    for garbage in (b"", b"\0\1\0\0", b"\xff" * 100, b"\0\1\0\0" + b"x" * 9000):
        reply = response_to(garbage)
        assert reply is not None
        assert reply.err is not None
        assert b"cannot be read" in reply.err.payload.to_bytes()
    end.close()
    raw.close()
    assert "Traceback" not in caplog.text
    first, last = (record.getMessage() for record in caplog.records)
    assert first.startswith(f"requests of {key} cannot be read: ")
    assert last == f"4 requests of {key} could not be read"


def test_tokens_are_those_of_ros(router: str, nodes: Nodes) -> None:
    node = nodes("pioneer3", router)
    node.advertise("/test/odom", TEXT, Qos())
    node.subscribe("/cmd_vel", TEXT, SENSOR_DATA, lambda *_: None, lambda _: None)
    node.serve("/switch", SWITCH, bytes)
    with pytest.raises(TimeoutError):
        node.call("/none", SWITCH, b"", 0)
    raw = raw_session(router)
    found: set[str] = set()

    def all_there() -> bool:
        replies = raw.liveliness().get(f"@ros2_lv/{DOMAIN}/**", timeout=5)
        found.update(str(each.ok.key_expr) for each in replies if each.ok)
        return len(found) >= 5

    wait_for(all_there, "tokens")
    zid = next(iter(found)).split("/")[2]
    start, name = f"@ros2_lv/{DOMAIN}/{zid}/0", "%/%test/pioneer3"
    service = f"std_srvs::srv::dds_::SetBool_/{SETBOOL}/::,10:,:,:,,"
    expected = {
        f"{start}/0/NN/{name}",
        f"{start}/1/MP/{name}/%test%odom/{TYPE_KEY}/::,10:,:,:,,",
        f"{start}/2/MS/{name}/%cmd_vel/{TYPE_KEY}/2::,5:,:,:,,",
        f"{start}/3/SS/{name}/%switch/{service}",
        f"{start}/4/SC/{name}/%none/{service}",
    }
    assert found == expected
    raw.close()


def test_messages_of_peers_with_keys_written_by_hand_are_taken(router: str, nodes: Nodes) -> None:
    listener, inbox = nodes("listener", router), Inbox()
    inbox.subscribe(listener)
    raw = raw_session(router)
    token = f"@ros2_lv/{DOMAIN}/{raw.zid()}/0/9/MP/%/%/hand/%chat/{TYPE_KEY}/::,10:,:,:,,"
    declared = raw.liveliness().declare_token(token)
    publisher = raw.declare_publisher(f"{DOMAIN}/chat/{TYPE_KEY}")

    def both_there() -> bool:
        publisher.put(b"plain")
        publisher.put(b"ours", attachment=Attachment(1, 2, gid_of(token)).pack())
        publisher.put(b"odd", attachment=b"odd")
        return {b"plain", b"ours", b"odd"} <= set(inbox.messages)

    wait_for(both_there, "messages")
    assert inbox.gids == {b"", gid_of(token)}
    wait_for(lambda: "/hand" in {each.node for each in listener.graph().endpoints}, "the graph")
    declared.undeclare()
    wait_for(lambda: inbox.left, "left")
    assert inbox.left == [gid_of(token)]
    raw.close()


def test_five_nodes_see_and_hear_each_other(router: str, nodes: Nodes, programs: Programs) -> None:
    listener, inbox = nodes("listener", router), Inbox()
    inbox.subscribe(listener)
    for number in range(4):
        programs(f"talk:talk{number}", domain=DOMAIN, connect=[router])
    expected = ("/talk0", "/talk1", "/talk2", "/talk3", "/test/listener")
    wait_for(lambda: listener.graph().nodes == expected and len(inbox.gids) == 4, "five nodes")
    publishers = [
        each for each in listener.graph().endpoints if each.kind is EndpointKind.PUBLISHER
    ]
    assert {each.gid for each in publishers} == inbox.gids


def test_domains_are_apart(router: str, nodes: Nodes) -> None:
    talker, other = nodes("talker", router), nodes("other", router, domain=DOMAIN + 1)
    listener, there, here = nodes("listener", router), Inbox(), Inbox()
    there.subscribe(other)
    here.subscribe(listener)
    wait_for(heard(talker.advertise("/chat", TEXT, Qos()), here, b"hello"), "a message")
    wait_for(lambda: len(listener.graph().nodes) == 2, "the graph")
    assert not there.messages
    assert other.graph().nodes == ("/test/other",)


def test_a_killed_publisher_has_left(router: str, nodes: Nodes, programs: Programs) -> None:
    listener, inbox = nodes("listener", router), Inbox()
    inbox.subscribe(listener)
    program = programs("talk", domain=DOMAIN, connect=[router])
    wait_for(lambda: inbox.messages, "a message")
    program.kill()
    wait_for(lambda: inbox.left, "left")
    assert set(inbox.left) == inbox.gids
    wait_for(lambda: listener.graph().nodes == ("/test/listener",), "the graph")


def test_a_stalled_subscriber_does_not_hold_up_a_publisher(
    router: str, nodes: Nodes, programs: Programs
) -> None:
    talker, listener, inbox = nodes("talker", router), nodes("listener", router), Inbox()
    writer = talker.advertise("/chat", TEXT, Qos())
    inbox.subscribe(listener)
    program = programs("listen", domain=DOMAIN, connect=[router])
    program.wait_for("ready")

    def there() -> bool:
        writer.write(b"first")
        return "got 5" in program.read()

    wait_for(there, "the subscriber")
    program.stall()
    longest = 0.0
    for _ in range(100):
        before = time.monotonic()
        writer.write(LARGE)
        longest = max(longest, time.monotonic() - before)
    assert longest < 2, "Zenoh waits for 5 s where messages may not be dropped"
    wait_for(heard(writer, inbox, b"still heard"), "a message")


def test_all_goes_on_after_a_restart_of_the_router(nodes: Nodes, programs: Programs) -> None:
    place = f"tcp/localhost:{free_port()}"
    program = start_router(programs, place)
    talker, listener, inbox = (
        nodes("talker", place),
        nodes("listener", place, mode="client"),
        Inbox(),
    )
    writer = talker.advertise("/chat", TEXT, Qos())
    inbox.subscribe(listener)
    wait_for(heard(writer, inbox, b"before"), "a message")
    program.kill()
    wait_for(lambda: inbox.left, "left")
    start_router(programs, place)
    wait_for(heard(writer, inbox, b"after"), "a message after the restart")
    wait_for(lambda: listener.graph().nodes == ("/test/listener", "/test/talker"), "the graph")


def test_a_node_without_a_router_says_so_once_and_waits_for_one(
    nodes: Nodes, programs: Programs, caplog: pytest.LogCaptureFixture
) -> None:
    place = f"tcp/localhost:{free_port()}"
    with caplog.at_level(logging.INFO, "pioneer3"):
        talker, listener, inbox = nodes("talker", place), nodes("listener", place), Inbox()
        inbox.subscribe(listener)
        writer = talker.advertise("/chat", TEXT, Qos())
        writer.write(b"to nobody")
        wait_for(lambda: len(caplog.records) == 2, "warnings")
        time.sleep(2.5)  # longer than two looks at the router
        assert len(caplog.records) == 2
        for record in caplog.records:
            assert "ros2 run rmw_zenoh_cpp rmw_zenohd" in record.message
            assert "pioneer3 ros2 router" in record.message
        start_router(programs, place)
        wait_for(heard(writer, inbox, b"hello"), "a message")
    with pytest.raises(LinkError, match="rmw_zenohd"):
        nodes("client", f"tcp/localhost:{free_port()}", mode="client")


def test_nothing_comes_after_the_end(
    router: str, nodes: Nodes, programs: Programs, capfd: pytest.CaptureFixture[str]
) -> None:
    programs("talk", domain=DOMAIN, connect=[router])
    listener, inbox = nodes("listener", router), Inbox()
    inbox.subscribe(listener)
    writer = listener.advertise("/other", TEXT, Qos())
    wait_for(lambda: inbox.messages, "a message")
    listener.close()
    listener.close()
    with pytest.raises(TimeoutError, match="has left"):
        listener.call("/switch", SWITCH, b"", 1)
    count = len(inbox.messages)
    writer.write(b"late")
    time.sleep(0.3)
    assert len(inbox.messages) == count
    assert not inbox.left
    assert capfd.readouterr() == ("", "")


def test_a_connection_over_tls_outlives_a_bad_cable(
    nodes: Nodes, programs: Programs, tmp_path: Path
) -> None:
    authority = Authority(tmp_path, "authority")
    certificate, key = authority.certificate("router")
    far, near, secure = (free_port() for _ in range(3))
    start_router(
        programs,
        f"tls/localhost:{secure}",
        listen=[f"tls/localhost:{secure}", f"tcp/localhost:{far}"],
        certificate=certificate,
        key=key,
    )
    cable = Cable(secure)
    over = [f"tls/localhost:{cable.port}"]
    start_router(programs, f"tcp/localhost:{near}", connect=over, ca=authority.file)
    talker = nodes("talker", f"tcp/localhost:{far}", mode="client")
    listener = nodes("listener", f"tcp/localhost:{near}", mode="client")
    inbox = Inbox()
    inbox.subscribe(listener)
    writer = talker.advertise("/chat", TEXT, Qos())
    wait_for(heard(writer, inbox, b"over tls"), "a message")
    cable.cut()
    wait_for(lambda: len(inbox.left) >= 1, "left after the cut")
    cable.whole = True
    wait_for(heard(writer, inbox, b"after the cut"), "a message after the cut")
    cable.flows = False
    before = len(inbox.left)
    wait_for(lambda: len(inbox.left) > before, "left in the stall")
    cable.flows = True
    wait_for(heard(writer, inbox, b"after the stall"), "a message after the stall")
    wait_for(lambda: len(listener.graph().nodes) == 2, "the graph")
    assert set(inbox.left) == inbox.gids
    cable.close()


def test_a_certificate_of_a_strange_authority_is_refused(
    nodes: Nodes, programs: Programs, tmp_path: Path
) -> None:
    authority, strange = Authority(tmp_path, "authority"), Authority(tmp_path, "strange")
    certificate, key = authority.certificate("router")
    place = f"tls/localhost:{free_port()}"
    start_router(programs, place, certificate=certificate, key=key, ca=authority.file)
    for mode in ("peer", "client"):
        with pytest.raises(ConfigError, match=r"not by an authority of .*strange\.pem"):
            nodes("node", place, ca=strange.file, mode=mode)
        with pytest.raises(ConfigError, match="certificate of its authority"):
            nodes("node", place, ca=authority.file, mode=mode)
    own, own_key = authority.certificate("robot")
    node = nodes("node", place, ca=authority.file, certificate=own, key=own_key)
    assert node.title.endswith(f"domain {DOMAIN}, by {place}")


def test_a_wrong_password_is_refused_and_no_secret_is_shown(
    nodes: Nodes, programs: Programs, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    def login(name: str, text: str, mode: int = 0o600) -> Path:
        file = tmp_path / name
        file.write_text(text)
        file.chmod(mode)
        return file

    users = login("users", f"router:one\nrobot:{SECRET}\n")
    place = f"tcp/localhost:{free_port()}"
    start_router(programs, place, credentials=users)
    wrong = login("wrong", "robot:wrong-horse\n")
    for mode in ("peer", "client"):
        with pytest.raises(ConfigError, match=r"refuses user or password of .*wrong") as refused:
            nodes("node", place, credentials=wrong, mode=mode)
        assert "wrong-horse" not in str(refused.value)
        with pytest.raises(ConfigError, match="without a user and a password"):
            nodes("node", place, mode=mode)
    with pytest.raises(ConfigError, match="chmod 600"):
        nodes("node", place, credentials=login("open", f"robot:{SECRET}", 0o644))
    with pytest.raises(ConfigError, match="user:password"):
        nodes("node", place, credentials=login("bad", SECRET))
    right = login("right", f"robot:{SECRET}\n")
    node = nodes("node", place, credentials=right)
    assert SECRET not in f"{caplog.text}{node.title}{ZenohOptions(credentials=right)}"


def test_nodes_that_log_in_hear_each_other_each_time(
    nodes: Nodes, programs: Programs, tmp_path: Path
) -> None:
    users, right = tmp_path / "users", tmp_path / "right"
    users.write_text(f"router:one\nrobot:{SECRET}\n")
    right.write_text(f"robot:{SECRET}\n")
    for file in (users, right):
        file.chmod(0o600)
    place = f"tcp/localhost:{free_port()}"
    start_router(programs, place, credentials=users)
    for _ in range(8):
        made = (nodes(name, place, credentials=right) for name in ("first", "second", "third"))
        first, *others = made
        writer = first.advertise("/chat", TEXT, Qos())
        inboxes = [Inbox() for _ in others]
        for inbox, other in zip(inboxes, others, strict=True):
            inbox.subscribe(other)
        for inbox in inboxes:
            wait_for(heard(writer, inbox, b"hello"), "a message")
        for each in (first, *others):
            each.close()


async def test_a_second_router_says_that_the_port_is_taken(router: str) -> None:
    with pytest.raises(ConfigError, match="another one"):
        async with asyncio.timeout(30):
            await serve_router(ZenohOptions(mode="router", connect=(), listen=(router,)))


def test_a_configuration_file_of_zenoh_counts(router: str, nodes: Nodes, tmp_path: Path) -> None:
    file = tmp_path / "session.json5"
    file.write_text(
        f'{{mode: "peer", connect: {{endpoints: ["{router}"]}}, /* as in ROS */'
        ' scouting: {multicast: {enabled: false}}, listen: {endpoints: ["tcp/localhost:0"]},'
        " timestamping: {enabled: true}}"
    )
    node, other = nodes("node", "tcp/localhost:1", config=file), nodes("other", router)
    assert node.title.endswith(f"by {router}")
    wait_for(lambda: len(other.graph().nodes) == 2, "the graph")
    file.write_text('{connect: "secret-horse"')
    with pytest.raises(ConfigError, match="no configuration file") as refused:
        nodes("node", router, config=file)
    assert "secret-horse" not in str(refused.value)
