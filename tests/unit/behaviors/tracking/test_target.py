"""Somebody whom transducers of a P3-AT hear in turn."""

from math import atan2, degrees, hypot, inf, radians

import pytest

from pioneer3.behaviors.detection import ClutterMap
from pioneer3.behaviors.pings import Ping, PingReader
from pioneer3.behaviors.tracking import Track, expected_range
from tests.unit.behaviors.tracking.scene import Point, Scene, ahead


def ping(distance: float, axis: float = 0.0, stamp: float = 0.0, number: int = 3) -> Ping:
    return Ping(number, 0.0, 0.0, radians(axis), distance, stamp)


def watched(scene: Scene, *way: Point) -> Track:
    """Return who is seen walking `way`, a point for each report, first heard straight ahead."""
    listener, clutter = PingReader(), ClutterMap()
    target = None
    for point in way:
        scene.people = [point]
        pings = listener.listen(scene.report())
        if target is not None:
            target.hear(pings, clutter)
        elif heard := [p for p in pings if p.distance < inf]:
            target = Track.from_ping(heard[0])
    assert target is not None
    return target


def off(target: Track, point: Point) -> float:
    x, y = target.estimate.position
    return hypot(x - point[0], y - point[1])


@pytest.mark.parametrize("bearing", [0.0, 12.0, -25.0, 40.0])
@pytest.mark.parametrize("gap", [0.3, 0.6, 0.9])
def test_who_stands_is_where_they_stand(bearing: float, gap: float) -> None:
    there = ahead(gap, bearing)
    x, y = watched(Scene(), *[there] * 30).estimate.position
    assert degrees(atan2(y, x)) == pytest.approx(bearing, abs=10)  # a third of a beam
    assert hypot(x, y) == pytest.approx(hypot(*there), abs=0.06)


def test_who_walks_away_has_their_speed() -> None:
    way = [ahead(0.4 + 0.04 * tick) for tick in range(20)]
    target = watched(Scene(), *way)
    assert target.estimate.velocity == pytest.approx((0.4, 0.0), abs=0.08)
    assert off(target, way[-1]) < 0.1
    assert target.walked


def test_who_walks_across_is_followed_from_beam_to_beam() -> None:
    way = [(1.1, -0.6 + 0.04 * tick) for tick in range(31)]
    target = watched(Scene(), *way)
    assert off(target, way[-1]) < 0.2
    assert target.estimate.velocity[1] > 0.2


def test_noise_is_no_walk() -> None:
    assert not watched(Scene(), *[ahead(0.5 + 0.02 * (tick % 2)) for tick in range(100)]).walked


def test_an_echo_farther_or_nearer_is_somebody_elses() -> None:
    target = Track.from_ping(ping(0.8))
    for tick in range(1, 11):
        target.hear([ping(0.8, stamp=tick / 10)], ClutterMap())
    others = [ping(0.2, stamp=1.1, number=4), ping(2.0, stamp=1.1, number=2)]
    assert target.hear(others, ClutterMap()) == others


def test_the_range_of_who_is_in_the_beam_is_to_their_outline() -> None:
    assert expected_range(1.0, 0.0) == pytest.approx(0.75)
    assert expected_range(1.0, radians(-15)) == pytest.approx(0.75)


def test_who_is_beside_the_beam_is_met_by_its_edge() -> None:
    # 25 degrees off: 5 degrees outside an edge at 20; cos(5) - sqrt(0.25^2 - sin(5)^2) = 0.762
    assert expected_range(1.0, radians(25)) == pytest.approx(0.7619, abs=1e-4)
    assert expected_range(1.0, radians(-25)) == expected_range(1.0, radians(25))


def test_what_the_transducer_beside_hears_as_near_is_theirs_too() -> None:
    def heard(distance: float, number: int) -> bool:
        target = Track.from_ping(ping(0.4, number=3))
        # 80 degrees off: no beam is that wide
        return (
            target.hear([ping(distance, axis=80.0, stamp=0.1, number=number)], ClutterMap()) == []
        )

    assert heard(0.5, 2)
    assert not heard(0.6, 2)
    assert not heard(0.5, 1)


def test_furniture_beside_them_does_not_pull_them_away() -> None:
    clutter = ClutterMap()
    clutter.learn([ping(0.95)])
    target = Track.from_ping(ping(0.8))
    assert target.hear([ping(0.95, stamp=0.1)], clutter)
    assert target.estimate.position == pytest.approx((1.05, 0.0))


def test_silence_where_they_are_expected_says_that_they_are_beside() -> None:
    target = Track.from_ping(ping(0.8, axis=5.0))
    for tick in range(1, 4):
        target.hear([ping(inf, axis=0.0, stamp=0.3 * tick)], ClutterMap())
    x, y = target.estimate.position
    assert degrees(atan2(y, x)) > 9
    assert target.seen == 0.0


def test_something_before_them_says_nothing_of_them() -> None:
    target = Track.from_ping(ping(0.8))
    target.hear([ping(0.2, stamp=0.1)], ClutterMap())
    assert target.estimate.position == pytest.approx((1.05, 0.0))
