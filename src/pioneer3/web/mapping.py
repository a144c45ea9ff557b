"""Makes maps with a robot of the page, and goes on with the map that robots drive on.

New ones are saved in the server's folder. A map that is updated stays as it is until somebody has
seen what has changed, and wants the new one.
"""

import asyncio
import logging
from collections.abc import Awaitable, Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec

from pioneer3.errors import PioneerError, Refusal
from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.maps import LineMap, MapObject
from pioneer3.navigation.connect import prepare_navigation
from pioneer3.navigation.map_files import free_path, not_continued, save_map, save_survey
from pioneer3.navigation.recording import points_of
from pioneer3.runtime.robot import Robot
from pioneer3.tasks import next_tick, running
from pioneer3.web import messages, navigation, requests
from pioneer3.web.control import Control, Operator
from pioneer3.web.scene import RobotScene
from pioneer3.web.world import map_message

if TYPE_CHECKING:
    from pioneer3.navigation.map_builder import MapBuilder
    from pioneer3.navigation.map_update import ContinuedMap

log = logging.getLogger(__name__)

PERIOD = 0.5
"""Clients hear of the map so often [s]."""
LONGEST = 7200.0
"""Time limit of an exploration [s]."""
UNFINISHED = "unfinished map"
"""Name of a new map that nobody has named."""


@dataclass(slots=True, eq=False)
class _Making:
    """A map that is being made.

    Attributes:
        used: The map that robots drive on, of one that is updated.
        finished: The new map, once somebody is to say whether it is kept.
    """

    builder: "MapBuilder"
    update: "ContinuedMap | None" = None
    used: LineMap | None = None
    finished: LineMap | None = None


class RobotMapping:
    """Makes maps with one robot of the page, and saves them in a folder.

    `whereabouts` returns the robot's place on the map that robots drive on, and `replace` has
    robots use another one. `publish` is called with the state, and with `None` when the robot
    leaves the page. The drawing is the map that is being made, as drawn last, `None` while none is,
    and `drawing_text` the message for it. What takes long runs `in_thread`.
    """

    def __init__(
        self,
        number: int,
        robot: Robot,
        scene: RobotScene,
        control: Control,
        *,
        whereabouts: Callable[[], Awaitable[Pose2]],
        replace: Callable[[LineMap, LineMap], None],
        tell: Callable[[Operator, str], None],
        publish: Callable[[messages.Mapping | None], None],
    ) -> None:
        self.folder = Path()
        self.in_thread: Callable[..., Awaitable[Any]] = asyncio.to_thread
        self._number, self._robot = number, robot
        self._scene, self._control = scene, control
        self._whereabouts, self._replace = whereabouts, replace
        self._tell, self._publish = tell, publish
        self._made: _Making | None = None
        self._begin, self._end = asyncio.Event(), asyncio.Event()
        self._updates = False
        self._name = ""
        self._saved = ""
        self._waits = ""
        self._asked_by: Operator | None = None
        self.drawing: LineMap | None = None
        self.drawing_text = ""

    @property
    def possible(self) -> bool:
        """Whether maps can be made: there is a laser, and the extra `nav`."""
        return bool(self._robot.laser.presence.there) and navigation.installed()

    @property
    def no_update(self) -> str | None:
        """The reason that the present map is not updated, nothing if it can be; `None` without."""
        known = self._scene.map_now
        if known is None or not len(known.walls):
            return None
        if known.file is None:
            return "only a map that a robot made can be, with its survey beside it"
        reason = not_continued(known.file)
        return reason or ("" if self._scene.tells_truth else self._scene.located.unsure())

    @property
    def making(self) -> bool:
        """Whether a map is being made."""
        return self._made is not None

    def ask(self, operator: Operator, request: requests.MakeMap) -> Refusal | None:
        """Carry out a request."""
        if request.step in ("begin", "update", "explore") and not self.possible:
            return Refusal("a map needs a robot with a laser, and numba and scipy")
        self._asked_by = operator
        if request.step in ("begin", "update"):
            return self._ask_to_begin(operator, updates=request.step == "update")
        if self._made is None:
            begins = request.step == "explore"
            return Refusal("begin a map first" if begins else "no map is being made")
        return self._ask_on(operator, request, self._made)

    def _ask_to_begin(self, operator: Operator, *, updates: bool) -> Refusal | None:
        if self._begin.is_set():
            return None
        if updates:
            if (reason := self.no_update) or reason is None:
                return Refusal(f"the map is not updated: {reason or 'there is none'}")
            if refused := self._control.take(operator):
                return refused
        self._updates = updates
        self._begin.set()
        return None

    def _ask_on(
        self, operator: Operator, request: requests.MakeMap, made: _Making
    ) -> Refusal | None:
        """Carry out a request about the map that is being made."""
        if refused := _not_now(request.step, made):
            return refused
        match request.step:
            case "explore":
                return self._control.start(operator, made.builder.mode(request.speed), LONGEST)
            case "name_place":
                made.builder.name_place(request.name)
                return None
        if refused := self._control.take(operator):
            return refused
        self._name = request.name if request.step != "discard" else ""
        self._end.set()
        return None

    async def run(self) -> None:
        """Make maps when asked to, until cancelled."""
        try:
            async with running(self._tell_state()):
                while True:
                    await self._begin.wait()
                    await self._try_to_make()
                    self._waits = ""
                    self._begin.clear()
                    self._end.clear()
        finally:
            self._publish(None)

    async def _try_to_make(self) -> None:
        try:
            await self._make()
        except PioneerError as error:
            self._answer(str(error))
        except Exception:
            log.exception("making a map failed")
            self._answer("Making the map failed; the log has the details.")

    async def _make(self) -> None:
        self._waits = "gets ready"
        await prepare_navigation(self.in_thread)
        if self._robot.snapshot is None:
            return
        made = await self._updated() if self._updates else self._new()
        self._made, self._saved, self._name, self._waits = made, "", UNFINISHED, ""
        try:
            async with running(made.builder.run()):
                await self._end.wait()
            if made.builder.exploring:
                self._robot.arbiter.end_mode("the map is finished")
            if made.update is not None and self._name:
                await self._ask_whether(made)
            if made.builder.mapper.survey.frames:
                await self._end_with(made)
        except asyncio.CancelledError:  # the program ends, and the map is kept all the same
            if self._name and made.builder.mapper.survey.frames:
                self._rescue(made)
            raise
        finally:
            self._made = self.drawing = None

    def _new(self) -> _Making:
        """Return a new map that begins where the robot is."""
        from pioneer3.nav.mapper import Mapper
        from pioneer3.navigation.map_builder import MapBuilder

        assert self._robot.snapshot is not None
        here = self._scene.robot_in_map(self._robot.snapshot.odometry.robot_in_odom)
        home = MapObject(kind="RobotHome", name="Home", pose=self._scene.robot_in_map(ORIGIN))
        mapper = Mapper(here, self._robot.settings.mapper)
        builder = MapBuilder(self._robot, mapper, objects=(home,), in_thread=self.in_thread)
        return _Making(builder)

    async def _updated(self) -> _Making:
        """Return the map that robots drive on, to go on with it.

        Raises:
            PioneerError: It cannot be read, or the robot is not sure where it is.
        """
        from pioneer3.navigation.map_builder import MapBuilder
        from pioneer3.navigation.map_update import ContinuedMap

        self._waits = "reads the survey of the map, and looks where the robot is"
        used = self._scene.map_now
        assert used is not None
        assert used.file is not None
        update: ContinuedMap = await self.in_thread(ContinuedMap, used.file)
        here = await self._whereabouts()
        mapper = await self.in_thread(update.mapper, here, self._robot.settings.mapper)
        objects = update.objects
        builder = MapBuilder(self._robot, mapper, objects=objects, in_thread=self.in_thread)
        return _Making(builder, update, used)

    async def _ask_whether(self, made: _Making) -> None:
        """Show the new map, and wait until somebody says whether it is kept."""
        self._waits = "closes the last loops, and compares the maps"
        self._end.clear()
        made.finished = await self.in_thread(made.builder.finished)
        await self._end.wait()
        self._waits = ""

    async def _end_with(self, made: _Making) -> None:
        """Save a map that is wanted."""
        mapper, update, finished = made.builder.mapper, made.update, made.finished
        if update is None:
            if self._name:
                path = free_path(self.folder / f"{self._name}.map")
                self._adopt(await self.in_thread(_write, made.builder, path), path)
        elif self._name and finished is not None and made.used is not None:
            line_map, before = await self.in_thread(update.replace, finished, mapper)
            if not self._scene.simulated:
                self._replace(made.used, line_map)
            self._saved = update.path.name
            self._answer(f"Saved {update.path.name}; the map as it was before is {before.name}.")
        else:
            self._answer(f"{update.path.name} stays as it is.")

    def _rescue(self, made: _Making) -> None:
        """Save what there is of a map beside all others."""
        if made.update is None:
            path = free_path(self.folder / f"{self._name}.map")
            _write(made.builder, path)
        else:
            finished = made.finished or made.builder.finished()
            path = made.update.write(finished, made.builder.mapper)
        log.warning("a map was not finished: it is saved as %s", path)

    def _adopt(self, line_map: LineMap, path: Path) -> None:
        """Use a map that was saved from now on, where no simulator has one."""
        if self._scene.remote is not None:
            self._scene.remote.adopt(replace(line_map, file=path))
        self._saved = path.name
        self._answer(f"Saved {path.name}, in the folder of this program.")

    async def _tell_state(self) -> None:
        while True:
            self._publish(self._message() if self.making or self.possible else None)
            await self._encode()
            await next_tick(PERIOD)

    async def _encode(self) -> None:
        """Encode what was drawn, in a thread: a large picture takes half a second."""
        made = self._made
        if made is None:
            return
        state = made.builder.state.latest
        drawing = made.finished or (state.line_map if state else None)
        if drawing is not None and drawing is not self.drawing:
            text = await self.in_thread(_text_of, drawing, made.update)
            if self._made is made:
                self.drawing, self.drawing_text = drawing, text

    def _message(self) -> messages.Mapping:
        made = self._made
        if made is None:
            return messages.Mapping(
                self._number,
                making=False,
                waits=self._waits,
                saved=self._saved,
                no_update=self.no_update,
            )
        return self._message_of(made)

    def _message_of(self, made: _Making) -> messages.Mapping:
        state = made.builder.state.latest
        asks = made.finished is not None and made.finished is self.drawing
        message = messages.Mapping(
            self._number,
            making=True,
            waits="" if asks else self._waits,
            updates=made.update.path.name if made.update else "",
            asks=asks,
        )
        if state is None:
            return message
        return msgspec.structs.replace(
            message,
            exploring=state.exploring,
            driven=round(state.driven, 1),
            area=round(state.area, 1),
            loops=state.loops,
            edges=state.edges,
            way=points_of(state.way) if state.exploring and state.way else (),
            remarks=state.remarks,
        )

    def _answer(self, news: str) -> None:
        if self._asked_by is not None:
            self._tell(self._asked_by, news)


def _not_now(step: str, made: _Making) -> Refusal | None:
    """Return the refusal of a step that is not to be taken yet, or no more."""
    asks, updates = made.finished is not None, made.update is not None
    match step:
        case "explore" | "name_place" | "finish" if asks:
            return Refusal("the map is finished: keep it, or the old one")
        case "save" if updates and not asks:
            return Refusal("finish the map first, and look at what has changed")
        case "finish" if not updates:
            return Refusal("this map is new: save it")
    return None


def _text_of(line_map: LineMap, update: "ContinuedMap | None") -> str:
    """Return the message for a map, with what has changed by it."""
    changes = update.changes(line_map) if update else ()
    return messages.encode(map_message(line_map, changes=changes))


def _write(builder: "MapBuilder", path: Path) -> LineMap:
    """Save a map and its survey; return it."""
    save_survey(builder.mapper, path)
    finished = builder.finished()
    save_map(finished, path)
    return finished
