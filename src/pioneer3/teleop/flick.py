"""From a phone that is turned to keys, with the lab's thresholds. Pure."""

from typing import Final

from pioneer3.teleop.keyboard import Key

FLICK: Final = 3.0
"""Slower turns mean nothing [rad/s]."""


def key_of(x: float, y: float, z: float) -> Key | None:
    """Return the key that a phone's turning stands for, if any.

    Args:
        x: About its right-hand side [rad/s]: forward, back.
        y: About its upper side: stop.
        z: About its screen: left, right.
    """
    if abs(x) > FLICK:
        return Key.FORWARD if x > 0 else Key.BACK
    if abs(z) > FLICK:
        return Key.LEFT if z > 0 else Key.RIGHT
    return Key.STOP if abs(y) > FLICK else None
