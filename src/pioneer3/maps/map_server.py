"""Reads the maps of ROS's map_server: a YAML file that describes a picture.

As in map_server, a pixel is occupied where its darkness (`negate`: brightness) is above
`occupied_thresh`, in the modes trinary and scale alike. In raw mode the shade itself is the
occupancy in percent, above 100 unknown. In trinary mode the average includes alpha.
Keys that map_server does not know are skipped, as it skips them; `pioneer3 map check` lists them.
"""

import logging
import re
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path, PureWindowsPath
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from pioneer3.arrays import Float
from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2, wrap
from pioneer3.maps.grid import walls_of
from pioneer3.maps.image import ShadeImage, read_image
from pioneer3.maps.line_map import (
    FREE,
    OCCUPIED,
    UNKNOWN,
    LineMap,
    OccupancyGrid,
    States,
)
from pioneer3.text import TextLine, one_line, shown, wrong

if TYPE_CHECKING:
    from yaml import Node

log = logging.getLogger(__name__)

MODES = ("trinary", "scale", "raw")
KEYS = ("image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh", "mode")
REQUIRED = KEYS[:3]
RESOLUTIONS = (0.001, 10.0)
"""Smallest and largest side of a pixel that is accepted [m]."""
FARTHEST = 1e5
"""Farthest coordinate of an origin [m]."""
LARGEST_YAML = 1 << 16
"""Larger files are not read [bytes]: usual ones have ten lines."""
_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")
_TRUE, _FALSE = ("1", "true", "yes", "on"), ("0", "false", "no", "off")


@dataclass(frozen=True, slots=True)
class YamlField:
    """A key of a YAML file, its value as text, and its line.

    `text` is a scalar as written, without quotes; `items` are the scalars of a list. Where the
    value is something else, both are empty. What reads them raises a ConfigError.
    """

    line: TextLine
    key: str
    text: str = ""
    items: tuple[str, ...] = ()

    def number(self, low: float, high: float) -> float:
        """Return a number from `low` to `high`."""
        return self._number(self.text, low, high)

    def numbers(self, count: int, low: float, high: float) -> tuple[float, ...]:
        """Return a list of `count` numbers."""
        if len(self.items) != count:
            given = shown(self.text) if self.text else f"a list of {len(self.items)}"
            raise self.wrong(f"expected a list of {count} numbers, not {given}")
        return tuple(self._number(item, low, high) for item in self.items)

    def flag(self) -> bool:
        """Return true or false, also written 1 or 0."""
        word = self.text.lower()
        if word not in _TRUE + _FALSE:
            raise self.wrong(f"expected 0 or 1, not {shown(self.text)}")
        return word in _TRUE

    def string(self) -> str:
        """Return the value, which is not empty."""
        if not self.text:
            raise self.wrong("has no value")
        return self.text

    def wrong(self, problem: str) -> ConfigError:
        """Return the error for this key."""
        return self.line.wrong(self.key, problem)

    def _number(self, word: str, low: float, high: float) -> float:
        if not _NUMBER.fullmatch(word):
            raise self.wrong(f"{shown(word)} is not a number")
        value = float(word)
        if not low <= value <= high:
            raise self.wrong(f"{shown(word)} is not in {low:g} to {high:g}")
        return value


@dataclass(frozen=True, slots=True)
class MapServerFile:
    """The contents of a YAML file, every key among its fields.

    The origin is the lower left corner of the picture, and its turn, in the map frame; a pixel,
    `resolution` [m] wide, is a wall above `occupied_thresh` and free below `free_thresh` [0 to 1].
    """

    path: Path
    fields: Mapping[str, YamlField]
    image: Path
    resolution: float
    origin: Pose2
    negate: bool
    occupied_thresh: float
    free_thresh: float
    mode: str

    def line_map(self) -> LineMap:
        """Read the picture and return the outline of its occupied cells, named after the file."""
        states = self._states(read_image(self.image))[::-1]
        grid = OccupancyGrid(states=states, resolution=self.resolution, origin=self.origin)
        try:
            walls = walls_of(grid)
        except OverflowError as error:
            raise wrong(self.image, f" pixels: {error}") from None
        return LineMap(name=self.path.stem, walls=walls, grids=(grid,), lines=np.empty((0, 4)))

    def _states(self, image: ShadeImage) -> States:
        """Return the cells as in :class:`OccupancyGrid`; row 0 is the top."""
        # a table of answers instead of 33 million numbers
        if self.mode == "trinary" and image.alpha is not None:
            total = 3 * image.shades.astype(np.uint16) + image.alpha
            judged: States = self._judged(4 * 255)[total]
            return judged
        if self.mode == "raw":
            shades = np.arange(256, dtype=np.float64)
            shades = 255 - shades if self.negate else shades
            states = self._compared(shades / 100)
            states[shades > 100] = UNKNOWN
            return states[image.shades]
        return self._judged(255)[image.shades]

    def _judged(self, white: int) -> States:
        """Return the states of the shades from 0, black, to `white`, shape (white + 1,)."""
        shades = np.arange(white + 1)
        return self._compared((shades if self.negate else white - shades) / white)

    def _compared(self, occupancy: Float) -> States:
        states = np.full(occupancy.shape, UNKNOWN, dtype=np.uint8)
        states[occupancy < self.free_thresh] = FREE
        states[occupancy > self.occupied_thresh] = OCCUPIED
        return states


def parse_map_server(path: Path, text: str) -> MapServerFile:
    """Read the text of a YAML file.

    Raises:
        ConfigError: It is not valid; one line, `path:line: field: why`.
    """
    fields = _fields(path, text)
    for key in REQUIRED:
        if key not in fields:
            raise wrong(path, f" {key}: missing, a map_server file needs it")
    x, y, yaw = fields["origin"].numbers(3, -FARTHEST, FARTHEST)
    occupied = _threshold(fields, "occupied_thresh", 0.65)
    free = _threshold(fields, "free_thresh", min(0.196, occupied))
    if free > occupied:
        problem = f"{free:g} is above occupied_thresh, {occupied:g}"
        raise fields["free_thresh"].wrong(problem)
    mode = fields["mode"].string() if "mode" in fields else MODES[0]
    if mode not in MODES:
        raise fields["mode"].wrong(f"expected {', '.join(MODES)}, not {shown(mode)}")
    return MapServerFile(
        path=path,
        fields=MappingProxyType(fields),
        image=_image_path(path, fields["image"]),
        resolution=fields["resolution"].number(*RESOLUTIONS),
        origin=Pose2(x, y, wrap(yaw)),
        negate="negate" in fields and fields["negate"].flag(),
        occupied_thresh=occupied,
        free_thresh=free,
        mode=mode,
    )


def _fields(path: Path, text: str) -> dict[str, YamlField]:
    """Return the keys of a YAML file; its nodes do not become objects, so aliases cost nothing."""
    import yaml

    try:
        root = yaml.compose(text, Loader=yaml.SafeLoader)
    except RecursionError:
        raise wrong(path, " not valid YAML: nested too deeply") from None
    except yaml.MarkedYAMLError as error:
        number = error.problem_mark.line + 1 if error.problem_mark else 1
        problem = f"{number}: not valid YAML: {one_line(error.problem or error)}"
        raise wrong(path, problem) from None
    except (yaml.YAMLError, ValueError, OverflowError) as error:
        raise wrong(path, f" not valid YAML: {one_line(error)}") from None
    if root is not None and not isinstance(root, yaml.MappingNode):
        line = TextLine(path, root.start_mark.line + 1, "")
        raise line.wrong("line", "expected 'key: value'")
    found: dict[str, YamlField] = {}
    for key, value in root.value if root else ():
        field = _field(path, key, value)
        if field.key in found:
            raise field.wrong(f"is on line {found[field.key].line.number} too")
        found[field.key] = field
    return found


def _field(path: Path, key: "Node", value: "Node") -> YamlField:
    from yaml import SequenceNode

    line = TextLine(path, key.start_mark.line + 1, "")
    name = key.value if isinstance(key.value, str) else ""
    if isinstance(value.value, str):
        return YamlField(line, name, text=value.value)
    items = [item.value for item in value.value] if isinstance(value, SequenceNode) else []
    return YamlField(line, name, items=tuple(i if isinstance(i, str) else "" for i in items))


def _threshold(fields: Mapping[str, YamlField], key: str, default: float) -> float:
    return fields[key].number(0.0, 1.0) if key in fields else default


def _image_path(path: Path, field: YamlField) -> Path:
    """Return the picture that a field names; that beside the file for one of another computer."""
    named = field.string()
    for name in (named, PureWindowsPath(named).name):
        image = path.parent / name
        with suppress(OSError, ValueError):
            if not image.is_file():
                continue
            if name != named:
                told = "is not there, %s beside the file is taken"
                log.warning(f"%s: image: %s {told}", path, shown(named), image.name)
            return image
    raise field.wrong(f"no such file: {shown(field.text)}, seen from the YAML file")
