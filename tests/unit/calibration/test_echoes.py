"""A full turn by what sonars hear once more."""

from math import cos, degrees, inf, pi

import numpy as np
import pytest

from pioneer3.arrays import Float
from pioneer3.calibration.echoes import full_turn
from pioneer3.errors import DeviceError


def turning(
    counted: float, *, turns: float = 3.0, wall: float | None = 0.5, seed: int = 0
) -> Float:
    """Return echoes of eight sonars, 25 a second, at 30 deg/s; a full turn counts as `counted`."""
    rng = np.random.default_rng(seed)
    rows = []
    for number, raw in enumerate(np.arange(0.0, turns * counted, 0.021).tolist()):
        transducer = number % 8
        bearing = raw * 2 * pi / counted + transducer * pi / 4
        heard = inf
        if wall is not None and cos(bearing) > cos(0.7):
            heard = wall + rng.normal() * 0.005
        rows.append((raw, transducer, heard))
    return np.array(rows)


@pytest.mark.parametrize("ratio", [0.94, 1.0, 1.03, 1.1])
def test_it_is_found_within_half_a_degree_and_four_deviations(ratio: float) -> None:
    found = full_turn(turning(ratio * 2 * pi))
    assert degrees(found.counted) == pytest.approx(360 * ratio, abs=0.6)
    assert found.counted == pytest.approx(ratio * 2 * pi, abs=4 * found.sigma)


def test_turns_to_the_right_tell_the_same() -> None:
    echoes = turning(1.02 * 2 * pi)
    echoes[:, 0] *= -1
    assert full_turn(echoes).counted == pytest.approx(1.02 * 2 * pi, rel=0.003)


def test_echoes_that_tell_nothing_are_refused() -> None:
    with pytest.raises(DeviceError, match="the same all around"):
        full_turn(turning(2 * pi, wall=None))
    with pytest.raises(DeviceError, match="let the robot turn"):
        full_turn(turning(2 * pi, turns=1.2))
    with pytest.raises(DeviceError, match="let the robot turn"):
        full_turn(np.empty((0, 3)))
    noise = turning(2 * pi)
    noise[:, 2] = np.random.default_rng(1).uniform(0.3, 2.0, len(noise))
    with pytest.raises(DeviceError, match="the same all around"):
        full_turn(noise)
