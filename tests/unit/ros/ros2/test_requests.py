"""Requests to a robot's node, over a network in memory."""

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import pytest

from pioneer3.ros.ros2 import requests as module
from pioneer3.ros.ros2.backend import Graph, NodeName, Qos
from pioneer3.ros.ros2.distros import distro_of
from pioneer3.ros.ros2.middleware import ClientTopics
from pioneer3.ros.ros2.requests import NodeRequests
from pioneer3.ros.ros2.types import MessageTypes
from tests.unit.ros.ros2.memory import MemoryBackend, MemoryNetwork

ALL = ("enable_motors", "disable_motors", "e_stop_trigger", "e_stop_reset")
ROBOT = NodeName("pioneer3", "/r1")
PATIENCE = 5.0


@pytest.fixture(scope="module")
def types() -> MessageTypes:
    return MessageTypes(distro_of("jazzy"))


def offering(
    types: MessageTypes, names: tuple[str, ...], *, serves: bool
) -> tuple[MemoryNetwork, list[str]]:
    """Return a network with a robot's node, and the requests that it gets."""
    network, got = MemoryNetwork(), list[str]()
    robot = MemoryBackend(network, ROBOT, serves=serves)

    def offer(name: str) -> None:
        if serves:
            trigger = types.service_type("std_srvs/Trigger")
            response = types.encode(types.make(trigger.response.name))

            def respond(request: bytes) -> bytes:
                got.append(name)
                return response

            robot.serve(f"/r1/{name}", trigger, respond)
        else:
            empty = types.message_type("std_msgs/Empty")
            robot.subscribe(
                f"/r1/{name}", empty, Qos(), lambda *_: got.append(name), lambda gid: None
            )

    for name in names:
        offer(name)
    return network, got


@contextmanager
def asking(types: MessageTypes, network: MemoryNetwork, *, serves: bool) -> Iterator[NodeRequests]:
    backend = MemoryBackend(network, NodeName("fleet_stop"), serves=serves)
    topics = ClientTopics(backend, backend.node, types)
    requests = NodeRequests(backend, types, topics, ROBOT.full)
    requests.open()
    yield requests
    requests.close()


def eventually(holds: Callable[[], bool]) -> None:
    end = time.monotonic() + PATIENCE
    while not holds():
        assert time.monotonic() < end
        time.sleep(0.001)


@pytest.mark.parametrize("serves", [True, False])
def test_services_are_called_or_topics_in_their_place_in_order(
    types: MessageTypes, serves: bool
) -> None:
    network, got = offering(types, ALL, serves=serves)
    with asking(types, network, serves=serves) as requests:
        requests.latch(True)
        eventually(lambda: len(got) == 1)
        requests.latch(False)
        eventually(lambda: len(got) == 2)
        requests.switch_motors(True)
        requests.switch_motors(False)
    assert got == ["e_stop_trigger", "e_stop_reset", "enable_motors", "disable_motors"]


@pytest.mark.parametrize("serves", [True, False])
def test_a_node_without_emergency_stop_takes_the_power_away(
    types: MessageTypes, serves: bool
) -> None:
    network, got = offering(types, ALL[:2], serves=serves)
    with asking(types, network, serves=serves) as requests:
        requests.latch(True)
        requests.latch(False)
    assert got == ["disable_motors"]


def test_topics_of_a_node_are_taken_by_a_program_that_could_call_services(
    types: MessageTypes,
) -> None:
    network, got = offering(types, ALL, serves=False)
    with asking(types, network, serves=True) as requests:
        requests.latch(True)
    assert got == ["e_stop_trigger"]


def test_a_node_without_any_of_it_is_told_of(
    types: MessageTypes, caplog: pytest.LogCaptureFixture
) -> None:
    network, got = offering(types, (), serves=True)
    with asking(types, network, serves=True) as requests:
        requests.switch_motors(False)
    assert got == []
    assert "/r1/pioneer3 has no disable_motors, neither a service nor a topic" in caplog.text


class Slow:
    """A service of a robot that begins to work on a request, and goes on when it is let.

    Attributes:
        begun: Set once it works.
        goes_on: To be set.
    """

    def __init__(self, network: MemoryNetwork, name: str) -> None:
        self.begun, self.goes_on = threading.Event(), threading.Event()
        self._respond = network.servers[f"/r1/{name}"]
        network.servers[f"/r1/{name}"] = self

    def __call__(self, request: bytes) -> bytes:
        self.begun.set()
        assert self.goes_on.wait(PATIENCE)
        return self._respond(request)


@pytest.mark.parametrize("name", ["enable_motors", "e_stop_reset"])
def test_an_emergency_stop_waits_for_no_request_and_none_on_its_way_undoes_it(
    types: MessageTypes, name: str
) -> None:
    network, got = offering(types, ALL, serves=True)
    slow = Slow(network, name)
    with asking(types, network, serves=True) as requests:
        requests.switch_motors(True) if name == "enable_motors" else requests.latch(False)
        assert slow.begun.wait(PATIENCE)
        requests.switch_motors(False)
        requests.latch(True)
        eventually(lambda: got == ["e_stop_trigger"])
        slow.goes_on.set()
        eventually(lambda: got == ["e_stop_trigger", name, "e_stop_trigger"])
        requests.latch(False)
    assert got[3:] == ["e_stop_reset"]


def test_a_release_comes_after_the_emergency_stop_before_it(types: MessageTypes) -> None:
    network, got = offering(types, ALL, serves=True)
    slow = Slow(network, "e_stop_trigger")
    with asking(types, network, serves=True) as requests:
        requests.latch(True)
        assert slow.begun.wait(PATIENCE)
        requests.latch(False)
        time.sleep(0.05)
        assert got == []
        slow.goes_on.set()
    assert got == ["e_stop_trigger", "e_stop_reset"]


def test_an_emergency_stop_is_made_again_if_one_before_it_failed(
    types: MessageTypes, caplog: pytest.LogCaptureFixture
) -> None:
    network, got = offering(types, ALL, serves=True)
    respond, begun, again = network.servers["/r1/e_stop_trigger"], threading.Event(), [False]

    def fails_first(request: bytes) -> bytes:
        if not begun.is_set():
            begun.set()
            eventually(lambda: again[0])
            raise TimeoutError
        return respond(request)

    network.servers["/r1/e_stop_trigger"] = fails_first
    with asking(types, network, serves=True) as requests:
        requests.latch(True)
        assert begun.wait(PATIENCE)
        requests.latch(True)
        requests.latch(True)
        again[0] = True
    assert got == ["e_stop_trigger"]
    assert "/r1/pioneer3 has not taken e_stop_trigger" in caplog.text


def test_a_graph_that_fails_ends_no_thread(
    types: MessageTypes, monkeypatch: pytest.MonkeyPatch
) -> None:
    network, got = offering(types, ALL, serves=True)
    fails, graph = [True], MemoryBackend.graph

    def failing(backend: MemoryBackend) -> Graph:
        if fails[0]:
            raise RuntimeError
        return graph(backend)

    def is_done() -> bool:
        with requests._changed:
            return not (requests._triggers or requests._waiting or requests._is_busy)

    monkeypatch.setattr(MemoryBackend, "graph", failing)
    with asking(types, network, serves=True) as requests:
        requests.latch(True)
        requests.switch_motors(True)
        eventually(is_done)
        fails[0] = False
        requests.latch(True)
        requests.latch(False)
    assert got == ["e_stop_trigger", "e_stop_reset"]


def test_an_emergency_stop_that_is_discovered_late_is_taken(
    types: MessageTypes, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "APPEARS", PATIENCE)
    network, got = offering(types, ALL[:2], serves=True)
    late, _ = offering(types, ALL, serves=True)

    def respond(request: bytes) -> bytes:
        got.append("e_stop_trigger")
        return request

    with asking(types, network, serves=True) as requests:
        requests.latch(True)
        time.sleep(0.1)
        (found,) = [each for each in late.endpoints if each.endpoint.name == "/r1/e_stop_trigger"]
        network.servers["/r1/e_stop_trigger"] = respond
        network.endpoints.append(found)
    assert got == ["e_stop_trigger"]
