"""UMBmark finds the errors that a square was driven with."""

from cmath import rect
from math import degrees, pi, sin

import pytest

from pioneer3.calibration.track import square
from pioneer3.calibration.umbmark import Umbmark, umbmark
from pioneer3.models import OdometryCorrection

BASE = 0.33
SIDE = 4.0
KNOWN = [
    OdometryCorrection(base_ratio=1.004, wheel_ratio=1.001),
    OdometryCorrection(base_ratio=0.997, wheel_ratio=0.9995),
    OdometryCorrection(base_ratio=0.995, wheel_ratio=1.0005),
    OdometryCorrection(base_ratio=1.01, wheel_ratio=1.01),
    OdometryCorrection(base_ratio=0.98, wheel_ratio=0.99),
    OdometryCorrection(base_ratio=1.02, wheel_ratio=1.02),
]


def measured(truth: OdometryCorrection) -> Umbmark:
    cw, ccw = (
        square(SIDE, left=left).poses(truth, BASE)[-1, :2].tolist() for left in (False, True)
    )
    return umbmark([(cw[0], cw[1])], [(ccw[0], ccw[1])], SIDE, BASE)


@pytest.mark.parametrize("truth", KNOWN)
def test_the_angles_are_those_of_the_formulas(truth: OdometryCorrection) -> None:
    found = measured(truth)
    # by the errors: a corner turns 90 degrees / E_b, a side is an arc of the radius R
    alpha = pi / 2 - pi / 2 / truth.base_ratio
    ratio = truth.wheel_ratio
    beta = SIDE / (BASE / 2 * (ratio + 1) / (ratio - 1)) / truth.base_ratio
    assert found.alpha == pytest.approx(alpha, rel=0.01)
    assert found.beta == pytest.approx(beta, rel=0.01)


@pytest.mark.parametrize("truth", KNOWN)
def test_the_ratios_are_found_within_one_percent_of_their_errors(truth: OdometryCorrection) -> None:
    found = measured(truth)
    assert found.base_ratio - 1 == pytest.approx(truth.base_ratio - 1, rel=0.01)
    assert found.wheel_ratio - 1 == pytest.approx(truth.wheel_ratio - 1, rel=0.01)


def ending(alpha: float, beta: float, corner: float) -> complex:
    """Return where a square ends, by the sum of a geometric series: sides that are arcs."""
    side = SIDE * 2 * sin(beta / 2) / beta * rect(1, beta / 2)
    turn = rect(1, beta + corner * (1 - alpha / (pi / 2)))
    return side * (1 - turn**4) / (1 - turn)


@pytest.mark.parametrize("truth", KNOWN)
def test_the_largest_error_is_that_of_the_formula(truth: OdometryCorrection) -> None:
    found = measured(truth)
    worst = max(abs(ending(found.alpha, found.beta, corner)) for corner in (pi / 2, -pi / 2))
    assert found.error == pytest.approx(worst, rel=0.01)


@pytest.mark.parametrize("truth", KNOWN[:3])
def test_the_largest_error_is_that_of_the_first_order(truth: OdometryCorrection) -> None:
    found = measured(truth)
    # a square to the left ends at 2 L (beta - alpha), one to the right at -2 L (alpha + beta),
    # both ahead and aside
    worst = max(abs(found.alpha + found.beta), abs(found.alpha - found.beta))
    assert found.error == pytest.approx(2 * SIDE * 2**0.5 * worst, rel=0.01)


def test_corners_alone_end_on_one_side_and_sides_alone_on_both() -> None:
    corners = measured(OdometryCorrection(base_ratio=1.003))
    assert corners.clockwise[0] == pytest.approx(corners.counterclockwise[0], rel=0.02)
    sides = measured(OdometryCorrection(wheel_ratio=1.0005))
    assert sides.clockwise[0] == pytest.approx(-sides.counterclockwise[0], rel=0.02)


def test_several_squares_tell_their_spread() -> None:
    cw, ccw = [(0.1, 0.0), (0.12, 0.0), (0.08, 0.0)], [(-0.1, 0.0), (-0.1, 0.02), (-0.1, -0.02)]
    found = umbmark(cw, ccw, SIDE, BASE)
    assert found.clockwise == pytest.approx((0.1, 0.0))
    assert found.spread == pytest.approx(0.02)
    assert found.error == pytest.approx(0.1)
    assert f"{degrees(found.beta):.2f} deg" in found.words
