"""The joystick at the robot (arcos.md 3.2 row 17, 5.8)."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import isfinite

from pioneer3.arcos import commands
from pioneer3.arcos.commands import Command
from pioneer3.arcos.reports import Joystick as JoystickReport
from pioneer3.arcos.reports import Report, SipFlag
from pioneer3.errors import ConfigError
from pioneer3.sim.firmware.accessories.base import Asked, Inputs

CENTRE, TOP = 512, 1023


@dataclass(frozen=True, slots=True, kw_only=True)
class Stick:
    """How somebody holds the stick.

    Attributes:
        forward: -1 backward to 1 forward.
        left: -1 right to 1 left.
        throttle: 0 to 1.
        button1: Pressed; robots drive by joystick only while it is.
        button2: Pressed.

    Raises:
        ConfigError: A value is not finite.
    """

    forward: float = 0.0
    left: float = 0.0
    throttle: float = 0.0
    button1: bool = False
    button2: bool = False

    def __post_init__(self) -> None:
        """Refuse NaN and infinity; what is too large stops at the end of the stick."""
        if not all(map(isfinite, (self.forward, self.left, self.throttle))):
            raise ConfigError(f"{self!r}: not finite")


class Joystick:
    """Reports how :attr:`stick` is held; it does not drive the simulated robot."""

    def __init__(self) -> None:
        self.stick = Stick()
        self._asked = Asked()

    def obey(self, command: Command, now: float) -> bool:
        """Take requests for reports."""
        match command:
            case commands.JoyInfo(how):
                self._asked.ask(how)
                return True
        return False

    def reports(self, now: float, *, cycle: bool) -> Sequence[Report]:
        """Return the stick's position when it is due."""
        if not self._asked.due(cycle=cycle):
            return ()
        stick = self.stick
        return (
            JoystickReport(
                button1=int(stick.button1),
                button2=int(stick.button2),
                x_raw=_raw(CENTRE + CENTRE * stick.left),
                y_raw=_raw(CENTRE + CENTRE * stick.forward),
                throttle_raw=_raw(2 * CENTRE * stick.throttle),
            ),
        )

    def inputs(self, sip: Inputs, now: float) -> Inputs:
        """Show the first button among the flags."""
        if not self.stick.button1:
            return sip
        return replace(sip, flags=sip.flags | SipFlag.JOYSTICK_BUTTON)

    def hang_up(self) -> None:
        """Send no more reports."""
        self._asked = Asked()


def _raw(value: float) -> int:
    return max(0, min(TOP, round(value)))
