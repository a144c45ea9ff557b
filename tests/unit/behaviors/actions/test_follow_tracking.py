"""Following, as decided from what a standing P3-AT hears."""

from math import radians

import pytest

from pioneer3.behaviors.action import Desire
from pioneer3.behaviors.actions.follow import FollowTracking
from pioneer3.behaviors.trackers import COAST, STANDS_STILL
from pioneer3.geometry import Pose2
from tests.unit.behaviors.support import seen, value
from tests.unit.behaviors.tracking.scene import Point, Scene, ahead


def decided(scene: Scene, follow: FollowTracking, seconds: float = 1.0) -> Desire:
    """Return the last decision of so many seconds."""
    desire = None
    for _ in range(round(seconds * 10)):
        desire = follow.decide(scene.report())
    assert desire is not None
    return desire


def walking(scene: Scene, follow: FollowTracking, start: Point, step: Point, count: int) -> Desire:
    """Return the last decision while somebody makes `count` steps, ten a second."""
    for number in range(count):
        scene.people = [(start[0] + step[0] * number, start[1] + step[1] * number)]
        desire = decided(scene, follow, 0.1)
    return desire


def test_without_anybody_it_stands_and_looks() -> None:
    desire = decided(Scene(), FollowTracking())
    assert (value(desire, "v"), value(desire, "w")) == (0.0, 0.0)
    assert desire.reason == "looks for somebody"


def test_it_goes_to_who_stands_in_front() -> None:
    desire = decided(Scene(people=[ahead(0.6)]), FollowTracking())
    # (0.6 - 0.3) / 0.8 s
    assert value(desire, "v") == pytest.approx(0.375, abs=0.06)
    assert value(desire, "w") == pytest.approx(0.0, abs=0.15)
    assert desire.reason.startswith("follows at 0.")


def test_at_the_distance_to_keep_it_stands() -> None:
    scene, follow = Scene(people=[ahead(0.3)]), FollowTracking()
    decided(scene, follow, 3.0)
    speeds = [value(decided(scene, follow, 0.1), "v") or 0.0 for _ in range(16)]
    # somebody so near is heard by edges of beams: 0.1 m of error are 0.12 m/s
    assert abs(sum(speeds)) / 16 < 0.12
    assert max(map(abs, speeds)) < 0.2


def test_it_makes_room_for_who_comes_nearer_but_not_fast() -> None:
    scene, follow = Scene(), FollowTracking()
    desire = walking(scene, follow, ahead(0.8), (-0.06, 0.0), 12)
    assert value(desire, "v") == -0.3


@pytest.mark.parametrize("side", [1, -1])
def test_it_turns_to_the_side_where_they_are(side: int) -> None:
    desire = decided(Scene(people=[ahead(0.5, 30.0 * side)]), FollowTracking())
    w = value(desire, "w")
    assert w is not None
    # 2 / s * (30 - 4) degrees, less what the beams leave open, is 32 to 60 degrees/s
    assert radians(25) < w * side <= radians(60)


def test_it_drives_as_fast_as_they_walk_at_the_distance_to_keep() -> None:
    scene, follow = Scene(), FollowTracking(speed=1.0)
    desire = walking(scene, follow, ahead(0.21), (0.03, 0.0), 14)  # to 0.6 m at 0.3 m/s
    assert value(desire, "v") == pytest.approx(0.3 + (0.6 - 0.3) / 0.8, abs=0.12)


def test_it_is_never_faster_than_told() -> None:
    scene, follow = Scene(people=[ahead(0.9)]), FollowTracking(speed=0.2)
    assert value(decided(scene, follow), "v") == 0.2


def test_a_wall_is_nobody() -> None:
    x = 0.313 + 0.6
    desire = decided(Scene(walls=[(x, -3.0, x, 3.0)]), FollowTracking(), 3.0)
    assert desire.reason == "looks for somebody"


def test_somebody_before_a_wall_is_somebody() -> None:
    x = 0.313 + 1.2
    scene = Scene(people=[ahead(0.5)], walls=[(x, -3.0, x, 3.0)])
    assert decided(scene, FollowTracking()).reason.startswith("follows at 0.")


def test_who_steps_out_of_the_beams_for_half_a_second_is_not_forgotten() -> None:
    scene, follow = Scene(), FollowTracking()
    walking(scene, follow, ahead(0.5), (0.0, 0.03), 15)
    before, place = follow.target, scene.people[0]
    scene.people = []
    desire = decided(scene, follow, 0.6)
    assert desire.reason.startswith("lost for 0.")
    assert "left" in desire.reason
    turn = value(desire, "w")
    assert turn is not None
    assert turn > 0.5  # on towards where they went
    scene.people = [(place[0], place[1] + 0.15)]
    assert decided(scene, follow, 0.6).reason.startswith("follows")
    assert follow.target is before


def test_it_does_not_drive_backwards_blindly() -> None:
    scene, follow = Scene(), FollowTracking()
    assert value(walking(scene, follow, ahead(0.7), (-0.05, 0.0), 12), "v") == -0.3
    scene.people = []
    assert value(decided(scene, follow, 0.6), "v") == 0.0


def test_who_is_gone_is_given_up() -> None:
    scene, follow = Scene(people=[ahead(0.5)]), FollowTracking()
    decided(scene, follow)
    scene.people = []
    desire = decided(scene, follow, COAST + 0.4)
    assert (value(desire, "v"), value(desire, "w")) == (0.0, 0.0)
    assert desire.reason == "looks for somebody"


def test_what_has_never_walked_is_furniture_in_the_end() -> None:
    scene, follow = Scene(people=[ahead(0.5)]), FollowTracking()
    assert decided(scene, follow, STANDS_STILL - 1).reason.startswith("follows")
    decided(scene, follow, 2.0)
    for _ in range(100):
        assert decided(scene, follow, 0.1).reason == "looks for somebody"


def test_who_stands_still_after_a_walk_is_still_somebody() -> None:
    scene, follow = Scene(), FollowTracking()
    walking(scene, follow, ahead(0.3), (0.04, 0.0), 15)
    assert decided(scene, follow, 3 * STANDS_STILL).reason.startswith("follows")


def test_furniture_beside_does_not_distract_from_somebody() -> None:
    """A post that the robot has heard for long stands where the person walks past."""
    scene, follow = Scene(people=[ahead(0.6, 25.0)]), FollowTracking()
    decided(scene, follow, STANDS_STILL + 1)
    post = scene.people[0]
    for number in range(20):
        scene.people = [post, ahead(0.4 + 0.03 * number, -15.0)]
        desire = decided(scene, follow, 0.1)
    assert desire.reason.startswith("follows at 0.9")
    turn = value(desire, "w")
    assert turn is not None
    assert turn < 0


def test_a_report_is_heard_once_however_often_it_is_asked() -> None:
    one, other = FollowTracking(), FollowTracking()
    scene = Scene(people=[ahead(0.6)])
    for _ in range(10):
        place = scene.report()
        for _ in range(3):
            one.decide(place)
        other.decide(place)
    assert one.target is not None
    assert other.target is not None
    assert one.target.estimate.state == other.target.estimate.state


def test_a_robot_without_sonars_stands_still() -> None:
    assert value(FollowTracking().decide(seen()), "v") == 0.0


def test_the_frame_does_not_matter() -> None:
    """The same scene elsewhere, turned, is followed in the same way."""
    here, there = Scene(people=[ahead(0.7, 15.0)]), Scene(pose=Pose2(3.0, -2.0, radians(135)))
    place = there.pose @ Pose2(*here.people[0])
    there.people = [(place.x, place.y)]
    one, other = decided(here, FollowTracking()), decided(there, FollowTracking())
    # people are octagons, and do not turn with the frame
    assert value(one, "v") == pytest.approx(value(other, "v"), abs=0.03)
    assert value(one, "w") == pytest.approx(value(other, "w"), abs=0.06)
