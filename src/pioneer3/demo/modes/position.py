"""Driving distances and turning right angles, and where that leads (facts.md 8.9)."""

from contextlib import AbstractContextManager, nullcontext
from math import pi

from pioneer3.arcos.commands import GyroMode
from pioneer3.behaviors.action import MODE, Ranked, Stack
from pioneer3.demo.modes.cockpit import Cockpit
from pioneer3.demo.modes.driving import speed_gauges
from pioneer3.demo.modes.mode import Mode
from pioneer3.demo.modes.row import (
    MISSING,
    Cell,
    Row,
    degrees_tenths,
    hundredths,
    millimetres,
    whole_degrees,
)
from pioneer3.demo.modes.travel import Travel
from pioneer3.geometry import Pose2
from pioneer3.robot.devices.gyro import GyroReading
from pioneer3.state import Snapshot
from pioneer3.units import DEGREE

DISTANCE, STEP = 1.0, 0.5
"""Of a move at first; what PageUp and PageDown change, and the least [m]."""
QUARTER = pi / 2
HELP = (
    "UNGUARDED, INTO WHAT IS IN THE WAY",
    "up, down: drive",
    "left, right: turn 90°",
    "page up, down: ±0.5 m",
    "space: stop",
    "r: here is 0, 0, 0",
    "x: both or either",
    "z: gyro off, only, on",
)
GYRO_ORDER = {
    GyroMode.ON: GyroMode.OFF,
    GyroMode.OFF: GyroMode.ONLY,
    GyroMode.ONLY: GyroMode.ON,
}


def position(cockpit: Cockpit) -> Mode:
    """Return the mode that drives distances."""
    pilot = _Legs(cockpit)
    return Mode(
        key="p",
        name="position",
        help=HELP,
        enter=pilot.enter,
        on_key=pilot.on_key,
        row=pilot.row,
        gauges=lambda: speed_gauges(cockpit),
        details=pilot.details,
    )


class _Legs:
    def __init__(self, cockpit: Cockpit) -> None:
        self._cockpit = cockpit
        self._distance = DISTANCE
        self._both = True
        self._gyro = GyroMode.ON
        self._stack: Stack | None = None
        self._travel = Travel()

    @property
    def has_gyro(self) -> bool:
        return bool(self._cockpit.robot.devices.gyro.presence.there)

    def enter(self) -> AbstractContextManager[object]:
        return self._cockpit.robot.devices.gyro.wanted() if self.has_gyro else nullcontext()

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
                self._cockpit.robot.arbiter.stop()
            case "r":
                self._reset()
            case "x":
                self._both = not self._both
            case "z":
                self._next_gyro()
            case _:
                return False
        return True

    def row(self) -> Row | None:
        snapshot, gyro = self._cockpit.snapshot, self._cockpit.robot.devices.gyro.latest
        if snapshot is None:
            return None
        mode = "both" if self._both else "either"
        return position_row(snapshot, self._cockpit.pose(snapshot), mode, self._gyro, gyro)

    def details(self) -> tuple[str, ...]:
        return (f"drives {self._distance:.1f} m",)

    def _go(self, *, distance: float | None = None, turn: float | None = None) -> None:
        snapshot = self._cockpit.snapshot
        if snapshot is None:
            self._cockpit.say("No robot is connected.")
            return
        running = self._cockpit.drives(self._stack)
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
            self._cockpit.tell(self._cockpit.robot.arbiter.decide())
        else:
            self._stack = Stack.of("position", MODE, (Ranked(50, self._travel),))
            self._cockpit.start(self._stack)

    def _reset(self) -> None:
        self._cockpit.robot.arbiter.stop()
        if self._cockpit.snapshot is not None:
            self._cockpit.origin = self._cockpit.snapshot.odometry.robot_in_odom
        self._cockpit.say("This place is 0, 0, 0 now; the robot itself was told nothing.")

    def _next_gyro(self) -> None:
        if not self.has_gyro:
            self._cockpit.say(str(self._cockpit.robot.devices.gyro.presence))
            return
        self._gyro = GYRO_ORDER[self._gyro]
        self._cockpit.robot.devices.gyro.set_mode(self._gyro)


def position_row(
    snapshot: Snapshot, pose: Pose2, mode: str, gyro: GyroMode, reading: GyroReading | None
) -> Row:
    """Return where the robot is; the gyro's columns only if it says anything."""
    inputs, raw = snapshot.inputs, snapshot.odometry.robot_in_encoder
    compass = MISSING if inputs.compass is None else whole_degrees(inputs.compass)
    cells = [
        Cell("x", 7, millimetres(pose.x)),
        Cell("y", 7, millimetres(pose.y)),
        Cell("th", 9, hundredths(pose.theta / DEGREE)),
        Cell("comp", 7, compass),
        Cell("volts", 8, hundredths(snapshot.battery.voltage)),
        Cell("mpacs", 7, str(round(snapshot.link.rate))),
        Cell("mode", 8, mode),
    ]
    if reading is not None:
        cells += [
            Cell("gyro", 6, gyro.name.lower()),
            Cell("gyro_th", 10, hundredths(reading.heading / DEGREE)),
            Cell("robot_th", 10, hundredths(raw.theta / DEGREE)),
        ]
    place = f"{millimetres(raw.x)},{millimetres(raw.y)},{degrees_tenths(raw.theta)}"
    return Row((*cells, Cell("raw", 10, f" {place}")))
