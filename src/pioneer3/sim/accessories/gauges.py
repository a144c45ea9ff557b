"""Accessories that only report: battery, wheel encoders, joystick (protocol.md 5.2, 5.8, 5.9)."""

from dataclasses import dataclass, replace
from math import isfinite
from typing import ClassVar

from pioneer3.arcos import commands
from pioneer3.arcos.commands import Command
from pioneer3.arcos.reports import BatteryInfo, Report, SipFlag, SmartBattery
from pioneer3.arcos.reports import Encoders as EncoderReport
from pioneer3.arcos.reports import Joystick as JoystickReport
from pioneer3.errors import ConfigError
from pioneer3.sim.accessories.base import BatteryState, CarryingRobot, ReportingAccessory, SipFields
from pioneer3.sim.body import EMPTY, FULL

LOW = 11.5
"""The firmware reports a low battery below it [V]; CONFIG has it (protocol.md 5.1)."""


def charge_percent(battery: BatteryState) -> int:
    """Return the charge, 0 to 100; a voltage that a test has set replaces the real one."""
    fixed = battery.fixed
    share = battery.charge if fixed is None else (fixed - EMPTY) / (FULL - EMPTY)
    return max(0, min(100, round(100 * share)))


Request = commands.RequestBatteryInfo | commands.RequestEncoders | commands.JoyInfo


class SimulatedGauge(ReportingAccessory):
    """A device that answers one kind of request."""

    request: ClassVar[type[Request]]

    def obey(self, command: Command, now: float) -> bool:
        if not isinstance(command, self.request):
            return False
        self._request.set(command.how)
        return True


class BatteryGauge(SimulatedGauge):
    """One battery with a gauge; its flags are all clear. The firmware reports the voltage."""

    request = commands.RequestBatteryInfo

    def __init__(self, body: CarryingRobot) -> None:
        super().__init__()
        self._body = body

    def read(self, now: float) -> Report:
        percent = charge_percent(self._body.battery)
        battery = SmartBattery(
            flags1=0,
            flags2=0,
            flags3=0,
            relative_charge_percent=percent,
            absolute_charge_percent=percent,
        )
        return BatteryInfo((battery,))


TICKS_PER_METRE = {"skid": 138_000, "differential": 128_000}
"""Ticks of a P3-AT and a P3-DX, as quoted from their manuals, unverified (protocol.md 5.1)."""


class SimulatedEncoders(SimulatedGauge):
    """Two counters of 32 bits that run from power-on; SETO does not reset them."""

    request = commands.RequestEncoders

    def __init__(self, body: CarryingRobot) -> None:
        super().__init__()
        self._body = body
        self._ticks = TICKS_PER_METRE[body.model.drive]

    def read(self, now: float) -> Report:
        left, right = (_s32(way * self._ticks) for way in self._body.wheel_travel)
        return EncoderReport(left_counts=left, right_counts=right)


def _s32(count: float) -> int:
    """Return `count` as a signed counter of 32 bits has it."""
    return (round(count) + (1 << 31)) % (1 << 32) - (1 << 31)


CENTRE, TOP = 512, 1023


@dataclass(frozen=True, slots=True, kw_only=True)
class StickPosition:
    """The position of the stick, from -1 to 1, and of the throttle, 0 to 1; all finite.

    Robots drive by joystick only while `button1` is pressed.
    """

    forward: float = 0.0
    left: float = 0.0
    throttle: float = 0.0
    button1: bool = False
    button2: bool = False

    def __post_init__(self) -> None:
        """Refuse NaN and infinity; larger numbers count as the end of the stick."""
        if not all(map(isfinite, (self.forward, self.left, self.throttle))):
            raise ConfigError(f"{self!r}: not finite")


class SimulatedJoystick(SimulatedGauge):
    """Reports the position of :attr:`stick`; it does not drive the simulated robot."""

    request = commands.JoyInfo

    def __init__(self) -> None:
        super().__init__()
        self.stick = StickPosition()

    def read(self, now: float) -> Report:
        stick = self.stick
        return JoystickReport(
            button1=int(stick.button1),
            button2=int(stick.button2),
            x_raw=_raw(CENTRE + CENTRE * stick.left),
            y_raw=_raw(CENTRE + CENTRE * stick.forward),
            throttle_raw=_raw(2 * CENTRE * stick.throttle),
        )

    def inputs(self, sip: SipFields, now: float) -> SipFields:
        """Show the first button among the flags."""
        if not self.stick.button1:
            return sip
        return replace(sip, flags=sip.flags | SipFlag.JOYSTICK_BUTTON)


def _raw(value: float) -> int:
    return max(0, min(TOP, round(value)))
