"""The state that all clients share: the robots, the world around them, and the clients."""

import asyncio
from collections.abc import AsyncIterator, Iterable
from contextlib import asynccontextmanager
from functools import partial
from itertools import count

from pioneer3 import __version__
from pioneer3.errors import CommandError
from pioneer3.maps import LineMap
from pioneer3.names import free_name
from pioneer3.navigation.traffic import Participant, Traffic
from pioneer3.runtime.robot import Robot
from pioneer3.sim.relief import FLAT, Relief
from pioneer3.tasks import running
from pioneer3.teleop.gamepad import SCHEME
from pioneer3.web import messages, requests
from pioneer3.web.access.access import Access, device
from pioneer3.web.access.sessions import Role, Session
from pioneer3.web.audience import Audience, find_audience
from pioneer3.web.classroom.classroom import Classroom
from pioneer3.web.clients import Clients, PageClient
from pioneer3.web.control import Control, Operator, Rule
from pioneer3.web.editor import Editor
from pioneer3.web.map_editor import MapEditor
from pioneer3.web.mapping import RobotMapping
from pioneer3.web.navigation import RobotNavigation
from pioneer3.web.robot_view import RobotView
from pioneer3.web.scene import Scene
from pioneer3.web.world import WorldChannel, WorldView, map_message

UPDATE_PERIOD = 0.1
"""Time between two updates about the simulated world and the clients [s]."""
SLOW_UPDATES = 5
"""Audiences of one robot are sent every fifth update about the world."""


class Page:
    """The robots and their clients. Robots are added with :meth:`hosting`.

    Attributes:
        robots: The robots by number.
        clients: The connected clients.
        access: Decides who is let in.
        map_editor: Edits the map.
        world: The world of simulated robots, which can be changed; `None` without.
        audiences: Sets of clients that are sent the same; the first sees all robots.
        world_changes: The changes of the world; `None` without one.
        traffic: The places of the robots, by which they keep apart.
        classroom: The class that the robots belong to; `None` without one.
        closed: Set when clients are to go.
    """

    def __init__(self, access: Access | None = None) -> None:
        self.robots: dict[int, RobotView] = {}
        self.clients = Clients(self.robots)
        self.access = access or Access(asyncio.get_running_loop().time)
        self.access.sessions.on_end = self._session_ended
        self.world: WorldView | None = None
        self.closed = asyncio.Event()
        self._count = count(1)
        self._map: LineMap | None = None
        self._drawn: LineMap | None = None
        self.traffic = Traffic()
        self.audiences = [Audience()]
        self.world_changes: WorldChannel | None = None
        self._slow_changes: WorldChannel | None = None
        self._updates = 0
        self.classroom: Classroom | None = None
        self._labels: dict[int, str] = {}
        self._editor: Editor | None = None
        self.map_editor = MapEditor(
            self._map_in_use,
            self._known_relief,
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
        number = number or next(self._count)
        taken = {view.name for view in self.robots.values()}
        named = free_name(name or robot.info.identity.name, taken)
        view = self._view(number, named, robot, scene)
        view.label = self._labels.get(number, named)
        self._add(view, scene)
        followed = (
            audience.scans.follow(number, robot.lasers, view.sensor_in_map)
            for audience in self.audiences
            if audience.sees(number)
        )
        try:
            self._publish_robots()
            self._publish_status(view)
            with self.traffic.joined(Participant(view.name, robot, scene.place)):
                async with running(
                    self._watch_status(view),
                    view.publish_snapshots(self.audiences, self.clients),
                    view.details.run(),
                    view.navigation.run(),
                    view.mapping.run(),
                    view.details.ask(),
                    *followed,
                ):
                    yield view
        finally:
            if scene.simulated:
                self.traffic.forget(view.name)  # it is in the world no more
            del self.robots[number]
            if self.world is not None and scene.simulated:
                del self.world.driven[scene.simulated[1]]
            for audience in self.audiences:
                audience.forget(number)
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
        if self.clients.update():
            self._wake()
        self._update_world()
        if self._map_now() is not self._map:  # clients of a simulator may load another
            self._publish_robots()

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

    def known(self, numbers: Iterable[int]) -> list[RobotView]:
        """Return the robots of these numbers; those that are gone are left out."""
        return [self.robots[number] for number in numbers if number in self.robots]

    def emergency_stop(self, number: int | None = None) -> None:
        """Stop a robot, or every one without a number, as hard as possible, latched."""
        for view in self.robots.values():
            if number in {None, view.number}:
                view.robot.emergency_stop()

    def add_audience(self, audience: Audience) -> None:
        """Let clients belong to `audience`; to be called before the first robot is hosted."""
        self.audiences.append(audience)
        self._publish_robots()

    def audience_for(self, session: Session, *, robot: int | None, small: bool) -> Audience:
        """Return the audience of a client that asks for one robot, or for small snapshots.

        A student's is always that of the own robot.
        """
        if session.role is Role.STUDENT:
            found = find_audience(self.audiences, robot=session.robot, student=True)
            assert found is not None
            return found
        return find_audience(self.audiences, robot=robot, small=small) or self.audiences[0]

    def join(self, client: PageClient, audience: Audience | None = None) -> int:
        """Add a client to an audience, without one to that of all robots; return its number."""
        (audience or self.audiences[0]).clients.add(client)
        number = self.clients.add(client)
        self.update()
        return number

    def leave(self, number: int) -> None:
        """Remove a client: robots that it drives stop at once."""
        client = self.clients.remove(number)
        for audience in self.audiences:
            audience.clients.discard(client)
            audience.scans.subscribe(number, on=False)
        self.release_control(client)
        for view in self.robots.values():
            view.details.unsubscribe(client)

    def release_control(self, operator: Operator) -> None:
        """End the control of `operator` over all robots; those that the operator drives stop."""
        for view in self.robots.values():
            view.control.release(operator)

    def _session_ended(self, session: Session) -> None:
        self.release_control(session)
        if self.classroom is not None:
            self.classroom.session_ended(session)

    def keep_alive(self, operator: Operator) -> None:
        """Note that the client of `operator` is alive."""
        for view in self.robots.values():
            view.control.keep_alive(operator)

    def name_for(self, session: Session, user_agent: str) -> str:
        """Return a name for a client, from its session or its device, that no other client has."""
        if session.role is Role.STUDENT:
            return session.name
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
                client.tell(self._prefixed(client, number, news))

        def show(operator: Operator, message: messages.Message) -> None:
            client = self.clients.find(operator)
            if client is not None:
                client.show(message)

        def publish(kind: str, state: messages.Navigation | messages.Mapping | None) -> None:
            key = f"{kind} {number}"
            text = "" if state is None else messages.encode(state)
            for audience in self.audiences:
                if state is None:
                    audience.retained.forget(key)
                elif audience.sees(number) and not audience.small:
                    audience.put(key, text)

        control = Control(robot, scene, tell, self._rule_for(number))
        navigation = RobotNavigation(
            number,
            robot,
            scene,
            control,
            tell=tell,
            show=show,
            publish=partial(publish, "navigation"),
            traffic=self.traffic,
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

    def _prefixed(self, client: PageClient, number: int, news: str) -> str:
        """Return `news` about a robot with its name, for a client that sees several."""
        several = len(self.robots) > 1 and client.role is not Role.STUDENT
        return f"{self.robots[number].label}: {news}" if several else news

    def _rule_for(self, number: int) -> Rule:
        """Return the rule for driving a robot; a class has its own."""

        def refusal(operator: Operator, *, take_over: bool) -> str | None:
            if self.classroom is None:
                return None
            return self.classroom.refusal(number, operator, take_over=take_over)

        return refusal

    def _add(self, view: RobotView, scene: Scene) -> None:
        """Add a robot, with its world if it is the first."""
        others = dict(self.robots)
        self.robots.clear()
        self.robots.update(sorted({**others, view.number: view}.items()))
        if scene.simulated:
            simulation, robot = scene.simulated
            if self.world is None:
                self.world = WorldView(simulation)
                self.world_changes = WorldChannel(self.world)
                self._slow_changes = WorldChannel(self.world)
                for audience in self.audiences:
                    slow = audience.is_limited
                    audience.world = self._slow_changes if slow else self.world_changes
                self._editor = Editor(self.world, self._take_control, self._stop)
            self.world.driven[robot] = view.number

    def _update_world(self) -> None:
        """Tell the changes of the world; audiences of one robot less often."""
        self._updates += 1
        for channel, every in ((self.world_changes, 1), (self._slow_changes, SLOW_UPDATES)):
            readers = [each for each in self.audiences if each.world is channel and each.clients]
            if channel is not None and readers and not self._updates % every and channel.update():
                for audience in readers:
                    audience.wake()

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

    def relabel(self, number: int, label: str) -> None:
        """Show a robot under another name from now on."""
        self._labels[number] = label
        if number in self.robots:
            self.robots[number].label = label
            self._publish_robots()

    def _publish_robots(self) -> None:
        """Tell the robots and the map, if they have changed."""
        self._map = self._map_now()
        robots = tuple(view.describe() for view in self.robots.values())
        for audience in self.audiences:
            audience.put("hello", messages.encode(self._hello(robots, audience)))
        if self._drawn is not self._map:  # a map may be large
            self._drawn = self._map
            text = self._map_text()
            for audience in self.audiences:
                audience.put("map", text)

    def _hello(self, robots: tuple[messages.Robot, ...], audience: Audience) -> messages.Hello:
        member = None
        if self.classroom is not None:
            own = audience.robot if audience.student else None
            member = messages.ClassMember(teacher=not audience.student, robot=own)
        return messages.Hello(
            version=__version__,
            robots=tuple(robot for robot in robots if audience.sees(robot.id)),
            models=self.world.models if self.world and not audience.student else None,
            gamepad=SCHEME,
            class_=member,
        )

    def _map_text(self) -> str:
        """Return the message for the map."""
        for view in self.robots.values():
            if view.mapping.drawing is not None and view.mapping.drawing is self._map:
                return view.mapping.drawing_text
        relief = self._known_relief() if self._map is self._known_map() else FLAT
        return messages.encode(map_message(self._map, relief))

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

    def _known_relief(self) -> Relief:
        """Return the heights of the known map."""
        if self.world is not None:
            return self.world.simulation.world.relief
        scenes = (view.scene for view in self.robots.values() if view.scene.map_now is not None)
        return next((scene.relief_now for scene in scenes), FLAT)

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
        for audience in self.audiences:
            if not audience.is_limited:
                audience.put("map draft", text)

    def _publish_status(self, view: RobotView) -> None:
        text = messages.encode(view.status())
        for audience in self.audiences:
            if audience.sees(view.number):
                audience.put(f"status {view.number}", text)

    async def _watch_status(self, view: RobotView) -> None:
        async for _ in view.robot.supervisor.status.values():
            self._publish_robots()
            self._publish_status(view)

    def _wake(self) -> None:
        for client in self.clients.connected.values():
            client.wake()
