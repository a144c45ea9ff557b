"""Readings become pings, once."""

from math import atan2, inf, nan, radians

import pytest

from pioneer3.behaviors.pings import PingReader
from pioneer3.geometry import Pose2
from tests.unit.behaviors.tracking.scene import Scene, ahead


def test_only_what_is_fresh_is_heard_and_only_once() -> None:
    scene, listener = Scene(people=[ahead(0.6)]), PingReader()
    place = scene.report()
    # 0.1 s, a transducer each 40 ms
    assert [ping.number for ping in listener.listen(place)] == [0, 1]
    assert listener.listen(place) == []
    assert [ping.number for ping in listener.listen(scene.report())] == [2, 3, 4]
    assert sorted(listener.latest) == [0, 1, 2, 3, 4]


def test_a_ping_is_where_the_transducer_was_between_two_reports() -> None:
    scene, listener = Scene(), PingReader()
    scene.pose = Pose2(1.0, 2.0, radians(80))
    listener.listen(scene.report())
    scene.pose = Pose2(1.2, 2.0, radians(100))
    ping = next(p for p in listener.listen(scene.report()) if p.number == 3)
    # halfway at (1.1, 2.0, 90 deg); transducer 3 sits at (0.245, 0.027), looks at 10 deg
    assert (ping.x, ping.y) == pytest.approx((1.1 - 0.027, 2.0 + 0.245))
    assert ping.axis == pytest.approx(radians(100))


def test_halfway_between_two_headings_is_the_short_way_round() -> None:
    scene, listener = Scene(pose=Pose2(theta=radians(175))), PingReader()
    listener.listen(scene.report())
    scene.pose = Pose2(theta=radians(-175))
    ping = next(p for p in listener.listen(scene.report()) if p.number == 3)
    assert abs(ping.axis) == pytest.approx(radians(170))


def test_a_point_is_on_the_axis() -> None:
    scene, listener = Scene(people=[ahead(0.6, 10)]), PingReader()
    scene.report()
    ping = next(p for p in listener.listen(scene.report()) if p.number == 3)
    x, y = ping.point
    assert atan2(y - ping.y, x - ping.x) == pytest.approx(ping.axis)
    assert ping.seen(x, y) == pytest.approx((ping.distance, 0.0))


def test_a_new_session_begins_with_nothing() -> None:
    scene, listener = Scene(), PingReader()
    for _ in range(4):
        listener.listen(scene.report())
    assert len(listener.latest) == 8
    scene.session = 2
    listener.listen(scene.report())
    assert sorted(listener.latest) == [2, 3] or len(listener.latest) < 4


def test_no_reading_is_no_echo() -> None:
    scene, listener = Scene(), PingReader()
    scene._ranges = [nan] * 16
    assert all(ping.distance == inf for ping in listener.listen(scene.report()))
