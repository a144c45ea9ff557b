"""The contents of the standard report, measured by the controller (protocol.md 4)."""

from collections.abc import Sequence
from itertools import compress
from math import degrees
from typing import Final

import numpy as np
from msgspec.structs import replace

from pioneer3.arcos import commands
from pioneer3.arcos.commands import Command
from pioneer3.arcos.reports import (
    NO_TEMPERATURE,
    SIP_MOVING,
    SIP_STOPPED,
    Fault,
    Sip,
    SipFlag,
    SonarReading,
)
from pioneer3.geometry import wrap
from pioneer3.sim.accessories import SipFields
from pioneer3.sim.accessories.gauges import LOW, charge_percent
from pioneer3.sim.body import Body
from pioneer3.sim.sensors import ARRAY, Firing, in_order
from pioneer3.sim.world import World
from pioneer3.units import DECIVOLT

FLAGS = SipFlag.SONAR_1, SipFlag.SONAR_2, SipFlag.SONAR_3, SipFlag.SONAR_4
SHORT: Final = frozenset({"P2OS", "AmigoOS", "PSOS"})
"""Controllers whose reports end before the fields that came with ARCOS (protocol.md 4.2)."""
LONGEST = 16
"""Transducers in the order of an array."""


class SonarArrays:
    """The sonar arrays of a robot with `count` transducers, in the default order and off at first.

    `firing` are the transducers that fire, in order, and `flags` the arrays that are on.
    """

    def __init__(self, count: int) -> None:
        self._count = count
        self.reset(on=False)

    def reset(self, *, on: bool) -> None:
        """Return to the default order."""
        self._orders = [*in_order(self._count)]
        self._on = [on] * len(FLAGS)
        self._tell()

    def switch(self, on: bool, array: int) -> None:
        """Switch one array, 1 to 4, or all of them, 0."""
        for each in range(len(FLAGS)):
            if array in {0, each + 1}:
                self._on[each] = on
        self._tell()

    def poll(self, numbers: Sequence[int]) -> None:
        """Set the order of those arrays that `numbers`, from 1, are of; none switch all off."""
        if not numbers:
            self.switch(on=False, array=0)
        for array in range(len(self._orders)):
            those = range(array * ARRAY, min((array + 1) * ARRAY, self._count))
            order = tuple(number - 1 for number in numbers if number - 1 in those)
            if order:
                self._orders[array] = order[:LONGEST]
        self._tell()

    def _tell(self) -> None:
        pairs = zip(self._orders, self._on, strict=False)
        self.firing: Firing = tuple(order if on else () for order, on in pairs)
        self.flags = SipFlag(0)
        for flag in compress(FLAGS, self._on):
            self.flags |= flag


MOST_READINGS = 32
"""Sonar readings in a report; 32 still fit into the 200 bytes of a frame (facts.md 12)."""
HOT = 80.0
"""Motors are too hot from here on [degC]; unverified."""
NOT_CHARGING, BULK, OVERCHARGE, FLOAT = range(4)
OVERCHARGE_FROM = 80
"""Charge at which a charger goes over to overcharge [percent]; unverified."""
FLOAT_FROM = 100
"""Charge at which it goes over to float [percent]; unverified."""
WIRE_BITS = 0x7FFF
"""Bits of x and y that hosts look at (protocol.md 4.2, 4.8)."""


class Instruments:
    """The controller's own sensors, and the commands that switch or fake them."""

    def __init__(self, world: World, body: Body) -> None:
        self._world, self._body = world, body
        self._sonar_arrays = SonarArrays(len(body.model.sonars))
        self._fake_heat = False
        self._fake_temperature: int | None = None
        self._bumped = False
        self.hang_up()

    def hang_up(self) -> None:
        """Return to the state after power-on: bumps at both ends are stalls."""
        # the user manual of the Pioneer 3; older firmware began with none
        self._front_stalls = self._rear_stalls = True
        self._sonar_arrays.reset(on=False)
        self._fire()

    def begin(self) -> None:
        """Begin a session: sonars fire from now on."""
        self._sonar_arrays.reset(on=True)
        self._fire()

    def obey(self, command: Command) -> bool:
        """Switch or fake a sensor; return whether `command` was for this."""
        match command:
            case commands.Sonar(on, array):
                self._sonar_arrays.switch(on, array)
                self._fire()
            case commands.Polling(numbers):
                self._sonar_arrays.poll(numbers)
                self._fire()
            case commands.BumpStall(front, rear):
                self._front_stalls, self._rear_stalls = front, rear
            case commands.BatTest(voltage):
                self._body.battery.fixed = voltage or None
            case commands.DigTempTest(on):
                self._fake_heat = on
            case commands.SpoofAnalogTemp(celsius):
                self._fake_temperature = None if celsius == NO_TEMPERATURE else celsius
            case _:
                return False
        return True

    def feel(self) -> None:
        """Stop if a bumper touches on the side the robot drives to, if that counts as a stall."""
        body, drive = self._body, self._body.drive
        ahead = drive.linear.velocity or drive.linear.target or drive.linear.remaining or 0.0
        bumpers = body.front_bumpers if ahead > 0 else body.rear_bumpers
        stalls = self._front_stalls if ahead > 0 else self._rear_stalls
        self._bumped = bool(ahead and stalls and bumpers)
        if self._bumped:
            drive.stop()
            drive.halt()

    def read(self, inputs: SipFields) -> Sip:
        """Return the standard report for this moment; accessories have filled in `inputs`."""
        body, model = self._body, self._body.model
        odom, angular = body.robot_in_odom, body.drive.angular
        v, w = body.speeds
        half = w * body.track / 2
        left_stalled, right_stalled = (int(each or self._bumped) for each in body.stalled_sides)
        faked = self._fake_temperature
        celsius = body.motor_temperature if faked is None else faked
        hot = celsius >= HOT or self._fake_heat
        volts, charge = body.battery.voltage, charge_percent(body.battery)
        decivolts = round(volts / DECIVOLT)
        report = Sip(
            number=SIP_MOVING if v or w else SIP_STOPPED,
            x_raw=round(odom.x / model.distance_factor) & WIRE_BITS,
            y_raw=round(odom.y / model.distance_factor) & WIRE_BITS,
            heading_raw=round(odom.theta / model.heading_factor),
            left_speed_raw=round((v - half) / model.speed_factor),
            right_speed_raw=round((v + half) / model.speed_factor),
            battery_decivolts=min(decivolts, 255),
            left_stall_rear_bumpers=left_stalled | body.rear_bumpers,
            right_stall_front_bumpers=right_stalled | body.front_bumpers,
            control_raw=round(wrap(odom.theta + (angular.remaining or 0.0)) / model.heading_factor),
            flags=self._flags(hot=hot) | inputs.flags,
            compass_raw=inputs.compass_raw,
            sonar=self._sonar(),
            analog_port=inputs.analog_port,
            gripper_state=inputs.gripper_state,
            analog=inputs.analog,
            digital_in=inputs.digital_in,
            digital_out=inputs.digital_out,
            battery_decivolts_wide=decivolts,
            charge_state=_charge_state(charge) if body.charging else NOT_CHARGING,
            turn_rate_decidegrees=round(degrees(w) * 10),
            faults=_faults(hot=hot, low=volts <= LOW),
            lateral_speed_mm=0,
            temperature_celsius=max(-127, min(127, round(celsius))),
            # 0 stands for "cannot tell" (protocol.md 4.2)
            charge_percent=max(1, charge),
        )
        return _shortened(report) if model.controller in SHORT else report

    def _flags(self, *, hot: bool) -> SipFlag:
        body = self._body
        flags = self._sonar_arrays.flags
        if body.drive.powered:
            flags |= SipFlag.MOTORS_ENABLED
        if body.stop_button:
            flags |= SipFlag.STOP_BUTTON
        if body.charging:
            flags |= SipFlag.CHARGER_POWER_GOOD
        return flags | SipFlag.HIGH_TEMPERATURE if hot else flags

    def _fire(self) -> None:
        self._world.fire(self._body, self._sonar_arrays.firing)

    def _sonar(self) -> tuple[SonarReading, ...]:
        numbers, ranges = self._world.fresh_sonar(self._body)
        raw = np.rint(ranges / self._body.model.range_factor).astype(int)
        return tuple(map(SonarReading, numbers[:MOST_READINGS].tolist(), raw.tolist()))


def _shortened(report: Sip) -> Sip:
    """Return a report without the fields from the wide battery voltage on."""
    return replace(
        report,
        battery_decivolts_wide=None,
        charge_state=None,
        turn_rate_decidegrees=None,
        faults=None,
        lateral_speed_mm=None,
        temperature_celsius=None,
        charge_percent=None,
    )


def _charge_state(percent: int) -> int:
    if percent >= FLOAT_FROM:
        return FLOAT
    return OVERCHARGE if percent >= OVERCHARGE_FROM else BULK


def _faults(*, hot: bool, low: bool) -> Fault:
    faults = Fault(0)
    if hot:
        faults |= Fault.HIGH_TEMPERATURE
    if low:
        faults |= Fault.UNDERVOLTAGE
    return faults
