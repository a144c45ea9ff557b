"""People in scans: where they are, and how fast they walk."""

from math import hypot, inf, pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from pioneer3.geometry import Pose2
from pioneer3.nav.mover import MEMORY_TIME, OFTEN
from pioneer3.nav.moving import PEOPLE_TIME, PERSON_RADIUS, Movers
from tests.combinations import examples

Float = NDArray[np.float64]
LASER = np.zeros(2)
AHEAD = np.array([0.0, pi / 2])
"""The laser looks along x, and sees a half circle."""
DT = 0.1


def legs(x: float, y: float) -> Float:
    """Return the echoes of somebody's two legs, each a small arc, from right to left."""
    arc = np.linspace(-1.0, 1.0, 5)[:, None] * (0.0, 0.04)
    return np.concatenate([arc + np.array((x, y + side)) for side in (-0.12, 0.12)])


def box(x: float, y: float) -> Float:
    return np.stack([np.full(10, x), np.linspace(y - 0.2, y + 0.2, 10)], axis=1)


def walk(movers: Movers, begin: tuple[float, float], velocity: tuple[float, float], n: int) -> None:
    for step in range(n):
        x, y = (p + v * DT * step for p, v in zip(begin, velocity, strict=True))
        movers.take(legs(x, y), LASER, AHEAD, DT * step)


@settings(deadline=None, max_examples=examples(30))
@given(st.floats(2.0, 3.0), st.floats(-1.0, 1.0), st.floats(0.4, 1.2), st.floats(-pi, pi))
def test_who_walks_has_a_place_and_a_velocity(
    x: float, y: float, speed: float, heading: float
) -> None:
    movers, velocity = Movers(), (speed * np.cos(heading), speed * np.sin(heading))
    walk(movers, (x, y), velocity, 16)
    [person] = movers.walking()
    assert (person.x, person.y) == pytest.approx(
        (x + 1.5 * velocity[0], y + 1.5 * velocity[1]), abs=0.15
    )
    assert (person.vx, person.vy) == pytest.approx(velocity, abs=0.25)
    assert movers.discs(1.5)[0, 4] == PERSON_RADIUS


def test_the_echoes_of_who_walks_are_told_apart_from_a_box() -> None:
    movers = Movers()
    for step in range(12):
        points = np.concatenate([box(2.0, -1.0), legs(3.0 - 0.08 * step, 1.0)])
        own = movers.take(points, LASER, AHEAD, DT * step)
    assert set(own.tolist()) == set(range(10, 20))


def test_a_box_never_walks_and_is_nobody() -> None:
    movers = Movers()
    for step in range(30):
        movers.take(box(2.0, 0.01 * (step % 2)), LASER, AHEAD, DT * step)
    assert not movers.people()


def test_a_strip_of_a_box_at_the_edge_of_the_view_is_nobody() -> None:
    movers, strip = Movers(), np.stack([np.full(5, 0.03), np.linspace(0.9, 1.0, 5)], axis=1)
    for step in range(2 * OFTEN):
        movers.take(strip, LASER, AHEAD, DT * step)
    assert len(movers.things) == 1
    assert not movers.people()


def test_who_stands_on_legs_is_a_person_before_they_walk() -> None:
    movers = Movers()
    walk(movers, (2.0, 0.0), (0.0, 0.0), OFTEN + 2)
    assert len(movers.people()) == 1
    assert not movers.walking()


def test_who_stops_stands_where_they_stopped() -> None:
    movers = Movers()
    walk(movers, (3.0, 0.0), (-0.8, 0.0), 15)
    for step in range(15, 30):
        movers.take(legs(3.0 - 0.8 * 1.4, 0.0), LASER, AHEAD, DT * step)
    [person] = movers.walking()
    assert person.stands is not None
    assert movers.discs(3.0)[0, 2:4].tolist() == [0.0, 0.0]


def test_two_who_meet_stay_two() -> None:
    movers = Movers()
    for step in range(30):
        away = max(0.3, 1.5 - 0.08 * step)
        points = np.concatenate([legs(2.5, -away), legs(2.5, away)])
        movers.take(points, LASER, AHEAD, DT * step)
    assert len(movers.walking()) == 2


def test_who_is_behind_the_laser_is_remembered_for_a_while() -> None:
    movers = Movers()
    walk(movers, (2.0, 0.0), (-0.8, 0.0), 15)
    nothing, behind = np.empty((0, 2)), np.array([pi, pi / 2])
    movers.take(nothing, LASER, behind, 5.0)
    assert len(movers.walking()) == 1
    movers.take(nothing, LASER, behind, 1.6 + MEMORY_TIME)
    assert not movers.walking()


def test_who_is_not_where_the_laser_looks_has_gone() -> None:
    movers = Movers()
    walk(movers, (3.0, 0.0), (-0.8, 0.0), 15)
    movers.take(np.empty((0, 2)), LASER, AHEAD, 2.5)
    assert not movers.things


def crowd(x: float, y: float) -> Float:
    """Return the echoes of two people who stand in each other: a blot as wide as no leg is."""
    return np.stack([np.full(12, x), np.linspace(y - 0.25, y + 0.25, 12)], axis=1)


def meet(movers: Movers) -> None:
    """Let somebody walk up to another one who stands, until both are one thing to the laser."""
    walk(movers, (2.0, 0.0), (0.0, 0.0), OFTEN + 2)
    for step in range(20):
        away = max(0.0, 1.2 - 0.08 * step)
        points = np.concatenate([legs(2.0, 0.0), legs(2.02, away)]) if away > 0.2 else crowd(2, 0)
        movers.take(points, LASER, AHEAD, DT * (OFTEN + 2 + step))


def test_two_who_stand_in_each_other_stay_people_though_they_look_like_none() -> None:
    movers = Movers()
    meet(movers)
    for step in range(30):
        movers.take(crowd(2.0, 0.0), LASER, AHEAD, 3.0 + DT * step)
    [person] = movers.people()
    assert person.holds_two(6.0)
    assert movers.discs(6.0)[0, 4] > PERSON_RADIUS


def test_who_steps_out_of_two_is_a_person_at_once() -> None:
    movers = Movers()
    meet(movers)
    for step in range(4):
        points = np.concatenate([legs(2.0, 0.0), legs(2.0, 0.5 + 0.08 * step)])
        movers.take(points, LASER, AHEAD, 3.0 + DT * step)
    assert len(movers.people()) == 2


def test_who_looks_like_no_person_any_more_is_believed_for_a_while() -> None:
    movers = Movers()
    walk(movers, (2.0, 0.0), (0.0, 0.0), OFTEN + 2)
    for step in range(OFTEN + 2, round(MEMORY_TIME / DT) + 2 * OFTEN):
        movers.take(crowd(2.0, 0.0), LASER, AHEAD, DT * step)
        assert bool(movers.people()) or DT * step > MEMORY_TIME
    assert not movers.people()
    assert len(movers.doubtful) == 12  # they may be legs for as long as people are about
    movers.take(crowd(2.0, 0.0), LASER, AHEAD, DT * step + PEOPLE_TIME)
    assert not len(movers.doubtful)


def test_people_who_step_on_stay_people_though_they_look_like_none() -> None:
    movers = Movers()
    walk(movers, (2.0, 0.0), (0.0, 0.0), OFTEN + 2)
    for step in range(OFTEN + 2, round(2 * MEMORY_TIME / DT)):
        came = 0.02 * min(max(step - 100, 0), 10)  # 20 cm in a second: less than a walker's way
        movers.take(crowd(2.0 - came, 0.0), LASER, AHEAD, DT * step)
        assert bool(movers.people()) or DT * step > MEMORY_TIME + 10
    assert not movers.walking()


@pytest.mark.parametrize("about", [False, True])
def test_a_new_thing_may_be_legs_where_people_are_and_an_old_one_is_none(*, about: bool) -> None:
    movers = Movers()
    for step in range(round(PEOPLE_TIME / DT) + 2):
        movers.met = DT * step if about else -inf
        movers.take(crowd(2.0, 0.0), LASER, AHEAD, DT * step)
        assert len(movers.doubtful) == (12 if DT * step < PEOPLE_TIME and about else 0)


def test_what_is_beside_somebody_may_be_legs() -> None:
    movers = Movers()
    old = round(PEOPLE_TIME / DT)
    for step in range(old + 2 * OFTEN):
        near = [legs(2.0, 0.7)] if step > old else []
        movers.take(np.concatenate([box(2.0, 0.0), *near]), LASER, AHEAD, DT * step)
    assert {(2.0, -0.2), (2.0, 0.2)} & {tuple(each) for each in movers.doubtful.round(6).tolist()}


AWAY = np.array([pi, pi / 2])
"""The laser looks the other way."""
EAR = Pose2()
"""A sonar at the laser, that listens along x."""
BEHIND = np.array([[-3.0, 0.0], [-3.0, 0.02]])
"""What the laser sees when it looks the other way."""


def turn_away_from_somebody() -> Movers:
    movers = Movers()
    walk(movers, (2.0, 0.0), (-0.4, 0.0), 20)
    movers.take(BEHIND, LASER, AWAY, 3.0)
    assert len(movers.people()) == 1
    return movers


def test_who_has_gone_behind_the_robot_is_forgotten_once_sonars_hear_past_them() -> None:
    movers = turn_away_from_somebody()
    for n in range(OFTEN):
        assert movers.people()
        movers.hear(EAR, 2.5, 3.0 + 0.2 * n)
    assert not movers.people()


def test_sonars_that_listen_elsewhere_or_to_something_nearer_tell_nothing() -> None:
    movers = turn_away_from_somebody()
    for n in range(2 * OFTEN):
        movers.hear(Pose2(theta=0.5), 2.5, 3.0 + 0.2 * n)
        movers.hear(Pose2(theta=pi), 2.5, 3.0 + 0.2 * n)
        movers.hear(EAR, 0.3, 3.0 + 0.2 * n)
    [person] = movers.people()
    assert (person.missed, person.heard) == (0, -np.inf)


def test_a_missed_echo_between_others_is_a_mistake() -> None:
    movers = turn_away_from_somebody()
    for n in range(4 * OFTEN):
        movers.hear(EAR, 5.0 if n % OFTEN else 0.95, 3.0 + 0.2 * n)
    assert movers.people()


def test_whom_sonars_hear_stays_for_as_long_as_they_stand_there() -> None:
    for heard in (False, True):
        movers = turn_away_from_somebody()
        for step in range(round(2 * MEMORY_TIME / DT)):
            now = 3.0 + DT * step
            if heard and step % 4 == 0:
                movers.hear(EAR, 0.95, now)
            movers.take(BEHIND, LASER, AWAY, now)
        assert bool(movers.people()) is heard


def test_who_was_just_met_close_by_is_not_forgotten_at_once() -> None:
    movers = Movers()
    walk(movers, (0.7, 0.0), (0.0, 0.0), OFTEN + 2)
    movers.take(BEHIND, LASER, AWAY, 2.0)
    assert len(movers.people()) == 1


@pytest.mark.parametrize("beyond", [1.4, 1.5])
def test_who_is_at_the_edge_of_the_view_does_not_go_because_one_leg_does(beyond: float) -> None:
    movers = Movers()
    walk(movers, (0.7, 0.0), (0.0, 0.0), 20)
    away = np.array([beyond, pi / 2])  # the laser turns: only the left leg is in view
    for step in range(20, 35):
        movers.take(legs(0.7, 0.0)[5:], LASER, away, DT * step)
    [person] = movers.people()
    assert person.x == pytest.approx(0.72, abs=0.05)
    assert person.y == pytest.approx(0.0, abs=0.02)
    assert person.stands is not None


def test_two_who_stand_together_stay_two_for_as_long_as_they_stand() -> None:
    movers = Movers()
    meet(movers)
    for step in range(20, 20 + round(2 * MEMORY_TIME / DT)):
        movers.take(crowd(2.0, 0.0), LASER, AHEAD, DT * step)
    [both] = movers.people()
    assert both.holds_two(both.seen)
    assert movers.discs(both.seen)[0, 4] > PERSON_RADIUS


def test_who_looks_like_no_legs_may_be_two() -> None:
    movers = Movers()
    walk(movers, (3.0, 0.0), (-0.8, 0.0), 10)
    now = 1.0
    assert movers.discs(0.9)[0, 4] == PERSON_RADIUS
    while now < 4.0:
        movers.take(box(2.25, 0.0), LASER, AHEAD, now)
        now += DT
    assert movers.discs(now)[0, 4] > PERSON_RADIUS


@pytest.mark.parametrize("apart", [0.3, 0.4])
def test_two_who_stand_side_by_side_are_as_wide_as_two(apart: float) -> None:
    movers = Movers()
    walk(movers, (2.0, 0.0), (0.0, 0.0), 20)
    assert movers.discs(1.9)[0, 4] == PERSON_RADIUS
    movers.forget()
    for step in range(20):
        both = np.concatenate([legs(2.0, -apart / 2), legs(2.0, apart / 2)])
        movers.take(both[both[:, 1].argsort()], LASER, AHEAD, DT * step)
    [(x, y, *_, radius)] = movers.discs(1.9)
    body = 0.25
    assert hypot(x - 2.0, abs(y) + apart / 2) + body < radius + 0.05
    assert radius < PERSON_RADIUS + apart


def test_who_is_not_where_the_laser_looks_has_gone_whatever_sonars_hear_there() -> None:
    movers = Movers()
    walk(movers, (1.3, 0.0), (0.0, 0.0), 20)
    for step in range(20, 40):
        movers.hear(EAR, 1.1, DT * step)
        movers.take(np.array([[3.0, 0.0], [3.0, 0.02]]), LASER, AHEAD, DT * step)
    assert not movers.people()


@pytest.mark.parametrize("metres", [np.inf, 0.0, 3.5])
def test_silence_is_nobody(metres: float) -> None:
    movers = Movers()
    walk(movers, (3.5, 0.0), (-0.4, 0.0), 20)
    movers.take(BEHIND, LASER, AWAY, 3.0)
    for n in range(2 * OFTEN):
        movers.hear(EAR, metres, 3.0 + 0.2 * n)
    [person] = movers.people()  # too far to be missed
    assert (person.missed, person.heard) == (0, -np.inf)
