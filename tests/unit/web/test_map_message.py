"""The map as pages are told of it."""

from base64 import b64decode
from math import cos, pi, sin
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap, MapObject, OccupancyGrid, shipped_map
from pioneer3.maps.image import parse_image
from pioneer3.maps.line_map import FREE, OCCUPIED, UNKNOWN
from pioneer3.sim.relief import Cylinder, HeightField, Mesh, Ramp, Step, Table
from pioneer3.sim.worldfile import Box, Wall, WorldFile
from pioneer3.web import world as module
from pioneer3.web.messages import encode
from pioneer3.web.world import SHADE, map_message
from tests.unit.sim.solid_files import write_block, write_hill
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


def test_heights_are_told_where_they_differ() -> None:
    world = WorldFile(
        name="w",
        wall_height=2.0,
        walls=(
            Wall(points=((0, 0), (1, 0))),
            Wall(points=((0, 1), (1, 1)), height=0.5),
        ),
        solids=(Cylinder(pose=Pose2(4.0, 4.0), radius=0.2, height=0.9),),
    )
    line_map = world.line_map()
    drawing = strict(encode(map_message(line_map, world.relief(line_map))))["map"]
    assert drawing["wall_height"] == 2.0
    assert drawing["heights"] == [2.0, 0.5] + [0.0] * 16
    alone = told(LineMap(name="m", walls=OUTLINES))
    assert (alone["wall_height"], alone["heights"], alone["solids"]) == (1.0, [], [])


def test_solids_are_told_with_their_shapes(tmp_path: Path) -> None:
    write_hill(tmp_path / "hill.png", rows=150, columns=301)
    write_block(tmp_path / "rock.stl", (1.0, 0.5, 0.6))
    ball(tmp_path / "ball.obj")
    solids = (
        Step(pose=Pose2(0, 0, 0.5), size=(2, 1), height=0.1),
        Ramp(pose=Pose2(3, 0), size=(2, 1), height=0.1, z=0.2),
        Table(pose=Pose2(0, 4), size=(1, 1), height=0.7, back=0.4),
        HeightField(file=tmp_path / "hill.png", pose=Pose2(-3, 3), size=(3, 2), height=0.1),
        Mesh(file=tmp_path / "rock.stl", pose=Pose2(-3, -3)),
        Mesh(file=tmp_path / "ball.obj", pose=Pose2(-6, -3)),
    )
    boxes = (Box(pose=Pose2(9, 9), size=(1, 1)), Box(pose=Pose2(0, 4), size=(0.2, 0.2), z=0.7))
    world = WorldFile(name="w", solids=solids, boxes=boxes)
    line_map = world.line_map()
    drawing = strict(encode(map_message(line_map, world.relief(line_map))))["map"]
    box, step, ramp, table, hill, rock, far = drawing["solids"]
    assert (step["kind"], step["ground"], table["ground"]) == ("step", True, False)
    assert step["shapes"][0]["at"] == [0.0, 0.0, 0.0, 0.5]
    assert (ramp["shapes"][0]["form"], ramp["shapes"][0]["size"]) == ("wedge", [2.0, 1.0, 0.1])
    assert box["shapes"][0]["at"] == [0.0, 4.0, 0.7, 0.0]
    assert len(table["shapes"]) == 6
    terrain = hill["shapes"][0]
    assert terrain["columns"] <= 100
    assert len(terrain["numbers"]) % terrain["columns"] == 0
    assert terrain["numbers"][0] == pytest.approx(0.1 * 55 / 255, abs=1e-3)
    assert len(rock["outline"]) == 4
    assert len(rock["shapes"][0]["corners"]) == 36
    prism = far["shapes"][0]
    assert len(prism["corners"]) < 3 * 3000
    points = np.array(prism["numbers"]).reshape(-1, 3)
    assert points[:, 2].min() == -1.0
    assert points[:, 2].max() == 1.0


def ball(path: Path, rows: int = 40, columns: int = 60) -> None:
    """Write a ball of radius 1 m, with 4560 triangles."""
    angles = [2 * pi * k / columns for k in range(columns)]
    heights = [pi * k / rows - pi / 2 for k in range(1, rows)]
    around = [(cos(h) * cos(a), cos(h) * sin(a), sin(h)) for h in heights for a in angles]
    points = [(0.0, 0.0, -1.0), *around, (0.0, 0.0, 1.0)]
    text = "".join(f"v {x:.6f} {y:.6f} {z:.6f}\n" for x, y, z in points)
    for k in range(columns):
        here, after = 2 + k, 2 + (k + 1) % columns
        text += f"f 1 {after} {here}\n"
        for row in range(rows - 2):
            low, high = row * columns, (row + 1) * columns
            text += f"f {low + here} {low + after} {high + after} {high + here}\n"
        last = (rows - 2) * columns
        text += f"f {last + here} {last + after} {len(points)}\n"
    path.write_text(text)


def test_the_office_is_small() -> None:
    assert len(encode(map_message(shipped_map("office")))) < 20_000
