"""Parts of a map: scans at poses, the ways measured between them, and both as arrays of a file."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from pioneer3.arrays import Float, Float32
from pioneer3.geometry import Pose2
from pioneer3.nav.beams import Beams
from pioneer3.nav.matching import Cloud
from pioneer3.nav.particles import rows_of

LOOP = 1
"""Bit of an edge's kind, in a file, that says that it closes a loop."""
TORN = 2
"""Bit of an edge's kind that says that the way is not known."""
MISSED = 4
"""Bit of an edge's kind that says that odometry missed a motion."""
VIEW = 5.0
"""Distance beyond which things seen count as if they were here [m]."""


@dataclass(frozen=True, slots=True, eq=False)
class KeyFrame:
    """A scan that is kept.

    Attributes:
        way: How far the robot had driven [m].
        turn: How far it had turned, left and right added [rad].
        view: The middle of what is near [m], in the robot's frame, shape (2,).
    """

    beams: Beams
    cloud: Cloud
    way: float
    turn: float
    view: Float

    @classmethod
    def of(cls, beams: Beams, cloud: Cloud, way: float, turn: float) -> Self:
        """Return the key frame of a scan."""
        away = np.hypot(*cloud.points.T)
        seen = cloud.points * np.minimum(1.0, VIEW / np.maximum(away, 1e-9))[:, None]
        view = seen.mean(axis=0) if len(seen) else np.zeros(2)
        return cls(beams, cloud, way, turn, view)


@dataclass(frozen=True, slots=True, eq=False)
class Edge:
    """A measured way from one key frame to another, by their numbers.

    Attributes:
        second_in_first: Pose of the second robot in the frame of the first [m, rad].
        information: Of it, in the frame of the second, shape (3, 3).
        loop: Whether it closes a loop, and so may be wrong altogether.
        torn: Whether the way is not known, as odometry missed a motion: the map has two pieces
            there, until loops join them.
        missed: Whether odometry missed a motion there, by as much as the scans say.
    """

    first: int
    second: int
    second_in_first: Pose2
    information: Float
    loop: bool = False
    torn: bool = False
    missed: bool = False

    @property
    def kind(self) -> int:
        """The kind in a file: bits."""
        return LOOP * self.loop + TORN * self.torn + MISSED * self.missed


@dataclass(frozen=True, slots=True, eq=False)
class Survey:
    """All that a map is made of: key frames, the robot's pose in the map at each, and edges.

    Those that are no loops connect all key frames.
    """

    frames: tuple[KeyFrame, ...]
    poses: tuple[Pose2, ...]
    edges: tuple[Edge, ...]


def arrays_of(survey: Survey, looked: int, waiting: Sequence[Edge]) -> dict[str, NDArray[Any]]:
    """Return a survey and the state of the search for loops as arrays.

    Points are rounded to 32 bits: a few micrometres.
    """
    frames, edges = survey.frames, (*survey.edges, *waiting)
    beams = [frame.beams for frame in frames]
    return {
        "poses": rows_of(survey.poses),
        "odometry": rows_of([one.robot_in_odom for one in beams]),
        "stamps": np.array([one.stamp for one in beams]),
        "ways": np.array([(frame.way, frame.turn) for frame in frames]).reshape(-1, 2),
        "lasers": np.array([(*one.origin, one.far) for one in beams]).reshape(-1, 3),
        "counts": np.array([(len(o.points), len(o.clear)) for o in beams]).reshape(-1, 2),
        "points": _joined([one.points for one in beams]),
        "clear": _joined([one.clear for one in beams]),
        "ends": np.array(
            [(edge.first, edge.second, edge.kind) for edge in edges], dtype=np.int64
        ).reshape(-1, 3),
        "edges": rows_of([edge.second_in_first for edge in edges]),
        "information": np.array([edge.information for edge in edges]).reshape(-1, 3, 3),
        "search": np.array([looked, len(waiting)], dtype=np.int64),
    }


def survey_of(arrays: Mapping[str, NDArray[Any]]) -> tuple[Survey, int, tuple[Edge, ...]]:
    """Return the survey, and the state of the search, that :func:`arrays_of` was given."""
    looked, waiting = arrays["search"].tolist()
    edges = tuple(
        Edge(
            first, second, Pose2(*way), information, *(bool(kind & b) for b in (LOOP, TORN, MISSED))
        )
        for (first, second, kind), way, information in zip(
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


def _joined(parts: Sequence[Float]) -> Float32:
    return np.concatenate([*parts, np.empty((0, 2))]).astype(np.float32)
