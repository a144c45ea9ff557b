"""The map of a page: the one that it shows, and the one that its robots drive on."""

from collections.abc import Callable, Mapping

from pioneer3.maps import LineMap
from pioneer3.runtime.robot import Robot
from pioneer3.sim.relief import FLAT, Relief
from pioneer3.web import messages
from pioneer3.web.robot_view import RobotView
from pioneer3.web.scene import RobotScene
from pioneer3.web.world import map_message

NOWHERE = RobotScene()


class PageMap:
    """The map of a page's robots, by number; `changed` is called when robots use another one.

    The map of `simulated` comes first, a scene in the simulated world of the page, if there is one.
    """

    def __init__(self, robots: Mapping[int, RobotView], changed: Callable[[], None]) -> None:
        self.simulated: RobotScene | None = None
        self._robots, self._changed = robots, changed
        self._shown: LineMap | None = None

    @property
    def in_use(self) -> LineMap | None:
        """The map that robots drive on; `None` while one is made, or without walls."""
        known = self._scene.map_now
        made = any(view.mapping.making for view in self._robots.values())
        return known if known is not None and len(known.walls) and not made else None

    @property
    def relief(self) -> Relief:
        """The heights of the map that robots drive on."""
        return self._scene.relief_now

    @property
    def is_new(self) -> bool:
        """Whether there is another map to show: clients of a simulator may load one."""
        return self._to_show is not self._shown

    def take_news(self) -> str | None:
        """Return the message for the map, `None` unless there is another one than before."""
        before, self._shown = self._shown, self._to_show
        if self._shown is before:  # a map may be large
            return None
        for view in self._robots.values():
            if view.mapping.drawing is self._shown:
                return view.mapping.drawing_text
        relief = self.relief if self._shown is self._scene.map_now else FLAT
        return messages.encode(map_message(self._shown, relief))

    def robots_on(self, line_map: LineMap) -> list[Robot]:
        """Return the robots that use a map."""
        return [view.robot for view in self._robots.values() if view.scene.map_now is line_map]

    def replace(self, used: LineMap, line_map: LineMap) -> None:
        """Have all robots that use a map use another one from now on."""
        views = [view for view in self._robots.values() if view.scene.map_now is used]
        for view in views:
            view.scene.adopt(line_map)
        self._changed()

    @property
    def _to_show(self) -> LineMap | None:
        """The map that is made, the one that is known, or the one before."""
        made = (view.mapping.drawing for view in self._robots.values())
        drawing = next((each for each in made if each is not None), None)
        return drawing or self._scene.map_now or self._shown

    @property
    def _scene(self) -> RobotScene:
        """The scene whose map is known: the simulated one, or a robot's."""
        known = (view.scene for view in self._robots.values() if view.scene.map_now is not None)
        return self.simulated or next(known, NOWHERE)
