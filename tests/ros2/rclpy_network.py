"""Runs `rclpy_peer.py` on a real ROS 2, and holds what it tells; and our node by that ROS 2."""

import asyncio
from collections import defaultdict
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from itertools import count
from pathlib import Path
from typing import Any

from pioneer3.ros.ros2.distros import distro_of
from pioneer3.ros.ros2.network import BackendName, Network
from pioneer3.ros.typestore import full_name
from tests.e2e.processes import PATIENCE, until
from tests.ros2 import programs
from tests.ros2.conftest import Robot, robot_on
from tests.ros2.foreign import Foreign, foreign
from tests.ros2.networks import DOMAINS, Ros2

PROGRAM = Path(__file__).with_name("rclpy_peer.py")


@dataclass(frozen=True)
class Graph:
    """The graph as the program sees it.

    Attributes:
        nodes: Full names.
        endpoints: Of topics: `topic`, `reads`, `node`, `kind`, `hash`, `reliable`, `latched`.
        services: Their types by name.
    """

    nodes: list[str]
    endpoints: list[dict[str, Any]]
    services: dict[str, list[str]]

    def on(self, topic: str) -> list[dict[str, Any]]:
        """Return the endpoints of other nodes on a topic."""
        return [e for e in self.endpoints if e["topic"] == topic and e["node"] != "/peer"]


@dataclass
class RclpyPeer(programs.Program):
    """The running program.

    Attributes:
        heard: Messages by topic.
        times: When they came [s, monotonic].
        mismatches: Topics and policies of incompatible endpoints.
    """

    heard: dict[str, list[dict[str, Any]]] = field(default_factory=lambda: defaultdict(list))
    times: dict[str, list[float]] = field(default_factory=lambda: defaultdict(list))
    mismatches: list[tuple[str, str]] = field(default_factory=list)
    is_ready: bool = False
    _responses: dict[int, Any] = field(default_factory=dict)
    _numbers: "count[int]" = field(default_factory=count)

    def hear(self, topic: str, type_name: str, **qos: Any) -> list[dict[str, Any]]:
        """Subscribe; return the list that messages come to."""
        self.heard[topic] = []
        self.do("listen", topic=topic, kind=full_name(type_name), **qos)
        return self.heard[topic]

    def publish(
        self, topic: str, type_name: str, fields: object, rate: float = 20.0, **qos: Any
    ) -> None:
        """Send a message again and again, at a rate [Hz], for nodes find each other in time."""
        kind = full_name(type_name)
        self.do("publish", topic=topic, kind=kind, fields=fields, rate=rate, **qos)

    def leave(self, *topics: str) -> None:
        """Unsubscribe, or publish no more."""
        for topic in topics:
            self.do("close", topic=topic)

    async def call(self, service: str, type_name: str, **fields: Any) -> Any:
        """Call a service; return the response."""
        return await self._ask(
            "call", service=service, kind=full_name(type_name, "srv"), fields=fields
        )

    async def graph(self) -> Graph:
        return Graph(**await self._ask("look"))

    async def graph_when(self, condition: Callable[[Graph], object]) -> Graph:
        """Return the graph as soon as it is so."""
        async with asyncio.timeout(PATIENCE):
            while not condition(graph := await self.graph()):  # noqa: ASYNC110
                await asyncio.sleep(0.05)
        return graph

    async def _ask(self, command: str, **arguments: Any) -> Any:
        number = next(self._numbers)
        self.do(command, number=number, **arguments)
        await until(lambda: number in self._responses)
        return self._responses.pop(number)

    def take(self, line: dict[str, Any]) -> None:
        match line:
            case {"message": message, "topic": topic}:
                self.heard[topic].append(message)
                self.times[topic].append(line["at"])
            case {"sent": topic, "began": at}:
                self.times[topic].append(at)
            case {"response": response, "number": number}:
                self._responses[number] = response
            case {"mismatch": topic, "policy": policy}:
                self.mismatches.append((topic, policy))
            case {"ready": True}:
                self.is_ready = True


@dataclass(frozen=True)
class ForeignLab:
    """A simulated robot, its node, and a program with rclpy beside it.

    Attributes:
        ros: What the program runs on; the node, too, if its backend is rclpy.
        network: Where all are.
        robot: With its node.
        peer: The program.
    """

    ros: Foreign
    network: Ros2
    robot: Robot
    peer: RclpyPeer

    @property
    def serves(self) -> bool:
        """Whether the node offers services."""
        return self.network.network.backend is BackendName.RCLPY

    def drive(self, peer: RclpyPeer, **qos: Any) -> None:
        """Send 0.3 m/s 20 times a second, in the type that this distribution's Nav2 sends."""
        twist = {"linear": {"x": 0.3}}
        if distro_of(self.ros.distro).stamped_commands:
            peer.publish("/cmd_vel", "geometry_msgs/TwistStamped", {"twist": twist}, **qos)
        else:
            peer.publish("/cmd_vel", "geometry_msgs/Twist", twist, **qos)


@asynccontextmanager
async def foreign_lab(
    backend: BackendName, distro: str, *arguments: str, world: tuple[str, ...] = ("--nomap",)
) -> AsyncIterator[ForeignLab]:
    """Run a robot and its node by this backend, then the program."""
    ros = foreign(distro)
    variables = ros.variables if backend is BackendName.RCLPY else {}
    network = Ros2(Network(backend=backend, domain=next(DOMAINS)), variables)
    async with (
        robot_on(network, "--distro", distro, *arguments, world=world) as robot,
        rclpy_peer(ros, network) as peer,
    ):
        yield ForeignLab(ros, network, robot, peer)


@asynccontextmanager
async def rclpy_peer(ros: Foreign, network: Ros2, **others: str) -> AsyncIterator[RclpyPeer]:
    """Run the program on a network, with other variables of the environment."""
    variables = {**ros.variables, "ROS_DOMAIN_ID": str(network.network.domain), **others}
    command = (ros.python, str(PROGRAM))
    async with programs.program(RclpyPeer, *command, variables=variables) as peer:
        await until(lambda: peer.is_ready)
        yield peer
