"""Driving distances and turning right angles (facts.md 8.9)."""

from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, field
from math import cos, pi, radians, sin

from pioneer3.arcos.commands import GyroMode
from pioneer3.behaviors.action import MODE, Action, Desire, Ranked, Situation, Stack
from pioneer3.behaviors.engine import approach
from pioneer3.demo.columns import (
    MISSING,
    ColumnCell,
    ColumnRow,
    degrees_tenths,
    hundredths,
    millimetres,
    whole_degrees,
)
from pioneer3.demo.mode import Context, DemoMode, Description
from pioneer3.demo.modes.driving import speed_gauges
from pioneer3.geometry import Pose2, wrap
from pioneer3.robot.devices.gyro import GyroReading
from pioneer3.state import Snapshot
from pioneer3.units import DEGREE

NEAR = 0.005
"""Distance from the goal that is near enough [m]."""
ALIGNED = radians(1)
"""Angle from the goal that is near enough [rad]."""
STANDING = 0.01
"""Speed below which the robot stands [m/s]."""
TURNING = radians(2)
"""Turn rate below which the robot stands [rad/s]."""


@dataclass(slots=True)
class Travel(Action):
    """Moves as MOVE and HEAD do, bounded by the robot's limits.

    It is `done` where it should be, and stands.
    """

    name: str = "travel"
    done: bool = False
    _left: float = field(default=0.0, init=False)
    _heading: float | None = field(default=None, init=False)
    _last: Pose2 | None = field(default=None, init=False)

    def go(self, distance: float) -> None:
        """Drive `distance` [m] along the way, wherever that bends; negative is backwards."""
        self._left, self.done = distance, False

    def face(self, heading: float) -> None:
        """Turn to `heading` in odometry's frame [rad], or keep it."""
        self._heading, self.done = wrap(heading), False

    def decide(self, situation: Situation) -> Desire:
        """Return speed and heading for the rest of the way."""
        here, twist, limits = situation.pose, situation.twist, situation.limits
        if self._last is not None:
            dx, dy = here.x - self._last.x, here.y - self._last.y
            self._left -= dx * cos(here.theta) + dy * sin(here.theta)
        self._last = here
        there = abs(self._left) <= NEAR
        off = 0.0 if self._heading is None else wrap(self._heading - here.theta)
        aligned = abs(off) <= ALIGNED
        still = abs(twist.v) < STANDING and abs(twist.w) < TURNING
        self.done = there and aligned and still
        to_go = f"{self._left:z.2f} m and {off / DEGREE:z.0f} deg to go"
        return Desire(
            v=0.0 if there else approach(self._left, limits.max_speed, limits.deceleration),
            heading=None if aligned else self._heading,
            w=0.0 if aligned else None,
            reason="there" if there and aligned else to_go,
        )


DISTANCE = 1.0
"""Distance of a move at first [m]."""
STEP = 0.5
"""Change by PageUp and PageDown, and the least distance [m]."""
QUARTER = pi / 2
GYRO_ORDER = {GyroMode.ON: GyroMode.OFF, GyroMode.OFF: GyroMode.ONLY, GyroMode.ONLY: GyroMode.ON}


def position(context: Context, about: Description) -> DemoMode:
    """Return the mode that drives distances."""
    pilot = _Position(context)
    return DemoMode(
        about,
        enter=pilot.enter,
        on_key=pilot.on_key,
        row=pilot.row,
        gauges=lambda: speed_gauges(context),
        details=pilot.details,
    )


class _Position:
    def __init__(self, context: Context) -> None:
        self._context = context
        self._distance = DISTANCE
        self._both = True
        self._gyro = GyroMode.ON
        self._stack: Stack | None = None
        self._travel = Travel()

    @property
    def has_gyro(self) -> bool:
        return bool(self._context.robot.devices.gyro.presence.there)

    def enter(self) -> AbstractContextManager[object]:
        return self._context.robot.devices.gyro.wanted() if self.has_gyro else nullcontext()

    def on_key(self, key: str) -> bool:
        match key.lower():
            case "up":
                self._go(distance=self._distance)
            case "down":
                self._go(distance=-self._distance)
            case "left":
                self._go(turn=QUARTER)
            case "right":
                self._go(turn=-QUARTER)
            case "pageup":
                self._distance += STEP
            case "pagedown":
                self._distance = max(STEP, self._distance - STEP)
            case "space":
                self._context.robot.arbiter.stop()
            case "r":
                self._reset()
            case "x":
                self._both = not self._both
            case "z":
                self._next_gyro()
            case _:
                return False
        return True

    def row(self) -> ColumnRow | None:
        snapshot, gyro = self._context.snapshot, self._context.robot.devices.gyro.latest
        if snapshot is None:
            return None
        mode = "both" if self._both else "either"
        return position_row(snapshot, self._context.pose(snapshot), mode, self._gyro, gyro)

    def details(self) -> tuple[str, ...]:
        return (f"drives {self._distance:.1f} m",)

    def _go(self, *, distance: float | None = None, turn: float | None = None) -> None:
        snapshot = self._context.snapshot
        if snapshot is None:
            self._context.say("No robot is connected.")
            return
        running = self._context.drives(self._stack)
        if not (running and self._both):
            self._travel = Travel()
        theta = snapshot.odometry.robot_in_odom.theta
        if distance is not None:
            self._travel.go(distance)
            if not self._both:
                self._travel.face(theta)
        if turn is not None:
            self._travel.face(theta + turn)
        if running and self._both:
            self._context.tell(self._context.robot.arbiter.decide())
        else:
            self._stack = Stack.of("position", MODE, (Ranked(50, self._travel),))
            self._context.start(self._stack)

    def _reset(self) -> None:
        self._context.robot.arbiter.stop()
        if self._context.snapshot is not None:
            self._context.origin = self._context.snapshot.odometry.robot_in_odom
        self._context.say("This place is 0, 0, 0 now; the robot itself was told nothing.")

    def _next_gyro(self) -> None:
        if not self.has_gyro:
            self._context.say(str(self._context.robot.devices.gyro.presence))
            return
        self._gyro = GYRO_ORDER[self._gyro]
        self._context.robot.devices.gyro.set_mode(self._gyro)


def position_row(
    snapshot: Snapshot, pose: Pose2, mode: str, gyro: GyroMode, reading: GyroReading | None
) -> ColumnRow:
    """Return where the robot is; the gyro's columns only if it says anything."""
    inputs, raw = snapshot.inputs, snapshot.odometry.robot_in_encoder
    compass = MISSING if inputs.compass is None else whole_degrees(inputs.compass)
    cells = [
        ColumnCell("x", 7, millimetres(pose.x)),
        ColumnCell("y", 7, millimetres(pose.y)),
        ColumnCell("th", 9, hundredths(pose.theta / DEGREE)),
        ColumnCell("comp", 7, compass),
        ColumnCell("volts", 8, hundredths(snapshot.battery.voltage)),
        ColumnCell("mpacs", 7, str(round(snapshot.link.rate))),
        ColumnCell("mode", 8, mode),
    ]
    if reading is not None:
        cells += [
            ColumnCell("gyro", 6, gyro.name.lower()),
            ColumnCell("gyro_th", 10, hundredths(reading.heading / DEGREE)),
            ColumnCell("robot_th", 10, hundredths(raw.theta / DEGREE)),
        ]
    place = f"{millimetres(raw.x)},{millimetres(raw.y)},{degrees_tenths(raw.theta)}"
    return ColumnRow((*cells, ColumnCell("raw", 10, f" {place}")))
