"""Nodes of ROS 1 over real sockets, with a master in this process."""

import asyncio
from collections.abc import AsyncIterator, Iterator
from contextlib import AsyncExitStack, asynccontextmanager
from struct import pack
from urllib.parse import urlsplit

import pytest

from pioneer3.errors import ConfigError
from pioneer3.ros.addresses import Addresses, addresses
from pioneer3.ros.tcpros.answers import MasterRefusalError, OddAnswerError, value_of
from pioneer3.ros.tcpros.master import CONNECTIONS, Api
from pioneer3.ros.tcpros.node import Ros1Node, ros1_node
from pioneer3.ros.tcpros.services import ServiceError
from pioneer3.ros.tcpros.subscriber import PublisherConnection
from pioneer3.ros.tcpros.types import Ros1Types
from tests.e2e.processes import free_port, until
from tests.ros1.little_master import LittleMaster, little_master

pytestmark = [pytest.mark.realtime]
TYPES = Ros1Types()
STRING, BOOL = TYPES.definition("std_msgs/String"), TYPES.definition("std_msgs/Bool")
SET_BOOL = TYPES.service_definition("std_srvs/SetBool")


@pytest.fixture
def master() -> Iterator[LittleMaster]:
    with little_master() as running:
        yield running


def text(words: str) -> bytes:
    return pack("<I", len(words)) + words.encode()


class Listener:
    """Hears a topic of a node."""

    def __init__(self, node: Ros1Node, topic: str) -> None:
        self.heard: list[tuple[bytes, str, bool]] = []
        self.left: list[str] = []
        self.subscription = node.subscribe(topic, STRING, self._received, self._left)

    def _received(self, data: bytes, connection: PublisherConnection, old: bool) -> None:
        self.heard.append((data, connection.node, old))

    def _left(self, connection: PublisherConnection) -> None:
        self.left.append(connection.node)


async def node(stack: AsyncExitStack, master: LittleMaster, name: str) -> Ros1Node:
    return await stack.enter_async_context(ros1_node(name, master.at, print))


async def test_messages_come_in_order_from_all_publishers(master: LittleMaster) -> None:
    async with AsyncExitStack() as stack:
        one, two, other = [await node(stack, master, name) for name in ("/one", "/two", "/other")]
        listener = Listener(other, "/chatter")
        publishers = [each.advertise("/chatter", STRING) for each in (one, two)]
        await until(lambda: all(each.matched for each in publishers))
        for number in range(5):
            publishers[0].write(text(f"{number}"))
        await until(lambda: len(listener.heard) == 5)
        publishers[1].write(text("two"))
        await until(lambda: len(listener.heard) == 6)
        assert [data for data, *_ in listener.heard[:5]] == [text(f"{n}") for n in range(5)]
        assert listener.heard[5] == (text("two"), "/two", False)


async def test_headers_are_numbered_by_their_publisher(master: LittleMaster) -> None:
    async with AsyncExitStack() as stack:
        one, other = [await node(stack, master, name) for name in ("/one", "/other")]
        type_, heard = TYPES.definition("sensor_msgs/Range"), list[bytes]()
        other.subscribe("/range", type_, lambda data, *_: heard.append(data), lambda _: None)
        publisher = one.advertise("/range", type_)
        await until(lambda: publisher.matched)
        message = TYPES.make("sensor_msgs/Range")
        for _ in range(2):
            publisher.write(TYPES.encode(message))
        await until(lambda: len(heard) == 2)
        assert [TYPES.decode(data, "sensor_msgs/Range").header.seq for data in heard] == [1, 2]


async def test_a_publisher_that_ends_is_missed_at_once(master: LittleMaster) -> None:
    async with AsyncExitStack() as stack:
        other = await node(stack, master, "/other")
        listener = Listener(other, "/chatter")
        async with ros1_node("/one", master.at, print) as one:
            publisher = one.advertise("/chatter", STRING)
            await until(lambda: publisher.matched)
        await until(lambda: listener.left == ["/one"])
        assert not listener.subscription.matched


async def test_late_subscribers_get_latched_messages_and_know_that_they_may_be_old(
    master: LittleMaster,
) -> None:
    async with AsyncExitStack() as stack:
        one, other = [await node(stack, master, name) for name in ("/one", "/other")]
        early = Listener(other, "/chatter")
        await until(lambda: "/other" in master.subscribers.get("/chatter", {}))
        publisher = one.advertise("/chatter", STRING, latched=True)
        publisher.write(text("first"))
        await until(lambda: early.heard)
        assert early.heard == [(text("first"), "/one", False)]
        late = Listener(await node(stack, master, "/late"), "/chatter")
        await until(lambda: late.heard)
        assert late.heard == [(text("first"), "/one", True)]
        publisher.write(text("second"))
        await until(lambda: len(late.heard) == 2)
        assert late.heard[1] == (text("second"), "/one", False)


async def test_another_type_is_told_and_ignored(master: LittleMaster) -> None:
    told: list[str] = []
    async with (
        ros1_node("/one", master.at, print) as one,
        ros1_node("/other", master.at, told.append) as other,
    ):
        one.advertise("/chatter", BOOL).write(b"\x01")
        listener = Listener(other, "/chatter")
        await until(lambda: told)
        assert "must be std_msgs/String" in told[0]
        assert "is of std_msgs/Bool" in told[0]
        assert not listener.heard


async def test_a_publisher_whose_computer_has_an_unknown_name_is_told(
    master: LittleMaster,
) -> None:
    told: list[str] = []
    master.publishers["/chatter"] = {"/far": "http://no-such-computer.invalid:1/"}
    async with ros1_node("/one", master.at, told.append) as one:
        listener = Listener(one, "/chatter")
        await until(lambda: told)
        assert "at http://no-such-computer.invalid:1/ CANNOT BE REACHED" in told[0]
        assert not listener.subscription.matched


async def test_a_node_does_not_hear_itself(master: LittleMaster) -> None:
    async with ros1_node("/one", master.at, print) as one:
        listener = Listener(one, "/chatter")
        publisher = one.advertise("/chatter", STRING)
        await until(lambda: "/one" in master.publishers.get("/chatter", {}))
        publisher.write(text("echo"))
        async with ros1_node("/other", master.at, print) as other:
            heard = other.advertise("/chatter", STRING)
            await until(lambda: heard.matched)
            heard.write(text("other"))
            await until(lambda: listener.heard)
        assert [name for _, name, _ in listener.heard] == ["/other"]


async def test_services_respond_and_failures_say_why(master: LittleMaster) -> None:
    async def handle(request: bytes) -> bytes:
        if request == b"\x00":
            raise ServiceError("it cannot")
        return pack("<?I", True, 2) + b"ok"

    async with AsyncExitStack() as stack:
        one, other = [await node(stack, master, name) for name in ("/one", "/other")]
        one.serve("/switch", SET_BOOL, handle)
        await until(lambda: "/switch" in master.services)
        assert await other.call("/switch", SET_BOOL, b"\x01") == pack("<?I", True, 2) + b"ok"
        with pytest.raises(ServiceError, match="it cannot"):
            await other.call("/switch", SET_BOOL, b"\x00")
        with pytest.raises(ServiceError, match=r"is of std_srvs/SetBool"):
            await other.call("/switch", TYPES.service_definition("std_srvs/Trigger"), b"")
        with pytest.raises(ServiceError, match="no service"):
            await other.call("/nobody", SET_BOOL, b"\x01")


@pytest.mark.parametrize("graph", [False, True])
async def test_a_new_master_learns_of_all_and_connections_last(
    monkeypatch: pytest.MonkeyPatch, *, graph: bool
) -> None:
    monkeypatch.setattr("pioneer3.ros.tcpros.node.LOOK", 3600.0)
    port, told = free_port(), list[str]()
    async with AsyncExitStack() as stack:
        with little_master(port) as first:
            joined = ros1_node("/one", first.at, told.append, graph=graph)
            one = await stack.enter_async_context(joined)
            other = await node(stack, first, "/other")
            listener = Listener(other, "/chatter")
            publisher = one.advertise("/chatter", STRING)
            await until(lambda: publisher.matched)
        await until(lambda: any("MASTER LOST" in each for each in told))
        publisher.write(text("without a master"))
        await until(lambda: len(listener.heard) == 1)
        with little_master(port) as second:
            await until(lambda: "/one" in second.publishers.get("/chatter", {}))
            await until(lambda: "/other" in second.subscribers.get("/chatter", {}))
            await until(lambda: any("master is back" in each for each in told))
            publisher.write(text("with another"))
            await until(lambda: len(listener.heard) == 2)
            assert listener.left == []
            await stack.aclose()


async def test_a_master_that_hangs_is_away_until_it_answers(
    monkeypatch: pytest.MonkeyPatch, master: LittleMaster
) -> None:
    monkeypatch.setattr("pioneer3.ros.tcpros.node.LOOK", 0.1)
    monkeypatch.setattr("pioneer3.ros.tcpros.node.AGAIN", 0.1)
    monkeypatch.setattr("pioneer3.ros.tcpros.master.PATIENCE", 0.3)
    told = list[str]()
    async with ros1_node("/one", master.at, told.append, graph=False) as one:
        one.advertise("/chatter", STRING)
        await until(lambda: "/chatter" in master.publishers)
        with master.turn:
            await until(lambda: any("no answer within 0.3 s" in each for each in told))
            monkeypatch.setattr("pioneer3.ros.tcpros.node.LOOK", 3600.0)
            await asyncio.sleep(1.0)  # for a look that finds it hanging still
        await until(lambda: any("master is back" in each for each in told))


async def test_the_end_of_a_node_leaves_nothing_with_the_master(master: LittleMaster) -> None:
    async with ros1_node("/one", master.at, print) as one:
        one.advertise("/chatter", STRING)
        Listener(one, "/other")
        one.serve("/switch", SET_BOOL, lambda request: asyncio.sleep(0, b""))
        await until(lambda: one.state and "/other" in master.subscribers)
    assert not any(master.publishers.values())
    assert not any(master.subscribers.values())
    assert not master.services


async def test_a_second_node_of_one_name_is_refused(master: LittleMaster) -> None:
    async with ros1_node("/one", master.at, print) as one:
        one.advertise("/chatter", STRING)
        await until(lambda: "/one" in master.nodes)
        with pytest.raises(ConfigError, match="a node /one is on the ROS master already"):
            async with ros1_node("/one", master.at, print):
                pass
    master.nodes["/gone"] = f"http://127.0.0.1:{free_port()}/"
    async with ros1_node("/gone", master.at, print) as gone:
        assert gone.name == "/gone"


async def test_others_may_ask_a_node_about_itself_and_shut_it_down(master: LittleMaster) -> None:
    async with ros1_node("/one", master.at, print) as one:
        one.advertise("/chatter", STRING)
        await until(lambda: "/one" in master.nodes)
        api = Api(master.nodes["/one"], "/other")
        assert await api.call("getPublications") == [["/chatter", "std_msgs/String"]]
        assert (await api.call("requestTopic", "/chatter", [["TCPROS"]]))[:2] == [
            "TCPROS",
            "127.0.0.1",
        ]
        with pytest.raises(MasterRefusalError, match="/nothing is not published here"):
            await api.call("requestTopic", "/nothing", [["TCPROS"]])
        await api.call("shutdown", "because")
        await asyncio.wait_for(one.ended.wait(), 5)


@pytest.mark.parametrize(
    "data",
    [b"GET / HTTP/1.1\r\n\r\n", b"\xff\xff\xff\xff", b"\x04\0\0\0\x09\0\0\0", b"\x02\0\0\0ab"],
)
async def test_whatever_connects_the_node_goes_on(master: LittleMaster, data: bytes) -> None:
    async with AsyncExitStack() as stack:
        one, other = [await node(stack, master, name) for name in ("/one", "/other")]
        publisher, listener = one.advertise("/chatter", STRING), Listener(other, "/chatter")
        await until(lambda: publisher.matched)
        api = Api(master.nodes["/one"], "/x")
        _, host, port = await api.call("requestTopic", "/chatter", [["TCPROS"]])
        reader, writer = await asyncio.open_connection(host, port)
        writer.write(data)
        writer.write_eof()
        assert await reader.read() == b""
        writer.close()
        publisher.write(text("still here"))
        await until(lambda: listener.heard)


async def test_a_subscriber_that_stalls_gets_the_newest_and_holds_up_nobody(
    master: LittleMaster,
) -> None:
    async with AsyncExitStack() as stack:
        one, other = [await node(stack, master, name) for name in ("/one", "/other")]
        publisher, listener = one.advertise("/chatter", STRING), Listener(other, "/chatter")
        await until(lambda: publisher.matched)
        api = Api(master.nodes["/one"], "/x")
        _, host, port = await api.call("requestTopic", "/chatter", [["TCPROS"]])
        _, stalled = await asyncio.open_connection(host, port, limit=1024)
        fields = [b"callerid=/stalled", b"topic=/chatter", b"md5sum=*", b"type=*"]
        header = b"".join(pack("<I", len(each)) + each for each in fields)
        stalled.write(pack("<I", len(header)) + header)
        for number in range(200):
            publisher.write(text(f"{number} " + "x" * 100_000))
            await asyncio.sleep(0.001)
        await until(lambda: listener.heard and listener.heard[-1][0][4:8] == b"199 ")
        stalled.close()


@pytest.mark.parametrize(
    ("method", "answer"),
    [
        ("getPid", [1, "two"]),
        ("getPid", 7),
        ("getPid", ["one", "", 1]),
        ("lookupNode", [1, "", 5]),
        ("registerSubscriber", [1, "", [5]]),
        ("registerSubscriber", [1, "", "uri"]),
        ("getSystemState", [1, "", [[["/a"]], [], []]]),
        ("getSystemState", [1, "", [[["/a", 5]], [], []]]),
        ("requestTopic", [1, "", []]),
        ("requestTopic", [1, "", ["TCPROS", "robot", 70000]]),
    ],
)
def test_an_odd_answer_is_an_error_of_the_known_kind(method: str, answer: object) -> None:
    with pytest.raises(OddAnswerError):
        value_of(method, answer)


@asynccontextmanager
async def web_server(answer: str | None) -> AsyncIterator[str]:
    """Run a program that answers each request by this XML, or never; yield its address."""
    ended = asyncio.Event()

    async def take(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        await reader.readuntil(b"</methodCall>")
        if answer is None:
            await ended.wait()
        body = str(answer).encode()
        writer.write(b"HTTP/1.1 200 OK\r\nContent-Type: text/xml\r\n")
        writer.write(b"Content-Length: %d\r\n\r\n%s" % (len(body), body))
        writer.close()

    server = await asyncio.start_server(take, "127.0.0.1", 0)
    try:
        yield f"http://127.0.0.1:{server.sockets[0].getsockname()[1]}/"
    finally:
        ended.set()
        server.close()


async def test_a_large_graph_is_known(master: LittleMaster) -> None:
    for number in range(500):
        master.publishers[f"/topic_{number}"] = {"/other": "http://127.0.0.1:1/"}
    async with ros1_node("/one", master.at, print) as one:
        await until(lambda: one.state is not None)
        assert one.state is not None
        assert len(one.state.publishers) == 500


@pytest.mark.parametrize("value", ["<int>1</int>", "<int>x</int>", "<i9/>", "<array/>"])
async def test_an_odd_node_is_not_alive(master: LittleMaster, value: str) -> None:
    answer = (
        f"<methodResponse><params><param><value>{value}</value></param></params></methodResponse>"
    )
    async with web_server(answer) as uri, ros1_node("/one", master.at, print) as one:
        master.nodes["/odd"] = uri
        assert not await one.is_alive("/odd")


async def test_a_node_that_hangs_holds_up_neither_others_nor_services(
    master: LittleMaster,
) -> None:
    async with web_server(None) as uri, AsyncExitStack() as stack:
        one, other = [await node(stack, master, name) for name in ("/one", "/other")]
        master.nodes["/hung"] = uri
        for number in range(24):
            master.publishers[f"/hung_{number}"] = {"/hung": uri}
            Listener(one, f"/hung_{number}")
        publisher, listener = (
            other.advertise("/chatter", STRING, latched=True),
            Listener(one, "/chatter"),
        )
        publisher.write(text("here"))
        other.serve("/switch", SET_BOOL, lambda request: asyncio.sleep(0, b"done"))
        await until(lambda: listener.heard and "/switch" in master.services)
        assert await one.call("/switch", SET_BOOL, b"\x01") == b"done"
        assert await one.alive_among(["/hung", "/other"]) == {"/hung", "/other"}
        while await one.alive_among(["/hung", "/other"]) != {"/other"}:
            pass


async def test_a_service_refuses_requests_that_are_too_long(master: LittleMaster) -> None:
    async with AsyncExitStack() as stack:
        one, other = [await node(stack, master, name) for name in ("/one", "/other")]
        one.serve("/switch", SET_BOOL, lambda request: asyncio.sleep(0, b"done"))
        await until(lambda: "/switch" in master.services)
        with pytest.raises(ServiceError):
            await other.call("/switch", SET_BOOL, bytes(1 << 17))
        assert await other.call("/switch", SET_BOOL, b"\x01") == b"done"


async def test_idle_connections_take_no_room_of_others(master: LittleMaster) -> None:
    async with ros1_node("/one", master.at, print) as one:
        one.advertise("/chatter", STRING)
        await until(lambda: "/one" in master.nodes)
        uri = master.nodes["/one"]
        at = urlsplit(uri)
        idle = [await asyncio.open_connection(at.hostname, at.port) for _ in range(CONNECTIONS + 9)]
        for _, writer in idle:
            writer.write(b"POST / HTTP/1.1\r\n")
        assert await Api(uri, "/other").call("getPublications")
        reader, writer = idle[0]
        assert await reader.read() == b""
        reader, writer = await asyncio.open_connection(at.hostname, at.port)
        writer.write(b"POST / HTTP/1.1\r\nContent-Length: 99999999999\r\n\r\n")
        assert b" 413 " in await reader.readline()
        for _, each in [*idle, (reader, writer)]:
            each.close()


@pytest.mark.parametrize(
    ("environment", "found"),
    [
        ({}, ("http://127.0.0.1:11311", "127.0.0.1", "127.0.0.1")),
        ({"ROS_IP": "127.0.0.1"}, ("http://127.0.0.1:11311", "127.0.0.1", "127.0.0.1")),
        ({"ROS_IP": "192.0.2.77"}, ("http://127.0.0.1:11311", "192.0.2.77", "0.0.0.0")),
        ({"ROS_HOSTNAME": "lab"}, ("http://127.0.0.1:11311", "lab", "0.0.0.0")),
        ({"ROS_HOSTNAME": "localhost"}, ("http://127.0.0.1:11311", "localhost", "127.0.0.1")),
        (
            {"ROS_MASTER_URI": "http://localhost:1"},
            ("http://localhost:1", "127.0.0.1", "127.0.0.1"),
        ),
    ],
)
def test_addresses_are_those_of_ros1s_variables(
    environment: dict[str, str], found: tuple[str, str, str]
) -> None:
    master, host, bind = found
    assert addresses(None, environment) == Addresses(master=master, host=host, bind=bind)


def test_an_address_that_is_none_is_refused() -> None:
    with pytest.raises(ConfigError, match="such as http://robot:11311, not robot"):
        addresses("robot", {})
    assert urlsplit(addresses("http://127.0.0.1:7", {}).master).port == 7
