"""Carries out the commands that drive (protocol.md 3.1)."""

from dataclasses import replace

from pioneer3.arcos import commands
from pioneer3.arcos.commands import Command
from pioneer3.geometry import Pose2, wrap
from pioneer3.sim.body import Body
from pioneer3.sim.motion import Axis

NO_DRIFT = -8192
"""A drift factor by which the left encoder would count nothing."""
MOTION = (
    commands.Vel,
    commands.RVel,
    commands.Rotate,
    commands.Move,
    commands.Head,
    commands.DHead,
    commands.Vel2,
)


def steer(body: Body, command: Command) -> bool:
    """Carry out a command that moves, stops or limits `body`; return whether it was one."""
    drive = body.drive
    match command:
        case commands.Stop():
            drive.stop()
        case commands.EStop() | commands.QStop():
            drive.emergency_stop()
        case commands.Enable(on):
            body.enable_motors(on=on)
        case _ if isinstance(command, MOTION):
            if drive.obeys:  # otherwise ignored without an answer, nothing remembered
                _set_in_motion(body, command)
        case _:
            return _set_up(body, command)
    return True


def _set_in_motion(body: Body, command: Command) -> None:
    drive = body.drive
    match command:
        case commands.Vel(speed):
            drive.linear.go(speed)
        case commands.RVel(rate) | commands.Rotate(rate):
            drive.angular.go(rate)
        case commands.Move(distance):
            drive.linear.travel(distance)
        case commands.Head(heading):
            body.turn_to(heading)
        case commands.DHead(angle):
            body.turn_by(angle)
        case commands.Vel2(left_units, right_units):
            left, right = (units * body.model.vel2_unit for units in (left_units, right_units))
            drive.linear.go((left + right) / 2)
            drive.angular.go((right - left) / body.track)


def _set_up(body: Body, command: Command) -> bool:
    """Obey a command that sets a limit or the odometry; return whether it was one."""
    drive = body.drive
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
        case commands.TicksMM(ticks) if ticks:
            body.set_encoders(replace(body.encoders, ticks_mm=ticks))
        case commands.RevCount(ticks) if ticks:
            body.set_encoders(replace(body.encoders, rev_count=ticks))
        case commands.DriftFactor(correction) if correction > NO_DRIFT:
            body.set_encoders(replace(body.encoders, drift_factor=correction))
        case _:
            return False
    return True


def _set_ramp(axis: Axis, acceleration: float) -> None:
    """Positive sets the acceleration, negative the deceleration; 0 sets nothing."""
    if acceleration > 0:
        axis.acceleration = acceleration
    elif acceleration < 0:
        axis.deceleration = -acceleration
