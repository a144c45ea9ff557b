"""Reads the maps of ROS's map_server: a YAML file that says what a picture means.

As map_server does: a pixel is occupied where its darkness (`negate`: brightness) is above
`occupied_thresh`; in the modes trinary and scale alike. In raw mode the shade itself is the
occupancy in percent, above 100 unknown. Averaging includes alpha in trinary mode, as ever since.
Keys that map_server does not know are skipped, as it skips them; `pioneer3 map check` lists them.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import cos, sin
from pathlib import Path
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2, wrap
from pioneer3.sim.maps.cells import FREE, OCCUPIED, UNKNOWN, Cells, States
from pioneer3.sim.maps.flat import Field, read_flat
from pioneer3.sim.maps.image import LARGEST_IMAGE, Image
from pioneer3.sim.maps.line_map import LineMap
from pioneer3.sim.maps.pgm import parse_pgm
from pioneer3.sim.maps.png import SIGNATURE, parse_png
from pioneer3.sim.maps.raster import MOST_WALLS, raster_outline
from pioneer3.sim.maps.text import read_bytes, shown, wrong

MODES = ("trinary", "scale", "raw")
KEYS = ("image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh", "mode")
REQUIRED = KEYS[:3]
RESOLUTIONS = (0.001, 10.0)
"""Smallest and largest side of a pixel that is believed [m]."""
FARTHEST = 1e5
"""Of an origin [m]."""
LARGEST_YAML = 1 << 16
"""Larger files are none [bytes]: they have ten lines."""


@dataclass(frozen=True, slots=True)
class ServerFile:
    """What a YAML file says.

    Attributes:
        path: The file.
        fields: Every key in it.
        image: The picture.
        resolution: Side of a pixel [m].
        origin: Lower left corner of the picture, and how it is turned, in the map frame.
        negate: Bright is occupied.
        occupied_thresh: Above it [0 to 1] a pixel is a wall.
        free_thresh: Below it [0 to 1] a pixel is known to be free.
        mode: `trinary`, `scale` or `raw`.
    """

    path: Path
    fields: Mapping[str, Field]
    image: Path
    resolution: float
    origin: Pose2
    negate: bool
    occupied_thresh: float
    free_thresh: float
    mode: str

    def line_map(self) -> LineMap:
        """Read the picture and return the outline of its occupied cells, named after the file.

        Raises:
            ConfigError: The picture cannot be read.
        """
        states = self._states(read_image(self.image))[::-1]
        try:
            edges = raster_outline(states == OCCUPIED)
        except OverflowError:
            most = f"{MOST_WALLS / 1e6:.0f} million"
            raise wrong(self.image, f" pixels: more than {most} edges; no map of rooms") from None
        return LineMap(
            name=self.path.stem,
            walls=placed(edges * self.resolution, self.origin),
            cells=(Cells(states=states, side=self.resolution, corner=self.origin),),
            lines=np.empty((0, 4)),
        )

    def _states(self, image: Image) -> States:
        """Return the cells as :class:`Cells` has them; row 0 is the top."""
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

    def _compared(self, occupancy: NDArray[np.float64]) -> States:
        states = np.full(occupancy.shape, UNKNOWN, dtype=np.uint8)
        states[occupancy < self.free_thresh] = FREE
        states[occupancy > self.occupied_thresh] = OCCUPIED
        return states


def parse_server(path: Path, text: str) -> ServerFile:
    """Read the text of a YAML file.

    Raises:
        ConfigError: It is no such file; one line, `path:line: field: why`.
    """
    fields = read_flat(path, text)
    for key in REQUIRED:
        if key not in fields:
            raise wrong(path, f" {key}: missing, a map_server file needs it")
    x, y, yaw = fields["origin"].numbers(3, -FARTHEST, FARTHEST)
    occupied = _threshold(fields, "occupied_thresh", 0.65)
    free = _threshold(fields, "free_thresh", min(0.196, occupied))
    if free > occupied:
        problem = f"{free:g} is above occupied_thresh, {occupied:g}"
        raise fields["free_thresh"].line.wrong("free_thresh", problem)
    return ServerFile(
        path=path,
        fields=MappingProxyType(fields),
        image=_image_path(path, fields["image"]),
        resolution=fields["resolution"].number(*RESOLUTIONS),
        origin=Pose2(x, y, wrap(yaw)),
        negate="negate" in fields and fields["negate"].flag(),
        occupied_thresh=occupied,
        free_thresh=free,
        mode=_mode(fields.get("mode")),
    )


def read_image(path: Path) -> Image:
    """Read a PGM or PNG picture.

    Raises:
        ConfigError: It is neither.
    """
    raw = read_bytes(path, LARGEST_IMAGE)
    if raw.startswith(SIGNATURE):
        return parse_png(path, raw)
    if raw.startswith((b"P2", b"P5")):
        return parse_pgm(path, raw)
    raise wrong(path, " header: neither a PGM (P2, P5) nor a PNG picture")


def placed(walls: NDArray[np.float64], origin: Pose2) -> NDArray[np.float64]:
    """Return `walls` (W, 4) of a frame that lies at `origin`."""
    c, s = cos(origin.theta), sin(origin.theta)
    x, y = walls[:, ::2], walls[:, 1::2]
    turned = np.empty_like(walls)
    turned[:, ::2], turned[:, 1::2] = origin.x + c * x - s * y, origin.y + s * x + c * y
    return turned


def _threshold(fields: Mapping[str, Field], key: str, default: float) -> float:
    return fields[key].number(0.0, 1.0) if key in fields else default


def _mode(field: Field | None) -> str:
    if field is None:
        return MODES[0]
    mode = field.string()
    if mode not in MODES:
        raise field.line.wrong("mode", f"expected {', '.join(MODES)}, not {shown(mode)}")
    return mode


def _image_path(path: Path, field: Field) -> Path:
    try:
        image = path.parent / field.string()
        if image.is_file():
            return image
    except (OSError, ValueError) as error:
        if isinstance(error, ConfigError):
            raise
    raise field.line.wrong("image", f"no such file: {shown(field.text)}, seen from the YAML file")
