"""Things that are not on the map."""

import numpy as np
import pytest
from numpy.typing import NDArray

from pioneer3.geometry import Pose2
from pioneer3.nav.beams import Beams
from pioneer3.nav.sightings import AGE, Sightings
from tests.unit.nav.offices import costs, room

Float = NDArray[np.float64]
HERE = Pose2(2.0, 3.0, 0.0)


def beams(stamp: float, *points: tuple[float, float], clear: tuple[float, float] = (0, 0)) -> Beams:
    """Return a scan with echoes at points of the robot's frame."""
    return Beams(
        stamp=stamp,
        robot_in_odom=Pose2(),
        points=np.array(points, dtype=np.float64).reshape(-1, 2),
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
    sightings.take(beams(6.0, (5.0, 0.0)), HERE)
    assert sightings.points(6.0) == pytest.approx(np.array([[7.0, 3.0]]), abs=0.05)
    sightings.take(beams(7.0, clear=(30.0, 0.0)), HERE)
    assert not len(sightings.points(7.0))


def test_a_beam_clears_nothing_right_before_its_echo(sightings: Sightings) -> None:
    sightings.take(beams(5.0, (3.0, 0.0)), HERE)
    sightings.take(beams(6.0, (3.1, 0.0)), HERE)
    assert len(sightings.points(6.0)) == 2


def test_old_things_do_not_count(sightings: Sightings) -> None:
    sightings.take(beams(5.0, (3.0, 0.0)), HERE)
    assert len(sightings.points(5.0 + AGE))
    assert not len(sightings.points(5.1 + AGE))


def test_far_things_are_not_noted(sightings: Sightings) -> None:
    sightings.take(beams(5.0, (7.0, 0.5)), HERE)
    assert not len(sightings.points(5.0))


def test_everything_can_be_forgotten(sightings: Sightings) -> None:
    sightings.take(beams(5.0, (3.0, 0.0)), HERE)
    sightings.forget()
    assert not len(sightings.points(5.0))
