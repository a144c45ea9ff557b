"""What robots answer, against servers on loopback: some answer, some refuse, some are silent."""

import asyncio
import threading
from collections.abc import Awaitable, Callable, Iterator
from contextlib import AsyncExitStack, contextmanager
from dataclasses import replace
from pathlib import Path
from struct import pack, unpack
from xmlrpc.server import SimpleXMLRPCServer

import pytest

from pioneer3.errors import ConfigError, NoRobotError
from pioneer3.fleet.columns import TableCell, shown
from pioneer3.fleet.live import (
    Live,
    OnTopics,
    Questions,
    SshAnswer,
    exit_code,
    look,
    look_at,
)
from pioneer3.fleet.ros_graph import NodeAddress
from pioneer3.fleet.spec import Fleet, FleetRobot
from pioneer3.sim.server.start import simulator
from tests.e2e.processes import free_port

pytestmark = pytest.mark.realtime
Serve = Callable[[asyncio.StreamReader, asyncio.StreamWriter], Awaitable[None]]
QUICK = 0.3
YES = SshAnswer(True, "yes")


def robot(number: int, *, ros: str = "", port: str = "/dev/ttyUSB0") -> FleetRobot:
    return FleetRobot(
        name=f"r{number}",
        host=f"r{number}",
        address=f"127.0.0.{number}",
        node=f"RosAria_r{number}",
        ros=ros,
        port=port,
    )


async def says_ssh(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
    writer.write(b"SSH-2.0-OpenSSH_9.2\r\n")
    await reader.read()
    writer.close()


async def says_nothing(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
    await reader.read()
    writer.close()


async def hangs_up(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
    writer.close()


async def says_http(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
    writer.write(b"HTTP/1.1 400 Bad Request\r\n\r\n")
    writer.close()


async def test_every_kind_of_host_is_told_apart_and_none_delays_the_others() -> None:
    port = free_port()
    kinds: dict[int, tuple[Serve, SshAnswer]] = {
        2: (says_ssh, YES),
        3: (says_nothing, SshAnswer(False, "silent")),
        4: (hangs_up, SshAnswer(False, "hung up")),
        5: (says_http, SshAnswer(False, "not ssh")),
    }
    clock = asyncio.get_running_loop().time
    async with AsyncExitStack() as stack:
        for number, (serve, _) in kinds.items():
            server = await asyncio.start_server(serve, f"127.0.0.{number}", port)
            await stack.enter_async_context(server)
        began = clock()
        answers = await look(
            [robot(number) for number in (*kinds, 6)], Questions(timeout=QUICK, ssh_port=port)
        )
        took = clock() - began
    assert [answer.ssh for answer in answers[:4]] == [answer for _, answer in kinds.values()]
    assert [answer.up for answer in answers] == [YES] * 5
    assert answers[4].ssh == SshAnswer(False, "refused")
    assert took < 3 * QUICK
    assert answers[0].seconds < QUICK
    assert [answer.driver for answer in answers] == [SshAnswer(None, "")] * 5


async def test_topics_of_ros_2_are_asked_and_a_robot_without_them_delays_nobody() -> None:
    async def ask(robot: FleetRobot, patience: float) -> OnTopics:
        match robot.name:
            case "r2":
                return OnTopics(network="DDS", battery=12.0, motors=True, stopped=False, age=0.5)
            case "r3":
                return OnTopics(network="DDS", motors=False, stopped=True)
            case "r4":
                raise NoRobotError("no node /r4/pioneer3")
            case "r5":
                raise ConfigError("laptop.key holds a secret")
        await asyncio.sleep(60)
        raise AssertionError

    async def clock(robot: FleetRobot) -> float:
        return -0.25

    questions = Questions(timeout=QUICK, ssh_port=free_port(), ros2=ask, clock=clock)
    robots = [robot(number, ros="2") for number in range(2, 7)]
    well, silent, missing, refused, hung = await look(robots, questions)
    assert (well.driver, well.ros) == (SshAnswer(True, "RosAria_r2"), SshAnswer(True, "DDS"))
    assert (well.battery, well.motors, well.stopped, well.age) == (12.0, True, False, 0.25)
    assert (silent.driver, silent.stopped) == (SshAnswer(False, "silent"), True)
    assert (missing.driver, missing.ros.said) == (
        SshAnswer(False, "no node"),
        "no node /r4/pioneer3",
    )
    assert refused.driver == SshAnswer(False, "no network")
    assert refused.ros.said == "laptop.key holds a secret"
    assert (hung.driver, hung.ros) == (SshAnswer(False, "no network"), SshAnswer(False, "silent"))
    titles, rows = shown(robots[:2], [well, silent])
    assert [rows[0][titles.index(title)].text for title in ("e-stop", "age")] == ["no", "0.2 s"]
    assert [rows[1][titles.index(title)].text for title in ("e-stop", "age")] == ["STOP", "-"]


@pytest.mark.parametrize(
    ("age", "text", "good"),
    [(-0.2, "-0.2 s", True), (0.9, "0.9 s", True), (5.0, "5.0 s", False), (1e9, "very old", False)],
)
def test_old_data_are_told(age: float, text: str, good: bool) -> None:
    yes = SshAnswer(True, "yes")
    answer = Live(robot="r1", up=yes, ssh=yes, driver=yes, ros=yes, age=age)
    titles, (row,) = shown([robot(1)], [answer])
    assert row[titles.index("age")] == TableCell(text, good)


async def test_a_clock_that_nobody_tells_is_left_out() -> None:
    async def clock(robot: FleetRobot) -> float:
        if robot.name == "r2":
            return 0.25
        if robot.name == "r3":
            raise ConnectionResetError
        await asyncio.sleep(60)
        return 0.0

    questions = Questions(timeout=QUICK, ssh_port=free_port(), clock=clock)
    answers = await look([robot(2), robot(3), robot(4)], questions)
    assert [answer.clock for answer in answers] == [0.25, None, None]


async def test_a_robot_that_listens_itself_is_asked_by_the_address_of_its_host() -> None:
    async with simulator(map_name="empty", port=0) as here:
        number = int(here.robots[0].url.rpartition(":")[2])
        one = robot(2, port=f"tcp://R2:{number}")
        fleet = Fleet(path=Path("fleet.toml"), robots=(replace(one, address="127.0.0.1"),))
        questions = Questions(ssh_port=free_port(), addresses=fleet.addresses)
        answer = await look_at(fleet.robots[0], questions)
    assert answer.driver == SshAnswer(True, f"{number} answers")
    assert answer.battery == pytest.approx(12.7, abs=1.5)
    assert answer.motors is False


@pytest.mark.parametrize(
    ("serve", "said"), [(says_nothing, "silent"), (hangs_up, "busy"), (None, "refused")]
)
async def test_a_port_without_a_robot_is_told(serve: Serve | None, said: str) -> None:
    number = free_port()
    async with AsyncExitStack() as stack:
        if serve:
            server = await asyncio.start_server(serve, "127.0.0.1", number)
            await stack.enter_async_context(server)
        one = robot(1, port=f"127.0.0.1:{number}")
        answer = await look_at(one, Questions(timeout=QUICK, ssh_port=free_port()))
    assert answer.driver == SshAnswer(False, said)
    assert (answer.battery, answer.motors) == (None, None)


class Node:
    """A ROS node, and the master that knows it, by the XML-RPC server of Python's library."""

    def __init__(self, *, alive: bool = True) -> None:
        self.asked: list[bytes] = []
        self.topic_port = free_port()
        self.master, self.node = rpc_server(), rpc_server()
        dead = f"http://r2:{free_port()}/"
        uri = f"http://r2:{self.node.server_address[1]}/" if alive else dead
        known = {"/RosAria_r2": uri}
        self.master.register_function(
            lambda caller, name: [1, "", known[name]] if name in known else [-1, "unknown", ""],
            "lookupNode",
        )
        self.node.register_function(lambda caller: [1, "", 42], "getPid")
        self.node.register_function(
            lambda caller, topic, protocols: (
                [0, "no such topic", []]
                if "motors" in topic
                else [1, "", ["TCPROS", "r2", self.topic_port]]
            ),
            "requestTopic",
        )

    async def publish(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        (length,) = unpack("<I", await reader.readexactly(4))
        self.asked.append(await reader.readexactly(length))
        field = b"type=std_msgs/Float64"
        header = pack("<I", len(field)) + field
        writer.write(pack("<I", len(header)) + header)
        writer.write(pack("<Id", 8, 12.5))
        await reader.read()
        writer.close()


def rpc_server() -> SimpleXMLRPCServer:
    return SimpleXMLRPCServer(("127.0.0.1", 0), logRequests=False)


@contextmanager
def serving(node: Node) -> Iterator[None]:
    servers = (node.master, node.node)
    threads = [threading.Thread(target=s.serve_forever, args=(0.05,)) for s in servers]
    for thread in threads:
        thread.start()
    try:
        yield
    finally:
        for server, thread in zip(servers, threads, strict=True):
            server.shutdown()
            server.server_close()
            thread.join()


async def ask_graph(node: Node, one: FleetRobot, *, other: NodeAddress | None = None) -> Live:
    port = node.master.server_address[1]
    questions = Questions(
        timeout=1.0,
        ssh_port=free_port(),
        master_port=port,
        masters=(other,) if other else (),
        addresses={"r2": "127.0.0.1"},
    )
    return await look_at(replace(one, address="127.0.0.1"), questions)


async def test_a_node_is_asked_though_its_host_name_is_unknown_here() -> None:
    node = Node()
    with serving(node):
        async with await asyncio.start_server(node.publish, "127.0.0.1", node.topic_port):
            answer = await ask_graph(node, robot(2, ros="1"))
    assert answer.driver == SshAnswer(True, "RosAria_r2")
    assert answer.ros == SshAnswer(True, f"127.0.0.1:{node.master.server_address[1]}")
    assert (answer.battery, answer.motors) == (12.5, None)
    assert b"topic=/RosAria_r2/battery_voltage" in node.asked[0]


async def test_a_node_that_was_killed_is_not_alive_though_the_master_lists_it() -> None:
    node = Node(alive=False)
    with serving(node):
        answer = await ask_graph(node, robot(2, ros="1"))
    assert answer.driver == SshAnswer(False, "node silent")
    assert answer.ros.ok


async def test_a_master_without_the_node_is_told() -> None:
    node = Node()
    with serving(node):
        answer = await ask_graph(node, robot(3, ros="1"))
    assert answer.driver == SshAnswer(False, "no node")
    assert answer.ros.ok


async def test_the_robots_own_master_counts_where_the_operators_is_away() -> None:
    node = Node()
    with serving(node):
        away = NodeAddress("127.0.0.1", free_port())
        answer = await ask_graph(node, robot(2, ros="1"), other=away)
    assert answer.driver.ok


@pytest.mark.parametrize(("serve", "said"), [(says_http, "no ROS"), (says_nothing, "silent")])
async def test_what_is_no_master_is_told(serve: Serve, said: str) -> None:
    async with await asyncio.start_server(serve, "127.0.0.1", 0) as server:
        port = server.sockets[0].getsockname()[1]
        questions = Questions(timeout=QUICK, ssh_port=free_port(), master_port=port)
        answer = await look_at(robot(1, ros="1"), questions)
    assert not answer.driver.ok
    assert answer.ros == SshAnswer(False, said)


def told(name: str, *, up: bool, clock: float | None = None) -> Live:
    no = SshAnswer(False, "no answer")
    return Live(
        robot=name, up=YES if up else no, ssh=no, driver=no, ros=SshAnswer(None, ""), clock=clock
    )


@pytest.mark.parametrize(
    ("up", "code"), [((True, True), 0), ((True, False), 1), ((False, False), 3), ((), 0)]
)
def test_the_exit_code_says_whether_some_or_none_answered(up: tuple[bool, ...], code: int) -> None:
    assert exit_code([told("r", up=each) for each in up]) == code


def test_columns_without_anything_are_left_out() -> None:
    titles, rows = shown([robot(2)], [told("r2", up=True)])
    assert titles == ("name", "address", "port", "up", "ssh", "driver")
    assert [cell.text for cell in rows[0]][-3:] == ["yes", "no answer", "no answer"]
    titles, _ = shown([robot(2, ros="1")], [told("r2", up=True, clock=0.0)])
    assert titles[-1] == "clock"
    assert "ROS" in titles
    assert shown([robot(2)], None)[0] == ("name", "address", "port")
    assert "host" in shown([replace(robot(2), host="cr-246")], None)[0]


def test_a_narrow_terminal_has_the_columns_that_matter() -> None:
    robots = [replace(robot(2, ros="1"), note="in the hall beside the stairs", laser="auto")]
    answers = [told("r2", up=True, clock=0.0)]
    wide, _ = shown(robots, answers)
    narrow, rows = shown(robots, answers, 60)
    assert narrow == ("name", "address", "ROS", "up", "ssh", "driver", "clock")
    assert set(narrow) < set(wide)
    assert [len(row) for row in rows] == [len(narrow)]
    assert sum(max(len(t), len(c.text)) + 2 for t, c in zip(narrow, rows[0], strict=True)) <= 60
