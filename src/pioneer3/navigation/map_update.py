"""Goes on with a map in a file, and replaces it once somebody has seen what has changed."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap, MapObject, OccupancyGrid
from pioneer3.nav.changes import MapChange, changes, render_days
from pioneer3.nav.mapper import Mapper
from pioneer3.nav.settings import MapperSettings
from pioneer3.navigation.map_files import copy_map, files_of, load_survey, save_map, save_survey
from pioneer3.sim.worldfile import load_world, write_world
from pioneer3.sim.worldfile.toml import is_world

NEW = "new"
"""The name of a new map ends so while the old one is there."""
BEFORE = "before"
"""The name of an old map ends so once there is a new one."""


class ContinuedMap:
    """A map that is continued. Its files stay as they are until :meth:`replace`.

    A world goes on with all that its file has: a laser sees no glass, and no people who have left.

    Attributes:
        objects: The places of the map itself, which stay.

    Raises:
        ConfigError: There is no map, or no survey beside it.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        world = load_world(path)
        self.line_map = world.line_map()
        self.objects: Sequence[MapObject] = world.base_map().objects
        self._world = world if is_world(path) else None
        self._state = load_survey(path)
        self._survey = Mapper.of(self._state).survey
        self._before: OccupancyGrid | None = None
        self._new: Path | None = None

    def mapper(self, here: Pose2, settings: MapperSettings) -> Mapper:
        """Return a mapper that goes on with the map; the robot is `here`, roughly."""
        return Mapper.of(self._state, here, settings)

    def changes(self, line_map: LineMap) -> list[MapChange]:
        """Return the walls that a map, drawn of the mapper, has and the old one not, and back."""
        (grid, *_) = line_map.grids
        if self._before is None:
            self._before = render_days(self._survey, grid.resolution)
        return changes(self._before, grid)

    def keep(self, mapper: Mapper) -> None:
        """Save the survey beside the old map, in a copy of it: a computer may lose its power.

        Raises:
            ConfigError: It cannot be written.
        """
        self._new = self._new or copy_map(self.path, NEW)
        save_survey(mapper, self._new)

    def write(self, line_map: LineMap, mapper: Mapper) -> Path:
        """Save the new map beside the old one; return its file.

        Raises:
            ConfigError: It cannot be written.
        """
        self.keep(mapper)
        assert self._new is not None
        self._save(line_map, self._new)
        return self._new

    def replace(self, line_map: LineMap, mapper: Mapper) -> tuple[LineMap, Path]:
        """Save the new map in place of the old one, which is copied; return it, and the copy.

        Raises:
            ConfigError: A file cannot be written.
        """
        before = copy_map(self.path, BEFORE)
        save_survey(mapper, self.path)
        self._save(line_map, self.path)
        self.discard()
        return replace(line_map, name=self.line_map.name, file=self.path), before

    def _save(self, line_map: LineMap, path: Path) -> None:
        if self._world is None:
            save_map(line_map, path)
        else:
            base = path.with_suffix(".map")
            save_map(line_map, base)
            write_world(replace(self._world, name=path.stem, map=base), path)

    def discard(self) -> None:
        """Delete what lies beside the old map."""
        if self._new is not None:
            for file in files_of(self._new):
                file.unlink(missing_ok=True)
        self._new = None
