"""Poses from the ways that were measured between them: Gauss-Newton's method, wrong loops apart."""

from collections.abc import Sequence

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import splu

from pioneer3.arrays import Float, Int
from pioneer3.nav.frames import Edge

PHI = 10.0
"""Squared error above which a loop, or a motion that odometry missed, is taken for partly wrong
[squared sigmas]."""
GRAPH_ROUNDS = 10
"""Rounds of the search at most."""
GRAPH_STEP = 1e-4
"""Step below which the search ends [m, rad]."""
GRAPH_PLAIN_ROUNDS = 2
"""Rounds in which all loops count in full, as far ends of a long way are far from each other."""


class _Graph:
    """The edges as arrays."""

    def __init__(self, edges: Sequence[Edge]) -> None:
        self.first = np.array([edge.first for edge in edges], dtype=np.int64)
        self.second = np.array([edge.second for edge in edges], dtype=np.int64)
        ways = [edge.second_in_first for edge in edges]
        self.way = np.array([(way.x, way.y, way.theta) for way in ways]).reshape(-1, 3)
        self.information = np.array([edge.information for edge in edges]).reshape(-1, 3, 3)
        self.doubtful = np.array([edge.loop or edge.missed for edge in edges], dtype=np.bool_)

    def errors(self, poses: Float) -> Float:
        """Return the errors in the frames of the seconds, shape (E, 3)."""
        a, b = poses[self.first], poses[self.second]
        apart = _turned(b[:, :2] - a[:, :2], -a[:, 2]) - self.way[:, :2]
        errors = np.empty((len(a), 3))
        errors[:, :2] = _turned(apart, -self.way[:, 2])
        errors[:, 2] = _wrapped(b[:, 2] - a[:, 2] - self.way[:, 2])
        return errors

    def jacobians(self, poses: Float) -> tuple[Float, Float]:
        """Return the derivatives of the errors by both poses, shape (E, 3, 3) each."""
        a, b = poses[self.first], poses[self.second]
        turn = -a[:, 2] - self.way[:, 2]
        c, s, apart = np.cos(turn), np.sin(turn), b[:, :2] - a[:, :2]
        second = np.zeros((len(a), 3, 3))
        second[:, 0, 0] = second[:, 1, 1] = c
        second[:, 0, 1], second[:, 1, 0] = -s, s
        second[:, 2, 2] = 1.0
        first = -second
        first[:, 0, 2] = s * apart[:, 0] + c * apart[:, 1]
        first[:, 1, 2] = -c * apart[:, 0] + s * apart[:, 1]
        return first, second


def optimized(
    poses: Float,
    edges: Sequence[Edge],
    *,
    held: int = 1,
    plain: int = GRAPH_PLAIN_ROUNDS,
    rounds: int = GRAPH_ROUNDS,
    small: float = GRAPH_STEP,
) -> Float:
    """Return the likeliest poses, shape (N, 3); the first `held` ones stay where they are.

    Loops, and motions that odometry missed, are weighted by dynamic covariance scaling (Agarwal et
    al., 2013), so that a wrong one does little harm; in `plain` rounds all count in full. An
    unbroken chain of edges that are no loops leads to each pose from the first. Steps below `small`
    [m, rad] end the search.
    """
    result = poses.copy()
    if len(result) <= held:
        return result
    graph = _Graph([edge for edge in edges if edge.first >= held or edge.second >= held])
    for number in range(rounds):
        step = _step(graph, result, held, robust=number >= plain)
        result[held:] += step
        if number >= plain and np.abs(step).max() < small:
            break
    result[held:, 2] = _wrapped(result[held:, 2])
    return result


def pieces_of(count: int, edges: Sequence[Edge]) -> Int:
    """Return the number of the piece of map of each of `count` poses, shape (N,).

    The places of poses in one piece are known to each other; torn edges part them.
    """
    ends = np.array([(e.first, e.second) for e in edges if not e.torn], dtype=np.int64)
    first, second = ends.reshape(-1, 2).T
    joined = coo_array((np.ones(len(first)), (first, second)), shape=(count, count))
    labels: Int = connected_components(joined, directed=False)[1]
    return labels


def _step(graph: _Graph, poses: Float, held: int, *, robust: bool) -> Float:
    """Return a step of Gauss-Newton's method for all poses but those held, shape (N - held, 3)."""
    errors, information = graph.errors(poses), graph.information
    if robust:
        squared = np.einsum("ei,eij,ej->e", errors, information, errors)
        scale = np.where(graph.doubtful, np.minimum(1.0, 2 * PHI / (PHI + squared)), 1.0)
        information = information * (scale**2)[:, None, None]
    count = len(poses) - held
    gradient = np.zeros((count, 3))
    rows, columns, values = [], [], []
    by_pose = tuple(
        zip((graph.first - held, graph.second - held), graph.jacobians(poses), strict=True)
    )
    for index, jacobian in by_pose:
        weighted = np.swapaxes(jacobian, 1, 2) @ information
        free = index >= 0
        np.add.at(gradient, index[free], -(weighted @ errors[:, :, None])[free, :, 0])
        for other, derivative in by_pose:
            both = free & (other >= 0)
            values.append((weighted[both] @ derivative[both]).ravel())
            rows.append(np.repeat(_numbers(index[both]), 3, axis=1).ravel())
            columns.append(np.tile(_numbers(other[both]), (1, 3)).ravel())
    place = np.concatenate(rows), np.concatenate(columns)
    matrix = coo_array((np.concatenate(values), place), shape=(3 * count, 3 * count)).tocsc()
    # the matrix is positive definite: pivots would only undo the order that leaves most zeros; for
    # blocks of three, supernodes that are filled up with zeros take three times as long
    solver = splu(
        matrix,
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        relax=1,
        options={"SymmetricMode": True},
    )
    step: Float = solver.solve(gradient.ravel()).reshape(-1, 3)
    return step


def _numbers(index: Int) -> Int:
    """Return the numbers of the three unknowns of each pose, shape (E, 3)."""
    return 3 * index[:, None] + np.arange(3)


def _turned(vectors: Float, angles: Float) -> Float:
    c, s = np.cos(angles), np.sin(angles)
    x, y = vectors[:, 0], vectors[:, 1]
    return np.stack([c * x - s * y, s * x + c * y], axis=1)


def _wrapped(angles: Float) -> Float:
    return np.arctan2(np.sin(angles), np.cos(angles))
