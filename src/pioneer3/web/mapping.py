"""Makes maps with a robot of the page, and saves them in the server's folder."""

import asyncio
import logging
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pioneer3.errors import PioneerError, Refusal
from pioneer3.geometry import ORIGIN
from pioneer3.maps import LineMap, MapObject
from pioneer3.navigation.connect import prepare_navigation
from pioneer3.runtime.robot import Robot
from pioneer3.tasks import running
from pioneer3.web import messages, navigation, requests
from pioneer3.web.control import Control, Operator
from pioneer3.web.navigation import points_of
from pioneer3.web.scene import RobotScene
from pioneer3.web.world import map_message

if TYPE_CHECKING:
    from pioneer3.navigation.map_builder import MapBuilder

log = logging.getLogger(__name__)

PERIOD = 0.5
"""Clients hear of the map so often [s]."""
LONGEST = 7200.0
"""Time limit of an exploration [s]."""


class RobotMapping:
    """Makes maps with one robot of the page, and saves them in a folder.

    `publish` is called with the state, and with `None` when the robot leaves the page. The drawing
    is the map that is being made, as drawn last, `None` while none is, and `drawing_text` the
    message for it. What takes long runs `in_thread`.
    """

    def __init__(
        self,
        number: int,
        robot: Robot,
        scene: RobotScene,
        control: Control,
        *,
        tell: Callable[[Operator, str], None],
        publish: Callable[[messages.Mapping | None], None],
    ) -> None:
        self.folder = Path()
        self.in_thread: Callable[..., Awaitable[Any]] = asyncio.to_thread
        self._number, self._robot = number, robot
        self._scene, self._control = scene, control
        self._tell, self._publish = tell, publish
        self._builder: MapBuilder | None = None
        self._begin, self._end = asyncio.Event(), asyncio.Event()
        self._name = ""
        self._saved = ""
        self._asked_by: Operator | None = None
        self.drawing: LineMap | None = None
        self.drawing_text = ""

    @property
    def possible(self) -> bool:
        """Whether maps can be made: there is a laser, and the extra `nav`."""
        return bool(self._robot.laser.presence.there) and navigation.installed()

    @property
    def making(self) -> bool:
        """Whether a map is being made."""
        return self._builder is not None

    def ask(self, operator: Operator, request: requests.MakeMap) -> Refusal | None:
        """Carry out a request."""
        self._asked_by, builder = operator, self._builder
        match request.step:
            case "begin" | "explore" if not self.possible:
                return Refusal("a map needs a robot with a laser, and numba and scipy")
            case "begin":
                self._begin.set()
            case "explore" if builder is None:
                return Refusal("begin a map first")
            case _ if builder is None:
                return Refusal("no map is being made")
            case "explore":
                mode = builder.mode(request.speed)
                return self._control.start(operator, mode, LONGEST)
            case "name_place":
                builder.name_place(request.name)
            case step:
                if refused := self._control.take(operator):
                    return refused
                self._name = request.name if step == "save" else ""
                self._end.set()
        return None

    async def run(self) -> None:
        """Make maps when asked to, until cancelled."""
        try:
            async with running(self._tell_state()):
                while True:
                    await self._begin.wait()
                    await self._try_to_make()
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
        await prepare_navigation(self.in_thread)
        from pioneer3.nav.mapper import Mapper
        from pioneer3.navigation.map_builder import MapBuilder
        from pioneer3.navigation.map_files import free_path

        snapshot = self._robot.snapshot
        if snapshot is None:
            return
        here = self._scene.robot_in_map(snapshot.odometry.robot_in_odom)
        home = MapObject(kind="RobotHome", name="Home", pose=self._scene.robot_in_map(ORIGIN))
        builder = self._builder = MapBuilder(
            self._robot,
            Mapper(here, self._robot.settings.mapper),
            objects=(home,),
            in_thread=self.in_thread,
        )
        self._saved, self._name = "", "unfinished map"
        try:
            async with running(builder.run()):
                await self._end.wait()
            if builder.exploring:
                self._robot.arbiter.end_mode("the map is finished")
            if self._name and builder.mapper.survey.frames:
                path = free_path(self.folder / f"{self._name}.map")
                self._adopt(await self.in_thread(_write, builder, path), path)
        except asyncio.CancelledError:  # the program ends, and the map is kept all the same
            if self._name and builder.mapper.survey.frames:
                _write(builder, free_path(self.folder / f"{self._name}.map"))
            raise
        finally:
            self._builder = self.drawing = None

    def _adopt(self, line_map: LineMap, path: Path) -> None:
        """Use a map that was saved from now on, where no simulator has one."""
        if self._scene.remote is not None:
            self._scene.remote.adopt(line_map)
        self._saved = path.name
        self._answer(f"Saved {path.name}, in the folder of this program.")

    async def _tell_state(self) -> None:
        while True:
            making = self._builder is not None
            self._publish(self._message() if making or self.possible else None)
            await self._encode()
            await asyncio.sleep(PERIOD)

    async def _encode(self) -> None:
        """Encode what was drawn, in a thread: a large picture takes half a second."""
        state = self._builder.state.latest if self._builder else None
        drawing = state.line_map if state else None
        if drawing is not None and drawing is not self.drawing:
            text = await self.in_thread(_text_of, drawing)
            if self._builder is not None:
                self.drawing, self.drawing_text = drawing, text

    def _message(self) -> messages.Mapping:
        state = self._builder.state.latest if self._builder else None
        if state is None:
            making = self._builder is not None
            return messages.Mapping(self._number, making=making, saved=self._saved)
        return messages.Mapping(
            self._number,
            making=True,
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


def _text_of(line_map: LineMap) -> str:
    return messages.encode(map_message(line_map))


def _write(builder: "MapBuilder", path: Path) -> LineMap:
    """Save a map and its survey; return it."""
    from pioneer3.navigation.map_files import save_map, save_survey

    save_survey(builder.mapper, path)
    finished = builder.finished()
    save_map(finished, path)
    return finished
