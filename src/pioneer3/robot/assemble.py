"""Turns reports into snapshots: counts into metres and radians, wrapping counters into a pose."""

from collections import deque
from functools import cache
from math import inf, nan
from operator import attrgetter

from pioneer3.arcos.reports import Config, Fault, Sip, SipFlag
from pioneer3.geometry import ORIGIN, Pose2, Twist2, wrap
from pioneer3.models import RobotModel
from pioneer3.state import (
    Battery,
    Bumpers,
    Charging,
    Inputs,
    LinkQuality,
    Motors,
    Odometry,
    Snapshot,
    Sonar,
    Words,
)
from pioneer3.units import DECIVOLT, DEGREE

SONAR_MAX = 5.0
"""Echoes from farther away count as none [m] (facts.md 7.2)."""
SONAR_FLAGS = int(SipFlag.SONAR_1 | SipFlag.SONAR_2 | SipFlag.SONAR_3 | SipFlag.SONAR_4)
NO_TEMPERATURE = (None, -128, -127)
"""ARIA tests for the second, AMRISim sends the third (protocol.md 4.9)."""
ANALOG_VOLT = 5.0 / 255
RATE_WINDOW = 1.0
CHARGING = (
    Charging.NONE,
    Charging.BULK,
    Charging.OVERCHARGE,
    Charging.FLOAT,
    Charging.BALANCE,
)
SELDOM = attrgetter(
    *("battery_decivolts", "battery_decivolts_wide", "charge_state", "charge_percent", "number"),
    *("flags", "faults", "flags3", "left_stall_rear_bumpers", "right_stall_front_bumpers"),
    *("digital_in", "digital_out", "analog", "analog_port", "compass_raw", "temperature_celsius"),
)
"""Fields that seldom change: while they are the same, so is all that is made of them."""

POSITION_MODULUS = 1 << 15
"""X and Y count in 15 bits; servers that count in 16 agree with that (protocol.md 4.8)."""


def difference(new: int, old: int, modulus: int) -> int:
    """Return the shortest signed distance from `old` to `new` on a counter of `modulus` steps.

    In [-modulus / 2, modulus / 2): exact while the counter moves less than half its range between
    two readings, which at 1 mm a count and 100 ms is 163 m/s.
    """
    half = modulus >> 1
    return (new - old + half) % modulus - half


class Counter:
    """A running total of a wrapping counter, in whole counts so that nothing is lost."""

    def __init__(self, modulus: int) -> None:
        self.total = 0
        self._modulus = modulus
        self._last: int | None = None

    def update(self, raw: int) -> int:
        """Take the next reading; return the total since the first one of this session."""
        if self._last is not None:
            self.total += difference(raw, self._last, self._modulus)
        self._last = raw
        return self.total


class Odometer:
    """Integrates the robot's counters into a pose that is continuous over reconnections."""

    def __init__(self) -> None:
        self.robot_in_odom = self.robot_in_encoder = ORIGIN
        self._begin = ORIGIN
        self._anchor: Pose2 | None = None
        self._x, self._y = Counter(POSITION_MODULUS), Counter(POSITION_MODULUS)

    def restart(self, pose: Pose2 | None = None) -> None:
        """Let the next reading be the present pose, or `pose`; the counters start again."""
        self._begin = self.robot_in_odom if pose is None else pose
        self._anchor = None
        self._x, self._y = Counter(POSITION_MODULUS), Counter(POSITION_MODULUS)

    def update(self, sip: Sip, model: RobotModel) -> Pose2:
        """Take the next reading; return the pose [m, rad]."""
        here = Pose2(
            self._x.update(sip.x_raw) * model.distance_factor,
            self._y.update(sip.y_raw) * model.distance_factor,
            wrap(sip.heading_raw * model.heading_factor),
        )
        before, self.robot_in_encoder = self.robot_in_encoder, here
        matrix = model.odometry.matrix(model.wheel_base)
        if self._anchor is None:
            self._anchor = self._begin @ here.inverse()
            matrix = None
        if matrix is None:
            self.robot_in_odom = self._anchor @ here
        else:
            self.robot_in_odom @= matrix.of_step(before.inverse() @ here)
        return self.robot_in_odom


class Assembler:
    """Makes snapshots of one robot, over all sessions with it."""

    def __init__(self) -> None:
        self.odometer = Odometer()
        self._sequence = 0
        self._ranges: list[float] = []
        self._stamps: deque[float] = deque()
        self.sessions = 0
        self._reports = 0
        self._seldom: object = None
        self._last: Snapshot | None = None

    def session_opened(self, model: RobotModel) -> None:
        """Begin a session: counters and readings of the last one are no longer valid."""
        self.odometer.restart()
        self._ranges = [nan] * len(model.sonars)
        self._stamps.clear()
        self.sessions += 1
        self._reports = 0

    def assemble(
        self,
        sip: Sip,
        stamp: float,
        *,
        model: RobotModel,
        config: Config | None,
        bad_checksums: int = 0,
        bytes_skipped: int = 0,
    ) -> Snapshot:
        """Return the snapshot made from `sip`, received at `stamp` [s]."""
        self._sequence += 1
        self._reports += 1
        self._stamps.append(stamp)
        while stamp - self._stamps[0] >= RATE_WINDOW:
            self._stamps.popleft()
        seldom = (SELDOM(sip), model, config)
        same = self._last if seldom == self._seldom else None
        self._seldom = seldom
        self._last = snapshot = Snapshot(
            stamp=stamp,
            sequence=self._sequence,
            odometry=self._odometry(sip, model),
            battery=same.battery if same else _battery(sip, config),
            motors=same.motors if same else _motors(sip),
            sonar=self._sonar(sip, model),
            bumpers=same.bumpers if same else _bumpers(sip, model, config),
            inputs=same.inputs if same else _inputs(sip),
            link=LinkQuality(
                reports=self._reports,
                bad_checksums=bad_checksums,
                bytes_skipped=bytes_skipped,
                rate=self._rate(),
                sessions=self.sessions,
            ),
            faults=_names(sip.faults) if sip.faults else (),
            words=same.words if same else _words(sip),
        )
        return snapshot

    def _rate(self) -> float:
        """Return the reports per second over the last second, from their intervals."""
        span = self._stamps[-1] - self._stamps[0]
        return (len(self._stamps) - 1) / span if span > 0 else 0.0

    def _odometry(self, sip: Sip, model: RobotModel) -> Odometry:
        left = sip.left_speed_raw * model.speed_factor
        right = sip.right_speed_raw * model.speed_factor
        if sip.turn_rate_decidegrees is None:
            turn_rate = (right - left) / model.wheel_base
        else:
            turn_rate = sip.turn_rate_decidegrees / 10 * DEGREE
        twist = Twist2((left + right) / 2, turn_rate)
        if (matrix := model.odometry.matrix(model.wheel_base)) is not None:
            wheels = matrix.of(Twist2(twist.v, (right - left) / model.wheel_base))
            twist, across = matrix.of(twist), wheels.w * model.true_base / 2
            left, right = wheels.v - across, wheels.v + across
        return Odometry(
            robot_in_odom=self.odometer.update(sip, model),
            robot_in_encoder=self.odometer.robot_in_encoder,
            twist=twist,
            left_speed=left,
            right_speed=right,
        )

    def _sonar(self, sip: Sip, model: RobotModel) -> Sonar:
        for reading in sip.sonar:
            while reading.number >= len(self._ranges):
                self._ranges.append(nan)
            metres = reading.range_raw * model.range_factor
            self._ranges[reading.number] = metres if metres < SONAR_MAX else inf
        return Sonar(
            ranges=tuple(self._ranges),
            fresh=tuple(reading.number for reading in sip.sonar),
            enabled=int(sip.flags) & SONAR_FLAGS != 0,
        )


def _battery(sip: Sip, config: Config | None) -> Battery:
    decivolts = sip.battery_decivolts_wide or sip.battery_decivolts
    voltage = decivolts * DECIVOLT
    state = sip.charge_state
    charging = CHARGING[state] if state is not None and state < len(CHARGING) else Charging.UNKNOWN
    alarm = (config.low_battery_decivolts or 0) * DECIVOLT if config else 0.0
    percent = sip.charge_percent
    reported = sip.faults is not None and Fault.UNDERVOLTAGE in sip.faults
    return Battery(
        voltage=voltage,
        charge=percent / 100 if percent else None,
        charging=charging,
        low=0 < voltage < alarm or reported,
    )


def _motors(sip: Sip) -> Motors:
    return Motors(
        enabled=SipFlag.MOTORS_ENABLED in sip.flags,
        left_stalled=bool(sip.left_stall_rear_bumpers & 1),
        right_stalled=bool(sip.right_stall_front_bumpers & 1),
        moving=sip.moving,
        stop_button=SipFlag.STOP_BUTTON in sip.flags,
    )


def _bumpers(sip: Sip, model: RobotModel, config: Config | None) -> Bumpers:
    front = (config.front_bumpers if config else None) or model.front_bumpers
    rear = (config.rear_bumpers if config else None) or model.rear_bumpers
    return Bumpers(
        front=_segments(sip.right_stall_front_bumpers, front),
        rear=_segments(sip.left_stall_rear_bumpers, rear),
    )


@cache
def _segments(bits: int, count: int) -> tuple[bool, ...]:
    return tuple(bool(bits >> (i + 1) & 1) for i in range(min(count, 7)))


def _inputs(sip: Sip) -> Inputs:
    celsius = sip.temperature_celsius
    return Inputs(
        digital_in=sip.digital_in or 0,
        digital_out=sip.digital_out or 0,
        analog=(sip.analog or 0) * ANALOG_VOLT,
        analog_port=sip.analog_port or 0,
        compass=wrap(2 * sip.compass_raw * DEGREE) if sip.compass_raw else None,
        temperature=None if celsius in NO_TEMPERATURE else celsius,
    )


def _words(sip: Sip) -> Words:
    return Words(
        flags=int(sip.flags),
        stalls=sip.left_stall_rear_bumpers | sip.right_stall_front_bumpers << 8,
        faults=None if sip.faults is None else int(sip.faults),
        flags3=None if sip.flags3 is None else int(sip.flags3),
    )


def _names(flags: Fault) -> tuple[str, ...]:
    return tuple(str(fault.name).lower().replace("_", " ") for fault in flags)
