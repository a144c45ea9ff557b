"""What is remembered of sonar, bumpers and laser, by the numbers of facts.md 7.2."""

from collections.abc import Sequence
from dataclasses import replace
from math import atan2, cos, degrees, inf, isnan, nan, pi, radians, sin

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pioneer3.behaviors.memory import RangeMemory, _nearest, thinned
from pioneer3.behaviors.surroundings import WINDOW, Buffer, Surroundings
from pioneer3.geometry import ORIGIN, Pose2, Twist2
from pioneer3.models import load_model
from pioneer3.state import Bumpers, LinkQuality, Motors, Scan, Snapshot, Sonar
from tests.unit.behaviors.support import P3AT, around, seen

COUNT = len(P3AT.sonars)
AHEAD = 3  # of the P3-AT: 10 degrees to the left


def reading(
    stamp: float, heard: dict[int, float] | None = None, pose: Pose2 = ORIGIN, sessions: int = 1
) -> Snapshot:
    ranges = [inf] * COUNT
    for number, metres in (heard or {}).items():
        ranges[number] = metres
    return replace(
        seen(stamp, pose=pose).snapshot,
        sonar=Sonar(ranges=tuple(ranges), fresh=tuple(heard or ()), enabled=True),
        link=LinkQuality(sessions=sessions),
    )


def remembering(*readings: Snapshot) -> RangeMemory:
    memory = RangeMemory(P3AT)
    for each in readings:
        memory.update(each)
    return memory


def test_an_echo_is_where_its_transducer_heard_it() -> None:
    mount = P3AT.sonars[AHEAD]
    (point,) = remembering(reading(0.0, {AHEAD: 1.0})).around(0.0).points()
    assert point.x == pytest.approx(mount.x + cos(mount.theta))
    assert point.y == pytest.approx(mount.y + sin(mount.theta))


def test_an_echo_is_placed_from_the_pose_before() -> None:
    memory = remembering(reading(0.0), reading(0.1, {AHEAD: 1.0}, Pose2(0.5)))
    (point,) = memory.around(0.1).points()
    mount = P3AT.sonars[AHEAD]
    assert point.x == pytest.approx(mount.x + cos(mount.theta) - 0.5)


@pytest.mark.parametrize(("age", "left"), [(4.9, 1), (5.1, 0)])
def test_an_echo_is_recent_for_five_seconds(age: float, left: int) -> None:
    memory = remembering(reading(0.0, {AHEAD: 1.0}), reading(age))
    assert len(memory.around(age).points()) == left


@pytest.mark.parametrize(("age", "metres", "left"), [(14.9, 2.0, 1), (15.1, 2.0, 0), (1.0, 2.9, 0)])
def test_near_echoes_are_remembered_for_fifteen_seconds(
    age: float, metres: float, left: int
) -> None:
    # the transducer sits 0.15 m before the centre: 2.9 m from there are more than 3 m
    memory = remembering(reading(0.0, {AHEAD: metres}), reading(age))
    assert len(memory.around(age).points(Buffer.CUMULATIVE)) == left


def test_what_was_left_behind_is_forgotten() -> None:
    memory = remembering(reading(0.0, {AHEAD: 1.0}), reading(1.0, pose=Pose2(-2.5)))
    assert memory.around(1.0).points(Buffer.CUMULATIVE) == ()
    assert len(memory.around(1.0).points()) == 1


def test_the_newest_24_are_recent_and_64_remembered() -> None:
    memory = RangeMemory(P3AT)
    for n in range(100):
        memory.update(reading(n / 100, {AHEAD: 0.5 + n / 50}, Pose2(0.0, n / 1000)))
    points = memory.around(1.0).points()
    assert len(points) == 24
    assert len(memory.around(1.0).points(Buffer.CUMULATIVE)) <= 64


def test_an_echo_at_the_same_place_replaces_the_older_one() -> None:
    memory = remembering(reading(0.0, {AHEAD: 1.0}), reading(0.1, {AHEAD: 1.04}))
    assert len(memory.around(0.1).points(Buffer.CUMULATIVE)) == 1
    memory.update(reading(0.2, {AHEAD: 1.1}))
    assert len(memory.around(0.2).points(Buffer.CUMULATIVE)) == 2


def test_nothing_is_known_while_the_sonar_is_silent() -> None:
    memory = remembering(reading(0.0))
    assert not memory.around(0.0).sensing
    memory.update(reading(0.1, {AHEAD: inf}))
    assert memory.around(0.1).sensing
    assert memory.around(1.1).sensing
    assert not memory.around(1.2).sensing


@pytest.mark.parametrize(
    ("model", "numbers", "behind"),
    [
        ("p3at-sh", range(16), True),
        ("p3at-sh", range(8), False),  # the front ring alone
        ("p3at-sh", (11, 12), True),  # the two next to straight back
        ("p3at-sh", (12, 13), False),  # both on the left
        ("p3at-sh", (9, 14), False),
        ("amigo-sh", range(8), True),
        ("amigo-sh", range(6), False),
    ],
)
def test_sonars_see_behind_where_they_look_and_are_heard(
    model: str, numbers: Sequence[int], behind: bool
) -> None:
    memory = RangeMemory(load_model(model))
    memory.update(reading(0.0, dict.fromkeys(numbers, inf)))
    assert memory.around(0.0).sensing
    assert memory.around(0.0).sees_behind is behind
    memory.update(reading(1.1, {AHEAD: inf}))
    assert memory.around(1.1).sensing
    assert not memory.around(1.1).sees_behind  # the others are silent


def test_a_new_session_knows_nothing_of_the_one_before() -> None:
    memory = remembering(reading(0.0, {AHEAD: 1.0}), reading(0.1, sessions=2))
    assert memory.around(0.1).points() == ()
    assert not memory.around(0.1).sensing


@pytest.mark.parametrize(
    ("bumpers", "bearing"),
    [
        # five segments of 135 / 5 = 27 degrees: the first is at 67.5 - 13.5 = 54 degrees
        (Bumpers(front=(True, False, False, False, False)), 54),
        (Bumpers(front=(False, False, True, False, False)), 0),
        (Bumpers(rear=(True, False, False, False, False)), 54 + 180),
    ],
)
def test_a_bumped_segment_is_a_point_on_the_radius(bumpers: Bumpers, bearing: float) -> None:
    (point,) = remembering(replace(reading(0.0), bumpers=bumpers)).around(0.0).points()
    assert point.distance == pytest.approx(P3AT.radius)
    assert (point.bearing - radians(bearing)) % (2 * pi) == pytest.approx(0, abs=1e-9)


def test_what_was_seen_lately_outlives_newer_echoes() -> None:
    memory = remembering(reading(0.0, {AHEAD: 1.0}))
    for n in range(1, 40):
        memory.update(reading(n / 20, {6: 2.0 + n / 100}))
    now = 39 / 20
    assert now < WINDOW
    ahead = (-0.3, 0.3)
    assert not memory.around(now).nearest(*ahead)
    assert memory.around(now).nearest(*ahead, Buffer.WINDOW)
    memory.update(reading(WINDOW + 0.1))
    assert not memory.around(WINDOW + 0.1).nearest(*ahead, Buffer.WINDOW)


@pytest.mark.parametrize(
    ("v", "left", "right", "corners"),
    [
        (0.2, True, True, [(0.313, 0.2525), (0.313, -0.2525)]),
        (0.2, False, True, [(0.313, -0.2525)]),
        (-0.2, True, False, [(-0.313, 0.2525)]),
    ],
)
def test_a_stall_is_something_at_the_corners(
    v: float, left: bool, right: bool, corners: list[tuple[float, float]]
) -> None:
    motors = Motors(enabled=True, left_stalled=left, right_stalled=right)
    moving = seen(0.0, twist=Twist2(v, 0.0)).snapshot
    stalled = seen(0.1, motors=motors).snapshot
    memory = remembering(moving, stalled)
    for recall in Buffer:
        found = [(p.x, p.y) for p in memory.around(0.1).points(recall)]
        assert found == [pytest.approx(corner) for corner in corners]


def scan(stamp: float, ranges: dict[int, float], sequence: int = 0) -> Scan:
    """Return a scan of one beam each degree; what is not given is free."""
    return Scan(
        stamp=stamp,
        sequence=sequence,
        robot_in_odom=ORIGIN,
        sensor_in_robot=Pose2(0.1),
        angles=tuple(radians(a) for a in range(-90, 91)),
        ranges=tuple(ranges.get(a, inf) for a in range(-90, 91)),
    )


def test_a_scan_replaces_the_one_before() -> None:
    memory = RangeMemory(P3AT)
    memory.update(reading(0.0), [scan(0.0, {0: 2.0, 90: 1.0})])
    ahead, left = memory.around(0.0).points()
    assert (ahead.x, ahead.y) == pytest.approx((2.1, 0.0))
    assert (left.x, left.y) == pytest.approx((0.1, 1.0))
    assert memory.around(0.0).sensing
    memory.update(reading(0.1), [scan(0.1, {0: 1.9}, 1)])
    assert [p.x for p in memory.around(0.1).points()] == [2.0]


def test_who_asks_late_gets_the_newest_scan_and_has_not_missed_what_stands() -> None:
    memory, hidden = RangeMemory(P3AT), dict.fromkeys(range(-20, 21), nan)
    for number in range(20):
        ranges = {0: 2.0} if number < 8 else hidden | {45 + number: 1.0}
        memory.update(reading(number / 10), [scan(number / 10, ranges, number)])
    late = memory.around(1.9)
    assert [degrees(atan2(p.y, p.x - 0.1)) for p in late.points()] == pytest.approx([64])
    assert late.points(Buffer.CUMULATIVE)[0].x == pytest.approx(2.1)


@pytest.mark.parametrize(
    ("first", "last", "heading", "behind"),
    [
        (-90, 90, 0, False),
        (-135, 135, 0, False),
        (-90, 90, 180, True),
        (-90, 90, 150, True),
        (-90, 90, 95, False),  # hardly past straight back
        (-179, 180, 0, True),
    ],
)
def test_a_laser_sees_behind_if_its_field_reaches_there(
    first: int, last: int, heading: int, behind: bool
) -> None:
    memory = RangeMemory(P3AT)
    count = last - first + 1
    looking = replace(
        scan(0.0, {}),
        sensor_in_robot=Pose2(theta=radians(heading)),
        angles=tuple(radians(first + i) for i in range(count)),
        ranges=(2.0,) * count,
    )
    memory.update(reading(0.0), [looking])
    assert memory.around(0.0).sensing
    assert memory.around(0.0).sees_behind is behind


@pytest.mark.parametrize(("width", "behind"), [(5, True), (75, False), (160, False)])
@pytest.mark.parametrize("hidden", [nan, -inf])
def test_a_laser_does_not_see_behind_a_wide_mask(width: int, hidden: float, behind: bool) -> None:
    masked = dict.fromkeys(range(-(width // 2), width // 2 + 1), hidden)
    free = dict.fromkeys(range(-90, 91), 2.0)
    memory = RangeMemory(P3AT)
    back = replace(scan(0.0, free | masked), sensor_in_robot=Pose2(-0.1, theta=pi))
    memory.update(reading(0.0), [back])
    assert memory.around(0.0).sensing
    assert memory.around(0.0).sees_behind is behind


def test_a_beam_that_sees_farther_cleans_what_was_remembered() -> None:
    memory = RangeMemory(P3AT)
    memory.update(reading(1.0), [scan(1.0, {0: 2.0, 45: 1.0, 90: 3.5})])
    assert len(memory.around(1.0).points(Buffer.CUMULATIVE)) == 2  # within 3 m
    memory.update(reading(2.1), [scan(2.1, {0: 2.5, 45: 1.05}, 1)])
    left = memory.around(2.1).points(Buffer.CUMULATIVE)
    assert sorted(round(p.distance, 1) for p in left) == [1.1, 2.6]


def test_a_laser_that_looks_through_glass_leaves_what_sonar_has_heard() -> None:
    memory = RangeMemory(P3AT)
    memory.update(reading(1.0, {AHEAD: 0.5}), [scan(1.0, {})])
    memory.update(reading(2.1), [scan(2.1, {}, 1)])
    for buffer in Buffer:
        assert len(memory.around(2.1).points(buffer)) == 1


def test_a_thin_leg_between_two_beams_is_remembered() -> None:
    memory = RangeMemory(P3AT)
    beside = dict.fromkeys((-2, 2), 2.0)
    memory.update(reading(1.0), [scan(1.0, {0: 1.5})])
    memory.update(reading(2.1), [scan(2.1, {1: 1.5} | beside, 1)])  # the next beam meets it
    assert len(memory.around(2.1).points(Buffer.CUMULATIVE)) == 2
    memory.update(reading(3.2), [scan(3.2, beside, 2)])
    left = memory.around(3.2).points(Buffer.CUMULATIVE)
    assert [round(p.distance, 1) for p in left] == [2.1]  # the leg is gone; of two so near, one


def test_a_masked_beam_forgets_nothing() -> None:
    memory = RangeMemory(P3AT)
    memory.update(reading(1.0), [scan(1.0, {0: 1.5})])
    memory.update(reading(2.1), [scan(2.1, {0: nan}, 1)])
    assert len(memory.around(2.1).points(Buffer.CUMULATIVE)) == 1


@pytest.mark.parametrize(("metres", "left"), [(0.1, 0), (0.18, 0), (0.2, 1)])
def test_a_laser_that_meets_the_robot_itself_sees_nothing(metres: float, left: int) -> None:
    # from 0.1 m ahead of the centre to the front at 0.313 m, less 0.03 m
    memory = RangeMemory(P3AT)
    memory.update(reading(0.0), [scan(0.0, {0: metres})])
    for buffer in Buffer:
        assert len(memory.around(0.0).points(buffer)) == left


def fine_scan(ranges: dict[int, float]) -> Scan:
    """Return a scan of 1081 beams of a quarter of a degree, of which some echo."""
    return replace(
        scan(0.0, {}),
        angles=tuple(radians(n / 4 - 135) for n in range(1081)),
        ranges=tuple(ranges.get(n, inf) for n in range(1081)),
    )


def test_of_a_fine_scan_the_nearest_reading_of_each_degree_is_taken() -> None:
    coarse = thinned(fine_scan({540: 2.0, 541: 1.5, 543: 1.8, 548: 3.0, 1080: 2.5}))
    assert len(coarse.ranges) == len(coarse.angles) == 271
    assert {n: r for n, r in enumerate(coarse.ranges) if r < inf} == {135: 1.5, 137: 3.0, 270: 2.5}
    assert coarse.angles[135] == pytest.approx(radians(0.375))
    for n in range(1081):
        assert abs(coarse.angles[n // 4] - radians(n / 4 - 135)) <= radians(0.376)


@given(st.lists(st.sampled_from([0.0, 0.5, 1.5, 2.5, inf, nan, -inf]), min_size=9, max_size=40))
def test_a_sector_has_its_nearest_echo_whatever_else_is_in_it(readings: list[float]) -> None:
    for some in (readings, [each for each in readings if each > 0 or isnan(each)]):
        ranges = tuple(some) or (inf,)
        angles = tuple(radians(0.25 * number) for number in range(len(ranges)))
        scan = replace(fine_scan({}), angles=angles, ranges=ranges)
        sectors = [ranges[at : at + 4] for at in range(0, len(ranges), 4)]
        coarse = thinned(scan).ranges if len(ranges) > 1 else (_nearest(ranges),)
        assert str(coarse) == str(tuple(_nearest(each) for each in sectors))


def test_thinning_keeps_apart_what_saw_nothing_and_what_is_not_valid() -> None:
    coarse = thinned(fine_scan({0: nan, 4: nan, 5: 1.0, 8: -inf}))
    assert isnan(coarse.ranges[0])
    assert coarse.ranges[1] == 1.0
    assert isnan(coarse.ranges[2])
    assert coarse.ranges[3] == inf


def test_a_coarse_scan_is_taken_as_it_is() -> None:
    made = scan(0.0, {0: 1.0})
    assert thinned(made) is made


def test_an_old_scan_says_nothing() -> None:
    memory = RangeMemory(P3AT)
    memory.update(reading(0.0), [scan(0.0, {0: 2.0})])
    memory.update(reading(1.1), [scan(0.0, {0: 2.0})])
    assert memory.around(1.1).points() == ()
    assert not memory.around(1.1).sensing


class TestQueries:
    HERE = around((1.0, 0.0), (0.8, radians(80)), (0.5, pi), (2.0, radians(-30)))

    @pytest.mark.parametrize(
        ("start", "end", "distance"),
        [
            (-70, 70, 1.0),
            (70, -70, 0.5),  # counter-clockwise: around the back
            (120, -120, 0.5),
            (-40, -20, 2.0),
            (-180, 180, 0.5),
            (10, 20, inf),
        ],
    )
    def test_sectors_go_counter_clockwise(self, start: float, end: float, distance: float) -> None:
        echo = self.HERE.nearest(radians(start), radians(end))
        assert echo.distance == pytest.approx(distance)
        assert bool(echo) == (distance < inf)

    @pytest.mark.parametrize("corners", [(0, -0.2, 3, 0.2), (3, 0.2, 0, -0.2)])
    def test_boxes_take_their_corners_in_any_order(
        self, corners: tuple[float, float, float, float]
    ) -> None:
        assert self.HERE.nearest_in_box(*corners).distance == pytest.approx(1.0)

    def test_points_are_seen_from_where_the_robot_is(self) -> None:
        pose = Pose2(1.0, 2.0, pi / 2)
        (point,) = Surroundings(pose, [(1.0, 3.5)]).points()
        assert (point.x, point.y) == pytest.approx((1.5, 0.0))
        assert (point.distance, point.bearing) == pytest.approx((1.5, 0.0))


def test_the_newest_scan_is_given_for_a_second_and_not_to_the_next_session() -> None:
    memory, made = RangeMemory(P3AT), scan(1.0, {})
    memory.update(reading(1.1), [made])
    assert memory.newest_scan(1.9) is made
    assert memory.newest_scan(2.1) is None
    memory.update(reading(1.2))
    assert memory.newest_scan(1.2) is made
    memory.update(reading(1.3, sessions=2))
    assert memory.newest_scan(1.3) is None
