"""Finds the twist to tell a controller whose odometry is wrong, so that the robot moves as asked.

The controller regulates the speeds that it measures. Whoever reads its reports corrects them by the
model's `odometry`; its commands are corrected the other way round.
"""

from typing import Final

from pioneer3.geometry import STILL, Twist2
from pioneer3.limits import Limits
from pioneer3.models.odometry import TwistMatrix
from pioneer3.robot.limits import limit
from pioneer3.state import Bumpers
from pioneer3.units import DEGREE

SETTLED: Final = 0.2
"""In this time [s] a later frame makes up for the rounding of those before it."""
FORGOTTEN: Final = 1.0
"""After a longer pause [s] the rounding of a frame is not made up for."""


class TwistCorrection:
    """Makes the twists of one session's frames. No clock.

    RVEL has whole degrees per second (protocol.md 3.1), and a robot bows by less than one: what
    rounding leaves out of a frame is put into those after it.
    """

    def __init__(self, matrix: TwistMatrix, limits: Limits) -> None:
        """`matrix` makes true twists of measured ones; `limits` are the controller's, too."""
        self._inverse, self._limits = matrix.inverse(), limits
        self._owed = self._left_out = 0.0
        self._at = -FORGOTTEN

    def told(self, twist: Twist2, now: float) -> Twist2:
        """Return what makes the robot move at `twist` from `now` [s] on; a stop stays one."""
        elapsed, self._at = now - self._at, now
        if twist.is_zero or elapsed > FORGOTTEN:
            self._owed = self._left_out = 0.0
        if twist.is_zero:
            return STILL
        wanted = limit(self._inverse.of(twist), self._limits, Bumpers())
        self._owed += self._left_out * elapsed
        more = max(-DEGREE, min(DEGREE, self._owed / SETTLED))
        turn_rate = round((wanted.w + more) / DEGREE) * DEGREE
        self._left_out = wanted.w - turn_rate
        top = self._limits.max_turn_rate
        # never a speed that nobody asked for, such as towards a pressed bumper
        speed = wanted.v if wanted.v * twist.v > 0 else 0.0
        return Twist2(speed, max(-top, min(top, turn_rate)))
