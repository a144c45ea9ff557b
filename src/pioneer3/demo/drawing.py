"""Pictures to scale, made of characters: the robot, its echoes, its trail."""

from collections.abc import Iterable, Sequence
from enum import StrEnum
from itertools import groupby
from math import ceil, cos, hypot, inf, isfinite, pi, sin
from operator import itemgetter
from typing import Final

from rich.text import Text

from pioneer3.models import RobotModel
from pioneer3.navigation.picture import CLOSE, HALF_BEAM, LEAVING, NEAR, NOSE, REACHES

BLANK: Final = 0x2800
BITS: Final = ((0x01, 0x08), (0x02, 0x10), (0x04, 0x20), (0x40, 0x80))
"""The bit of each dot of a character, its rows from the top."""
NONE: Final = -1


class Braille:
    """A picture of dots and letters, so many characters wide and high.

    Where some meet in a character, the last of them in the order of `styles` colours it.
    """

    def __init__(self, columns: int, rows: int, styles: Sequence[str]) -> None:
        self.columns, self.rows = columns, rows
        self._styles = tuple(styles)
        self._bits = [[0] * columns for _ in range(rows)]
        self._ranks = [[NONE] * columns for _ in range(rows)]
        self._letters: dict[tuple[int, int], str] = {}

    def dot(self, across: int, down: int, style: str) -> None:
        """Set a dot, counted from the upper left corner."""
        row, column = down // 4, across // 2
        self._bits[row][column] |= BITS[down % 4][across % 2]
        self._ranks[row][column] = max(self._ranks[row][column], self._styles.index(style))

    def write(self, row: int, column: int, text: str, style: str) -> None:
        """Write `text` over the dots, as far as there is room."""
        for at, letter in enumerate(text[: self.columns - column], column):
            self._letters[row, at] = letter
            self._ranks[row][at] = self._styles.index(style)

    def is_free(self, row: int, column: int, count: int) -> bool:
        """Return whether `count` characters have room there and hide no letter."""
        cells = [(row, at) for at in range(column, column + count)]
        inside = column >= 0 and column + count <= self.columns
        return inside and not any(cell in self._letters for cell in cells)

    def text(self) -> Text:
        """Return the picture in colours."""
        text = Text(no_wrap=True, overflow="crop", end="")
        for row in range(self.rows):
            text.append("\n" if row else "")
            cells = [self._cell(row, column) for column in range(self.columns)]
            for style, same in groupby(cells, key=itemgetter(1)):
                text.append("".join(letter for letter, _ in same), style or None)
        return text

    def _cell(self, row: int, column: int) -> tuple[str, str]:
        rank = self._ranks[row][column]
        if rank == NONE:
            return " ", ""
        letter = self._letters.get((row, column)) or chr(BLANK + self._bits[row][column])
        return letter, self._styles[rank]


class Ink(StrEnum):
    """The meaning of a dot, as its style. Later ones cover earlier ones."""

    GRID = "bright_black"
    TRAIL = "blue"
    FAR = "cyan"
    LASER = "magenta"
    CLOSE = "yellow"
    NEAR = "bold red"
    BODY = "green"


class Canvas(Braille):
    """Dots on a plane around the robot: x [m] is up, y [m] is left.

    A character has two dots across and four down, which are about square. `reach` is from the
    middle to the nearest edge [m].

    Raises:
        ValueError: there is no room, or nothing to reach.
    """

    def __init__(self, columns: int, rows: int, reach: float) -> None:
        if columns < 1 or rows < 1 or not 0 < reach < inf:
            raise ValueError(f"no picture of {reach} m has {columns} x {rows} characters")
        super().__init__(columns, rows, [*Ink])
        self._across, self._down = 2 * columns, 4 * rows
        self.scale = 2 * reach / min(self._across, self._down)

    def point(self, x: float, y: float, ink: Ink) -> None:
        """Set the dot at a point [m], if it is in the picture."""
        if dot := self._dot_of(x, y):
            self.dot(*dot, ink)

    def line(self, x1: float, y1: float, x2: float, y2: float, ink: Ink) -> None:
        """Draw from one point to another [m]."""
        steps = max(1, ceil(hypot(x2 - x1, y2 - y1) / self.scale * 1.5))
        for step in range(steps + 1):
            part = step / steps
            self.point(x1 + part * (x2 - x1), y1 + part * (y2 - y1), ink)

    def box(self, x1: float, y1: float, x2: float, y2: float, ink: Ink) -> None:
        """Fill a rectangle [m], `x1` below `x2` and `y1` below `y2`; it is a dot at least."""
        rows = max(1, ceil((x2 - x1) / self.scale * 1.5))
        for row in range(rows + 1):
            x = x1 + row / rows * (x2 - x1)
            self.line(x, y1, x, y2, ink)

    def arc(
        self,
        x: float,
        y: float,
        radius: float,
        ink: Ink,
        *,
        start: float = 0.0,
        end: float = 2 * pi,
        gap: int = 1,
    ) -> None:
        """Draw an arc about a point [m] between two bearings [rad], a dot in every `gap`."""
        steps = max(1, ceil(radius * (end - start) / self.scale * (1.5 if gap == 1 else 1 / gap)))
        for step in range(steps + 1):
            bearing = start + step / steps * (end - start)
            self.point(x + radius * cos(bearing), y + radius * sin(bearing), ink)

    def name(self, x: float, y: float, text: str, ink: Ink) -> None:
        """Write `text` from a point [m] to the right, as far as there is room."""
        if dot := self._dot_of(x, y):
            self.write(dot[1] // 4, dot[0] // 2, text, ink)

    def _dot_of(self, x: float, y: float) -> tuple[int, int] | None:
        """Return column and row of the dot that a point falls on, or `None` outside."""
        across = round(self._across / 2 - 0.5 - y / self.scale)
        down = round(self._down / 2 - 0.5 - x / self.scale)
        if 0 <= across < self._across and 0 <= down < self._down:
            return across, down
        return None


def ring(
    model: RobotModel,
    ranges: Sequence[float],
    columns: int,
    rows: int,
    *,
    reach: float = 3.0,
    laser: Iterable[tuple[float, float]] = (),
    trail: Iterable[tuple[float, float]] = (),
) -> Canvas:
    """Return the picture: the robot facing up, an arc for each echo, rings of metres.

    Ranges [m] are those of each sonar; what is not finite is not drawn. The nearest edge of the
    picture is `reach` from the robot's centre [m]. Points that the laser hit, and the trail of
    places where the robot has been, are in its frame [m].

    Raises:
        ValueError: there is no room, or nothing to reach.
    """
    canvas = Canvas(columns, rows, reach)
    _grid(canvas, reach)
    for x, y in trail:
        canvas.point(x, y, Ink.TRAIL)
    for x, y in laser:
        canvas.point(x, y, Ink.LASER)
    _body(canvas, model)
    for mount, distance in zip(model.sonars, ranges, strict=False):
        if isfinite(distance):  # from anywhere in the beam
            start, end = mount.theta - HALF_BEAM, mount.theta + HALF_BEAM
            canvas.arc(mount.x, mount.y, distance, nearness(distance), start=start, end=end)
    return canvas


def around_laser(
    points: Iterable[tuple[float, float]], columns: int, rows: int, reach: float
) -> Canvas:
    """Return the picture of a laser alone: its points, rings of metres, itself in the middle.

    The points are in the laser's frame [m], and the nearest edge is `reach` away from it [m].

    Raises:
        ValueError: there is no room, or nothing to reach.
    """
    canvas = Canvas(columns, rows, reach)
    _grid(canvas, reach)
    for x, y in points:
        canvas.point(x, y, Ink.LASER)
    canvas.box(-canvas.scale, -canvas.scale, canvas.scale, canvas.scale, Ink.BODY)
    return canvas


FAR_REACHES = (*REACHES, 8.0, 12.0, 20.0, 30.0)
SHOWN = 0.9
"""Share of a laser's points that its picture shows."""


def reach_for_points(points: Iterable[tuple[float, float]], before: float) -> float:
    """Return the reach [m] that shows most of a laser's points [m], steadily.

    The one `before` is kept while it fits as well.
    """
    distances = sorted(hypot(x, y) for x, y in points)
    if not distances:
        return before
    far = distances[min(len(distances) - 1, int(SHOWN * len(distances)))]
    fitting = next((reach for reach in FAR_REACHES if far <= reach), FAR_REACHES[-1])
    return before if fitting < before and far > LEAVING * fitting else fitting


def nearness(distance: float) -> Ink:
    """Return the ink for an echo at `distance` [m]."""
    return Ink.NEAR if distance < NEAR else Ink.CLOSE if distance < CLOSE else Ink.FAR


def _grid(canvas: Canvas, reach: float) -> None:
    """Draw a ring for each metre, the half ones where there is room; name the outermost."""
    step = 0.5 if reach <= 1.0 else 1.0
    number = 1
    if reach > REACHES[-1]:
        step = 2.0 if reach <= 12.0 else 5.0
    while (radius := number * step) <= reach:
        canvas.arc(0.0, 0.0, radius, Ink.GRID, gap=4)
        canvas.name(radius - 2 * canvas.scale, 0.0, f"{radius:g} m", Ink.GRID)
        number += 1


def _body(canvas: Canvas, model: RobotModel) -> None:
    half, front = model.width / 2, model.length_front
    canvas.box(-model.length_rear, -half, front, half, Ink.BODY)
    canvas.line(front, 0.0, front + NOSE, 0.0, Ink.BODY)
