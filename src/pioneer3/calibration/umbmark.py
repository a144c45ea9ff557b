"""UMBmark: a square is driven both ways, and what it misses its beginning by is told apart.

Borenstein and Feng, Measurement and correction of systematic odometry errors in mobile robots, IEEE
Transactions on Robotics and Automation 12 (6), 1996. Whatever turns too much in corners makes a
square end on the same side both ways; whatever bends straight sides does not.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import degrees, hypot, pi, sin, sqrt

from pioneer3.geometry import ORIGIN, Pose2, arc

Point = tuple[float, float]

ROUNDS = 12
"""Times that the formulas are repeated."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Umbmark:
    """Errors by squares.

    Attributes:
        clockwise: Centre of gravity of the return errors [m]: the true place at the end, less that
            by odometry, ahead and to the left of the beginning. `counterclockwise` likewise.
        spread: Standard deviation of a return error about its centre [m]; 0 of single squares.
        alpha: Angle by which each corner turns less than odometry tells [rad].
        beta: Angle by which each side bends to the left [rad].
        base_ratio: E_b: distance of the wheels over what the controller takes it for.
        wheel_ratio: E_d: diameter of the right wheel over that of the left.
    """

    clockwise: Point
    counterclockwise: Point
    spread: float
    alpha: float
    beta: float
    base_ratio: float
    wheel_ratio: float

    @property
    def error(self) -> float:
        """E_max,syst: the larger distance of the two centres from the beginning [m]."""
        return max(hypot(*self.clockwise), hypot(*self.counterclockwise))

    @property
    def words(self) -> str:
        """The errors for people."""
        return (
            f"E = {100 * self.error:.1f} cm, alpha = {degrees(self.alpha):.2f} deg, "
            f"beta = {degrees(self.beta):.2f} deg"
        )


def umbmark(
    clockwise: Sequence[Point], counterclockwise: Sequence[Point], side: float, wheel_base: float
) -> Umbmark:
    """Return the errors by return errors [m] of squares of one `side` [m], one or more each way.

    The controller takes `wheel_base` [m] for the distance of the wheels. The published formulas
    are of the first order; they are repeated for what they leave of errors that are larger.
    """
    cw, ccw = _centre(clockwise), _centre(counterclockwise)
    alpha, beta = _angles(cw, ccw, side)
    for _ in range(ROUNDS):
        right, left = (_end(alpha, beta, side, left=each) for each in (False, True))
        told = _angles(right, left, side)
        wanted = _angles(cw, ccw, side)
        alpha, beta = alpha + wanted[0] - told[0], beta + wanted[1] - told[1]
    base_ratio = pi / 2 / (pi / 2 - alpha)
    # half of the distance of the wheels over the radius of a side
    half = base_ratio * wheel_base * sin(beta / 2) / side
    groups = ((clockwise, cw), (counterclockwise, ccw))
    squares = sum((x - c[0]) ** 2 + (y - c[1]) ** 2 for each, c in groups for x, y in each)
    free = len(clockwise) + len(counterclockwise) - 2
    return Umbmark(
        clockwise=cw,
        counterclockwise=ccw,
        spread=sqrt(squares / free) if free > 0 else 0.0,
        alpha=alpha,
        beta=beta,
        base_ratio=base_ratio,
        wheel_ratio=(1 + half) / (1 - half),
    )


def _angles(cw: Point, ccw: Point, side: float) -> tuple[float, float]:
    """Return alpha and beta by the published formulas, the mean of those by x and by y."""
    return (
        (-cw[0] - ccw[0] - cw[1] + ccw[1]) / (8 * side),
        (-cw[0] + ccw[0] - cw[1] - ccw[1]) / (8 * side),
    )


def _end(alpha: float, beta: float, side: float, *, left: bool) -> Point:
    """Return where a square ends whose corners and sides have these errors."""
    here = ORIGIN
    corner = Pose2(0.0, 0.0, pi / 2 - alpha if left else alpha - pi / 2)
    for _ in range(4):
        here = here @ arc(side, beta, 1.0) @ corner
    return here.x, here.y


def _centre(points: Sequence[Point]) -> Point:
    return sum(x for x, _ in points) / len(points), sum(y for _, y in points) / len(points)
