"""Pictures of robots in their map."""

from itertools import cycle
from math import tau
from typing import Any

import numpy as np

from pioneer3.arrays import Float, UInt8
from pioneer3.errors import ConfigError
from pioneer3.gym.simulation import GoalSimulation
from pioneer3.maps.grid import shape_of, touched

Image = UInt8

METADATA: dict[str, Any] = {"render_modes": ["rgb_array"], "render_fps": 10}
"""Metadata of environments at 10 steps a second."""
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
"""Colours of robots and their goals, one after another."""
CORNERS = 24
"""Corners of the polygon that is drawn as a circle."""


def metadata_of(simulation: GoalSimulation, render_mode: str | None) -> dict[str, Any]:
    """Return :data:`METADATA` with the frame rate of a simulation.

    Raises:
        ConfigError: There is no such render mode.
    """
    modes = METADATA["render_modes"]
    if render_mode is not None and render_mode not in modes:
        raise ConfigError(f"render_mode: {render_mode!r} is not one of {', '.join(modes)}")
    return METADATA | {"render_fps": max(1, round(1 / simulation.task.dt))}


class EnvironmentRenderer:
    """Draws one copy of the map of a simulation, with its robots and goals."""

    def __init__(self, simulation: GoalSimulation) -> None:
        self._simulation = simulation
        self._bounds = bounds = simulation.maps.bounds
        self._cell = max(bounds.x_max - bounds.x_min, bounds.y_max - bounds.y_min) / LONG_SIDE
        height, width = shape_of(bounds, self._cell)
        # programs that encode films need even sides
        shape = (height + height % 2, width + width % 2, 3)
        self._empty = np.full(shape, WHITE, dtype=np.uint8)
        self._paint(self._empty, simulation.maps.walls, WALL)

    def render(self, copy: int = 0) -> Image:
        """Return a picture, shape (H, W, 3): walls, robots with their headings, goals as circles.

        Robots that were removed are not drawn.
        """
        simulation, image = self._simulation, self._empty.copy()
        outlines, away = simulation.world.outlines, np.tile(simulation.maps.offsets[copy], 2)
        first = copy * simulation.robots
        who = range(first, first + simulation.robots)
        for n, colour in zip(who, cycle(COLOURS), strict=False):
            if simulation.active[n]:
                x, y, theta = simulation.poses[n]
                nose = outlines.front[n] * np.array([np.cos(theta), np.sin(theta)])
                heading = [[x, y, x + nose[0], y + nose[1]]]
                circle = _circle(simulation.goals[n], simulation.task.goal_radius)
                strokes = [outlines.outlines[n] - away, heading, circle]
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
