"""Holds the poses, edges and pieces of a map while loops are added to it."""

from dataclasses import dataclass, field
from math import hypot

import numpy as np

from pioneer3.arrays import Float
from pioneer3.geometry import Pose2
from pioneer3.nav.frames import Edge, Survey
from pioneer3.nav.graph import optimized, pieces_of
from pioneer3.nav.particles import rows_of

ALONE_MOVE = 0.05
"""Move of the robot up to which a loop is taken by itself [m]; another one needs a second that
agrees with it."""
MOST_ALONE = 0.3
"""Move up to which a loop is taken by itself at most [m]."""
LOOPS_APART = 0.2
"""Difference below which two loops agree [m], which is less than one that is taken by itself moves
the robot."""
LOOPS_TURN = 0.05
"""Difference of headings below which two loops agree [rad]."""
LOOP_MOVE = 0.02
"""Difference of a loop from the poses above which the last ones are made new [m]."""
LOOP_TURN = 0.004
"""Difference of a loop from the headings above which the last poses are made new [rad]."""
LAST_FRAMES = 500
"""Key frames whose poses a loop makes new at once."""
LOOP_PATIENCE = 0.02
"""Loops after which all poses are made new, as a share of the key frames: so these rounds take time
with the way, not with its square."""
LOOP_PLAIN_ROUNDS = 2
"""Rounds of the graph in which all loops count in full."""
LOOP_ROUNDS = 3
"""Rounds of the graph at most: the next loops go on where these end. Of the whole graph each is a
step of its own."""
LOOP_STEP = 2e-3
"""Step of the graph below which it ends [m, rad]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Progress:
    """How far the search for loops is.

    Attributes:
        looked: Number of the first key frame that has not been looked for.
        waiting: Loops with which nothing else agrees so far.
        fresh: Loops since all poses were made new.
        due: Rounds of the whole graph that are still to be made.
        plain: Those of them in which all loops count in full.
        poses: Of the first key frames, as the search left them, shape (N, 3).
        views: The middle of what each of these sees, in its robot's frame [m], shape (N, 2).
        ways: How far the robot had driven at each of these [m], shape (N,).
        edges: Number of the edges, as the search left them.
        closed: How far the robot had driven at the latest loop [m].
        torn: Whether an edge is torn.
    """

    looked: int = 0
    waiting: tuple[Edge, ...] = ()
    fresh: int = 0
    due: int = 0
    plain: int = 0
    poses: Float = field(default_factory=lambda: np.empty((0, 3)))
    views: Float = field(default_factory=lambda: np.empty((0, 2)))
    ways: Float = field(default_factory=lambda: np.empty(0))
    edges: int = 0
    closed: float = 0.0
    torn: bool = False


class PoseGraph:
    """The poses of a map, to which loops are added.

    Attributes:
        frames: The key frames.
        poses: Of the robot at each of them.
        edges: All edges.
        ways: How far the robot had driven at each key frame [m], shape (N,).
        piece: Number of the piece of map of each key frame, shape (N,).
        closed: How far the robot had driven at the latest loop [m].
    """

    def __init__(self, survey: Survey, progress: Progress) -> None:
        known = len(progress.poses)
        new, later = survey.frames[known:], survey.edges[progress.edges :]
        self.frames, self.poses, self.edges = survey.frames, survey.poses, [*survey.edges]
        self._fresh, self._due, self._plain = progress.fresh, progress.due, progress.plain
        self._rows = np.concatenate([progress.poses, rows_of(survey.poses[known:])])
        self._seen = np.concatenate([progress.views, *(frame.view[None] for frame in new)])
        self.ways = np.concatenate([progress.ways, [frame.way for frame in new]])
        self._views: Float | None = None
        closed = [float(self.ways[edge.second]) for edge in later if edge.loop]
        self.closed = max((progress.closed, *closed))
        self._torn = progress.torn or any(edge.torn for edge in later)
        count = len(self.frames)
        self.piece = pieces_of(count, self.edges) if self._torn else np.zeros(count, dtype=np.int64)

    @property
    def is_due(self) -> bool:
        """Whether a round of the whole graph is to be made before the next loop."""
        return self._due > 0

    @property
    def pieces(self) -> int:
        """Number of the pieces of the map."""
        return len(np.unique(self.piece)) if self._torn else 1

    @property
    def views(self) -> Float:
        """The middle of what each key frame sees [m], shape (N, 2)."""
        if self._views is None:
            (x, y, theta), (along, across) = self._rows.T, self._seen.T
            c, s = np.cos(theta), np.sin(theta)
            self._views = np.stack([x + c * along - s * across, y + s * along + c * across], axis=1)
        return self._views

    def progress(self, looked: int, waiting: tuple[Edge, ...]) -> Progress:
        """Return how far the search is, which has `looked` for so many key frames."""
        return Progress(
            looked=looked,
            waiting=waiting,
            fresh=self._fresh,
            due=self._due,
            plain=self._plain,
            poses=self._rows,
            views=self._seen,
            ways=self.ways,
            edges=len(self.edges),
            closed=self.closed,
            torn=self._torn,
        )

    def settle(self) -> None:
        """Make the round of the whole graph that is due."""
        plain, before = min(1, self._plain), self._rows
        self._bend(held=1, plain=plain, rounds=1)
        self._due, self._plain, self._fresh = self._due - 1, self._plain - plain, 0
        if not plain and np.abs(self._rows - before)[:, :2].max() < LOOP_STEP:
            self._due = 0

    def of_piece(self, number: int, begin: int, end: int) -> list[int]:
        """Return the key frames from one number to another in the piece of a key frame."""
        return [
            k
            for k in range(max(0, begin), min(len(self.frames), end))
            if self.piece[k] == self.piece[number]
        ]

    def error(self, edge: Edge) -> Pose2:
        """Return how far the second robot is from where the edge has it, in its own frame."""
        between = self.poses[edge.first].inverse() @ self.poses[edge.second]
        return between.inverse() @ edge.second_in_first

    def agree(self, a: Edge, b: Edge, near: float) -> bool:
        """Whether two loops say the same, within `near` [m]."""
        olds = self.poses[a.first].inverse() @ self.poses[b.first]
        news = self.poses[a.second].inverse() @ self.poses[b.second]
        off = (a.second_in_first @ news).inverse() @ (olds @ b.second_in_first)
        return hypot(off.x, off.y) < min(LOOPS_APART, near) and abs(off.theta) < LOOPS_TURN

    def merge(self, edge: Edge) -> None:
        """Make one piece of two by a loop."""
        first, second = edge.first, edge.second
        moved = self.poses[first] @ edge.second_in_first @ self.poses[second].inverse()
        mine = self.piece == self.piece[second]
        if mine[0]:  # the first pose stays where it is
            moved, mine = moved.inverse(), self.piece == self.piece[first]
        self.poses = tuple(
            moved @ pose if part else pose
            for pose, part in zip(self.poses, mine.tolist(), strict=True)
        )
        self._rows, self._views = rows_of(self.poses), None
        self.piece[mine] = self.piece[second if mine[first] else first]
        self.accept(edge, Pose2(ALONE_MOVE, ALONE_MOVE))

    def accept(self, edge: Edge, moved: Pose2) -> None:
        """Take a loop that moves the second robot so far, in its own frame."""
        self.edges.append(edge)
        self._fresh += 1
        self.closed = max(self.closed, float(self.ways[edge.second]))
        far, held = hypot(moved.x, moved.y), max(1, len(self._rows) - LAST_FRAMES)
        plain = 0 if far < MOST_ALONE else LOOP_PLAIN_ROUNDS
        if far > ALONE_MOVE and held > 1:
            self._due, self._plain = LOOP_ROUNDS, plain
        elif far > LOOP_MOVE or abs(moved.theta) > LOOP_TURN:
            self._bend(held=held, plain=plain, rounds=LOOP_ROUNDS)
        if self._fresh > LOOP_PATIENCE * len(self.frames):
            self._due = max(1, self._due)

    def _bend(self, *, held: int, plain: int, rounds: int) -> None:
        """Make the poses from the number `held` on new."""
        self._rows = optimized(
            self._rows, self.edges, held=held, plain=plain, rounds=rounds, small=LOOP_STEP
        )
        later = (Pose2(*row) for row in self._rows[held:].tolist())
        self.poses = (*self.poses[:held], *later)
        self._views = None
