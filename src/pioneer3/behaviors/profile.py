"""How fast to go with so much left to go."""

from math import copysign, sqrt

SETTLE = 0.35
"""Time constant of the last stretch [s]: three report cycles, so that it does not overshoot."""
MARGIN = 0.7
"""Share of the deceleration planned with; the rest covers the delay of a report cycle."""


def approach(remaining: float, top: float, deceleration: float) -> float:
    """Return the speed towards a point `remaining` away, signed like it.

    Square root far away (constant deceleration), proportional near. Metres or radians alike.
    """
    distance = abs(remaining)
    speed = min(top, sqrt(2 * MARGIN * deceleration * distance), distance / SETTLE)
    return copysign(speed, remaining)
