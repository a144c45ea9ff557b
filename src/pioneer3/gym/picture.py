"""Pictures of robots in their map."""

from itertools import cycle
from math import tau
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pioneer3.errors import ConfigError
from pioneer3.gym.arena import Arena
from pioneer3.sim.maps.grid import shape_of, touched

Float = NDArray[np.float64]
Image = NDArray[np.uint8]

METADATA: dict[str, Any] = {"render_modes": ["rgb_array"], "render_fps": 10}
"""Of environments at 10 steps a second."""
LONG_SIDE = 600
"""[pixels]."""
WHITE, WALL = (255, 255, 255), (60, 60, 60)
COLOURS = (
    (31, 119, 180),
    (214, 39, 40),
    (44, 160, 44),
    (255, 127, 14),
    (148, 103, 189),
    (23, 190, 207),
)
"""Of robots and their goals, one after another."""
CORNERS = 24
"""Of what stands for a circle."""


def metadata_of(arena: Arena, render_mode: str | None) -> dict[str, Any]:
    """Return :data:`METADATA` at the pace of an arena.

    Raises:
        ConfigError: There is no such render mode.
    """
    modes = METADATA["render_modes"]
    if render_mode is not None and render_mode not in modes:
        raise ConfigError(f"render_mode: {render_mode!r} is none of {', '.join(modes)}")
    return METADATA | {"render_fps": max(1, round(1 / arena.task.dt))}


class Artist:
    """Draws the copies of an arena.

    Args:
        arena: Whose robots to draw.
    """

    def __init__(self, arena: Arena) -> None:
        self._arena = arena
        self._bounds = bounds = arena.copies.bounds
        self._cell = max(bounds.x_max - bounds.x_min, bounds.y_max - bounds.y_min) / LONG_SIDE
        height, width = shape_of(bounds, self._cell)
        # what makes films of pictures wants even sides
        shape = (height + height % 2, width + width % 2, 3)
        self._empty = np.full(shape, WHITE, dtype=np.uint8)
        self._paint(self._empty, arena.copies.walls, WALL)

    def draw(self, copy: int = 0) -> Image:
        """Return a picture, shape (H, W, 3): walls, robots with their headings, goals as circles.

        Who has left is not drawn.
        """
        arena, image = self._arena, self._empty.copy()
        first = copy * arena.robots
        who = range(first, first + arena.robots)
        for n, colour in zip(who, cycle(COLOURS), strict=False):
            if arena.present[n]:
                x, y, theta = arena.poses[n]
                nose = arena.world.outlines.front[n] * np.array([np.cos(theta), np.sin(theta)])
                sides = arena.world.outlines.outlines[n] - np.tile(arena.copies.shifts[copy], 2)
                circle = _circle(arena.goals[n], arena.task.goal_radius)
                strokes = [sides, [[x, y, x + nose[0], y + nose[1]]], circle]
                self._paint(image, np.concatenate(strokes), colour)
        return np.ascontiguousarray(image[::-1])

    def _paint(self, image: Image, segments: Float, colour: tuple[int, int, int]) -> None:
        cells = touched(segments, self._bounds, self._cell)
        image[: cells.shape[0], : cells.shape[1]][cells] = colour


def _circle(middle: Float, radius: float) -> Float:
    """Return the sides of a polygon [m], shape (CORNERS, 4)."""
    angles = np.linspace(0.0, tau, CORNERS + 1)
    points = middle + radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    return np.concatenate([points[:-1], points[1:]], axis=1)
