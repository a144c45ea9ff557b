"""Runs `dds_peer.py`, a program on DDS without this project's code, and holds what it tells."""

import asyncio
import sys
from collections import defaultdict
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from tests.e2e.processes import until
from tests.ros2 import programs
from tests.ros2.networks import Ros2

PROGRAM = Path(__file__).with_name("dds_peer.py")
CMD_VEL = "rt/cmd_vel"
TWIST = "geometry_msgs/msg/Twist"


@dataclass(frozen=True)
class Message:
    """A message that the program has received: when [s, monotonic], its fields, and its bytes."""

    at: float
    fields: dict[str, Any]
    cdr: bytes


@dataclass
class Program(programs.Program):
    """The running program.

    Attributes:
        guid: Of its participant.
        heard: Messages by the name of the reader.
        left: Number of writers that have left each reader.
        found: Participants and endpoints that are there, by identity.
        guids: Identities of its own endpoints by name.
    """

    guid: str = ""
    heard: dict[str, list[Message]] = field(default_factory=lambda: defaultdict(list))
    left: dict[str, int] = field(default_factory=lambda: defaultdict(int))
    found: dict[str, dict[str, Any]] = field(default_factory=dict)
    guids: dict[str, str] = field(default_factory=dict)

    async def reader(self, topic: str, type_name: str, key: str = "", **qos: Any) -> list[Message]:
        """Read a topic; return the list that its messages come to."""
        await self._open(key or topic, topic, type_name, reads=True, **qos)
        return self.heard[key or topic]

    async def writer(self, topic: str, type_name: str, key: str = "", **qos: Any) -> None:
        await self._open(key or topic, topic, type_name, reads=False, **qos)

    async def close(self, key: str) -> None:
        self.do("close", key=key)
        await until(lambda: key not in self.guids)

    async def drive(self, speed: float, seconds: float, key: str = CMD_VEL) -> None:
        """Send a velocity 20 times a second."""
        for _ in range(round(seconds / 0.05)):
            self.do("send", key=key, fields={"linear": {"x": speed}})
            await asyncio.sleep(0.05)

    async def send_until(
        self, condition: Callable[[], object], key: str = CMD_VEL, **content: Any
    ) -> None:
        """Send `fields`, or raw bytes as `cdr`, until a condition holds.

        The first messages may be lost: endpoints do not know each other at the same moment.
        """

        def sent() -> object:
            self.do("send_raw" if "cdr" in content else "send", key=key, **content)
            return condition()

        await until(sent)

    def endpoints(self, topic: str, kind: str = "publication") -> list[dict[str, Any]]:
        """Return the endpoints of others on a topic."""
        return [
            each
            for guid, each in self.found.items()
            if (each["found"], each.get("topic")) == (kind, topic) and guid[:24] != self.guid[:24]
        ]

    async def _open(self, key: str, topic: str, type_name: str, **wanted: Any) -> None:
        self.do("open", key=key, topic=topic, kind=type_name, **wanted)
        await until(lambda: key in self.guids)

    def take(self, line: dict[str, Any]) -> None:
        match line:
            case {"message": fields}:
                message = Message(line["at"], fields, bytes.fromhex(line["cdr"]))
                self.heard[line["key"]].append(message)
            case {"left": True}:
                self.left[line["key"]] += 1
            case {"gone": True}:
                self.found.pop(line["guid"], None)
            case {"found": _}:
                self.found[line["guid"]] = line
            case {"opened": key}:
                self.guids[key] = line["guid"]
            case {"closed": key}:
                del self.guids[key]
            case {"guid": guid}:
                self.guid = guid


@asynccontextmanager
async def program_on(network: Ros2, gid_bytes: int = 16) -> AsyncIterator[Program]:
    """Run the program on a network."""
    domain = str(network.network.domain)
    command = (sys.executable, str(PROGRAM), domain, str(gid_bytes))
    async with programs.program(Program, *command) as program:
        await until(lambda: program.guid)
        yield program
