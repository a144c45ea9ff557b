"""The map as pages are told of it."""

from base64 import b64decode
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap, MapObject, OccupancyGrid, shipped_map
from pioneer3.maps.image import parse_image
from pioneer3.maps.line_map import FREE, OCCUPIED, UNKNOWN
from pioneer3.web import world as module
from pioneer3.web.messages import encode
from pioneer3.web.world import SHADE, map_message
from tests.unit.web.browser import strict

STATES = np.array([[OCCUPIED, UNKNOWN, FREE], [FREE, FREE, UNKNOWN]], dtype=np.uint8)
GRID = OccupancyGrid(states=STATES, resolution=0.05, origin=Pose2(1.0, 2.0, 0.5))
OUTLINES = np.array([[0.0, 0.0, 1.0, 1.0 / 3.0], [1.0, 1.0, 1.0, 1.05]])
AREA = MapObject(
    kind="ForbiddenArea", name="lab", pose=Pose2(), outline=((7, 7), (9, 7), (9, 9), (7, 9))
)
GOAL = MapObject(kind="GoalWithHeading", name="door", pose=Pose2(1.0, 2.0, 0.25))


def told(line_map: LineMap | None) -> Any:
    return strict(encode(map_message(line_map)))["map"]


def test_no_map_is_null() -> None:
    assert told(None) is None


def test_walls_that_outline_cells_are_told_as_cells() -> None:
    mixed = LineMap(name="m", walls=OUTLINES, grids=(GRID,), lines=OUTLINES[:1])
    assert told(mixed)["walls"] == [[0.0, 0.0, 1.0, 0.333]]
    (cells,) = told(mixed)["cells"]
    assert (cells["side"], cells["corner"]) == (0.05, [1.0, 2.0, 0.5])
    picture = parse_image(Path("cells.png"), b64decode(cells["png"]))
    assert (picture.shades // SHADE).tolist() == STATES.tolist()


def test_many_cells_are_joined(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MOST_CELLS", 2)
    (cells,) = told(LineMap(name="m", walls=OUTLINES, grids=(GRID,)))["cells"]
    assert cells["side"] == pytest.approx(0.1)


def test_objects_say_all_that_is_drawn() -> None:
    area, goal = told(LineMap(name="m", walls=OUTLINES, objects=(AREA, GOAL)))["objects"]
    assert (area["role"], area["forbidden"], area["name"]) == ("area", True, "lab")
    assert area["points"] == [[7, 7], [9, 7], [9, 9], [7, 9]]
    assert goal == {
        "role": "goal",
        "kind": "GoalWithHeading",
        "name": "door",
        "x": 1.0,
        "y": 2.0,
        "theta": 0.25,
        "heads": True,
        "forbidden": False,
        "solid": False,
        "points": [],
    }


def test_the_office_is_small() -> None:
    assert len(encode(map_message(shipped_map("office")))) < 20_000
