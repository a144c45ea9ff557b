"""A browser at the page, without a network between: it speaks ASGI with the application."""

import asyncio
import json
from collections.abc import AsyncIterator, Callable, MutableMapping
from contextlib import asynccontextmanager
from dataclasses import dataclass
from math import hypot
from types import TracebackType
from typing import Any, Self

from numpy.random import default_rng
from starlette.types import ASGIApp

from pioneer3 import Robot, connect_async
from pioneer3.geometry import Pose2
from pioneer3.links import Link
from pioneer3.links.memory import null_modem
from pioneer3.maps import LineMap
from pioneer3.models import load_model
from pioneer3.sim.body import Body
from pioneer3.sim.equipment import Equipment
from pioneer3.sim.firmware import Firmware
from pioneer3.sim.relief import FLAT, Relief
from pioneer3.sim.server import Simulation
from pioneer3.sim.server.running import RunningSimulation
from pioneer3.sim.server.running import SimulatedRobot as RobotHere
from pioneer3.sim.world import World
from pioneer3.sim.worldfile import ClientMaps
from pioneer3.tasks import running
from pioneer3.web.app import make_app
from pioneer3.web.control import Control
from pioneer3.web.page import Page
from pioneer3.web.robot_view import RobotView
from pioneer3.web.scene import RobotScene
from tests.support import SimulatedRobot

Message = MutableMapping[str, Any]
HERE = "localhost:8080"


def strict(text: str) -> dict[str, Any]:
    """Return the object in `text`; a browser's JSON.parse knows no NaN and no Infinity."""

    def refuse(constant: str) -> None:
        raise AssertionError(f"{constant} is not JSON")

    value = json.loads(text, parse_constant=refuse)
    assert isinstance(value, dict)
    return value


class Browser:
    """One WebSocket to `app`.

    Attributes:
        heard: Every message so far.
        closed: The code the application closed with, or `None`.
    """

    def __init__(
        self,
        app: ASGIApp,
        *,
        host: str = HERE,
        origin: str | None = None,
        peer: str = "127.0.0.1",
        **headers: str,
    ) -> None:
        named = {"host": host} | ({} if origin is None else {"origin": origin}) | headers
        self._scope: dict[str, Any] = {
            "type": "websocket",
            "scheme": "ws",
            "path": "/ws",
            "headers": [(n.replace("_", "-").encode(), v.encode()) for n, v in named.items()],
            "query_string": b"",
            "client": (peer, 50000),
            "server": ("127.0.0.1", 8080),
        }
        self._app = app
        self._said: asyncio.Queue[Message] = asyncio.Queue()
        self.heard: list[dict[str, Any]] = []
        self.closed: int | None = None

    async def __aenter__(self) -> Self:
        self._said.put_nowait({"type": "websocket.connect"})
        self.task = asyncio.ensure_future(self._app(self._scope, self._said.get, self._send))
        await asyncio.sleep(0.01)
        return self

    async def __aexit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        await self.leave()

    async def leave(self) -> None:
        """Close the tab."""
        self._said.put_nowait({"type": "websocket.disconnect", "code": 1001})
        await self.task

    def say(self, type_: str, **fields: object) -> None:
        """Send a request."""
        self.say_text(json.dumps({"type": type_, **fields}))

    def say_text(self, text: str) -> None:
        """Send any text."""
        self._said.put_nowait({"type": "websocket.receive", "text": text})

    def say_bytes(self, data: bytes) -> None:
        """Send a frame of bytes."""
        self._said.put_nowait({"type": "websocket.receive", "bytes": data})

    def drive(self, v: float, w: float = 0.0) -> None:
        """Hold a velocity."""
        self.say("drive", v=v, w=w)

    async def keep_driving(self, v: float, seconds: float, w: float = 0.0) -> None:
        """Hold a key, as the page does: a request every 66 ms."""
        loop = asyncio.get_running_loop()
        end = loop.time() + seconds
        while loop.time() < end:
            self.drive(v, w)
            await asyncio.sleep(0.066)

    async def stay(self, seconds: float) -> None:
        """Look at the page for so long: it pings, half as often as real ones do."""
        loop = asyncio.get_running_loop()
        end = loop.time() + seconds
        while loop.time() < end:
            self.say("ping", t=0)
            await asyncio.sleep(1.0)

    async def stay_until(self, is_so: Callable[[], object], longest: float) -> None:
        """Look at the page until something is so, and a second more; fail after so long."""
        loop = asyncio.get_running_loop()
        end = loop.time() + longest
        while not is_so():
            assert loop.time() < end, f"not so after {longest:g} s"
            await self.stay(1.0)
        await self.stay(1.0)

    def all(self, type_: str) -> list[dict[str, Any]]:
        """Return the messages of one type so far."""
        return [message for message in self.heard if message["type"] == type_]

    def latest(self, type_: str) -> dict[str, Any]:
        """Return the newest message of one type."""
        return self.all(type_)[-1]

    def snapshots(self, robot: int = 1) -> list[dict[str, Any]]:
        """Return every snapshot of a robot so far."""
        told = [snapshot for frame in self.all("robots") for snapshot in frame["snapshots"]]
        return [snapshot for snapshot in told if snapshot["robot"] == robot]

    @property
    def snapshot(self) -> dict[str, Any]:
        """The newest snapshot of the first robot."""
        return self.snapshots()[-1]

    @property
    def driver(self) -> str | None:
        """Who drives the first robot, `you` if it is this page."""
        driver = self.snapshot["driver"]
        if driver is None:
            return None
        return "you" if driver["id"] == self.latest("people")["id"] else str(driver["name"])

    async def _send(self, message: Message) -> None:
        match message["type"]:
            case "websocket.send":
                self.heard.append(strict(message["text"]))
            case "websocket.close":
                self.closed = message["code"]


@dataclass(frozen=True)
class Product:
    """A robot in a simulated world, and the page of it."""

    sim: SimulatedRobot
    robot: Robot
    page: Page
    view: RobotView
    app: ASGIApp

    @property
    def control(self) -> Control:
        """Of the robot."""
        return self.view.control

    @property
    def speed(self) -> float:
        """True speed [m/s]."""
        return self.sim.speed

    @property
    def travelled(self) -> float:
        """Distance from the start [m]."""
        pose = self.sim.body.robot_in_world
        return hypot(pose.x, pose.y)


@asynccontextmanager
async def product(
    scene: RobotScene | None = None, *, equipment: Equipment | None = None
) -> AsyncIterator[Product]:
    """Join world, firmware, driver and page, in the loop's time."""
    async with SimulatedRobot(equipment=equipment) as sim, connect_async(sim.open) as robot:
        page = Page()
        async with page.hosting(robot, scene or RobotScene()) as view, running(page.run()):
            yield Product(sim, robot, page, view, make_app(page))


def simulated(
    *poses: Pose2, line_map: LineMap | None = None, relief: Relief = FLAT
) -> RunningSimulation:
    """Return a simulation with a robot at each pose, without a network and without time."""
    bodies = [Body(load_model("p3dx-sh"), pose) for pose in poses]
    world = World(line_map, bodies, relief=relief)
    simulation = Simulation(world, [Firmware(world, body) for body in bodies])
    robots = [
        RobotHere(
            name=f"robot-{number}",
            body=body,
            firmware=port.firmware,
            port=port,
            url=f"memory:{number}",
        )
        for number, (body, port) in enumerate(zip(bodies, simulation.ports, strict=True), 1)
    ]
    return RunningSimulation(simulation, robots, default_rng(0), ClientMaps())


@dataclass(frozen=True)
class Playground:
    """A simulation whose first robot is driven by a page."""

    simulation: RunningSimulation
    robot: Robot
    page: Page
    control: Control
    app: ASGIApp


@asynccontextmanager
async def playground(
    *poses: Pose2, line_map: LineMap | None = None, relief: Relief = FLAT
) -> AsyncIterator[Playground]:
    """Join simulation, driver and page, in the loop's time; one robot at the origin if not said."""
    here = simulated(*(poses or (Pose2(),)), line_map=line_map, relief=relief)
    port = here.robots[0].port
    serving: list[asyncio.Task[None]] = []

    async def plug_in() -> Link:
        ours, theirs = null_modem()
        serving.append(asyncio.ensure_future(port.serve(theirs)))
        return ours

    async with running(here._simulation.run()), connect_async(plug_in) as robot:
        page = Page()
        async with (
            page.hosting(robot, RobotScene.of(here, here.robots[0])) as view,
            running(page.run()),
        ):
            yield Playground(here, robot, page, view.control, make_app(page))
    await asyncio.gather(*serving)
