"""The pose graph."""

from collections.abc import Sequence
from math import hypot, pi

import numpy as np
import pytest

from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.nav.frames import Edge
from pioneer3.nav.graph import GRAPH_ROUNDS, GRAPH_STEP, PHI, _Graph, optimized
from pioneer3.nav.particles import rows_of

ODOMETRY = np.diag([1e3, 1e3, 1e4])
LOOP = np.diag([1e4, 1e4, 1e5])


def solved(
    guesses: Sequence[Pose2], edges: list[Edge], *, held: int = 1, precise: bool = False
) -> list[Pose2]:
    """Return the likeliest poses."""
    rounds, small = (50, 1e-8) if precise else (GRAPH_ROUNDS, GRAPH_STEP)
    rows = optimized(rows_of(guesses), edges, held=held, rounds=rounds, small=small)
    return [Pose2(*row) for row in rows.tolist()]


def square(seed: int, laps: int = 2) -> tuple[list[Pose2], list[Pose2], list[Edge]]:
    """Return true poses, drifting guesses and the edges of laps around a square."""
    rng = np.random.default_rng(seed)
    truth, guesses, edges = [ORIGIN], [ORIGIN], list[Edge]()
    for number in range(40 * laps):
        way = Pose2(0.5, 0.0, pi / 2 if number % 10 == 9 else 0.0)
        truth.append(truth[-1] @ way)
        noise = rng.standard_normal(3) * (0.02, 0.02, 0.01)
        measured = way @ Pose2(*noise.tolist())
        guesses.append(guesses[-1] @ measured)
        edges.append(Edge(number, number + 1, measured, ODOMETRY))
    for number in range(40, 40 * laps + 1, 3):
        way = truth[number - 40].inverse() @ truth[number]
        noise = rng.standard_normal(3) * (0.01, 0.01, 0.003)
        edges.append(Edge(number - 40, number, way @ Pose2(*noise.tolist()), LOOP, loop=True))
    return truth, guesses, edges


def worst(a: list[Pose2], b: list[Pose2]) -> float:
    return max(hypot(p.x - q.x, p.y - q.y) for p, q in zip(a, b, strict=True))


def squared_errors(poses: Sequence[Pose2], edges: list[Edge]) -> float:
    """Return how far poses are from what the edges say [squared sigmas]."""
    graph = _Graph(edges)
    errors = graph.errors(rows_of(poses))
    return float(np.einsum("ei,eij,ej->", errors, graph.information, errors))


def test_loops_take_the_drift_out() -> None:
    truth, guesses, edges = square(1)
    found = solved(guesses, edges)
    assert found[0] == guesses[0]
    assert squared_errors(found, edges) < squared_errors(guesses, edges) / 10
    first, last = found[0], found[80]
    assert hypot(first.x - last.x, first.y - last.y) < 0.05
    assert worst(found, truth) < worst(guesses, truth)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_it_agrees_with_gtsam(seed: int) -> None:
    gtsam = pytest.importorskip("gtsam")
    _, guesses, edges = square(seed)
    graph, values = gtsam.NonlinearFactorGraph(), gtsam.Values()
    fixed = gtsam.noiseModel.Isotropic.Sigma(3, 1e-9)
    graph.add(gtsam.PriorFactorPose2(0, gtsam.Pose2(0, 0, 0), fixed))
    for edge in edges:
        way = edge.second_in_first
        model = gtsam.noiseModel.Gaussian.Information(edge.information)
        if edge.loop:
            kernel = gtsam.noiseModel.mEstimator.DCS.Create(PHI)
            model = gtsam.noiseModel.Robust.Create(kernel, model)
        measured = gtsam.Pose2(way.x, way.y, way.theta)
        graph.add(gtsam.BetweenFactorPose2(edge.first, edge.second, measured, model))
    for number, pose in enumerate(guesses):
        values.insert(number, gtsam.Pose2(pose.x, pose.y, pose.theta))
    result = gtsam.LevenbergMarquardtOptimizer(graph, values).optimize()
    theirs = [result.atPose2(number) for number in range(len(guesses))]
    ours = solved(guesses, edges, precise=True)
    assert max(hypot(p.x - q.x(), p.y - q.y()) for p, q in zip(ours, theirs, strict=True)) < 2e-3


def test_a_wrong_loop_does_little_harm() -> None:
    truth, guesses, edges = square(2)
    right = solved(guesses, edges)
    wrong = Edge(5, 60, Pose2(3.0, -2.0, 1.0), LOOP, loop=True)
    found = solved(guesses, [*edges, wrong])
    assert worst(found, right) < 0.05
    assert worst(found, truth) < 0.5


def test_one_pose_stays_where_it_is() -> None:
    assert solved([Pose2(1.0, 2.0, 3.0)], []) == [Pose2(1.0, 2.0, 3.0)]


def test_poses_that_are_held_stay_and_the_others_take_the_drift() -> None:
    truth, guesses, edges = square(1)
    settled = solved(guesses[:61], [edge for edge in edges if edge.second <= 60], precise=True)
    onwards = [settled[60] @ (guesses[60].inverse() @ pose) for pose in guesses[61:]]
    found = solved([*settled, *onwards], edges, held=41, precise=True)
    assert found[:41] == settled[:41]
    assert squared_errors(found, edges) < squared_errors([*settled, *onwards], edges) / 2
    assert worst(found, truth) < worst([*settled, *onwards], truth)
