"""What the sonars say (facts.md 8.7)."""

from collections.abc import Mapping, Sequence
from math import isfinite, isnan
from types import MappingProxyType

from pioneer3.demo.modes.cockpit import Cockpit
from pioneer3.demo.modes.mode import Gauge, Mode
from pioneer3.demo.modes.row import Cell, Row, millimetres
from pioneer3.robot.devices import Presence
from pioneer3.state import Sonar

WIDTH = 6
FARTHEST = 5.0
"""What ARIA prints where nothing echoed [m]."""
NEAR = 0.5
GROUPS: Mapping[str, range] = MappingProxyType(
    {
        "1": range(32),
        "2": range(8),
        "3": range(8, 16),
        "4": range(16, 24),
        "5": range(24, 32),
    }
)


def sonar(cockpit: Cockpit) -> Mode:
    """Return the mode that shows ranges."""
    shown = GROUPS["2"]

    def on_key(key: str) -> bool:
        nonlocal shown
        if key not in GROUPS:
            return False
        shown = GROUPS[key]
        if cockpit.snapshot and shown[0] >= len(cockpit.snapshot.sonar.ranges):
            cockpit.say(f"This robot has no sonars {shown[0]} to {shown[-1]}.")
        return True

    def presence() -> Presence:
        count = len(cockpit.robot.info.model.sonars)
        if count:
            return Presence(True, f"The robot's model has {count} sonars.")
        return Presence(False, "The robot has no sonars: its model has none.")

    def now() -> Sonar:
        return cockpit.snapshot.sonar if cockpit.snapshot else Sonar()

    return Mode(
        key="s",
        name="sonar",
        help=("1: all", "2: 0-7", "3: 8-15", "4, 5: 16-23, 24-31"),
        presence=presence,
        on_key=on_key,
        row=lambda: sonar_row(now().ranges, shown) if cockpit.snapshot else None,
        gauges=lambda: _gauges(now().ranges, shown),
    )


def sonar_row(ranges: Sequence[float], shown: range) -> Row:
    """Return numbers and ranges of the sonars in `shown` that there are."""
    numbers = [number for number in shown if number < len(ranges)]
    return Row(tuple(Cell(str(n), WIDTH, millimetres(_bounded(ranges[n]))) for n in numbers))


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
