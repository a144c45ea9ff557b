"""Who is taken for somebody."""

from math import inf

import pytest

from pioneer3.behaviors.detection import ClutterMap, PersonDetector
from pioneer3.behaviors.pings import PingReader
from tests.unit.behaviors.support import P3AT
from tests.unit.behaviors.tracking.scene import Scene, ahead


def hearing(scene: Scene, reports: int = 4, clutter: ClutterMap | None = None) -> PersonDetector:
    """Listen for a turn of the ring."""
    listener = PingReader()
    for _ in range(reports):
        listener.listen(scene.report())
    return PersonDetector(listener.latest, scene.now, P3AT, clutter or ClutterMap())


@pytest.mark.parametrize("gap", [0.2, 0.6, 0.8])
@pytest.mark.parametrize("bearing", [0.0, 20.0, -30.0])
def test_somebody_in_front_is(gap: float, bearing: float) -> None:
    ping = hearing(Scene(people=[ahead(gap, bearing)])).nearest_person()
    assert ping is not None
    assert gap - 0.05 < ping.distance < gap + 0.25


@pytest.mark.parametrize("place", [ahead(1.2), ahead(0.6, 90.0), ahead(0.6, 180.0)])
def test_somebody_far_away_or_beside_is_not(place: tuple[float, float]) -> None:
    assert hearing(Scene(people=[place])).nearest_person() is None


@pytest.mark.parametrize("distance", [0.5, 0.7, 0.95])
def test_a_wall_across_is_not(distance: float) -> None:
    x = P3AT.length_front + distance
    heard = hearing(Scene(walls=[(x, -3.0, x, 3.0)]))
    assert heard.walls() >= {2, 3, 4, 5}
    assert heard.nearest_person() is None


def test_of_two_the_nearer_one_is() -> None:
    ping = hearing(Scene(people=[ahead(0.8, 25), ahead(0.5, -25)])).nearest_person()
    assert ping is not None
    assert ping.number in {4, 5}


def test_furniture_is_not() -> None:
    scene, clutter = Scene(people=[ahead(0.6)]), ClutterMap()
    listener = PingReader()
    for _ in range(30):
        for ping in listener.listen(scene.report()):
            clutter.take(ping)
    heard = PersonDetector(listener.latest, scene.now, P3AT, clutter)
    assert heard.nearest_person() is None
    scene.people = [ahead(0.3)]
    assert hearing(scene, clutter=clutter).nearest_person() is not None


def test_old_echoes_are_not() -> None:
    heard = hearing(Scene(people=[ahead(0.6)]))
    assert (
        PersonDetector(heard.latest, heard.now + 1.0, P3AT, ClutterMap()).nearest_person() is None
    )


def test_who_was_lost_may_come_back_farther_away_but_only_near_where_they_went() -> None:
    heard = hearing(Scene(people=[ahead(1.3, 10.0)]))
    assert heard.nearest_person() is None
    assert heard.returning_person(*ahead(1.4, 20.0)) is not None
    assert heard.returning_person(*ahead(0.3, -40.0)) is None


def test_without_echoes_there_is_nobody() -> None:
    heard = hearing(Scene())
    assert all(ping.distance == inf for ping in heard.latest.values())
    assert heard.nearest_person() is None
