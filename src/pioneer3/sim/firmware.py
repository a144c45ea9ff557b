"""The robot's controller: commands become motion, the world becomes reports.

The only file of the simulator that knows ARCOS. Facts: arcos.md 2.7, 3, 4, 5, 12; where the old
emulator is wrong (arcos.md 9, 13), this follows the real firmware.
"""

from math import degrees

from pioneer3.arcos import commands, reports
from pioneer3.arcos.commands import Command
from pioneer3.arcos.device import (
    Commanded,
    Device,
    Event,
    SessionClosed,
    SessionOpened,
    WatchdogBit,
    WatchdogFed,
)
from pioneer3.geometry import Pose2, wrap
from pioneer3.sim.accessories import Accessories, Equipment
from pioneer3.sim.body import Body
from pioneer3.sim.configuration import configuration
from pioneer3.sim.motion import Axis
from pioneer3.sim.scanner import Scanner
from pioneer3.sim.world import World
from pioneer3.state import Identity
from pioneer3.units import DECIVOLT, HEADING_UNIT

CYCLE = 0.1
"""Pause between information packets [s]."""
NAME = "MobileSim"
"""By this name real ARIA programs know a simulator, and take its laser (arcos.md 2.6)."""
NO_TEMPERATURE = -128
MOST_READINGS = 32
MOTION = (
    commands.Vel,
    commands.RVel,
    commands.Rotate,
    commands.Move,
    commands.Head,
    commands.DHead,
    commands.Vel2,
)
ALL_SONARS = (
    reports.SipFlag.SONAR_1
    | reports.SipFlag.SONAR_2
    | reports.SipFlag.SONAR_3
    | reports.SipFlag.SONAR_4
)


class Firmware:
    """One robot's controller: feed it bytes and time, send :attr:`device`'s outgoing bytes."""

    def __init__(
        self,
        world: World,
        body: Body,
        name: str = NAME,
        watchdog: float = 2.0,
        equipment: Equipment | None = None,
    ) -> None:
        self.body = body
        self.identity = Identity(name=name, family=body.model.family, model=body.model.name)
        self.device = Device(self.identity, watchdog)
        self._world = world
        self._watchdog = watchdog
        self._scanner = Scanner(world, body)
        self.accessories = Accessories(body, equipment)
        self._next_report = 0.0

    def receive(self, data: bytes, now: float) -> None:
        """Take bytes from the host at `now` [s, monotonic]."""
        for event in self.device.receive(data, now):
            self._handle(event, now)

    def hang_up(self, now: float) -> None:
        """Take note that the host's link is gone for good."""
        for event in self.device.hang_up():
            self._handle(event, now)

    def tick(self, now: float) -> None:
        """Look at the clock: the watchdog, and the reports that are due."""
        for event in self.device.tick(now):
            self._handle(event, now)
        self.accessories.tick(now)
        if self.device.is_open:
            self._send(now, cycle=False)
        if not self.device.is_open or now < self._next_report - 1e-6:
            return
        late = now - self._next_report > CYCLE
        self._next_report = now + CYCLE if late else self._next_report + CYCLE
        self._send(now, cycle=True)
        self.device.send(self.information(now))
        for report in self._scanner.reports():
            self.device.send(report)

    def _send(self, now: float, *, cycle: bool) -> None:
        for report in self.accessories.reports(now, cycle=cycle):
            self.device.send(report)

    def information(self, now: float) -> reports.Sip:
        """Return the standard information packet for this moment."""
        body, model = self.body, self.body.model
        v, w = body.drive.linear.velocity, body.drive.angular.velocity
        half = w * model.wheel_base / 2
        inputs = self.accessories.inputs(now)
        decivolts = round(body.battery.voltage / DECIVOLT)
        flags = reports.SipFlag(0)
        if body.drive.powered:
            flags |= reports.SipFlag.MOTORS_ENABLED
        if body.sonar_on:
            flags |= ALL_SONARS
        if body.stop_button:
            flags |= reports.SipFlag.STOP_BUTTON
        return reports.Sip(
            number=reports.SIP_MOVING if v or w else reports.SIP_STOPPED,
            x_raw=round(body.robot_in_odom.x / model.distance_factor) & 0x7FFF,
            y_raw=round(body.robot_in_odom.y / model.distance_factor) & 0x7FFF,
            heading_raw=round(body.robot_in_odom.theta / HEADING_UNIT),
            left_speed_raw=round((v - half) / model.speed_factor),
            right_speed_raw=round((v + half) / model.speed_factor),
            battery_decivolts=min(decivolts, 255),
            left_stall_rear_bumpers=int(body.stalled),
            right_stall_front_bumpers=int(body.stalled),
            control_raw=round(body.robot_in_odom.theta / HEADING_UNIT),
            flags=flags | inputs.flags,
            compass_raw=inputs.compass_raw,
            sonar=self._sonar_readings(),
            analog_port=inputs.analog_port,
            gripper_state=inputs.gripper_state,
            analog=inputs.analog,
            digital_in=inputs.digital_in,
            digital_out=inputs.digital_out,
            battery_decivolts_wide=decivolts,
            charge_state=0,
            turn_rate_decidegrees=round(degrees(w) * 10),
            faults=reports.Fault(0),
            lateral_speed_mm=0,
            temperature_celsius=NO_TEMPERATURE,
            charge_percent=0,
        )

    def _sonar_readings(self) -> tuple[reports.SonarReading, ...]:
        if not self.body.sonar_on:
            return ()
        unit = self.body.model.range_factor
        ranges = self._world.sonar(self.body)[:MOST_READINGS]
        return tuple(
            reports.SonarReading(number, round(metres / unit))
            for number, metres in enumerate(ranges.tolist())
        )

    def _handle(self, event: Event, now: float) -> None:
        match event:
            case SessionOpened():
                self.body.reset_odometry()
                self.body.sonar_on = True
                self._next_report = now
                self.tick(now)
            case SessionClosed():
                self.body.session_ended()
                self._scanner.off()
                self.accessories.hang_up()
            case Commanded(command):
                self._obey(command, now)
            case WatchdogBit():
                self.body.drive.held = True
            case WatchdogFed():
                self.body.drive.held = False

    def _obey(self, command: Command, now: float) -> None:
        """Carry out one command; what this robot does not have is ignored, as by the real one."""
        if not self.accessories.claims(command) and self._scanner.obey(command):
            return
        if self._move(command) or self._set_up(command):
            return
        if self.accessories.obey(command, now):
            self._send(now, cycle=False)
            return
        match command:
            case commands.RequestConfig():
                self.device.send(
                    configuration(
                        self.identity,
                        self.body,
                        self.accessories.equipment,
                        cycle=CYCLE,
                        watchdog=self._watchdog,
                    )
                )
            case commands.BatTest(voltage):
                self.body.battery.fixed = voltage or None
            case commands.SimSetPose(x, y, heading):
                self.body.robot_in_world = Pose2(x, y, wrap(heading))
            case commands.SimReset():
                self.body.reset()

    def _move(self, command: Command) -> bool:
        """Obey a motion command; return whether it was one."""
        drive = self.body.drive
        match command:
            case commands.Stop():
                drive.stop()
            case commands.EStop() | commands.QStop():
                drive.emergency_stop()
            case commands.Enable(on):
                self.body.enable_motors(on=on)
            case _ if isinstance(command, MOTION):
                if drive.obeys:  # otherwise ignored without an answer, nothing remembered
                    self._set_in_motion(command)
            case _:
                return False
        return True

    def _set_in_motion(self, command: Command) -> None:
        drive = self.body.drive
        match command:
            case commands.Vel(speed):
                drive.linear.go(speed)
            case commands.RVel(rate) | commands.Rotate(rate):
                drive.angular.go(rate)
            case commands.Move(distance):
                drive.linear.travel(distance)
            case commands.Head(heading):
                self.body.turn_to(heading)
            case commands.DHead(angle):
                self.body.turn_by(angle)
            case commands.Vel2(left_units, right_units):
                left, right = (u * self.body.model.vel2_unit for u in (left_units, right_units))
                drive.linear.go((left + right) / 2)
                drive.angular.go((right - left) / self.body.model.wheel_base)

    def _set_up(self, command: Command) -> bool:
        """Obey a command that sets a limit or a switch; return whether it was one."""
        body, drive = self.body, self.body.drive
        match command:
            case commands.SetV(speed):
                drive.linear.top = min(speed, body.model.max_speed)
            case commands.SetRV(rate):
                drive.angular.top = min(rate, body.model.max_turn_rate)
            case commands.SetA(acceleration):
                _set_ramp(drive.linear, acceleration)
            case commands.SetRA(acceleration):
                _set_ramp(drive.angular, acceleration)
            case commands.SetO(x, y, heading):
                body.reset_odometry(Pose2(x or 0.0, y or 0.0, wrap(heading or 0.0)))
            case commands.Sonar(on):
                body.sonar_on = on
            case _:
                return False
        return True


def _set_ramp(axis: Axis, acceleration: float) -> None:
    """Positive sets the acceleration, negative the deceleration; 0 sets nothing."""
    if acceleration > 0:
        axis.acceleration = acceleration
    elif acceleration < 0:
        axis.deceleration = -acceleration
