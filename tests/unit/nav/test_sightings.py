"""Things that are not on the map."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from pioneer3.geometry import Pose2
from pioneer3.nav.beams import Beams
from pioneer3.nav.costs import COST_CELL
from pioneer3.nav.echoes import BODY_RADIUS, ECHO_AGE, ECHO_DOUBT
from pioneer3.nav.mover import OFTEN, Mover
from pioneer3.nav.moving import PEOPLE_TIME, PERSON_RADIUS
from pioneer3.nav.sightings import (
    COMING_WAY,
    LOOK,
    PASSING_TIME,
    STANDING_TIME,
    Sightings,
)
from tests.unit.nav.offices import costs, room

Float = NDArray[np.float64]
HERE = Pose2(2.0, 3.0, 0.0)


def beams(stamp: float, *points: tuple[float, float], clear: tuple[float, float] = (0, 0)) -> Beams:
    """Return a scan with two echoes at each point of the robot's frame, beside each other."""
    twice = [(x, y + aside) for x, y in points for aside in (0.0, 0.02)]
    return Beams(
        stamp=stamp,
        robot_in_odom=Pose2(),
        points=np.array(twice, dtype=np.float64).reshape(-1, 2),
        clear=np.array([clear] if any(clear) else [], dtype=np.float64).reshape(-1, 2),
        origin=np.array([0.1, 0.0]),
        far=30.0,
    )


@pytest.fixture
def sightings() -> Sightings:
    return Sightings(costs(room()))


def test_echoes_that_no_wall_explains_are_noted(sightings: Sightings) -> None:
    sightings.take(beams(5.0, (3.0, 0.0), (-1.95, 0.0)), HERE)  # the other one is the wall
    assert sightings.points(6.0) == pytest.approx(np.array([[5.0, 3.0]]), abs=0.05)
    assert sightings.seen_at(5.1, 3.0, 0.3) == 5.0
    assert sightings.seen_at(8.0, 3.0, 0.3) is None


def test_a_thing_that_a_beam_passes_has_gone(sightings: Sightings) -> None:
    sightings.take(beams(5.0, (3.0, 0.0)), HERE)
    sightings.take(beams(6.0, (4.5, 0.0)), HERE)
    assert sightings.points(6.0) == pytest.approx(np.array([[6.5, 3.0]]), abs=0.05)
    sightings.take(beams(7.0, clear=(30.0, 0.0)), HERE)
    assert not len(sightings.points(7.0))


def test_a_beam_clears_nothing_right_before_its_echo(sightings: Sightings) -> None:
    sightings.take(beams(5.0, (3.0, 0.0)), HERE)
    sightings.take(beams(6.0, (3.1, 0.0)), HERE)
    assert len(sightings.points(6.0)) == 2


def test_old_things_do_not_count(sightings: Sightings) -> None:
    sightings.take(beams(5.0, (3.0, 0.0)), HERE)
    assert len(sightings.points(5.0 + PEOPLE_TIME))
    assert not len(sightings.points(5.1 + PEOPLE_TIME))


def test_far_things_are_not_noted(sightings: Sightings) -> None:
    sightings.take(beams(5.0, (7.0, 0.5)), HERE)
    assert not len(sightings.points(5.0))


def test_everything_can_be_forgotten(sightings: Sightings) -> None:
    sightings.take(beams(5.0, (3.0, 0.0)), HERE)
    sightings.forget()
    assert not len(sightings.points(5.0))


def stray(stamp: float, x: float, y: float, theta: float = 0.0) -> Beams:
    """Return a scan with a wall and an echo that stands alone."""
    wall = [(-1.95, 0.1 * n) for n in range(10)]
    scan = beams(stamp, *wall)
    points = np.array([*scan.points.tolist(), (x, y)])
    return replace(scan, points=points, robot_in_odom=Pose2(theta=theta))


def test_an_echo_that_stands_alone_is_believed_the_second_time(sightings: Sightings) -> None:
    sightings.take(stray(5.0, 3.0, 0.0), HERE)
    assert not len(sightings.points(5.0))
    latest = sightings.latest(5.0)
    assert latest is not None
    assert len(latest) == 20
    sightings.take(stray(5.1, 1.0, 0.5), HERE)
    assert not len(sightings.points(5.1))
    sightings.take(stray(5.2, 1.02, 0.5), HERE)
    assert sightings.points(5.2) == pytest.approx(np.array([[3.02, 3.5]]), abs=0.05)
    assert sightings.latest(6.0) is None


def test_far_echoes_beside_walls_are_of_the_walls(sightings: Sightings) -> None:
    """Odometry is late, so that walls seem to be beside where they are while the robot turns."""
    for x, count in ((4.5, 0), (1.0, 1)):  # 33 cm before the upper wall
        sightings.take(beams(5.0, (x, 2.75 - 0.33)), HERE)
        assert len(sightings.points(5.0)) == count


AXIS = np.array([[0.2, 0.0, 0.0]])
"""A sonar that listens ahead."""


def hear(sightings: Sightings, metres: float, at: Pose2, now: float) -> None:
    sightings.hear(AXIS, np.array([metres]), at, now)


def test_glass_that_only_sonars_hear_is_kept_clear_of_and_planned_around(
    sightings: Sightings,
) -> None:
    for now in (5.0, 5.1, 5.2):
        sightings.take(beams(now, (5.0, 0.0)), HERE)  # the laser looks through it
        hear(sightings, 0.8, HERE, now)
    assert sightings.echoes.near(2.5, 3.0, 1.0, 5.2) == pytest.approx(np.array([[3.0, 3.0]]))
    assert any(np.hypot(*(point - (3.0, 3.0))) < 0.05 for point in sightings.points(5.2))


def test_a_single_echo_of_a_sonar_changes_no_plan(sightings: Sightings) -> None:
    hear(sightings, 0.8, HERE, 5.0)
    assert not len(sightings.points(5.0))


def test_the_echo_of_a_wall_of_the_map_is_no_thing(sightings: Sightings) -> None:
    by_the_wall = Pose2(9.0, 3.0, 0.0)
    for now in (5.0, 5.1, 5.2):
        hear(sightings, 0.8, by_the_wall, now)
    assert not len(sightings.points(5.2))
    assert not len(sightings.echoes.near(9.0, 3.0, 1.5, 5.2))


def test_the_echo_of_a_thing_that_the_laser_sees_is_no_other_thing(sightings: Sightings) -> None:
    beside = (1.0, 0.16)
    for now in (5.0, 5.1, 5.2):
        sightings.take(beams(now, beside), HERE)
        hear(sightings, 0.8, HERE, now)
    assert sightings.points(5.2) == pytest.approx(np.array([[3.0, 3.17]]), abs=0.05)


def test_far_echoes_are_points_and_close_no_door(sightings: Sightings) -> None:
    hear(sightings, 1.2, HERE, 5.0)
    assert sightings.echoes.near(3.4, 3.0, 1.0, 5.0) == pytest.approx(np.array([[3.4, 3.0]]))


def test_who_comes_nearer_is_where_the_last_echo_was(sightings: Sightings) -> None:
    for now, metres in ((5.0, 0.8), (5.2, 0.6), (5.4, 0.4)):
        hear(sightings, metres, HERE, now)
    arc = sightings.echoes.near(2.5, 3.0, 2.0, 5.4)
    assert np.hypot(*(arc - (2.2, 3.0)).T).min() == pytest.approx(0.4)
    hear(sightings, 0.7, HERE, 5.6)
    arc = sightings.echoes.near(2.5, 3.0, 2.0, 5.6)
    assert np.hypot(*(arc - (2.2, 3.0)).T).min() == pytest.approx(0.7)
    assert not len(sightings.echoes.near(2.5, 3.0, 2.0, 9.0))


def test_what_a_sonar_does_not_hear_any_more_has_gone(sightings: Sightings) -> None:
    for now in (5.0, 5.1, 5.2):
        hear(sightings, 0.8, HERE, now)
    hear(sightings, np.inf, HERE, 5.3)
    assert not len(sightings.points(5.3))


def walk_by(sightings: Sightings) -> None:
    """Let somebody walk past, far enough from the sonar's beam."""
    for step in range(15):
        y = -1.0 + 0.08 * step
        legs = [(2.5, y + side + off) for side in (-0.12, 0.12) for off in (-0.04, 0.0, 0.04)]
        sightings.take(beams(5.0 + 0.1 * step, *legs), HERE)


@pytest.mark.parametrize("people", [False, True])
def test_where_people_are_a_near_echo_may_be_of_a_body(sightings: Sightings, people: bool) -> None:
    if people:
        walk_by(sightings)
    hear(sightings, 0.4, HERE, 6.5)
    bodies = sightings.echoes.bodies(6.5)
    assert len(bodies) == (3 if people else 0)
    if people:  # the nearest point of each is as far from the sonar as the echo
        away = np.hypot(*(bodies - (HERE.x + AXIS[0, 0], HERE.y)).T)
        assert away - BODY_RADIUS == pytest.approx(0.4)
    assert not len(sightings.echoes.bodies(6.5 + 2 * ECHO_AGE))


def test_plans_forget_what_sonars_heard_sooner_where_people_are(sightings: Sightings) -> None:
    for now in (5.0, 5.1, 5.2):
        hear(sightings, 0.8, HERE, now)
    assert len(sightings.points(5.2 + 2 * ECHO_AGE))
    sightings.movers.met = 5.2
    assert not len(sightings.points(5.2 + 2 * ECHO_AGE))
    assert len(sightings.points(5.2 + ECHO_AGE / 2))


def test_who_walks_leaves_nothing_behind_that_plans_avoid(sightings: Sightings) -> None:
    walk_by(sightings)
    assert len(sightings.movers.walking()) == 1
    assert not len(sightings.points(6.4))


def test_a_walker_who_stands_is_planned_around_unless_it_is_the_only_way(
    sightings: Sightings,
) -> None:
    come_and_stand(sightings, 2.0 + STANDING_TIME)
    assert not len(sightings.points(7.0 + STANDING_TIME - 2.0))
    assert len(sightings.points(7.0 + STANDING_TIME)) > 5
    assert not len(sightings.points(7.0 + STANDING_TIME, people=False))


def come_and_stand(sightings: Sightings, seconds: float) -> None:
    """Let somebody come from the right, from second 5 on, and stand ahead of the robot."""
    for step in range(round(seconds / 0.1)):
        y = -1.0 + 0.08 * min(step, 15)
        legs = [(2.5, y + side + off) for side in (-0.12, 0.12) for off in (-0.04, 0.0, 0.04)]
        sightings.take(beams(5.0 + 0.1 * step, *legs), HERE)


def test_the_line_on_which_somebody_comes_or_turns_back_is_told(sightings: Sightings) -> None:
    come_and_stand(sightings, 1.5)
    [(x, y, to_x, to_y)] = sightings.lines(6.5).tolist()
    assert ((x + to_x) / 2, (y + to_y) / 2) == pytest.approx((4.5, 3.1), abs=0.2)
    assert (to_x - x, to_y - y) == pytest.approx((0.0, 2 * COMING_WAY), abs=3.0)
    assert not len(sightings.lines(6.5 + PASSING_TIME))


def test_who_comes_to_a_wall_goes_on_along_it(sightings: Sightings) -> None:
    way = sightings.way_of((8.0, 4.5), (1.0, 0.2))
    assert way[0] == pytest.approx((8.0, 4.5))
    assert (way[:, 0] < 10.0 - PERSON_RADIUS + 0.05).all()
    assert (way[:, 1] < 6.0 - PERSON_RADIUS + 0.05).all()
    assert np.hypot(*np.diff(way, axis=0).T).max() < 0.11
    assert way[-1, 1] > way[0, 1] + 0.5
    assert len(sightings.way_of((9.95, 5.95), (1.0, 1.0))) < 20  # a corner: nobody goes on


def test_echoes_outside_of_people_may_be_legs(sightings: Sightings) -> None:
    come_and_stand(sightings, 2.0)
    people = sightings.movers.discs(6.9)
    assert not len(sightings._legs(people, 6.9))
    assert len(sightings._legs(people[:0], 6.9))
    assert not len(sightings._legs(people[:0], 9.0))
    beside = people + np.array([0.0, 0.4, 0.0, 0.0, 0.0])
    assert len(sightings._legs(np.concatenate([people, beside]), 6.9))  # of either of the two


@pytest.mark.parametrize(("people", "scans", "stays"), [(True, 1, 0), (True, 6, 1), (False, 1, 1)])
def test_where_people_are_what_was_seen_once_may_have_passed(
    sightings: Sightings, people: bool, scans: int, stays: int
) -> None:
    for n in range(scans):
        sightings.take(beams(5.0 + 0.1 * n, (1.0, 0.0), (1.0, 0.02)), HERE)
    now = 5.0 + 0.1 * scans
    sightings.movers.met = now if people else -np.inf
    assert len(sightings.points(now)) == 1
    assert len(sightings.points(now + 2 * PASSING_TIME)) == stays
    assert len(sightings.near(3.0, 3.0, 1.0, now + 2 * PASSING_TIME)) == stays


def test_nothing_is_where_the_robot_stands(sightings: Sightings) -> None:
    sightings.take(beams(5.0, (1.0, 0.0), (1.0, 0.02)), HERE)
    assert len(sightings.points(5.0))
    sightings.take(beams(6.0), HERE @ Pose2(0.9, 0.05, 2.0))
    assert not len(sightings.points(6.0))


@pytest.mark.parametrize("people", [True, False])
def test_where_people_are_what_was_seen_long_ago_explains_no_echo(
    sightings: Sightings, people: bool
) -> None:
    sightings.take(beams(5.0, (0.6, 0.0), (0.6, 0.02)), HERE)
    sightings.movers.met = 5.0 if people else -np.inf
    hear(sightings, 0.4, HERE, 5.1)
    assert not len(sightings.echoes.near(3.0, 3.0, 1.0, 5.1))
    hear(sightings, 0.4, HERE, 8.0)
    assert bool(len(sightings.echoes.near(3.0, 3.0, 1.0, 8.0))) is people


def test_sonars_tell_who_has_gone_behind_the_robot(sightings: Sightings) -> None:
    walk_by(sightings)
    away = HERE @ Pose2(0.5, 0.0, np.pi)
    sightings.take(beams(6.5, (2.0, 0.0), (2.0, 0.02)), away)
    [person] = sightings.movers.people()
    x, y = person.at(7.0)
    bearing = float(np.arctan2(y - away.y, x - away.x))
    towards = np.array([[0.0, 0.0, bearing - np.pi]])
    for n in range(OFTEN):
        assert sightings.movers.people()
        sightings.hear(towards, np.array([np.inf]), away, 7.0 + 0.1 * n)
    assert not sightings.movers.people()


def test_one_sonar_does_not_clear_what_another_hears_in_the_same_report(
    sightings: Sightings,
) -> None:
    two = np.array([[0.2, 0.0, 0.0], [0.2, 0.0, 0.05]])
    for ranges in ([0.4, 0.8], [0.8, 0.4]):
        sightings.hear(two, np.array(ranges), HERE, 5.0)
        assert len(sightings.echoes.near(3.0, 3.0, 2.0, 5.0)) == 6  # an arc, and a middle


def test_what_passes_once_a_thing_has_gone_is_new(sightings: Sightings) -> None:
    place = (1.0, 0.0), (1.0, 0.02)
    for n in range(6):
        sightings.take(beams(5.0 + 0.1 * n, *place), HERE)
    sightings.take(beams(6.0), HERE @ Pose2(1.0, 0.0, 2.0))  # the robot stands there
    sightings.take(beams(7.0, *place), HERE)
    sightings.movers.met = 7.0
    assert not len(sightings.points(7.0 + 2 * PASSING_TIME))


def test_what_steers_a_robot_is_one_point_of_each_cell_but_none_of_people() -> None:
    rng, sightings = np.random.default_rng(3), Sightings(costs(room()))
    walls, seen = rng.uniform(0.0, 6.0, (3000, 2)), rng.uniform(2.0, 4.0, (50, 2))
    x, y, now = 3.0, 2.5, 1.0
    sightings.movers.things.append(Mover(3.5, 2.5, 0.0, 0.0, now, (3.5, 2.5, now), walks=True))
    found = sightings.obstacles(x, y, walls, seen, now)
    points = np.concatenate([walls, seen])
    points = points[np.hypot(*(points - (x, y)).T) < LOOK]
    apart = np.hypot(*(points - (3.5, 2.5)).T) > PERSON_RADIUS + ECHO_DOUBT
    cells = np.round((points[apart] - (x, y)) / COST_CELL).astype(int)
    _, first = np.unique(cells, axis=0, return_index=True)
    expected = points[apart][np.sort(first)]
    assert found[:-1, :2] == pytest.approx(expected, abs=0.0)
    assert found[-1].tolist() == [3.5, 2.5, 0.0, 0.0, PERSON_RADIUS]
