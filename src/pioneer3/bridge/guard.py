"""Decides which packets of the host that has the robot reach it. No I/O, no clock.

All pass except commands that move the robot, while there is a reason to hold them back. A PULSE
takes their place, which keeps the robot's watchdog fed. Commands to stand still always pass.

==============  ==================================================================================
reason          ends
==============  ==================================================================================
`PAUSED`        when the pause ends
`STOPPED`       somebody else stopped the robot: with an ENABLE 1 of the host, once the motors are
                off. It shows that a person, or the program's own logic, wants the robot to move
`CUT_OFF`       :data:`SETTLE` after the host is heard again: commands from before come first
==============  ==================================================================================

A command that was held back is never sent later: the robot moves again for the next one.
"""

from enum import Enum
from typing import Final

PULSE: Final = bytes([0])
ENABLE: Final = 4
STOPS: Final = frozenset({29, 55, 57})
"""STOP, ESTOP and QSTOP (protocol.md 3.1)."""
DRIVE, TURN, SIDE = "drive", "turn", "side"
VELOCITIES: Final = {9: {TURN}, 11: {DRIVE}, 21: {TURN}, 32: {DRIVE, TURN}, 110: {SIDE}}
"""ROTATE, VEL, RVEL, VEL2 and LATVEL, and what each of them sets; 0 stops that."""
PLACES: Final = {8: {DRIVE}, 12: {TURN}, 13: {TURN}, 22: {TURN}}
"""MOVE, HEAD, DHEAD and DCHEAD: they end by themselves, and no number in them means standing."""


class HeldBack(Enum):
    """A reason to hold back commands that move the robot."""

    PAUSED = "paused"
    STOPPED = "somebody stopped the robot"
    CUT_OFF = "its host was cut off"


class Guard:
    """Follows what one host commands, and holds back what must not move the robot.

    `holds` are the reasons to hold back, and so many packets were `withheld`.
    """

    def __init__(self) -> None:
        self.holds: set[HeldBack] = set()
        self.withheld = 0
        self._moved: set[str] = set()

    @property
    def moving(self) -> bool:
        """Whether a command that reached the robot since its last stop may move it still."""
        return bool(self._moved)

    def stopped(self) -> None:
        """Note that the bridge itself has stopped the robot."""
        self._moved.clear()

    def passed(self, payload: bytes, *, powerless: bool) -> bytes:
        """Return the payload to send to the robot in the place of `payload`, which the host sent.

        `powerless` says that the robot's motors are off.
        """
        number = payload[0]
        if number in STOPS:
            self._moved.clear()
        elif number == ENABLE:
            return self._enable(payload, powerless=powerless)
        elif number in VELOCITIES and _is_zero(payload):
            self._moved -= VELOCITIES[number]
        elif axes := VELOCITIES.get(number) or PLACES.get(number):
            if self.holds:
                self.withheld += 1
                return PULSE
            self._moved |= axes
        return payload

    def _enable(self, payload: bytes, *, powerless: bool) -> bytes:
        if _is_zero(payload):
            self._moved.clear()
        elif HeldBack.STOPPED in self.holds:
            if not powerless:  # sent before the host could know of the stop
                self.withheld += 1
                return PULSE
            self.holds.discard(HeldBack.STOPPED)
        return payload


def moves(payload: bytes) -> bool:
    """Return whether a command of a host moves the robot."""
    number = payload[0]
    return number in PLACES or (number in VELOCITIES and not _is_zero(payload))


def _is_zero(payload: bytes) -> bool:
    """Return whether the number of a command is 0; without one, robots take it for 0 as well."""
    return not any(payload[2:4])
