"""What all visitors share: the robots, the world around them, and who is here."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from itertools import count
from typing import Any

from pioneer3 import __version__
from pioneer3.errors import CommandError
from pioneer3.runtime.robot import Robot
from pioneer3.sim.maps import LineMap
from pioneer3.tasks import running
from pioneer3.web import messages, requests
from pioneer3.web.access.access import Access, device
from pioneer3.web.access.sessions import Session, free_name
from pioneer3.web.channel import Notices
from pioneer3.web.editor import Editor, refusal
from pioneer3.web.guest import Guest, Somebody
from pioneer3.web.people import People
from pioneer3.web.plan import plan
from pioneer3.web.scans import Scans
from pioneer3.web.scene import Scene
from pioneer3.web.snapshots import Snapshots
from pioneer3.web.station import Station
from pioneer3.web.wheel import Wheel
from pioneer3.web.world import WorldView
from pioneer3.web.world_news import WorldNews

LOOK = 0.1
"""Time between two looks at the simulated world, and at who is here [s]."""


class Page:
    """The robots and their visitors. Robots come with :meth:`hosting`.

    Attributes:
        stations: The robots by number.
        people: Who looks at them now.
        access: Who may come in.
        world: What surrounds simulated robots and can be changed; `None` without.
        notices: Who the robots are, and how it stands with their links.
        world_news: What changes in the world; `None` without one.
        snapshots: What the robots say.
        scans: What their lasers see, for those who want it.
        closed: Set when visitors are to go.
    """

    def __init__(self, access: Access | None = None) -> None:
        self.stations: dict[int, Station] = {}
        self.people = People(self.stations)
        self.access = access or Access(asyncio.get_running_loop().time)
        self.access.sessions.on_end = self.let_go
        self.world: WorldView | None = None
        self.closed = asyncio.Event()
        self._count = count(1)
        self._map: LineMap | None = None
        self._drawn: LineMap | None = None
        self.notices = Notices()
        self.snapshots = Snapshots(self._wake)
        self.scans = Scans(self._wake)
        self.world_news: WorldNews | None = None
        self._editor: Editor | None = None

    @asynccontextmanager
    async def hosting(
        self, robot: Robot, scene: Scene, name: str = "", number: int = 0
    ) -> AsyncIterator[Station]:
        """Show `robot` to all visitors, and let them drive it, while the block lasts.

        Args:
            robot: A connected robot.
            scene: What surrounds it.
            name: What people call it; empty for the robot's own name.
            number: What it goes by in requests; 0 for the next.
        """
        taken = {station.name for station in self.stations.values()}
        named = free_name(name or robot.info.identity.name, taken)
        station = self._station(number or next(self._count), named, robot, scene)
        number = self._own(station, scene)
        try:
            self._greet()
            self._tell_status(station)
            async with running(
                self._watch_status(station),
                self._watch_snapshots(station),
                station.details.run(),
                station.details.ask(),
                self.scans.follow(station),
            ):
                yield station
        finally:
            del self.stations[number]
            if self.world is not None and scene.simulated:
                del self.world.driven[scene.simulated[1]]
            self.snapshots.forget(number)
            self.scans.forget(number)
            self.notices.forget(f"status {number}")
            self._greet()

    async def run(self) -> None:
        """Keep visitors up to date about the world and each other; ends by cancellation."""
        try:
            while True:
                self.look()
                await asyncio.sleep(LOOK)
        finally:
            self.closed.set()

    def look(self) -> None:
        """Let visitors know what has changed in the world, and who is here."""
        if not self.people.guests:
            return
        news = self.people.look()
        if self.world is not None and self.world_news is not None:
            news |= self.world_news.look()
        if self._map_now() is not self._map:  # clients of a simulator may load another
            self._greet()
        if news:
            self._wake()

    def station(self, number: int | None) -> Station:
        """Return the robot of this number, the first without one.

        Raises:
            CommandError: there is none.
        """
        found = next(iter(self.stations.values()), None) if number is None else None
        found = found or self.stations.get(number or 0)
        if found is None:
            raise CommandError("there is no robot" if number is None else f"no robot {number}")
        return found

    def emergency_stop(self) -> None:
        """Stop every robot as hard as possible, latched."""
        for station in self.stations.values():
            station.robot.emergency_stop()

    def enter(self, guest: Guest) -> int:
        """Let `guest` in; return their number."""
        number = self.people.enter(guest)
        self.look()
        return number

    def leave(self, number: int) -> None:
        """Show a guest out: robots that they drive stop at once."""
        self.scans.want(number, wanted=False)
        guest = self.people.leave(number)
        self.let_go(guest)
        for station in self.stations.values():
            station.details.unwatch(guest)

    def let_go(self, who: Somebody) -> None:
        """Take every wheel from `who`; the robots that they drive stop at once."""
        for station in self.stations.values():
            station.wheel.let_go(who)

    def heard_of(self, who: Somebody) -> None:
        """Note that `who` is still there."""
        for station in self.stations.values():
            station.wheel.heard_of(who)

    def name_for(self, session: Session, user_agent: str) -> str:
        """Return what to call a guest: as the session, or after the device, and like no other."""
        names = {guest.name for guest in self.people.guests.values()}
        if session is not self.access.here:
            return free_name(session.name, names)
        return free_name(device(user_agent), names | self.access.sessions.names)

    async def edit(self, who: object, edit: requests.Edit) -> dict[str, Any] | None:
        """Change the simulated world for `who`; return the answer, if there is one."""
        if self._editor is None:
            return refusal("only a simulated world can be changed here")
        return await self._editor.obey(who, edit)

    def _station(self, number: int, name: str, robot: Robot, scene: Scene) -> Station:
        def tell(who: Somebody, news: str) -> None:
            guest = self.people.guest(who)
            if guest is not None:
                guest.tell(f"{name}: {news}" if len(self.stations) > 1 else news)

        return Station(number, name, robot, scene, Wheel(robot, tell))

    def _own(self, station: Station, scene: Scene) -> int:
        """Take a robot in, with its world if it is the first; return its number."""
        others = dict(self.stations)
        self.stations.clear()
        self.stations.update(sorted({**others, station.number: station}.items()))
        if scene.simulated:
            simulation, robot = scene.simulated
            if self.world is None:
                self.world = WorldView(simulation)
                self.world_news = WorldNews(self.world)
                self._editor = Editor(self.world, self._may_edit, self._stop)
            self.world.driven[robot] = station.number
        return station.number

    def _may_edit(self, who: object, robot: int | None) -> bool:
        """Give the wheel of `robot`, or of all, to `who` if that is free or theirs; return if so.

        A guest gets all of them or none.
        """
        guest = self.people.guest(who)
        wanted = self.stations.values() if robot is None else [self.stations[robot]]
        wheels = [station.wheel for station in wanted]
        if guest is None or any(wheel.holder not in (None, guest) for wheel in wheels):
            return False
        return all(wheel.take(guest) is None for wheel in wheels)

    def _stop(self, robot: int) -> None:
        self.stations[robot].robot.arbiter.stop()

    def _greet(self) -> None:
        """Say what is here, if that has changed."""
        self._map = self._map_now()
        hello = messages.hello(
            __version__,
            [station.describe() for station in self.stations.values()],
            self.world.models if self.world else None,
        )
        news = self.notices.put("hello", messages.encode(hello))
        if self._drawn is not self._map:  # once for all: a map may be large
            self._drawn = self._map
            news |= self.notices.put("map", messages.encode(plan(self._map)))
        if news:
            self._wake()

    def _map_now(self) -> LineMap | None:
        """Return the map of the simulated world, or the first that a robot's surroundings have."""
        if self.world is not None:
            return self.world.simulation.world.map
        maps = (station.scene.map_now for station in self.stations.values())
        return next((known for known in maps if known is not None), self._map)

    def _tell_status(self, station: Station) -> None:
        text = messages.encode(station.status())
        if self.notices.put(f"status {station.number}", text):
            self._wake()

    async def _watch_status(self, station: Station) -> None:
        async for _ in station.robot.supervisor.status.values():
            self._greet()
            self._tell_status(station)

    async def _watch_snapshots(self, station: Station) -> None:
        feed = station.robot.supervisor.snapshots
        async for snapshot in feed.values():
            if self.people.guests:
                who = station.wheel.driver()
                driver = self.people.tell_of(who) if who is not None else None
                text = messages.encode(station.snapshot(snapshot, driver))
                self.snapshots.put(station.number, text)

    def _wake(self) -> None:
        for guest in self.people.guests.values():
            guest.wake()
