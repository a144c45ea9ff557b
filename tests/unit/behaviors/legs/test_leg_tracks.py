"""People keep their tracks; things that stand still are furniture."""

from math import hypot, pi

import pytest

from pioneer3.behaviors.leg_tracking import HIDDEN_TIME, STANDING_TIME, LegTrack, LegTracks
from pioneer3.geometry import Pose2
from tests.unit.behaviors.legs.scans import LEG, Room


def look(tracks: LegTracks, room: Room, count: int = 1, followed: LegTrack | None = None) -> None:
    for _ in range(count):
        tracks.look(room.scan(), followed)


def walk(
    tracks: LegTracks, room: Room, *ways: tuple[Pose2, Pose2], seconds: float
) -> list[list[LegTrack]]:
    """Let people walk straight, each from one place to another; return the tracks of each scan."""
    count, seen = round(seconds * 10), []
    for tick in range(count + 1):
        share = tick / count
        room.people = [
            Pose2(a.x + share * (b.x - a.x), a.y + share * (b.y - a.y), a.theta) for a, b in ways
        ]
        look(tracks, room)
        seen.append(list(tracks.tracks))
    return seen


def nearest(tracks: LegTracks, x: float, y: float) -> LegTrack:
    def away(track: LegTrack) -> float:
        return hypot(track.estimate.state[0] - x, track.estimate.state[1] - y)

    found = min(tracks.tracks, key=away)
    assert away(found) < 0.15
    return found


def test_a_person_is_one_track_between_the_legs() -> None:
    tracks = LegTracks()
    look(tracks, Room(people=[Pose2(1.2, 0.3)]), 5)
    (track,) = tracks.tracks
    assert track.estimate.position == pytest.approx((1.2, 0.3), abs=0.03)
    assert track.pairs == 5
    assert not track.walked


def test_who_walks_has_a_speed_and_has_walked() -> None:
    tracks = LegTracks()
    walk(tracks, Room(), (Pose2(1.0), Pose2(2.2)), seconds=3.0)
    (track,) = tracks.tracks
    assert track.walked
    assert track.estimate.velocity == pytest.approx((0.4, 0.0), abs=0.05)


def test_what_stands_still_is_furniture_unless_it_is_followed() -> None:
    tracks, room = LegTracks(), Room(people=[Pose2(1.2)], posts=[(1.5, 1.0, LEG)])
    look(tracks, room)
    followed = nearest(tracks, 1.2, 0.0)
    look(tracks, room, round(STANDING_TIME * 10) + 1, followed)
    assert tracks.tracks == [followed]
    (spot,) = tracks.furniture
    assert (spot.x, spot.y) == pytest.approx((1.5, 1.0), abs=0.03)


def test_who_has_walked_may_stand() -> None:
    tracks, room = LegTracks(), Room()
    walk(tracks, room, (Pose2(1.0), Pose2(2.0)), seconds=2.5)
    (before,) = tracks.tracks
    look(tracks, room, 100)
    assert tracks.tracks == [before]
    assert tracks.furniture == []


def test_furniture_that_is_carried_away_is_forgotten() -> None:
    tracks, room = LegTracks(), Room(posts=[(1.5, 0.0, LEG)], walls=[(3.0, -4.0, 3.0, 4.0)])
    look(tracks, room, 30)
    assert len(tracks.furniture) == 1
    room.posts = []
    look(tracks, room, 10)
    assert tracks.furniture == []


def test_a_leg_beside_a_person_who_walks_past_stays_furniture() -> None:
    tracks, room = LegTracks(), Room(posts=[(1.5, 0.45, LEG)])
    look(tracks, room, 30)
    steps = walk(tracks, room, (Pose2(1.0), Pose2(2.2)), seconds=3.0)
    person = steps[-1][0]
    assert all(person in step for step in steps[1:])
    assert person.estimate.position == pytest.approx((2.2, 0.0), abs=0.1)
    assert len(tracks.furniture) == 1


def test_people_who_cross_keep_their_tracks() -> None:
    """One walks past before the other, and hides them."""
    tracks, room = LegTracks(), Room()
    near = Pose2(1.2, -1.2, pi / 2), Pose2(1.2, 1.2, pi / 2)
    far = Pose2(2.0, 1.0, -pi / 2), Pose2(2.0, -1.0, -pi / 2)
    steps = walk(tracks, room, near, far, seconds=5.0)
    one, other = nearest(tracks, 1.2, 1.2), nearest(tracks, 2.0, -1.0)
    assert one is not other
    assert one in steps[5]
    assert other in steps[5]


def test_who_walks_behind_a_pillar_comes_out_as_the_same() -> None:
    tracks, room = LegTracks(), Room(walls=[(1.0, -0.15, 1.0, 0.15)])
    before, hidden = None, 0
    for tick in range(61):
        room.people = [Pose2(2.0, -1.2 + 0.04 * tick, pi / 2)]
        look(tracks, room)
        if tick == 10:
            before = nearest(tracks, 2.0, -0.8)
        hidden += not any(track.legs for track in tracks.tracks)
    assert 3 <= hidden < 10 * HIDDEN_TIME
    assert nearest(tracks, 2.0, 1.2) is before


def test_who_is_gone_in_plain_sight_is_given_up() -> None:
    tracks, room = LegTracks(), Room(walls=[(4.0, -4.0, 4.0, 4.0)])
    walk(tracks, room, (Pose2(1.0), Pose2(2.0)), seconds=2.5)
    room.people = []
    look(tracks, room, 8)
    assert len(tracks.tracks) == 1
    look(tracks, room, 10)
    assert tracks.tracks == []
