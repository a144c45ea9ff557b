"""Finds places again: loops in the way of a robot, and the poses that follow from them."""

from collections.abc import Iterator
from dataclasses import dataclass
from math import hypot

import numpy as np

from pioneer3.arrays import Float
from pioneer3.geometry import Pose2
from pioneer3.nav.frames import Edge, Survey
from pioneer3.nav.matching import Cloud, Match, Prior, rotation
from pioneer3.nav.pose_graph import ALONE_MOVE, LOOPS_APART, MOST_ALONE, PoseGraph, Progress
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
SEARCH_SCORE = 0.25
"""Score of a search below which a match is not worth it."""
LOOP_INLIERS = 0.3
"""Share of points on walls from which on a match closes a loop: across a hall, two passes see less
than half the same, and only what one of them saw through tells that they are apart."""
LOOP_RATIO = 0.05
"""Ratio from which on the walls fix the position in all directions: see `Match.ratio`."""
LOOP_WORTH = 0.1
"""That ratio times the share of points on walls, from which on a match is taken that no other one
has to confirm: below, it was up to 0.25 m off along a wall."""
ALONE_PER_WAY = 0.02
"""Move up to which a loop is taken by itself, as a share of the way since the last loop."""
ASKED_PIECES = 2
"""Pieces of the map, the latest ones, that are looked for at a time."""
ASKED_PLACES = 3
"""Places that a piece is looked for at, at a time, besides that of the tear."""
JOINED_WAY = 1.5
"""Distance from a place within which a piece is looked for [m]."""
JOINED_INLIERS = 0.65
"""Share of points on walls from which on a piece belongs there, as its heading is not known."""
JOINED_APART = 2.5
"""Way between two places of a piece that confirm each other [m]: corridors look alike."""
LOOPS_WAY = 20.0
"""Way within which two loops agree [m]."""
LOOP_PRIOR = np.diag([1.0, 1.0, 10.0])
"""Information of a loop besides its points."""
MATCH_FLOOR = np.diag([0.01, 0.01, 0.003]) ** 2
"""Errors of a match that its points do not show [m, m, rad]: motion in a scan, rough walls."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Improvement:
    """An improvement of a :class:`MapSnapshot`: poses, and all edges with the loops found.

    The `pieces` of the map are those whose places to each other are not known. The edges of the
    snapshot were so many as `before`.
    """

    poses: tuple[Pose2, ...]
    edges: tuple[Edge, ...]
    before: int
    progress: Progress
    pieces: int


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MapSnapshot:
    """A map at one instant, for a thread of its own."""

    survey: Survey
    progress: Progress

    @property
    def is_looked_through(self) -> bool:
        """Whether all key frames have been looked for, and their poses follow from the loops."""
        return self.progress.looked >= len(self.survey.frames) and not self.progress.due

    def improve(self) -> Improvement:
        """Look for a place that the robot has been at before.

        It ends after the first key frame that had to be compared with others, as that takes long;
        so does a round of the whole graph.
        """
        search, looked, count = _Search(self), self.progress.looked, len(self.survey.frames)
        if self.progress.due:
            search.settle()
            return search.finish(looked)
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
        self._graph = PoseGraph(snapshot.survey, snapshot.progress)
        self._before = len(snapshot.survey.edges)
        self._waiting = [*snapshot.progress.waiting]
        asked = [self._graph.frames[edge.second].way for edge in self._waiting]
        self._tried = max((self._graph.closed, *asked))

    def look_for(self, number: int) -> bool:
        """Look for the place of a key frame among older ones, and close the loops found.

        Return whether there were any that it was compared with.
        """
        way = self._graph.ways[number]
        if number < RECENT_FRAMES + AROUND_FRAMES or way - self._tried < ATTEMPT_WAY:
            return False
        drift = min(MOST_DRIFT, DRIFT_START + DRIFT_SHARE * (way - self._graph.closed))
        query = self._query(number)
        for old in self._candidates(number, SEEN_APART + drift):
            self._tried = way
            edge = self._close(old, number, query, drift)
            if edge is not None:
                self._take(edge)
            if self._graph.is_due:  # the poses are about to change
                break
        return bool(self._tried == way)

    def settle(self) -> None:
        """Make the round of the whole graph that is due."""
        self._graph.settle()

    def finish(self, looked: int) -> Improvement:
        """Return the result; key frames before the number `looked` have been looked for."""
        graph = self._graph
        return Improvement(
            poses=graph.poses,
            edges=(*graph.edges,),
            before=self._before,
            progress=graph.progress(looked, (*self._waiting,)),
            pieces=graph.pieces,
        )

    def _candidates(self, number: int, near: float) -> Iterator[int]:
        """Yield the key frame of each old pass that saw most of the same."""
        views = self._graph.views
        off = np.hypot(*(views[: number - RECENT_FRAMES] - views[number]).T)
        close = np.flatnonzero(off < near)
        if not len(close):
            return
        passes = np.split(close, np.flatnonzero(np.diff(close) > AROUND_FRAMES) + 1)
        best = sorted((float(off[part].min()), int(part[off[part].argmin()])) for part in passes)
        yield from (old for _, old in best[:ASKED_PASSES])

    def _query(self, number: int) -> Cloud:
        """Return the points of the last key frames in the frame of the robot at one."""
        here = self._graph.poses[number].inverse()
        numbers = self._graph.of_piece(number, number - POOLED_FRAMES + 1, number + 1)
        clouds = [self._graph.frames[k].cloud.moved(here @ self._graph.poses[k]) for k in numbers]
        return Cloud(
            np.concatenate([cloud.points for cloud in clouds]),
            np.concatenate([cloud.normals for cloud in clouds]),
        )

    def _close(self, old: int, number: int, query: Cloud, drift: float) -> Edge | None:
        """Return the loop from an old key frame to a new one, if there is one."""
        graph = self._graph
        around = self._around(old, min(number - RECENT_FRAMES, old + AROUND_FRAMES))
        guess = graph.poses[old].inverse() @ graph.poses[number]
        since = graph.ways[number] - graph.closed
        turn = min(MOST_TURN_DRIFT, TURN_DRIFT_START + TURN_DRIFT * since)
        sparse = np.ascontiguousarray(query.points[:: max(1, len(query.points) // SEARCHED_POINTS)])
        found = around.submap.search_for(sparse, guess, drift, turn, SEARCH_SCORE)
        if found is None:
            return None
        match = around.submap.match(query, found, Prior.around(found, 0.5, 0.2))
        certain = match.inliers >= LOOP_INLIERS and match.ratio >= LOOP_RATIO
        if not certain or around.contradicts(graph.frames[number].beams, match.pose):
            return None
        if graph.piece[old] == graph.piece[number] and match.inliers * match.ratio < LOOP_WORTH:
            return None
        moved = guess.inverse() @ match.pose
        if hypot(moved.x, moved.y) > drift + 0.1:
            return None
        return Edge(old, number, match.pose, certainty(match, LOOP_PRIOR), loop=True)

    def join(self) -> None:
        """Look for the place of a piece of the map in the one that the map began with.

        Each call asks a few places: that beside the tear, and others in turn.
        """
        graph = self._graph
        pieces = np.unique(graph.piece[graph.piece != graph.piece[0]])
        for piece in pieces[-ASKED_PIECES:].tolist():
            members = np.flatnonzero(graph.piece == piece)
            latest = members[-1] == len(graph.frames) - 1
            number = int(members[-1] if latest else members[len(graph.frames) % len(members)])
            known = np.flatnonzero(graph.piece == graph.piece[0])
            away = known[::AROUND_FRAMES]
            turn = len(graph.frames) * ASKED_PLACES
            others = [int(away[(turn + k) % len(away)]) for k in range(ASKED_PLACES)]
            beside = int(known[np.abs(known - members[0]).argmin()])
            for old in dict.fromkeys((beside, *others)):
                if self._join(old, number, graph.poses[number] if old == beside else None):
                    break

    def _join(self, old: int, number: int, near: Pose2 | None) -> bool:
        """Join the piece of a key frame to that of an old one, if it is seen from there.

        It is looked for near a pose, if that is given.
        """
        around = self._around(old, old + AROUND_FRAMES)
        begin = self._graph.poses[old].inverse() @ near if near else Pose2()
        query = self._query(number)
        match = around.find(
            query, self._graph.frames[number].beams, begin, way=JOINED_WAY, fit=JOINED_INLIERS
        )
        if match is None or match.ratio < LOOP_RATIO:
            return False
        edge = Edge(old, number, match.pose, certainty(match, LOOP_PRIOR), loop=True)
        return self._merge(edge)

    def _around(self, old: int, last: int) -> Vicinity:
        """Return the map around an old key frame, in its frame, up to another one."""
        graph, here = self._graph, self._graph.poses[old].inverse()
        numbers = graph.of_piece(old, old - AROUND_FRAMES, last + 1)
        return Vicinity(
            [graph.frames[k] for k in numbers], [here @ graph.poses[k] for k in numbers]
        )

    def _merge(self, edge: Edge) -> bool:
        """Make one piece of two by a loop, once another one agrees."""
        if not self._is_seconded(edge):
            self._waiting.append(edge)
            return False
        self._graph.merge(edge)
        return True

    def _is_seconded(self, edge: Edge) -> bool:
        """Whether another edge between two pieces, which waited for it, says the same."""
        graph = self._graph
        for other in self._waiting:
            apart = graph.piece[other.first] != graph.piece[other.second]
            independent = abs(graph.ways[other.second] - graph.ways[edge.second]) >= JOINED_APART
            if apart and independent and graph.agree(other, edge, LOOPS_APART):
                self._waiting.remove(other)
                graph.edges.append(other)
                return True
        return False

    def _take(self, edge: Edge) -> None:
        """Close a loop, or wait for another that agrees."""
        graph = self._graph
        moved, way = graph.error(edge), graph.ways[edge.second]
        alone = min(MOST_ALONE, ALONE_MOVE + ALONE_PER_WAY * (way - graph.closed))
        if graph.piece[edge.first] != graph.piece[edge.second]:
            self._merge(edge)
            return
        if hypot(moved.x, moved.y) < alone:
            graph.accept(edge, moved)
            return
        self._waiting = [e for e in self._waiting if way - graph.ways[e.second] < LOOPS_WAY]
        for other in self._waiting:
            if edge.second - other.second >= POOLED_FRAMES and graph.agree(other, edge, alone):
                self._waiting.remove(other)
                graph.edges.append(other)
                graph.accept(edge, moved)
                return
        self._waiting.append(edge)


def certainty(match: Match, prior: Float) -> Float:
    """Return the information of an edge by a match of its second robot, in that one's frame.

    The `prior` is information of what is known besides, in the frame of the match.
    """
    turn = np.eye(3)
    turn[:2, :2] = rotation(match.pose.theta)
    covariance = turn.T @ np.linalg.inv(match.information + prior) @ turn
    result: Float = np.linalg.inv(covariance + MATCH_FLOOR)
    return result
