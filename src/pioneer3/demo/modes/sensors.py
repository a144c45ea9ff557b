"""Sonars, bumpers and the laser (facts.md 8.7, 8.8, 8.11)."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from math import atan2, hypot, isfinite, isnan, pi

from pioneer3.demo.columns import ColumnCell, ColumnRow, millimetres
from pioneer3.demo.mode import Context, DemoMode, Description, Gauge
from pioneer3.geometry import ORIGIN
from pioneer3.robot.devices import Presence
from pioneer3.state import Bumpers, Scan, Sonar
from pioneer3.units import DEGREE, MM

SONAR_WIDTH = 6
FARTHEST = 5.0
"""ARIA prints this where nothing echoed [m]."""
NEAR = 0.5
GROUPS: Mapping[str, range] = {
    "1": range(32),
    "2": range(8),
    "3": range(8, 16),
    "4": range(16, 24),
    "5": range(24, 32),
}


def sonar(context: Context, about: Description) -> DemoMode:
    """Return the mode that shows ranges."""
    shown = GROUPS["2"]

    def on_key(key: str) -> bool:
        nonlocal shown
        if key not in GROUPS:
            return False
        shown = GROUPS[key]
        if context.snapshot and shown[0] >= len(context.snapshot.sonar.ranges):
            context.say(f"This robot has no sonars {shown[0]} to {shown[-1]}.")
        return True

    def presence() -> Presence:
        count = len(context.robot.info.model.sonars)
        if count:
            return Presence(True, f"The robot's model has {count} sonars.")
        return Presence(False, "The robot has no sonars: its model has none.")

    def now() -> Sonar:
        return context.snapshot.sonar if context.snapshot else Sonar()

    return DemoMode(
        about,
        presence=presence,
        on_key=on_key,
        row=lambda: sonar_row(now().ranges, shown) if context.snapshot else None,
        gauges=lambda: _gauges(now().ranges, shown),
    )


def sonar_row(ranges: Sequence[float], shown: range) -> ColumnRow:
    """Return numbers and ranges of the sonars in `shown` that there are."""
    numbers = [number for number in shown if number < len(ranges)]
    return ColumnRow(
        tuple(ColumnCell(str(n), SONAR_WIDTH, millimetres(_bounded(ranges[n]))) for n in numbers)
    )


def _gauges(ranges: Sequence[float], shown: range) -> list[Gauge]:
    return [
        Gauge(
            name=f"{number:2d}",
            share=min(ranges[number], FARTHEST) / FARTHEST,
            text=f"{ranges[number]:.2f} m" if isfinite(ranges[number]) else "no echo",
            alarm=ranges[number] < NEAR,
        )
        for number in shown
        if number < len(ranges) and not isnan(ranges[number])
    ]


def _bounded(distance: float) -> float:
    return min(distance, FARTHEST) if not isnan(distance) else distance


BUMPER_WIDTH = 6
SEPARATOR = ColumnCell(" |", 2, " |")


def bumps(context: Context, about: Description) -> DemoMode:
    """Return the mode that shows bumpers by segment."""

    def presence() -> Presence:
        snapshot, config = context.snapshot, context.robot.info.config
        if snapshot is None:
            return Presence(None, "Nobody knows of bumpers: no robot is connected.")
        front, rear = len(snapshot.bumpers.front), len(snapshot.bumpers.rear)
        source = "CONFIG" if config and (config.front_bumpers or config.rear_bumpers) else "model"
        if front or rear:
            return Presence(
                True, f"The robot's {source} says {front} front and {rear} rear segments."
            )
        return Presence(False, "The robot has no bumpers: neither its CONFIG nor its model has.")

    return DemoMode(
        about,
        presence=presence,
        row=lambda: bumps_row(context.snapshot.bumpers) if context.snapshot else None,
    )


def bumps_row(bumpers: Bumpers) -> ColumnRow:
    """Return front and rear segments, `trig` or `clear`."""
    return ColumnRow((*_segments(bumpers.front), SEPARATOR, *_segments(bumpers.rear)))


def _segments(segments: tuple[bool, ...]) -> tuple[ColumnCell, ...]:
    return tuple(
        ColumnCell(str(number), BUMPER_WIDTH, "trig" if pressed else "clear")
        for number, pressed in enumerate(segments, 1)
    )


Point = tuple[float, float]


def laser(context: Context, about: Description) -> DemoMode:
    """Return the mode that shows the laser."""
    lasers, device = context.robot.lasers, context.robot.laser
    raw, held = False, ExitStack()

    def on_key(key: str) -> bool:
        nonlocal raw
        if key in {"z", "Z"}:
            raw = not raw
        elif key in set("123456789"):
            choose(int(key))
        else:
            return False
        return True

    def choose(number: int) -> None:
        nonlocal device
        if number <= len(lasers):
            device = lasers[number - 1]
            connect()
            context.say(f"Laser {number} it is: {device.presence.reason}")
        elif len(lasers) == 1:
            context.say(f"There is no laser {number}: laser 1 is the only one.")
        else:
            context.say(f"There is no laser {number}: there are lasers 1 to {len(lasers)}.")

    @contextmanager
    def enter() -> Iterator[None]:
        with held:
            connect()
            yield

    def connect() -> None:
        held.close()
        held.enter_context(device.wanted())

    def row() -> ColumnRow | None:
        scan = device.latest
        if scan is None or context.snapshot is None:
            return None
        told = raw_line(scan) if raw else buffer_line(scan)
        return ColumnRow(tail=f"{told}   LOST" if device.lost else told)

    def points() -> list[Point]:
        return points_in_robot(device.latest) if device.latest else []

    return DemoMode(
        about,
        presence=lambda: device.presence,
        enter=enter,
        on_key=on_key,
        again=connect,
        row=row,
        points=points,
    )


def points_in_robot(scan: Scan) -> list[Point]:
    """Return where the laser hit something, in the robot's frame [m]."""
    return replace(scan, robot_in_odom=ORIGIN, last_in_odom=None).points_in_odom()


def buffer_line(scan: Scan) -> str:
    """Return the nearest point in front, the farthest one, and how many readings there are."""
    points = [(hypot(x, y), atan2(y, x)) for x, y in points_in_robot(scan)]
    ahead = [point for point in points if abs(point[1]) <= pi / 2]
    close = f"Close: {_polar(*min(ahead))}" if ahead else "No close reading."
    far = f"Far: {_polar(*max(points))}" if points else "No far reading."
    return f"{close}   {far}   {len(scan.ranges)} readings"


def raw_line(scan: Scan) -> str:
    """Return the nearest reading and the one in the middle, as the laser gives them."""
    if not scan.ranges:
        return "No readings."
    nearest = min(range(len(scan.ranges)), key=lambda number: scan.ranges[number])
    close = _reading(scan, nearest) if isfinite(scan.ranges[nearest]) else "none"
    return f"Close: {close}   Middle: {_reading(scan, len(scan.ranges) // 2)}"


def _reading(scan: Scan, number: int) -> str:
    reflectance = scan.reflectances[number] if scan.reflectances else 0
    return f"{_polar(scan.ranges[number], scan.angles[number])} {reflectance} refl"


def _polar(distance: float, angle: float) -> str:
    length = f"{distance / MM:4.0f}mm" if isfinite(distance) else "  no echo"
    return f"{length} {angle / DEGREE:z5.1f} deg"
