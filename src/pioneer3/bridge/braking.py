"""Stops of the bridge itself: repeated until the robot's reports confirm them. No I/O, no clock."""

from math import inf
from typing import Final

from pioneer3.arcos import commands
from pioneer3.arcos.reports import Sip
from pioneer3.arcos.reports.sip import SipFlag

STOP: Final = commands.to_payload(commands.Stop())
EMERGENCY_STOP: Final = commands.to_payload(commands.EStop())
POWER_OFF: Final = commands.to_payload(commands.Enable(on=False))
REPEAT: Final = 0.2
"""Pause between two stops [s]: a lost one costs that much."""
BRAKING: Final = 1.0
"""Longest wait for the robot to stand before its motors lose their power [s]."""
LONGEST: Final = 3.0
"""A robot that moves on after that many seconds of stops is not repeated any more [s]."""
REACTION: Final = 0.15
"""A report younger than this after a stop may be from before it [s]: one cycle, and a cable."""
STANDING_MM_S: Final = 5
"""Wheels slower than this stand [mm/s]."""


class Braking:
    """One stop at a time, `active` from when it is wanted until the robot stands.

    By the last report the motors may be `powerless`, and the wheels `at_rest`. :meth:`tick` must be
    called at the deadline [s, monotonic, as every `now`].
    """

    def __init__(self) -> None:
        self.active = self.powerless = self.at_rest = False
        self.deadline = inf
        self._takes_power = self._stands = False
        self._began = -inf

    def begin(self, now: float, *, take_power: bool = False, hard: bool = False) -> list[bytes]:
        """Begin to stop; return the packets to send at once.

        The motors lose their power once the robot stands with `take_power`, and at once with
        `hard`, which stops as hard as the robot can.
        """
        self._takes_power = (self._takes_power and self.active) or take_power or hard
        self.active, self._stands, self._began = True, False, now
        self.deadline = now + REPEAT
        return [STOP, EMERGENCY_STOP, POWER_OFF] if hard else [STOP]

    def cancel(self) -> None:
        """Leave the robot to a fresh command."""
        self.active, self.deadline = False, inf

    def observe(self, report: Sip, now: float) -> None:
        """Take a report of the robot."""
        self.powerless = not report.flags & SipFlag.MOTORS_ENABLED
        speed = max(abs(report.left_speed_raw), abs(report.right_speed_raw))
        self.at_rest = speed <= STANDING_MM_S
        self._stands = self.at_rest and now >= self._began + REACTION
        if self.active and self._stands:
            if self._takes_power and not self.powerless:
                self.deadline = min(self.deadline, now)
            else:
                self.cancel()

    def tick(self, now: float) -> list[bytes]:
        """Return the packets that are due."""
        if now < self.deadline:
            return []
        self.deadline = now + REPEAT
        late = now >= self._began + BRAKING
        if self._takes_power and (self._stands or late):
            return [POWER_OFF] if self._stands else [STOP, POWER_OFF]
        if now >= self._began + LONGEST:
            self.cancel()
            return []
        return [STOP]
