"""Finds places again: loops in the way of a robot, and the poses that follow from them."""

from collections.abc import Iterator
from dataclasses import dataclass
from math import hypot

import numpy as np

from pioneer3.arrays import Float
from pioneer3.geometry import Pose2
from pioneer3.nav.frames import Edge, Survey
from pioneer3.nav.graph import optimized, pieces_of
from pioneer3.nav.matching import Cloud, Match, Prior, Submap, rotation
from pioneer3.nav.particles import rows_of
from pioneer3.nav.relocalization import Vicinity

RECENT_FRAMES = 30
"""Key frames that scans are matched against live; older ones make loops."""
POOLED_FRAMES = 4
"""Key frames with the points of which a place is looked for."""
AROUND_FRAMES = 10
"""Key frames before and after an old one among the points of which a place is looked for."""
ASKED_PASSES = 2
"""Passes of the same place that are asked."""
ATTEMPT_WAY = 0.5
"""Way from one attempt to the next [m]."""
DRIFT_SHARE = 0.04
"""Distance of a robot from where it is thought to be at most, as a share of the way since the last
loop."""
DRIFT_START = 0.3
"""Distance of a robot from where it is thought to be from the beginning [m]."""
MOST_DRIFT = 15.0
"""Distance beyond which is not searched [m]."""
TURN_DRIFT = 0.002
"""Error of the heading at most by the way since the last loop [rad/m]."""
TURN_DRIFT_START = 0.06
"""Error of the heading from the beginning [rad]."""
MOST_TURN_DRIFT = 0.35
"""Error of the heading beyond which is not searched [rad]."""
SEEN_APART = 3.0
"""Difference between the views from two places below which they are the same [m]."""
SEARCHED_POINTS = 180
"""Points of a search, of all that there are."""
SEARCH_SCORE = 0.4
"""Score of a search below which a match is not worth it."""
LOOP_INLIERS = 0.65
"""Share of points on walls from which on a match closes a loop."""
LOOP_RATIO = 0.05
"""Ratio from which on the walls fix the position in all directions: see `Match.ratio`."""
ALONE_MOVE = 0.05
"""Move of the robot up to which a loop is taken by itself [m]; another one needs a second that
agrees with it."""
ALONE_PER_WAY = 0.02
"""Move up to which a loop is taken by itself, as a share of the way since the last loop."""
MOST_ALONE = 0.3
"""Move up to which a loop is taken by itself at most [m]."""
ASKED_PIECES = 2
"""Pieces of the map, the latest ones, that are looked for at a time."""
ASKED_PLACES = 3
"""Places that a piece is looked for at, at a time, besides that of the tear."""
JOINED_WAY = 1.5
"""Distance from a place within which a piece is looked for [m]."""
JOINED_APART = 2.5
"""Way between two places of a piece that confirm each other [m]: corridors look alike."""
LOOPS_APART = 0.2
"""Difference below which two loops agree [m], which is less than one that is taken by itself moves
the robot."""
LOOPS_TURN = 0.05
"""Difference of headings below which two loops agree [rad]."""
LOOPS_WAY = 20.0
"""Way within which two loops agree [m]."""
LOOP_MOVE = 0.02
"""Difference of a loop from the poses above which they are made new [m]."""
LOOP_TURN = 0.004
"""Difference of a loop from the headings above which poses are made new [rad]."""
LOOP_PATIENCE = 8
"""Loops after which poses are made new in any case."""
LOOP_PRIOR = np.diag([1.0, 1.0, 10.0])
"""Information of a loop besides its points."""
LOOP_PLAIN_ROUNDS = 2
"""Rounds of the graph in which all loops count in full."""
LOOP_ROUNDS = 3
"""Rounds of the graph at most: the next loops go on where these end."""
LOOP_STEP = 2e-3
"""Step of the graph below which it ends [m, rad]."""
MATCH_FLOOR = np.diag([0.01, 0.01, 0.003]) ** 2
"""Errors of a match that its points do not show [m, m, rad]: motion in a scan, rough walls."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Improvement:
    """An improvement of a :class:`MapSnapshot`: poses, and all edges with the `loops` found.

    The `pieces` of the map are those whose places to each other are not known.
    """

    poses: tuple[Pose2, ...]
    edges: tuple[Edge, ...]
    looked: int
    waiting: tuple[Edge, ...]
    loops: int
    pieces: int


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MapSnapshot:
    """A map at one instant, for a thread of its own.

    Key frames from the number `looked` on have not been looked for; with the loops that are
    `waiting` nothing else agrees so far.
    """

    survey: Survey
    looked: int
    waiting: tuple[Edge, ...]

    @property
    def is_looked_through(self) -> bool:
        """Whether all key frames have been looked for."""
        return self.looked >= len(self.survey.frames)

    def improve(self) -> Improvement:
        """Look for a place that the robot has been at before.

        It ends after the first key frame that had to be compared with others, as that takes long.
        """
        search, looked, count = _Search(self), self.looked, len(self.survey.frames)
        while looked < count and not search.look_for(looked):
            looked += 1
        if looked < count:
            looked += 1
        elif not self.is_looked_through:
            search.join()
        return search.finish(looked)


class _Search:
    """Looks for loops, one key frame after the other."""

    def __init__(self, snapshot: MapSnapshot) -> None:
        survey = snapshot.survey
        self._frames, self._poses = survey.frames, survey.poses
        self._edges, self._waiting = [*survey.edges], [*snapshot.waiting]
        self._views = self._seen_from_all()
        self._ways = np.array([frame.way for frame in self._frames])
        loops = [edge.second for edge in self._edges if edge.loop]
        self._closed = max((self._frames[k].way for k in loops), default=0.0)
        asked = [self._frames[edge.second].way for edge in self._waiting]
        self._tried = max((self._closed, *asked))
        self._found = self._fresh = 0
        self._piece = pieces_of(len(self._frames), self._edges)

    def look_for(self, number: int) -> bool:
        """Look for the place of a key frame among older ones, and close the loops found.

        Return whether there were any that it was compared with.
        """
        way = self._ways[number]
        if number < RECENT_FRAMES + AROUND_FRAMES or way - self._tried < ATTEMPT_WAY:
            return False
        drift = min(MOST_DRIFT, DRIFT_START + DRIFT_SHARE * (way - self._closed))
        query = self._query(number)
        for old in self._candidates(number, SEEN_APART + drift):
            self._tried = way
            edge = self._close(old, number, query, drift)
            if edge is not None:
                self._take(edge)
        return bool(self._tried == way)

    def finish(self, looked: int) -> Improvement:
        """Return the result; key frames before the number `looked` have been looked for."""
        return Improvement(
            poses=self._poses,
            edges=(*self._edges,),
            looked=looked,
            waiting=(*self._waiting,),
            loops=self._found,
            pieces=len(np.unique(self._piece)),
        )

    def _candidates(self, number: int, near: float) -> Iterator[int]:
        """Yield the key frame of each old pass that saw most of the same."""
        views = self._views[: number - RECENT_FRAMES]
        off = np.hypot(*(views - self._views[number]).T)
        close = np.flatnonzero(off < near)
        if not len(close):
            return
        passes = np.split(close, np.flatnonzero(np.diff(close) > AROUND_FRAMES) + 1)
        best = sorted((float(off[part].min()), int(part[off[part].argmin()])) for part in passes)
        yield from (old for _, old in best[:ASKED_PASSES])

    def _query(self, number: int) -> Cloud:
        """Return the points of the last key frames in the frame of the robot at one."""
        here = self._poses[number].inverse()
        numbers = self._of_piece(number, number - POOLED_FRAMES + 1, number + 1)
        clouds = [self._frames[k].cloud.moved(here @ self._poses[k]) for k in numbers]
        return Cloud(
            np.concatenate([cloud.points for cloud in clouds]),
            np.concatenate([cloud.normals for cloud in clouds]),
        )

    def _close(self, old: int, number: int, query: Cloud, drift: float) -> Edge | None:
        """Return the loop from an old key frame to a new one, if there is one."""
        here = self._poses[old].inverse()
        numbers = self._of_piece(
            old, old - AROUND_FRAMES, min(number - RECENT_FRAMES, old + AROUND_FRAMES) + 1
        )
        submap = Submap(
            [self._frames[k].cloud for k in numbers], [here @ self._poses[k] for k in numbers]
        )
        guess = here @ self._poses[number]
        since = self._ways[number] - self._closed
        turn = min(MOST_TURN_DRIFT, TURN_DRIFT_START + TURN_DRIFT * since)
        sparse = np.ascontiguousarray(query.points[:: max(1, len(query.points) // SEARCHED_POINTS)])
        found, worth = submap.search(sparse, guess, drift, turn)
        if worth < SEARCH_SCORE:
            return None
        match = submap.match(query, found, Prior.around(found, 0.5, 0.2))
        if match.inliers < LOOP_INLIERS or match.ratio < LOOP_RATIO:
            return None
        moved = guess.inverse() @ match.pose
        if hypot(moved.x, moved.y) > drift + 0.1:
            return None
        return Edge(old, number, match.pose, certainty(match, LOOP_PRIOR), loop=True)

    def join(self) -> None:
        """Look for the place of a piece of the map in the one that the map began with.

        Each call asks a few places: that beside the tear, and others in turn.
        """
        for piece in np.unique(self._piece[self._piece != self._piece[0]])[-ASKED_PIECES:].tolist():
            members = np.flatnonzero(self._piece == piece)
            latest = members[-1] == len(self._frames) - 1
            number = int(members[-1] if latest else members[len(self._frames) % len(members)])
            known = np.flatnonzero(self._piece == self._piece[0])
            away = known[::AROUND_FRAMES]
            turn = len(self._frames) * ASKED_PLACES
            others = [int(away[(turn + k) % len(away)]) for k in range(ASKED_PLACES)]
            beside = int(known[np.abs(known - members[0]).argmin()])
            for old in dict.fromkeys((beside, *others)):
                if self._join(old, number, self._poses[number] if old == beside else None):
                    break

    def _join(self, old: int, number: int, near: Pose2 | None) -> bool:
        """Join the piece of a key frame to that of an old one, if it is seen from there.

        It is looked for near a pose, if that is given.
        """
        here = self._poses[old].inverse()
        numbers = self._of_piece(old, old - AROUND_FRAMES, old + AROUND_FRAMES + 1)
        around = Vicinity(
            [self._frames[k] for k in numbers], [here @ self._poses[k] for k in numbers]
        )
        begin = here @ near if near else Pose2()
        query = self._query(number)
        match = around.find(
            query, self._frames[number].beams, begin, way=JOINED_WAY, fit=LOOP_INLIERS
        )
        if match is None or match.ratio < LOOP_RATIO:
            return False
        edge = Edge(old, number, match.pose, certainty(match, LOOP_PRIOR), loop=True)
        return self._merge(edge)

    def _merge(self, edge: Edge) -> bool:
        """Make one piece of two by a loop, once another one agrees."""
        if not self._is_seconded(edge):
            self._waiting.append(edge)
            return False
        first, second = edge.first, edge.second
        moved = self._poses[first] @ edge.second_in_first @ self._poses[second].inverse()
        mine = self._piece == self._piece[second]
        if mine[0]:  # the first pose stays where it is
            moved, mine = moved.inverse(), self._piece == self._piece[first]
        self._poses = tuple(
            moved @ pose if part else pose
            for pose, part in zip(self._poses, mine.tolist(), strict=True)
        )
        self._piece[mine] = self._piece[second if mine[first] else first]
        self._accept(edge, Pose2(LOOP_MOVE, LOOP_MOVE))
        return True

    def _is_seconded(self, edge: Edge) -> bool:
        """Whether another edge between two pieces, which waited for it, says the same."""
        for other in self._waiting:
            apart = self._piece[other.first] != self._piece[other.second]
            independent = abs(self._ways[other.second] - self._ways[edge.second]) >= JOINED_APART
            if apart and independent and self._agree(other, edge, LOOPS_APART):
                self._waiting.remove(other)
                self._edges.append(other)
                return True
        return False

    def _of_piece(self, number: int, begin: int, end: int) -> list[int]:
        """Return the key frames from one number to another in the piece of a key frame."""
        return [
            k
            for k in range(max(0, begin), min(len(self._frames), end))
            if self._piece[k] == self._piece[number]
        ]

    def _take(self, edge: Edge) -> None:
        """Close a loop, or wait for another that agrees."""
        moved, way = self._error(edge), self._ways[edge.second]
        alone = min(MOST_ALONE, ALONE_MOVE + ALONE_PER_WAY * (way - self._closed))
        if self._piece[edge.first] != self._piece[edge.second]:
            self._merge(edge)
            return
        if hypot(moved.x, moved.y) < alone:
            self._accept(edge, moved)
            return
        self._waiting = [e for e in self._waiting if way - self._ways[e.second] < LOOPS_WAY]
        for other in self._waiting:
            if edge.second - other.second >= POOLED_FRAMES and self._agree(other, edge, alone):
                self._waiting.remove(other)
                self._edges.append(other)
                self._accept(edge, moved)
                return
        self._waiting.append(edge)

    def _error(self, edge: Edge) -> Pose2:
        """Return how far the second robot is from where the edge has it, in its own frame."""
        between = self._poses[edge.first].inverse() @ self._poses[edge.second]
        return between.inverse() @ edge.second_in_first

    def _agree(self, a: Edge, b: Edge, near: float) -> bool:
        """Whether two loops say the same, within `near` [m]."""
        olds = self._poses[a.first].inverse() @ self._poses[b.first]
        news = self._poses[a.second].inverse() @ self._poses[b.second]
        off = (a.second_in_first @ news).inverse() @ (olds @ b.second_in_first)
        return hypot(off.x, off.y) < min(LOOPS_APART, near) and abs(off.theta) < LOOPS_TURN

    def _accept(self, edge: Edge, moved: Pose2) -> None:
        self._edges.append(edge)
        self._found += 1
        self._fresh += 1
        self._closed = self._ways[edge.second]
        far = hypot(moved.x, moved.y) > LOOP_MOVE or abs(moved.theta) > LOOP_TURN
        if far or self._fresh >= LOOP_PATIENCE:
            self._fresh = 0
            plain = 0 if hypot(moved.x, moved.y) < MOST_ALONE else LOOP_PLAIN_ROUNDS
            self._poses = optimized(
                self._poses, self._edges, plain=plain, rounds=LOOP_ROUNDS, small=LOOP_STEP
            )
            self._views = self._seen_from_all()

    def _seen_from_all(self) -> Float:
        """Return the middle of what each key frame sees, shape (N, 2)."""
        views = np.array([frame.view for frame in self._frames]).reshape(-1, 2)
        x, y, theta = rows_of(self._poses).T
        c, s = np.cos(theta), np.sin(theta)
        across, along = views[:, 1], views[:, 0]
        return np.stack([x + c * along - s * across, y + s * along + c * across], axis=1)


def certainty(match: Match, prior: Float) -> Float:
    """Return the information of an edge by a match of its second robot, in that one's frame.

    The `prior` is information of what is known besides, in the frame of the match.
    """
    turn = np.eye(3)
    turn[:2, :2] = rotation(match.pose.theta)
    covariance = turn.T @ np.linalg.inv(match.information + prior) @ turn
    result: Float = np.linalg.inv(covariance + MATCH_FLOOR)
    return result
