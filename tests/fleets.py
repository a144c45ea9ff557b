"""A fleet of simulated robots, each at a cable in memory that tests may spoil."""

from collections.abc import AsyncIterator, Callable
from contextlib import AsyncExitStack, asynccontextmanager
from dataclasses import dataclass, field

from pioneer3.fleet.drive import FleetDrive
from pioneer3.fleet.members import Member, MemberReport
from pioneer3.fleet.spec import FleetRobot
from pioneer3.navigation.connect import connect_async
from pioneer3.runtime.driven import Driven
from pioneer3.tasks import running
from pioneer3.teleop.keyboard import Manner
from tests.support import SimulatedRobot, until

UP, LEFT, ESCAPE, QUIT = "\x1b[A", "\x1b[D", "\x1b", "\x04"


def robot(number: int) -> FleetRobot:
    return FleetRobot(
        name=f"p3at-{number}", host="", address=f"10.0.0.{number}", node=f"RosAria_p3at_{number}"
    )


@dataclass
class Simulated:
    """Robots of a fleet, and how to connect to them.

    Attributes:
        robots: As in a fleet file.
        sims: Theirs, by name.
        attempts: How often each was connected to.
        driven: Those connected.
    """

    robots: list[FleetRobot]
    sims: dict[str, SimulatedRobot]
    attempts: dict[str, int] = field(default_factory=dict)
    driven: dict[str, Driven] = field(default_factory=dict)

    @asynccontextmanager
    async def connect(self, robot: FleetRobot) -> AsyncIterator[Driven]:
        self.attempts[robot.name] = self.attempts.get(robot.name, 0) + 1
        async with connect_async(self.sims[robot.name].open) as driven:
            self.driven[robot.name] = driven
            yield driven

    def speeds(self) -> list[float]:
        return [round(sim.speed, 1) for sim in self.sims.values()]


@asynccontextmanager
async def simulated(
    count: int = 5, make: Callable[[], SimulatedRobot] = SimulatedRobot
) -> AsyncIterator[Simulated]:
    robots = [robot(number) for number in range(1, count + 1)]
    async with AsyncExitStack() as stack:
        sims = {each.name: await stack.enter_async_context(make()) for each in robots}
        yield Simulated(robots, sims)


@dataclass
class Fleet:
    """A fleet that somebody drives."""

    drive: FleetDrive
    here: Simulated

    def press(self, *tokens: str) -> None:
        for token in tokens:
            self.drive.press(token)

    def member(self, number: int) -> Member:
        return self.drive.look()[number - 1]

    def told(self, number: int) -> MemberReport:
        told = self.member(number).told
        assert told is not None
        return told

    def sim(self, number: int) -> SimulatedRobot:
        return self.here.sims[f"p3at-{number}"]


@asynccontextmanager
async def driven(
    here: Simulated, manner: Manner | None = None, *, connected: int | None = None
) -> AsyncIterator[Fleet]:
    """Drive the robots of `here` once so many are `connected`, all if not given."""
    drive = FleetDrive(here.robots, here.connect, manner or Manner(speed=0.2, latch=True))
    wanted = len(here.robots) if connected is None else connected
    async with running(drive.run()):
        await until(lambda: sum(member.told is not None for member in drive.look()) >= wanted)
        yield Fleet(drive, here)
