"""The state that all clients share: the robots, the world around them, and the clients."""

import asyncio
from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager
from functools import partial
from itertools import count
from typing import Protocol

from pioneer3 import __version__
from pioneer3.errors import CommandError
from pioneer3.maps import LineMap
from pioneer3.runtime.robot import Robot
from pioneer3.runtime.traffic import Traffic
from pioneer3.tasks import running
from pioneer3.teleop.gamepad import SCHEME
from pioneer3.web import messages, requests
from pioneer3.web.access.access import Access, device
from pioneer3.web.access.sessions import Role, Session, free_name
from pioneer3.web.broadcast import FrameChannel, RetainedChannel, ScanChannel, Subscriber
from pioneer3.web.control import Control, Operator
from pioneer3.web.editor import Editor
from pioneer3.web.map_editor import MapEditor
from pioneer3.web.mapping import RobotMapping
from pioneer3.web.navigation import RobotNavigation
from pioneer3.web.robot_view import RobotView
from pioneer3.web.scene import Scene
from pioneer3.web.world import WorldChannel, WorldView, map_message

UPDATE_PERIOD = 0.1
"""Time between two updates about the simulated world and the clients [s]."""


class PageClient(Operator, Subscriber, Protocol):
    """A client of the page. Clients are compared by identity."""

    @property
    def role(self) -> Role:
        """The permissions of the client."""

    def tell(self, news: str) -> None:
        """Show `news`."""

    def show(self, message: messages.Message) -> None:
        """Send `message` to this client alone."""


class Clients:
    """The connected clients of a page.

    Attributes:
        connected: By number; a number is never used again.
        version: Counts the changes of the clients and of the operators who have control.
    """

    def __init__(self, robots: Mapping[int, RobotView]) -> None:
        self.connected: dict[int, PageClient] = {}
        self.version = 0
        self._robots = robots
        self._count = count(1)
        self._holders: tuple[messages.Holder, ...] = ()
        self._clients: tuple[messages.Client, ...] = ()

    def add(self, client: PageClient) -> int:
        """Add `client`; return its number."""
        number = next(self._count)
        self.connected[number] = client
        return number

    def remove(self, number: int) -> PageClient:
        """Remove a client; return it."""
        return self.connected.pop(number)

    def update(self) -> bool:
        """Compare the clients with the last update; return whether anything has changed."""
        clients = tuple(
            messages.Client(number, client.name, client.role)
            for number, client in self.connected.items()
        )
        holders = tuple(
            messages.Holder(view.number, self.number_of(holder), holder.name)
            for view in self._robots.values()
            if (holder := view.control.holder) is not None
        )
        if (holders, clients) == (self._holders, self._clients):
            return False
        self._holders, self._clients = holders, clients
        self.version += 1
        return True

    def message_for(self, number: int) -> str:
        """Return the message about all clients, for the client of this number."""
        you = self.connected[number]
        return messages.encode(
            messages.People(number, you.name, you.role, self._holders, self._clients)
        )

    def number_of(self, operator: object) -> int | None:
        """Return the number of an operator that is a client, or `None`."""
        return next((n for n, client in self.connected.items() if client is operator), None)

    def find(self, operator: object) -> PageClient | None:
        """Return `operator` if it is a client."""
        return next((client for client in self.connected.values() if client is operator), None)


class Page:
    """The robots and their clients. Robots are added with :meth:`hosting`.

    Attributes:
        robots: The robots by number.
        clients: The connected clients.
        access: Decides who is let in.
        map_editor: Edits the map.
        world: The world of simulated robots, which can be changed; `None` without.
        retained: The robots, their connections, and the map.
        world_changes: The changes of the world; `None` without one.
        snapshots: The newest snapshots.
        scans: The newest sweeps of lasers.
        closed: Set when clients are to go.
    """

    def __init__(self, access: Access | None = None) -> None:
        self.robots: dict[int, RobotView] = {}
        self.clients = Clients(self.robots)
        self.access = access or Access(asyncio.get_running_loop().time)
        self.access.sessions.on_end = self.release_control
        self.world: WorldView | None = None
        self.closed = asyncio.Event()
        self._count = count(1)
        self._map: LineMap | None = None
        self._drawn: LineMap | None = None
        self._traffic = Traffic()
        self.retained = RetainedChannel()
        self.snapshots = FrameChannel(self._wake)
        self.scans = ScanChannel(self._wake)
        self.world_changes: WorldChannel | None = None
        self._editor: Editor | None = None
        self.map_editor = MapEditor(
            self._map_in_use,
            robots_on=self._robots_on,
            adopt=self._adopt_map,
            publish=self._publish_draft,
        )

    @asynccontextmanager
    async def hosting(
        self, robot: Robot, scene: Scene, name: str = "", number: int = 0
    ) -> AsyncIterator[RobotView]:
        """Show `robot` to all clients, and let them drive it, while the block lasts.

        Args:
            robot: A connected robot.
            scene: Its surroundings.
            name: Shown to people; empty for the robot's own name.
            number: Identifies it in requests; 0 for the next.
        """
        taken = {view.name for view in self.robots.values()}
        named = free_name(name or robot.info.identity.name, taken)
        view = self._view(number or next(self._count), named, robot, scene)
        number = self._add(view, scene)
        try:
            self._publish_robots()
            self._publish_status(view)
            async with running(
                self._watch_status(view),
                view.publish_snapshots(self.snapshots, self.clients),
                view.details.run(),
                view.navigation.run(),
                view.mapping.run(),
                view.details.ask(),
                self.scans.follow(number, robot.lasers, view.sensor_in_map),
            ):
                yield view
        finally:
            del self.robots[number]
            if self.world is not None and scene.simulated:
                del self.world.driven[scene.simulated[1]]
            self.snapshots.forget(number)
            self.scans.forget(number)
            self.retained.forget(f"status {number}")
            self._publish_robots()

    async def run(self) -> None:
        """Keep clients up to date about the world and each other; ends by cancellation."""
        try:
            async with running(self.map_editor.run()):
                while True:
                    self.update()
                    await asyncio.sleep(UPDATE_PERIOD)
        finally:
            self.closed.set()

    def update(self) -> None:
        """Tell clients the changes of the world and of the clients."""
        self.map_editor.follow()
        if not self.clients.connected:
            return
        changed = self.clients.update()
        if self.world_changes is not None:
            changed |= self.world_changes.update()
        if self._map_now() is not self._map:  # clients of a simulator may load another
            self._publish_robots()
        if changed:
            self._wake()

    def robot(self, number: int | None) -> RobotView:
        """Return the robot of this number, the first without one.

        Raises:
            CommandError: there is none.
        """
        found = next(iter(self.robots.values()), None) if number is None else None
        found = found or self.robots.get(number or 0)
        if found is None:
            raise CommandError("there is no robot" if number is None else f"no robot {number}")
        return found

    def emergency_stop(self) -> None:
        """Stop every robot as hard as possible, latched."""
        for view in self.robots.values():
            view.robot.emergency_stop()

    def join(self, client: PageClient) -> int:
        """Add a client; return its number."""
        number = self.clients.add(client)
        self.update()
        return number

    def leave(self, number: int) -> None:
        """Remove a client: robots that it drives stop at once."""
        self.scans.subscribe(number, on=False)
        client = self.clients.remove(number)
        self.release_control(client)
        for view in self.robots.values():
            view.details.unsubscribe(client)

    def release_control(self, operator: Operator) -> None:
        """End the control of `operator` over all robots; those that the operator drives stop."""
        for view in self.robots.values():
            view.control.release(operator)

    def keep_alive(self, operator: Operator) -> None:
        """Note that the client of `operator` is alive."""
        for view in self.robots.values():
            view.control.keep_alive(operator)

    def name_for(self, session: Session, user_agent: str) -> str:
        """Return a name for a client, from its session or its device, that no other client has."""
        names = {client.name for client in self.clients.connected.values()}
        if session is not self.access.here:
            return free_name(session.name, names)
        return free_name(device(user_agent), names | self.access.sessions.names)

    async def edit(
        self, client: PageClient, edit: requests.Edit | requests.MapEdit
    ) -> messages.Added | messages.EditRefused | None:
        """Change the simulated world or the map for `client`; return the answer, if there is one.

        Edits of a map may take long: they are answered later.
        """
        if isinstance(edit, requests.MapEdit):
            self.map_editor.ask(edit, client.show)
            return None
        if self._editor is None:
            return messages.EditRefused("only a simulated world can be changed here")
        answer = await self._editor.apply(client, edit)
        self.update()  # clients know a thing before the answer names it
        return answer

    def _view(self, number: int, name: str, robot: Robot, scene: Scene) -> RobotView:
        def tell(operator: Operator, news: str) -> None:
            client = self.clients.find(operator)
            if client is not None:
                client.tell(f"{name}: {news}" if len(self.robots) > 1 else news)

        def show(operator: Operator, message: messages.Message) -> None:
            client = self.clients.find(operator)
            if client is not None:
                client.show(message)

        def publish(kind: str, state: messages.Navigation | messages.Mapping | None) -> None:
            key = f"{kind} {number}"
            if state is None:
                self.retained.forget(key)
            elif self.retained.put(key, messages.encode(state)):
                self._wake()

        control = Control(robot, scene, tell)
        navigation = RobotNavigation(
            number,
            robot,
            scene,
            control,
            tell=tell,
            show=show,
            publish=partial(publish, "navigation"),
            traffic=self._traffic,
            name=name,
        )
        mapping = RobotMapping(
            number, robot, scene, control, tell=tell, publish=partial(publish, "mapping")
        )
        return RobotView(
            number,
            name,
            robot,
            scene=scene,
            control=control,
            navigation=navigation,
            mapping=mapping,
        )

    def _add(self, view: RobotView, scene: Scene) -> int:
        """Add a robot, with its world if it is the first; return its number."""
        others = dict(self.robots)
        self.robots.clear()
        self.robots.update(sorted({**others, view.number: view}.items()))
        if scene.simulated:
            simulation, robot = scene.simulated
            if self.world is None:
                self.world = WorldView(simulation)
                self.world_changes = WorldChannel(self.world)
                self._editor = Editor(self.world, self._take_control, self._stop)
            self.world.driven[robot] = view.number
        return view.number

    def _take_control(self, client: object, robot: int | None) -> bool:
        """Give `client` control of a robot, or of all without a number; return whether it has it.

        It gets control of all of them or of none.
        """
        operator = self.clients.find(client)
        wanted = self.robots.values() if robot is None else [self.robots[robot]]
        controls = [view.control for view in wanted]
        if operator is None or any(each.holder not in (None, operator) for each in controls):
            return False
        return all(each.take(operator) is None for each in controls)

    def _stop(self, robot: int) -> None:
        self.robots[robot].robot.arbiter.stop()

    def _publish_robots(self) -> None:
        """Tell the robots and the map, if they have changed."""
        self._map = self._map_now()
        hello = messages.Hello(
            version=__version__,
            robots=tuple(view.describe() for view in self.robots.values()),
            models=self.world.models if self.world else None,
            gamepad=SCHEME,
        )
        changed = self.retained.put("hello", messages.encode(hello))
        if self._drawn is not self._map:  # a map may be large
            self._drawn = self._map
            changed |= self.retained.put("map", self._map_text())
        if changed:
            self._wake()

    def _map_text(self) -> str:
        """Return the message for the map."""
        for view in self.robots.values():
            if view.mapping.drawing is not None and view.mapping.drawing is self._map:
                return view.mapping.drawing_text
        return messages.encode(map_message(self._map))

    def _map_now(self) -> LineMap | None:
        """Return the map that is made, that of the simulated world, or the first of a scene."""
        made = (view.mapping.drawing for view in self.robots.values())
        if (drawing := next((each for each in made if each is not None), None)) is not None:
            return drawing
        return self._known_map() or self._map

    def _known_map(self) -> LineMap | None:
        """Return the map of the simulated world, or the first of a scene."""
        if self.world is not None:
            return self.world.simulation.world.map
        maps = (view.scene.map_now for view in self.robots.values())
        return next((known for known in maps if known is not None), None)

    def _map_in_use(self) -> LineMap | None:
        """Return the map that robots drive on; `None` while one is made, or without walls."""
        known = self._known_map()
        made = any(view.mapping.making for view in self.robots.values())
        return known if known is not None and len(known.walls) and not made else None

    def _robots_on(self, line_map: LineMap) -> list[Robot]:
        return [view.robot for view in self.robots.values() if view.scene.map_now is line_map]

    def _adopt_map(self, used: LineMap, line_map: LineMap) -> None:
        """Have all robots that use a map use another one from now on."""
        views = [view for view in self.robots.values() if view.scene.map_now is used]
        for view in views:
            view.scene.adopt(line_map)
        self.update()

    def _publish_draft(self, text: str) -> None:
        if self.retained.put("map draft", text):
            self._wake()

    def _publish_status(self, view: RobotView) -> None:
        text = messages.encode(view.status())
        if self.retained.put(f"status {view.number}", text):
            self._wake()

    async def _watch_status(self, view: RobotView) -> None:
        async for _ in view.robot.supervisor.status.values():
            self._publish_robots()
            self._publish_status(view)

    def _wake(self) -> None:
        for client in self.clients.connected.values():
            client.wake()
