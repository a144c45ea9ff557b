"""What stands still, and what does not."""

from math import inf, radians

from pioneer3.behaviors.detection import FORGET, ClutterMap
from pioneer3.behaviors.pings import Ping


def ping(distance: float, stamp: float, *, axis: float = 0.0, number: int = 3) -> Ping:
    return Ping(number, 0.0, 0.0, radians(axis), distance, stamp)


def heard(distance: float, *stamps: float) -> ClutterMap:
    clutter = ClutterMap()
    for stamp in stamps:
        clutter.take(ping(distance, stamp))
    return clutter


def test_what_echoes_for_two_seconds_is_furniture() -> None:
    assert heard(1.0, 0.0, 1.0, 2.0).explains(ping(1.0, 2.1)) == 0.0


def test_what_echoes_for_less_is_not() -> None:
    assert heard(1.0, 0.0, 1.0, 1.9).explains(ping(1.0, 2.0)) == inf


def test_two_echoes_are_chance() -> None:
    assert heard(1.0, 0.0, 2.5).explains(ping(1.0, 2.6)) == inf


def test_who_walks_past_is_no_furniture() -> None:
    clutter = ClutterMap()
    for tick in range(40):
        clutter.take(ping(1.0 + 0.04 * tick, tick / 10))  # 0.4 m/s away
    assert clutter.explains(ping(2.0, 4.0)) == inf


def test_the_place_may_be_anywhere_on_the_arc() -> None:
    clutter = heard(1.0, 0.0, 1.0, 2.0)
    # the place is 20 degrees off these axes: half a beam is 15, and the edges are not sharp
    assert clutter.explains(ping(1.0, 2.1, axis=20)) == 0.0
    assert clutter.explains(ping(1.0, 2.1, axis=-20)) == 0.0
    assert clutter.explains(ping(1.0, 2.1, axis=23)) == inf


def test_an_echo_from_before_it_is_not_explained() -> None:
    assert heard(1.0, 0.0, 1.0, 2.0).explains(ping(0.8, 2.1)) == inf


def test_what_lets_echoes_through_is_doubted() -> None:
    clutter = heard(1.0, 0.0, 1.0, 2.0)
    for stamp in (2.1, 2.4, 2.7):
        clutter.take(ping(inf, stamp))
    assert clutter.spots == []


def test_a_nearer_echo_says_nothing_of_what_is_behind() -> None:
    clutter = heard(1.0, 0.0, 1.0, 2.0)
    for tick in range(10):
        clutter.take(ping(0.5, 2.1 + tick / 10))
    assert clutter.explains(ping(1.0, 3.2)) == 0.0


def test_old_places_are_forgotten_when_new_ones_come() -> None:
    clutter = heard(1.0, 0.0, 1.0, 2.0)
    clutter.take(ping(1.5, 2.1 + FORGET, axis=90))
    assert clutter.explains(ping(1.0, 2.2 + FORGET)) == inf


def test_what_is_told_to_be_furniture_is() -> None:
    clutter = ClutterMap()
    clutter.learn([ping(0.7, 0.0)])
    assert clutter.explains(ping(0.7, 0.1)) == 0.0
