"""Faults of others, of callbacks and of the library: the node must hear, or end."""

import asyncio
import signal
import sys
import threading
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager, suppress
from dataclasses import replace
from importlib import import_module
from typing import Any

import pytest

from pioneer3.errors import LinkError
from pioneer3.ros.dds.backend import DdsBackend
from pioneer3.ros.dds.endpoints import SAMPLES
from pioneer3.ros.dds.services import WAITING, ServiceResponder, with_id, without_id
from pioneer3.ros.ros2.backend import EndpointKind, Qos
from pioneer3.ros.ros2.network import BackendName
from pioneer3.ros.ros2.start import NodeOptions, on_ros2
from pioneer3.tasks import in_own_thread
from tests.e2e.processes import until
from tests.ros2.conftest import robot_on
from tests.ros2.dds_network import program_on
from tests.ros2.networks import Peer, Ros2, network_of
from tests.ros2.test_failures import FOREVER, commander

pytestmark = [pytest.mark.realtime]
EMPTY = "std_msgs/Empty"
DEEP = Qos(depth=1000)
FLOOD = 8 * SAMPLES


def empty(peer: Peer) -> bytes:
    return peer.types.encode(peer.types.make(EMPTY))


def subscribe(
    peer: Peer,
    name: str,
    received: Callable[[bytes], object],
    left: Callable[[bytes], None] = lambda gid: None,
) -> None:
    def take(_: bytes, gid: bytes) -> None:
        received(gid)

    peer.backend.subscribe(name, peer.types.message_type(EMPTY), DEEP, take, left)


@asynccontextmanager
async def with_services() -> AsyncIterator[tuple[Peer, Peer]]:
    """Run two nodes that can call each other."""
    async with network_of(BackendName.DDS) as network:
        network.network = replace(network.network, dds_services=True)
        async with network.peer() as peer, network.peer("other") as other:
            yield peer, other


class Stall:
    """Holds up the thread that receives, as a stopped process would, by a message on `/stall`."""

    def __init__(self, peer: Peer, other: Peer) -> None:
        self._held, self._go = threading.Event(), threading.Event()
        self._cdr = empty(other)
        subscribe(peer, "/stall", self._hold)
        self._writer = other.publisher("/stall", EMPTY)

    def _hold(self, _: bytes) -> None:
        self._held.set()
        self._go.wait(30.0)

    async def begin(self) -> None:
        await until(lambda: self._writer.matched)
        self._writer.write(self._cdr)
        await until(self._held.is_set)

    def end(self) -> None:
        self._go.set()


async def test_endpoints_that_cannot_be_read_hide_no_others(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    """As names are that are no UTF-8, for which the library raises when it takes them."""
    builtin: Any = import_module("cyclonedds.builtin")
    construct = builtin.endpoint_constructor

    def refuse(*args: Any) -> Any:
        if "rt/unreadable" in args:
            raise UnicodeDecodeError("utf-8", b"\xff", 0, 1, "invalid start byte")
        return construct(*args)

    monkeypatch.setattr(builtin, "endpoint_constructor", refuse)
    names = [f"/good{number}" for number in range(10)]
    async with network_of(BackendName.DDS) as network, program_on(network) as program:
        await program.writer("rt/unreadable", "std_msgs/msg/Empty")
        for name in names:
            await program.writer(f"rt{name}", "std_msgs/msg/Empty")
        async with network.peer() as peer:
            await until(lambda: all(peer.endpoint(name) for name in names))
            heard: list[bytes] = []
            left: list[bytes] = []
            subscribe(peer, names[0], heard.append, left.append)
            await program.send_until(lambda: heard, f"rt{names[0]}", fields={})
            await program.close("rt/unreadable")
            await program.close(f"rt{names[0]}")
            await until(lambda: left)
            assert left == heard[:1]
    assert caplog.text.count("descriptions of endpoints cannot be read") == 1


async def test_an_error_of_a_callback_is_logged_and_others_hear(
    caplog: pytest.LogCaptureFixture,
) -> None:
    async with (
        network_of(BackendName.DDS) as network,
        network.peer() as peer,
        network.peer("other") as other,
    ):
        heard: list[bytes] = []
        subscribe(peer, "/bad", lambda gid: 1 // 0, lambda gid: [][len(gid)])
        subscribe(peer, "/good", heard.append)
        bad, good = other.publisher("/bad", EMPTY), other.publisher("/good", EMPTY)
        await until(lambda: bad.matched and good.matched)
        bad.write(empty(other))
        await until(lambda: "ZeroDivisionError" in caplog.text)
        bad.close()
        await until(lambda: "IndexError" in caplog.text)
        good.write(empty(other))
        await until(lambda: heard)


async def test_a_flood_on_one_topic_does_not_hold_up_the_others() -> None:
    async with (
        network_of(BackendName.DDS) as network,
        network.peer() as peer,
        network.peer("other") as other,
    ):
        heard: list[str] = []
        stall = Stall(peer, other)
        subscribe(peer, "/flood", lambda gid: heard.append("flood"))
        subscribe(peer, "/stop", lambda gid: heard.append("stop"))
        flood, stop = other.publisher("/flood", EMPTY, DEEP), other.publisher("/stop", EMPTY)
        await until(lambda: flood.matched and stop.matched)
        await stall.begin()
        for _ in range(FLOOD):
            flood.write(empty(other))
        stop.write(empty(other))
        await asyncio.sleep(0.5)
        stall.end()
        await until(lambda: len(heard) == FLOOD + 1)
        assert heard.index("stop") <= 2 * SAMPLES


async def test_messages_that_waited_come_before_the_departure_of_their_publisher() -> None:
    async with (
        network_of(BackendName.DDS) as network,
        network.peer() as peer,
        network.peer("other") as other,
        network.peer("watcher") as watcher,
    ):
        heard: list[str] = []
        subscribe(peer, "/t", lambda gid: heard.append("message"), lambda gid: heard.append("left"))
        stall = Stall(peer, other)  # its turn is later, so that /t has a turn of its own afterwards
        writer = other.publisher("/t", EMPTY)
        await until(lambda: writer.matched and watcher.endpoint("/t"))
        await stall.begin()
        for _ in range(5):
            writer.write(empty(other))
        writer.close()
        await until(lambda: not watcher.endpoint("/t", EndpointKind.PUBLISHER))
        await asyncio.sleep(0.3)
        stall.end()
        await until(lambda: heard.count("message") == 5 and "left" in heard)
        await asyncio.sleep(0.3)
        assert heard[-1] == "left"


async def test_a_node_that_was_stopped_obeys_nobody_that_left_meanwhile() -> None:
    async with network_of(BackendName.DDS) as network, robot_on(network, *FOREVER) as robot:
        for _ in range(3):
            async with commander(network) as program:
                await until(lambda: robot.tap.now.v > 0.25)
                robot.node.process.send_signal(signal.SIGSTOP)
                await asyncio.sleep(0.3)
                assert program.stdin is not None
                program.stdin.close()
                await program.wait()
            await asyncio.sleep(0.5)
            robot.node.process.send_signal(signal.SIGCONT)
            await until(lambda: robot.tap.now.is_zero)
            await asyncio.sleep(1.0)
            assert robot.tap.now.is_zero


async def test_a_library_that_fails_is_told_as_departures_and_ends_the_node(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    heard: list[bytes] = []
    left: list[bytes] = []

    def fail() -> None:
        raise OSError

    async def listen(network: Ros2, other: Peer) -> None:
        writer = other.publisher("/t", EMPTY)
        options = NodeOptions(network=network.network)
        async with on_ros2(options, lambda line: None) as (backend, _, types, _):
            assert isinstance(backend, DdsBackend)
            subscribe(Peer(backend, types), "/t", heard.append, left.append)
            await until(lambda: writer.matched)
            writer.write(empty(other))
            await until(lambda: heard)
            monkeypatch.setattr(backend._entities, "wait", fail)
            backend._entities.wake()
            await asyncio.sleep(20.0)

    async with network_of(BackendName.DDS) as network, network.peer("other") as other:
        with pytest.raises(LinkError, match="nothing is received any more"):
            await listen(network, other)
    assert heard[0] in left


async def test_requests_that_wait_do_not_hold_up_other_services() -> None:
    async with with_services() as (peer, other):
        go = threading.Event()
        type_ = peer.types.service_type("std_srvs/Trigger")
        response = peer.types.encode(peer.types.make(type_.response.name))

        def slow(_: bytes) -> bytes:
            go.wait(30.0)
            return response

        peer.backend.serve("/slow", type_, slow)
        peer.backend.serve("/stop", type_, lambda cdr: response)
        request = peer.types.encode(peer.types.make(type_.request.name))

        def call() -> None:
            other.backend.call("/slow", type_, request, 30.0)

        waiting = [asyncio.create_task(in_own_thread(call)) for _ in range(6)]
        await asyncio.sleep(1.0)
        assert not (await other.call("/stop", "std_srvs/Trigger")).success
        assert not any(each.done() for each in waiting)
        go.set()
        await asyncio.gather(*waiting)


async def test_a_request_that_fails_gets_a_response_that_says_so(
    caplog: pytest.LogCaptureFixture,
) -> None:
    async with with_services() as (peer, other):
        type_ = peer.types.service_type("std_srvs/SetBool")
        peer.backend.serve("/bad", type_, lambda cdr: bytes(1 // 0))
        assert not (await other.call("/bad", "std_srvs/SetBool", data=True)).success
        assert "ZeroDivisionError" in caplog.text


def test_requests_beyond_the_bound_are_refused_at_once(caplog: pytest.LogCaptureFixture) -> None:
    go, sent = threading.Event(), list[bytes]()

    def respond(request: bytes) -> bytes:
        go.wait(30.0)
        return request

    server = ServiceResponder("/slow", respond, b"\0\1\0\0refusal", sent.append)
    for number in range(WAITING + 3):
        server.take(with_id(b"\0\1\0\0request", 7, number), b"")
    refused = [without_id(each) for each in sent]
    assert refused == [(b"\0\1\0\0refusal", 7, WAITING + number) for number in range(3)]
    assert caplog.text.count("those that come now fail") == 1
    go.set()
    server.close()


async def test_what_is_closed_leaves_nothing_behind() -> None:
    from cyclonedds.core import Entity

    async with network_of(BackendName.DDS) as network, network.peer() as peer:
        type_ = peer.types.message_type(EMPTY)

        def cycle(number: int) -> None:
            name = f"/t{number}"
            subscribed = peer.backend.subscribe(name, type_, DEEP, print, print)
            advertised = peer.backend.advertise(name, type_, DEEP)
            for each in (subscribed, advertised):
                each.close()

        cycle(0)
        before = len(Entity._entities)
        for number in range(20):
            cycle(number)
        assert len(Entity._entities) == before


async def test_a_backend_closes_while_others_open_endpoints() -> None:
    interval = sys.getswitchinterval()
    sys.setswitchinterval(1e-5)
    try:
        async with network_of(BackendName.DDS) as network:
            for _ in range(5):
                await close_amid_changes(network)
    finally:
        sys.setswitchinterval(interval)


async def close_amid_changes(network: Ros2) -> None:
    is_over = threading.Event()
    async with network.peer() as peer:
        type_ = peer.types.message_type(EMPTY)

        def change() -> None:
            kept = []
            with suppress(Exception):  # the participant is gone
                while not is_over.is_set():
                    kept.append(peer.backend.advertise("/t", type_, Qos()))
                    kept.append(peer.backend.advertise("/t", type_, Qos()))
                    kept.pop().close()

        threads = [threading.Thread(target=change) for _ in range(3)]
        for each in threads:
            each.start()
        await asyncio.sleep(0.1)
        await asyncio.to_thread(peer.backend.close)
        is_over.set()
        for each in threads:
            await asyncio.to_thread(each.join)
