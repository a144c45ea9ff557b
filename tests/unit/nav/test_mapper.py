"""Maps from scans."""

import re
from dataclasses import replace
from itertools import pairwise
from math import hypot, pi, radians

import numpy as np
import pytest

from benchmarks.nav_drives import HARD
from benchmarks.nav_mapping import Trial
from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.nav.loops import ASKED_PASSES, JOINED_APART, RECENT_FRAMES
from pioneer3.nav.mapper import Mapper
from pioneer3.nav.particles import rows_of
from tests.unit.nav.halls import HALL, ROUND, look


def drifting(number: int) -> Pose2:
    """Return the odometry at a place of the way around: it turns too little, and bends."""
    pose = ORIGIN
    for before, after in pairwise(ROUND[: number + 1]):
        step = before.inverse() @ after
        pose @= Pose2(1.01 * step.x, step.y, 0.95 * step.theta + 0.004)
    return pose


def driven(*, improve: bool, rounds: int = 1) -> tuple[Mapper, list[float], list[Pose2]]:
    """Return a mapper after laps around the block.

    Returns:
        The mapper, its errors on the way [m], and the true poses at its key frames.
    """
    rng, mapper, errors = np.random.default_rng(1), Mapper(ROUND[0]), list[float]()
    kept = list[Pose2]()
    odom_before_lap = ORIGIN
    for lap in range(rounds):
        for number, place in enumerate(ROUND[lap > 0 :], start=int(lap > 0)):
            odometry = odom_before_lap @ drifting(number)
            beams = look(HALL, place, odometry, noise=0.005, rng=rng, count=181)
            here = mapper.add(beams)
            errors.append(hypot(here.x - place.x, here.y - place.y))
            kept += [place] * (len(mapper.survey.frames) - len(kept))
            if improve:
                mapper.improve()
        odom_before_lap = odom_before_lap @ drifting(len(ROUND) - 1)
        back = ROUND[-1].inverse() @ ROUND[0]
        odom_before_lap @= back
    return mapper, errors, kept


def test_it_knows_where_the_robot_is_though_odometry_drifts() -> None:
    mapper, errors, _ = driven(improve=False)
    assert max(errors) < 0.05
    odometry = ROUND[0] @ drifting(len(ROUND) - 1)
    assert hypot(odometry.x - ROUND[-1].x, odometry.y - ROUND[-1].y) > 0.2
    found = mapper.odom_in_map @ drifting(len(ROUND) - 1)
    assert found.x == pytest.approx(mapper.robot_in_map.x)
    assert mapper.inliers > 0.6


@pytest.mark.parametrize("continued", [False, True])
def test_it_finds_out_that_a_laser_is_mounted_askew(*, continued: bool) -> None:
    askew, mapper = radians(3), Mapper(Pose2(1.0, 1.5))
    way = [Pose2(1.0 + 0.1 * number, 1.5) for number in range(50)]
    for place in [*way, *reversed(way)] * 2:
        odometry = way[0].inverse() @ place
        mapper.add(look(HALL, place @ Pose2(0.0, 0.0, askew), odometry, count=181))
    if continued:
        mapper = Mapper.of(mapper.state)
    found = mapper.mounting_error
    assert found == pytest.approx(askew, abs=radians(0.5))
    (told,) = mapper.remarks(Pose2(0.16, 0.0, radians(1)))
    assert re.search(
        r"looks [23]\.\d degrees to the left of .* --laser-pose 0\.16,0,[34]\.\d mends it$", told
    )


def test_a_laser_that_looks_where_it_is_said_to_is_left_alone() -> None:
    mapper, _, _ = driven(improve=False)
    assert abs(mapper.mounting_error) < radians(0.5)
    assert mapper.remarks(ORIGIN) == ()


@pytest.mark.parametrize("told", [0.96, 1.03])
def test_a_corridor_is_as_long_as_it_is_though_wheels_tell_ways_wrong(told: float) -> None:
    room = [[0.0, 0.0, 6.0, 0.0], [0.0, 0.0, 0.0, 4.0], [0.0, 4.0, 6.0, 4.0]]
    door = [[6.0, 0.0, 6.0, 1.0], [6.0, 3.0, 6.0, 4.0]]
    corridor = [[6.0, y, 60.0, y] for y in (1.0, 3.0)]
    walls, rng, mapper = np.array(room + door + corridor), np.random.default_rng(4), Mapper()
    for x in [*np.linspace(1, 5, 25), *np.linspace(5, 1, 25), *np.linspace(1, 31, 180)]:
        seen = look(walls, Pose2(x, 2.0), Pose2(told * (x - 1)), noise=0.005, rng=rng)
        near = np.hypot(*seen.points.T) < 6.0
        mapper.add(replace(seen, points=seen.points[near]))
    assert mapper.robot_in_map.x == pytest.approx(30.0, abs=0.1)


def test_a_robot_that_stands_makes_no_key_frames() -> None:
    mapper = Mapper()
    for _ in range(5):
        mapper.add(look(HALL, Pose2(2.0, 1.5)))
    assert len(mapper.survey.frames) == 1


def test_between_scans_the_robot_moves_as_odometry_says() -> None:
    mapper = Mapper(Pose2(1.0, 2.0, pi / 2))
    mapper.add(look(HALL, Pose2(2.0, 1.5), Pose2(5.0, 5.0, 0.0)))
    mapper.move(Pose2(5.5, 5.0, 0.0))
    assert mapper.robot_in_map.x == pytest.approx(1.0)
    assert mapper.robot_in_map.y == pytest.approx(2.5)


def test_loops_are_found_and_right() -> None:
    mapper, errors, places = driven(improve=True, rounds=2)
    loops = [edge for edge in mapper.survey.edges if edge.loop]
    assert len(loops) >= 3
    for edge in loops:
        true = places[edge.first].inverse() @ places[edge.second]
        off = true.inverse() @ edge.second_in_first
        assert hypot(off.x, off.y) < 0.03
    assert max(errors) < 0.05


def test_a_step_of_the_search_for_loops_compares_one_place_at_most() -> None:
    mapper, _, _ = driven(improve=False, rounds=2)
    steps = 0
    while not mapper.snapshot.is_looked_through:
        before = sum(edge.loop for edge in mapper.survey.edges)
        mapper.apply(mapper.snapshot.improve())
        assert sum(edge.loop for edge in mapper.survey.edges) - before <= ASKED_PASSES
        steps += 1
    assert steps > 5


def test_a_loop_is_found_though_the_map_has_drifted_by_six_percent() -> None:
    mapper, _, places = driven(improve=False, rounds=2)
    survey, state = mapper.survey, mapper.state
    drifted = [
        Pose2(0.06 * frame.way) @ pose
        for frame, pose in zip(survey.frames, survey.poses, strict=True)
    ]
    ways = [drifted[edge.first].inverse() @ drifted[edge.second] for edge in survey.edges]
    again = Mapper.of(state | {"poses": rows_of(drifted), "edges": rows_of(ways)})
    again.improve()
    loops = [edge for edge in again.survey.edges if edge.loop]
    assert len(loops) >= 2
    for edge in loops:
        true = places[edge.first].inverse() @ places[edge.second]
        off = true.inverse() @ edge.second_in_first
        assert hypot(off.x, off.y) < 0.15


def test_what_was_added_while_a_thread_worked_moves_along() -> None:
    mapper, _, _ = driven(improve=False)
    snapshot, before = mapper.snapshot, mapper.survey.poses
    mapper.add(look(HALL, Pose2(2.5, 1.5), drifting(len(ROUND) - 1) @ Pose2(0.5)))
    added = len(mapper.survey.poses) - len(before)
    improvement = snapshot.improve()
    shift = Pose2(1.0, -2.0, 0.5)
    moved = replace(improvement, poses=tuple(shift @ pose for pose in improvement.poses))
    here = mapper.robot_in_map
    mapper.apply(moved)
    assert added == 1
    wanted = moved.poses[-1] @ before[-1].inverse() @ here
    assert (mapper.robot_in_map.x, mapper.robot_in_map.y) == pytest.approx((wanted.x, wanted.y))
    assert len(mapper.survey.poses) == len(before) + 1
    assert mapper.survey.edges[-1].second == len(before)


def moved_unnoticed(after: list[Pose2]) -> tuple[Mapper, list[Pose2]]:
    """Return a mapper of a robot that was carried from one way to another, and the true poses."""
    mapper, kept = Mapper(ROUND[0]), list[Pose2]()
    to_odometry = ROUND[0].inverse() @ ROUND[44] @ after[0].inverse()
    for number, place in enumerate([*ROUND[:45], *after]):
        odometry = (to_odometry if number >= 45 else ROUND[0].inverse()) @ place
        mapper.add(look(HALL, place, odometry, count=181))
        kept += [place] * (len(mapper.survey.frames) - len(kept))
        mapper.improve()
    return mapper, kept


def off(mapper: Mapper, true: list[Pose2]) -> float:
    """Return the largest error of a key frame [m]."""
    pairs = zip(mapper.survey.poses, true, strict=True)
    return max(hypot(pose.x - place.x, pose.y - place.y) for pose, place in pairs)


def test_a_robot_that_was_lifted_and_turned_is_found_at_once() -> None:
    begin = ROUND[44]
    move = Pose2(begin.x - 0.4, begin.y + 0.3) @ Pose2(0.0, 0.0, 2.0) @ Pose2(-begin.x, -begin.y)
    mapper, true = moved_unnoticed([move @ place for place in reversed(ROUND[25:45])])
    assert off(mapper, true) < 0.05
    assert mapper.pieces == 1
    weight = {edge.missed: edge.information[0, 0] for edge in mapper.survey.edges if not edge.loop}
    assert weight[True] < 0.1 * weight[False]
    assert "once unnoticed; the scans show" in mapper.remarks()[0]
    assert Mapper.of(mapper.state).remarks() == mapper.remarks()


def test_a_robot_that_was_carried_away_begins_a_piece_that_is_joined_later() -> None:
    mapper, true = moved_unnoticed([Pose2(place.x + 0.2, 1.2, 0.2) for place in ROUND[:25]])
    torn = [edge.second for edge in mapper.survey.edges if edge.torn]
    assert len(torn) == 1
    assert off(mapper, true) < 0.05
    ways = [frame.way for frame in mapper.survey.frames]
    loops = [edge for edge in mapper.survey.edges if edge.loop]
    joins = [edge for edge in loops if edge.first < torn[0] <= edge.second]
    assert abs(ways[joins[0].second] - ways[joins[1].second]) >= JOINED_APART
    assert "once unnoticed; the scans show" in mapper.remarks()[0]
    again = Mapper.of(mapper.state)
    assert (again.pieces, again.remarks()) == (1, mapper.remarks())


def test_wheels_that_turn_in_vain_are_told_once() -> None:
    mapper = Mapper(ROUND[0])
    for number, place in enumerate([ROUND[0]] * 5 + ROUND[1:20]):
        mapper.add(look(HALL, place, Pose2(0.25 * number), count=181))
    assert mapper.robot_in_map.x == pytest.approx(ROUND[19].x, abs=0.02)
    assert "once unnoticed" in mapper.remarks()[0]


@pytest.mark.parametrize("loops", [False, True])
def test_wheels_that_turn_in_vain_after_a_lift_are_not_believed(*, loops: bool) -> None:
    rng = np.random.default_rng(1)
    walls = [[-6.0, -1.2, 14.0, -1.2], [-6.0, 1.2, 14.0, 1.2]]
    for x in (-5.0 + np.cumsum(rng.uniform(0.6, 1.4, 18))).tolist():  # pillars
        walls += [[x, 1.2, x, 1.1], [x, 1.1, x + 0.4, 1.1], [x + 0.4, 1.1, x + 0.4, 1.2]]
    way = [Pose2(0.1 * number) for number in range(12)]
    lifted = Pose2(way[-1].x, 0.1, 0.7)
    true = [*way, *[lifted] * 6, *(lifted @ Pose2(0.05 * number) for number in range(1, 11))]
    rolled = [0.1 * number for number in range(12)]
    rolled += [1.1 + 0.08 * number for number in range(6)]
    rolled += [1.5 + 0.05 * number for number in range(1, 11)]
    mapper = Mapper()
    for place, metres in zip(true, rolled, strict=True):
        odometry, corridor = Pose2(metres), np.array(walls)
        here = mapper.add(look(corridor, place, odometry, noise=0.005, rng=rng, count=181))
        if loops and any(edge.missed for edge in mapper.survey.edges[-1:]):
            found = mapper.snapshot.improve()
            loop = replace(found.edges[-1], loop=True, missed=False)
            mapper.apply(replace(found, edges=(*found.edges, loop)))
    assert hypot(here.x - true[-1].x, here.y - true[-1].y) < 0.03


def test_a_piece_that_nothing_joins_is_told() -> None:
    mapper, elsewhere = Mapper(), HALL[:4] * 0.7
    for number in range(12):
        mapper.add(look(HALL, Pose2(2.0 + 0.25 * number, 1.5), Pose2(0.25 * number), count=181))
    for number in range(12, 24):
        place = Pose2(1.0 + 0.25 * (number - 12), 3.0, 0.1)
        mapper.add(look(elsewhere, place, Pose2(0.25 * number), count=181))
        mapper.improve()
    assert mapper.pieces == 2
    assert "2 pieces" in mapper.remarks()[0]
    assert Mapper.of(mapper.state).pieces == 2


def test_a_saved_map_is_continued_from_another_place() -> None:
    mapper, _, _ = driven(improve=True)
    state = {name: array.copy() for name, array in mapper.state.items()}
    again = Mapper.of(state, Pose2(6.3, 1.2, 0.2))
    assert len(again.survey.frames) == len(mapper.survey.frames)
    assert again.survey.poses == mapper.survey.poses
    place = Pose2(6.0, 1.5, 0.0)
    for number in range(RECENT_FRAMES + 20):
        step = Pose2(0.1 * number)
        true = place @ Pose2(min(step.x, 3.0))
        here = again.add(look(HALL, true, Pose2(min(step.x, 3.0)), count=181))
        assert hypot(here.x - true.x, here.y - true.y) < 0.05
    assert len(again.survey.frames) > len(mapper.survey.frames)


def test_a_state_survives_saving() -> None:
    mapper, _, _ = driven(improve=True)
    one, other = mapper.state, Mapper.of(mapper.state).state
    assert one.keys() == other.keys()
    for name, array in one.items():
        assert array == pytest.approx(other[name]), name


def test_an_empty_map_can_be_saved() -> None:
    mapper = Mapper.of(Mapper().state)
    assert mapper.add(look(HALL, Pose2(2.0, 1.5))) == ORIGIN


@pytest.mark.thorough
def test_after_a_gap_a_scan_that_fits_elsewhere_as_well_is_where_odometry_has_it() -> None:
    # somebody hides half of the room when a robot that has driven a metre without a scan sees again
    outcome = Trial(name="office", conditions=HARD, seconds=180.0, seed=7205).run()
    assert outcome is not None
    assert outcome.errors.max() < 0.05
