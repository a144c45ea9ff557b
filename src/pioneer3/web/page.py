"""The state that all clients share: the robots, the world around them, and the clients."""

import asyncio
from collections.abc import AsyncIterator, Iterable, Sequence
from contextlib import asynccontextmanager
from functools import partial
from itertools import count
from pathlib import Path

from pioneer3 import __version__
from pioneer3.errors import CommandError, Refusal
from pioneer3.names import free_name
from pioneer3.navigation.traffic import Participant, Traffic
from pioneer3.runtime.robot import Robot
from pioneer3.tasks import next_tick, running
from pioneer3.teleop.gamepad import SCHEME
from pioneer3.web import messages, requests
from pioneer3.web.access.access import Access
from pioneer3.web.access.sessions import LoginSession
from pioneer3.web.audience import Audience, Audiences
from pioneer3.web.calibration import RobotCalibration
from pioneer3.web.classroom.classroom import Classroom
from pioneer3.web.clients import Clients, PageClient
from pioneer3.web.control import Control, Operator
from pioneer3.web.details import RobotDetails
from pioneer3.web.editor import Editor
from pioneer3.web.logs import PageLogs
from pioneer3.web.map_editor import MapEditor
from pioneer3.web.mapping import RobotMapping
from pioneer3.web.navigation import RobotNavigation
from pioneer3.web.page_map import PageMap
from pioneer3.web.replay.replay import LogPlayer
from pioneer3.web.replay.view import RecordedDetails
from pioneer3.web.robot_view import RobotView, called
from pioneer3.web.scene import RobotScene
from pioneer3.web.world import WorldView

UPDATE_PERIOD = 0.1
"""Time between two updates about the simulated world and the clients [s]."""


class Page:
    """The robots by number, and their clients. Robots are added with :meth:`hosting`.

    The world is that of simulated robots, which can be changed; robots keep apart by the places in
    `traffic`. When clients are to go, `closed` is set.
    """

    def __init__(self, access: Access | None = None) -> None:
        self.robots: dict[int, RobotView] = {}
        self.clients = Clients(self.robots)
        self.audiences = Audiences()
        self.access = access or Access(asyncio.get_running_loop().time)
        self.access.sessions.on_end = self._session_ended
        self.map = PageMap(self.robots, self.update)
        self.map_editor = MapEditor(self.map, self._publish_draft)
        self.world: WorldView | None = None
        self.traffic = Traffic()
        self.classroom: Classroom | None = None
        self.replay: LogPlayer | None = None
        self.logs = PageLogs(self.clients, handed_in=self._handed_in)
        self.closed = asyncio.Event()
        self._count = count(1)
        self._labels: dict[int, str] = {}
        self._editor: Editor | None = None

    def _handed_in(self, name: str) -> Path | None:
        """Return the run of a name that was handed in to the class."""
        return self.classroom.runs.find(name) if self.classroom is not None else None

    @asynccontextmanager
    async def hosting(
        self, robot: Robot, scene: RobotScene, name: str = "", number: int = 0
    ) -> AsyncIterator[RobotView]:
        """Show `robot` to all clients, and let them drive it, while the block lasts.

        People see the name, empty for what the robot is :func:`called`; requests have the
        number, 0 for the next.
        """
        number = number or next(self._count)
        taken = {view.name for view in self.robots.values()}
        named = free_name(name or called(robot.info), taken)
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
                    view.calibration.run(),
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
                    await next_tick(UPDATE_PERIOD)
        finally:
            self.closed.set()

    def update(self) -> None:
        """Tell clients the changes of the world and of the clients."""
        self.map_editor.follow()
        changed = self.clients.update()
        if not self.clients.connected:
            return
        if changed:
            for audience in self.audiences:
                audience.wake()
        if self.world is not None:
            self.world.tell(self.audiences)
        if self.map.is_new:
            self._publish_robots()

    def robot(self, number: int | None) -> RobotView:
        """Return the robot of this number, the first without one; CommandError if there is none."""
        found = next(iter(self.robots.values()), None) if number is None else None
        found = found or self.robots.get(number or 0)
        if found is None:
            raise CommandError("there is no robot" if number is None else f"no robot {number}")
        return found

    def details(self, number: int | None) -> RobotDetails | RecordedDetails:
        """Return the details of a robot, as :meth:`robot` finds it."""
        return self.replay.details(number) if self.replay else self.robot(number).details

    def all_details(self) -> Sequence[RobotDetails | RecordedDetails]:
        """Return the details of all robots."""
        if self.replay is not None:
            return self.replay.all_details()
        return [view.details for view in self.robots.values()]

    def beside(self) -> "Page":
        """Return a page without robots for the same people; their sessions end at this one."""
        other = Page(self.access)
        self.access.sessions.on_end = self._session_ended
        other.closed = self.closed
        return other

    @asynccontextmanager
    async def replaying(self, replay: LogPlayer) -> AsyncIterator[None]:
        """Show a replay to all clients, and no robot, while the block lasts."""
        self.replay = replay
        for audience in self.audiences:
            audience.put("hello", messages.encode(replay.hello()))
        async with running(replay.run()):
            yield

    def play(self, request: requests.PlayRequest) -> messages.Refused | None:
        """Play the replay as a client asks; return the refusal where there is none."""
        if self.replay is None:
            return messages.Refused(requests.NOT_REPLAYED)
        self.replay.ask(request)
        return None

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
        self.audiences.add(audience)
        self._publish_robots()

    def join(self, client: PageClient, audience: Audience | None = None) -> int:
        """Add a client to an audience, without one to that of all robots; return its number."""
        (audience or self.audiences.first).clients.add(client)
        number = self.clients.add(client)
        self.update()
        return number

    def leave(self, number: int, audience: Audience) -> None:
        """Remove a client of `audience`: robots that it drives stop at once."""
        client = self.clients.connected.pop(number)
        self.clients.release_control(client)
        audience.clients.discard(client)
        audience.scans.subscribe(number, on=False)
        for details in self.all_details():
            details.unsubscribe(client)

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

    def _view(self, number: int, name: str, robot: Robot, scene: RobotScene) -> RobotView:
        tell = partial(self.clients.tell, number)
        control = Control(robot, scene, tell, partial(self._refusal, number))
        navigation = RobotNavigation(
            number,
            robot,
            scene,
            control,
            show=self.clients.show,
            publish=partial(self.audiences.publish, number, "navigation"),
            traffic=self.traffic,
            name=name,
        )
        mapping = RobotMapping(
            number,
            robot,
            scene,
            control,
            whereabouts=navigation.whereabouts,
            replace=self.map.replace,
            tell=tell,
            publish=partial(self.audiences.publish, number, "mapping"),
        )
        calibration = RobotCalibration(
            number, robot, control, publish=partial(self.audiences.publish, number, "calibration")
        )
        return RobotView(
            number,
            name,
            robot,
            scene=scene,
            control=control,
            navigation=navigation,
            mapping=mapping,
            calibration=calibration,
        )

    def _refusal(self, number: int, operator: Operator, *, take_over: bool) -> Refusal | None:
        """Return the class's refusal to let an operator drive, or `None`."""
        if self.classroom is None:
            return None
        return self.classroom.refusal(number, operator, take_over=take_over)

    def _session_ended(self, session: LoginSession) -> None:
        self.clients.release_control(session)
        if self.classroom is not None:
            self.classroom.session_ended(session)

    def _add(self, view: RobotView, scene: RobotScene) -> None:
        """Add a robot, with its world if it is the first."""
        others = dict(self.robots)
        self.robots.clear()
        self.robots.update(sorted({**others, view.number: view}.items()))
        if scene.simulated:
            simulation, robot = scene.simulated
            if self.world is None:
                self.world = WorldView(simulation)
                self.world.show_to(self.audiences)
                self.map.simulated = scene
                self._editor = Editor(self.world, self.clients.take_control, self._stop)
            self.world.driven[robot] = view.number

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
        news = self.map.take_news()
        robots = tuple(view.describe() for view in self.robots.values())
        for audience in self.audiences:
            audience.put("hello", messages.encode(self._hello(robots, audience)))
            if news is not None:
                audience.put("map", news)

    def _hello(
        self, robots: tuple[messages.ListedRobot, ...], audience: Audience
    ) -> messages.Hello:
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

    def _publish_status(self, view: RobotView) -> None:
        text = messages.encode(view.status())
        for audience in self.audiences:
            if audience.sees(view.number):
                audience.put(f"status {view.number}", text)

    def _publish_draft(self, text: str) -> None:
        for audience in self.audiences:
            if not audience.is_limited:
                audience.put("map draft", text)

    async def _watch_status(self, view: RobotView) -> None:
        async for _ in view.robot.supervisor.status.values():
            self._publish_robots()
            self._publish_status(view)
