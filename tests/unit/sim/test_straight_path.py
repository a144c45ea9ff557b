"""Whether a robot can be sent straight to a place of a map."""

import numpy as np
import pytest

from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap, MapObject
from pioneer3.models import load_model
from pioneer3.sim.placement.straight_path import PathCheck, check_path

MODEL = load_model("p3dx-sh")
ROOM = [(0, 0, 10, 0), (10, 0, 10, 10), (10, 10, 0, 10), (0, 10, 0, 0), (5, 0, 5, 4)]
AREA = MapObject(
    kind="ForbiddenArea", name="lab", pose=Pose2(), outline=((7, 7), (9, 7), (9, 9), (7, 9))
)
LINE = MapObject(kind="ForbiddenLine", name="", pose=Pose2(), outline=((0, 6), (3, 6)))
TAPE = MapObject(kind="Tape", name="", pose=Pose2(), outline=((0, 3), (5, 3)))
MAP = LineMap(name="room", walls=np.array(ROOM, dtype=float), objects=(AREA, LINE, TAPE))
START = (2.0, 2.0)


@pytest.mark.parametrize(
    ("end", "expected"),
    [
        ((4.0, 5.0), PathCheck()),
        ((8.0, 8.0), PathCheck('This is inside a forbidden area, "lab".')),
        ((9.4, 9.4), PathCheck('The straight way there crosses a forbidden area, "lab".')),
        ((1.0, 8.0), PathCheck("The straight way there crosses a forbidden line.")),
        ((4.0, 8.0), PathCheck()),
        ((11.0, 5.0), PathCheck("This is outside the walls of the map.")),
        ((5.1, 2.0), PathCheck("There is no room: a wall is 0.10 m away.")),
        (
            (8.0, 2.0),
            PathCheck(
                warning="Something stands in the straight way there: it may not get through."
            ),
        ),
        ((4.78, 3.0), PathCheck(warning="A wall is 0.22 m from there: it may stop before it.")),
    ],
)
def test_what_a_map_says(end: tuple[float, float], expected: PathCheck) -> None:
    assert check_path(MAP, MODEL, START, end) == expected


def test_a_robot_may_leave_a_forbidden_area() -> None:
    assert check_path(MAP, MODEL, (8.0, 8.0), (6.0, 5.0)) == PathCheck()


def test_without_walls_only_what_is_forbidden_counts() -> None:
    bare = LineMap(name="bare", walls=np.empty((0, 4)), objects=(LINE,))
    assert check_path(bare, MODEL, START, (90.0, 0.0)) == PathCheck()
    assert check_path(bare, MODEL, START, (1.0, 8.0)).refusal
