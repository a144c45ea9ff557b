"""The robots that one operator drives: each is connected by itself, and holds up no other one."""

import asyncio
import logging
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractAsyncContextManager
from dataclasses import dataclass
from enum import StrEnum
from typing import Final

from pioneer3.errors import (
    ConfigError,
    HungUpError,
    PioneerError,
    PortBusyError,
    PortPermissionError,
    TurnedAwayError,
)
from pioneer3.fleet.reach import given_model, port_of
from pioneer3.fleet.spec import Fleet, FleetRobot
from pioneer3.navigation.connect import connect_async
from pioneer3.robot.explain import Reason
from pioneer3.robot.supervisor import Connection
from pioneer3.runtime.driven import Driven
from pioneer3.tasks import running

log = logging.getLogger(__name__)

PAUSES: Final = (0.5, 1.0, 2.0, 4.0, 8.0)
"""Before the next attempts to connect [s]; the last one repeats."""

REFUSALS: Final = (ConfigError, PortPermissionError, PortBusyError, HungUpError, TurnedAwayError)
"""Errors by which a robot that is there does not let this program in."""
Connect = Callable[[FleetRobot], AbstractAsyncContextManager[Driven]]
"""Connects to a robot for the length of a block: at its port, or over topics."""
Join = Callable[[FleetRobot, Driven], AbstractAsyncContextManager[None]]
"""Lets a connected robot take part for the length of a block."""


class Reached(StrEnum):
    """Whether a robot is reached."""

    WAITS = "waits"
    CONNECTED = "connected"
    LOST = "lost"
    REFUSED = "refused"


@dataclass(frozen=True, slots=True, kw_only=True)
class MemberReport:
    """The report of a robot that is connected, and why it `stands`: `None` while it moves.

    The battery's voltage [V] may be `low`. The robot is `taken` if another program drives it: then
    only stops count here. The report has an age [s].
    """

    speed: float
    turn_rate: float
    motors: bool
    voltage: float
    low: bool
    stands: Reason | None
    taken: bool = False
    age: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Member:
    """One robot at one instant, and the number that chooses it.

    `why` is the trouble in plain words, empty while it is connected, and began at `since`
    [s, monotonic].
    """

    name: str
    number: int
    reached: Reached
    why: str
    since: float
    told: MemberReport | None


class Connector:
    """Keeps one robot connected, again and again."""

    def __init__(self, robot: FleetRobot, number: int, connect: Connect, join: Join) -> None:
        self.robot = robot
        self._number = number
        self._connect = connect
        self._join = join
        self._driven: Driven | None = None
        self._clock = asyncio.get_running_loop().time
        self._reached, self._why = Reached.WAITS, "connecting"
        self._since = self._clock()

    async def run(self) -> None:
        """Connect, and connect again after each end, until cancelled; then the robot stands."""
        failed = 0
        while True:
            try:
                async with self._connect(self.robot) as driven, self._join(self.robot, driven):
                    self._driven, failed = driven, 0
                    await self._follow(driven)
            except (PioneerError, OSError) as error:
                self._note(_kind(error, self._reached), str(error))
            except Exception as error:
                log.exception("%s: failed", self.robot.name)
                self._note(Reached.LOST, f"{type(error).__name__}: {error}")
            finally:
                self._driven = None
            await asyncio.sleep(PAUSES[min(failed, len(PAUSES) - 1)])
            failed += 1

    def look(self) -> Member:
        """Return its state now."""
        driven = self._driven
        return Member(
            name=self.robot.name,
            number=self._number,
            reached=self._reached,
            why=self._why,
            since=self._since,
            told=_told(driven) if driven and self._reached is Reached.CONNECTED else None,
        )

    async def _follow(self, driven: Driven) -> None:
        """Note each loss, and each return, until the driver ends; it connects again by itself."""
        async for status in driven.supervisor.status.values(latest_first=True):
            match status.connection:
                case Connection.CONNECTED:
                    self._note(Reached.CONNECTED, "")
                case Connection.LOST | Connection.CLOSED:
                    self._note(Reached.LOST, status.message)

    def _note(self, reached: Reached, why: str) -> None:
        if reached is not self._reached:
            self._since = self._clock()
        self._reached, self._why = reached, why


class Members:
    """All robots of one operator, with their numbers by name."""

    def __init__(
        self, robots: Sequence[FleetRobot], numbers: Mapping[str, int], connect: Connect, join: Join
    ) -> None:
        self._connectors = [
            Connector(robot, numbers[robot.name], connect, join)
            for robot in sorted(robots, key=lambda robot: numbers[robot.name])
        ]

    async def run(self) -> None:
        """Keep all connected until cancelled; then all stand, side by side."""
        async with running(*(connector.run() for connector in self._connectors)):
            await asyncio.get_running_loop().create_future()

    def look(self) -> list[Member]:
        """Return the state of all now, by their numbers."""
        return [connector.look() for connector in self._connectors]


def _kind(error: Exception, before: Reached) -> Reached:
    """Return the meaning of an `error` that ended an attempt."""
    if isinstance(error, REFUSALS):
        return Reached.REFUSED
    return Reached.LOST if before in {Reached.CONNECTED, Reached.LOST} else Reached.WAITS


def _told(driven: Driven) -> MemberReport | None:
    now = driven.snapshot
    if now is None:
        return None
    return MemberReport(
        speed=now.odometry.twist.v,
        turn_rate=now.odometry.twist.w,
        motors=now.motors.enabled,
        voltage=now.battery.voltage,
        low=now.battery.low,
        stands=driven.why_not_moving(),
        taken=driven.supervisor.taken,
        age=asyncio.get_running_loop().time() - now.stamp,
    )


def connects(
    fleet: Fleet, ros1: Connect, ros2: Connect, *, max_speed: float | None = None
) -> Connect:
    """Return the function that connects to a robot: over ROS if its node has it, or at its port.

    At ports it keeps below `max_speed` [m/s].
    """

    def connect(robot: FleetRobot) -> AbstractAsyncContextManager[Driven]:
        match robot.ros:
            case "1":
                return ros1(robot)
            case "2":
                return ros2(robot)
        port = port_of(fleet, robot.name)
        return connect_async(port, model=given_model(fleet, robot), max_speed=max_speed)

    return connect
