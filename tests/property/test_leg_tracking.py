"""Holds for every scan: legs, tracks, and the motion towards them."""

from dataclasses import replace
from math import hypot, inf, isfinite, nan, pi, radians

from hypothesis import given
from hypothesis import strategies as st

from pioneer3.behaviors.actions.follow import FollowTracking
from pioneer3.behaviors.leg_tracking import FASTEST_PERSON, WIDEST_GATE, LegTracks
from pioneer3.behaviors.legs import LEGS_RANGE, WIDEST_BOTH, find_legs
from pioneer3.behaviors.trackers import LaserOrSonarTracker, LegTracker
from pioneer3.geometry import Pose2
from pioneer3.state import Scan
from tests.unit.behaviors.legs.scans import Room
from tests.unit.behaviors.support import seen, value

BEAMS = 91
READING = st.floats(0.0, 6.0) | st.sampled_from([inf, -inf, nan])
RUNS = st.lists(st.tuples(READING, st.integers(1, 12)), min_size=1, max_size=30)
SCANS = st.lists(
    st.tuples(RUNS, st.floats(0.02, 0.5), st.floats(-0.05, 0.05), st.floats(-0.1, 0.1)), max_size=30
)


def scan_of(runs: list[tuple[float, int]], number: int, stamp: float, pose: Pose2) -> Scan:
    """Return a scan of things, each as wide as some beams."""
    ranges = [metres for metres, count in runs for _ in range(count)][:BEAMS]
    ranges += [inf] * (BEAMS - len(ranges))
    return Scan(
        stamp=stamp,
        sequence=number,
        robot_in_odom=pose,
        sensor_in_robot=Pose2(0.1),
        angles=tuple(radians(2 * k - 90) for k in range(BEAMS)),
        ranges=tuple(ranges),
    )


@given(RUNS)
def test_legs_are_within_reach_and_no_wider_than_people(runs: list[tuple[float, int]]) -> None:
    for leg in find_legs(scan_of(runs, 1, 0.1, Pose2())):
        assert hypot(leg.x - 0.1, leg.y) <= LEGS_RANGE + 0.1
        assert 0 < leg.width <= WIDEST_BOTH


@given(SCANS)
def test_a_track_never_jumps(
    scans: list[tuple[list[tuple[float, int]], float, float, float]],
) -> None:
    tracks, pose, stamp = LegTracks(), Pose2(), 0.0
    for number, (runs, dt, way, turn) in enumerate(scans, 1):
        pose, stamp = pose @ Pose2(way, 0.0, turn), stamp + dt
        expected = {track: track.estimate.at(stamp) for track in tracks.tracks}
        tracks.look(scan_of(runs, number, stamp, pose))
        for track in tracks.tracks:
            x, y = track.estimate.position
            assert hypot(*track.estimate.velocity) <= FASTEST_PERSON * (1 + 1e-9)
            if track in expected:
                assert hypot(x - expected[track][0], y - expected[track][1]) <= WIDEST_GATE


@given(SCANS, st.lists(st.booleans(), min_size=30, max_size=30))
def test_whatever_is_seen_the_bounds_hold(
    scans: list[tuple[list[tuple[float, int]], float, float, float]], comes: list[bool]
) -> None:
    for tracker in (LegTracker(), LaserOrSonarTracker()):
        action, pose, now = FollowTracking(tracker=tracker), Pose2(), 0.0
        for number, (runs, dt, way, turn) in enumerate(scans, 1):
            pose, now = pose @ Pose2(way, 0.0, turn), now + dt
            scan = scan_of(runs, number, now, pose) if comes[number - 1] else None
            place = seen(now, pose=pose, sequence=number)
            desire = action.decide(replace(place, scan=scan))
            v, w = value(desire, "v"), value(desire, "w")
            assert v is not None
            assert w is not None
            assert isfinite(v)
            assert -0.3 <= v <= 0.5
            assert abs(w) <= radians(60)
            if action.target is None:
                assert (v, w) == (0.0, 0.0)


@given(st.floats(0.8, 3.5), st.floats(-1.2, 1.2), st.floats(0.0, pi / 4))
def test_somebody_who_faces_the_robot_is_seen_on_both_legs(
    distance: float, bearing: float, turned: float
) -> None:
    person = Pose2(theta=bearing) @ Pose2(distance, 0.0, turned)
    tracks = LegTracks()
    tracks.look(Room(people=[person], beams=1081, view=1.5 * pi).scan())
    (track,) = tracks.tracks
    x, y = track.estimate.position
    assert track.pairs == 1
    assert hypot(x - person.x, y - person.y) < 0.05
