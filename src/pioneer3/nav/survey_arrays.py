"""A survey as arrays, to be written to a file and read again."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pioneer3.geometry import Pose2
from pioneer3.nav.beams import Beams
from pioneer3.nav.frames import Edge, KeyFrame, Survey
from pioneer3.nav.matching import Cloud

Float = NDArray[np.float64]


def arrays_of(survey: Survey, looked: int, waiting: Sequence[Edge]) -> dict[str, NDArray[Any]]:
    """Return a survey and the state of the search for loops as arrays.

    Points are rounded to 32 bits: a few micrometres.
    """
    frames, edges = survey.frames, (*survey.edges, *waiting)
    beams = [frame.beams for frame in frames]
    return {
        "poses": _poses(survey.poses),
        "odometry": _poses([one.robot_in_odom for one in beams]),
        "stamps": np.array([one.stamp for one in beams]),
        "ways": np.array([(frame.way, frame.turn) for frame in frames]).reshape(-1, 2),
        "lasers": np.array([(*one.origin, one.far) for one in beams]).reshape(-1, 3),
        "counts": np.array([(len(o.points), len(o.clear)) for o in beams]).reshape(-1, 2),
        "points": _joined([one.points for one in beams]),
        "clear": _joined([one.clear for one in beams]),
        "ends": np.array([(e.first, e.second, e.loop) for e in edges], dtype=np.int64).reshape(
            -1, 3
        ),
        "edges": _poses([edge.second_in_first for edge in edges]),
        "information": np.array([edge.information for edge in edges]).reshape(-1, 3, 3),
        "search": np.array([looked, len(waiting)], dtype=np.int64),
    }


def survey_of(arrays: Mapping[str, NDArray[Any]]) -> tuple[Survey, int, tuple[Edge, ...]]:
    """Return the survey, and the state of the search, that :func:`arrays_of` was given."""
    looked, waiting = arrays["search"].tolist()
    edges = tuple(
        Edge(first, second, Pose2(*way), information, bool(loop))
        for (first, second, loop), way, information in zip(
            arrays["ends"].tolist(), arrays["edges"].tolist(), arrays["information"], strict=True
        )
    )
    counts = arrays["counts"].astype(np.int64)
    points, clear = (
        np.split(arrays[name].astype(np.float64), np.cumsum(counts[:, column])[:-1])
        for column, name in enumerate(("points", "clear"))
    )
    odometry, lasers = arrays["odometry"].tolist(), arrays["lasers"]
    frames = []
    for number, (way, turn) in enumerate(arrays["ways"].tolist()):
        beams = Beams(
            stamp=float(arrays["stamps"][number]),
            robot_in_odom=Pose2(*odometry[number]),
            points=points[number],
            clear=clear[number],
            origin=lasers[number, :2].copy(),
            far=float(lasers[number, 2]),
        )
        frames.append(KeyFrame.of(beams, Cloud.of(beams), way, turn))
    poses = tuple(Pose2(*pose) for pose in arrays["poses"].tolist())
    split = len(edges) - waiting
    return Survey(tuple(frames), poses, edges[:split]), looked, edges[split:]


def _poses(poses: Sequence[Pose2]) -> Float:
    return np.array([(pose.x, pose.y, pose.theta) for pose in poses]).reshape(-1, 3)


def _joined(parts: Sequence[Float]) -> NDArray[np.float32]:
    return np.concatenate([*parts, np.empty((0, 2))]).astype(np.float32)
