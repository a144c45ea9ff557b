"""What the old emulator does otherwise than a robot, in numbers: why its tracks differ from ours.

Facts: facts.md 9.3, 9.4, protocol.md 4.9; the times of its reaction are measured in the captures.
"""

from math import radians
from pathlib import Path

import numpy as np

from pioneer3.arcos import commands
from pioneer3.geometry import wrap
from tests.conformance.replay import CYCLE, Float, captured, said

LATENCY = 0.1
"""By how much its motion comes late [s]. A command acts in the second cycle after it, or in the
third; half a cycle is won back, because each step goes its whole way with the velocity of its end.
"""
READ_WITHIN = 0.003
"""What comes this soon after a report [s] is still read in that cycle, the rest in the next."""
TOP_TURN_RATE = 0.75
"""Of its p3at, whatever SETRV says [rad/s]."""
JUMP = 0.05
"""A turn rate this near to the wanted one, either sign, jumps there [rad/s]."""
SLOWEST = 0.007
"""It turns to a heading at least this fast [rad/s]."""
ROUNDED = radians(0.5)
"""TH comes in whole degrees [rad]."""
BEAM_STEP = radians(180 / 181)
"""Between beams [rad]: it divides the field of view by the number of beams, not of gaps."""


def headings(path: Path, turn_acceleration: float) -> Float:
    """Return where its way of turning leads at each of its reports [rad].

    For RVEL it ramps. For HEAD the turn rate [rad/s] is the angle left [rad], so it never turns
    faster than it could in a second, and comes nearer and nearer without arriving soon. It reads
    at its reports and obeys one cycle later. A reversal of the turn happens at once.
    """
    wall = [time for time, _ in captured(path).sips]
    orders = [
        (time, order)
        for time, order in said(path)
        if isinstance(order, commands.RVel | commands.Head)
    ]
    theta, rate, result = 0.0, 0.0, [0.0, 0.0]
    for read in wall[:-2]:
        known = [order for time, order in orders if time <= read + READ_WITHIN]
        rate = _ramp(rate, _wanted_rate(known[-1:], theta), turn_acceleration * CYCLE)
        theta += rate * CYCLE
        result.append(theta)
    return np.array(result)


def _wanted_rate(order: list[commands.RVel | commands.Head], theta: float) -> float:
    match order:
        case [commands.RVel(rate)]:
            return max(-TOP_TURN_RATE, min(TOP_TURN_RATE, rate))
        case [commands.Head(heading)]:
            left = wrap(heading - theta)
            size = max(SLOWEST, min(TOP_TURN_RATE, abs(left)))
            return size if left > 0 else -size
    return 0.0


def _ramp(rate: float, wanted: float, change: float) -> float:
    if abs(abs(rate) - abs(wanted)) <= JUMP or wanted < 0 < rate:
        return wanted
    return rate + max(-change, min(change, wanted - rate))
