"""What the laser sees nearest and farthest (facts.md 8.11)."""

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from math import atan2, cos, hypot, isfinite, pi, sin

from pioneer3.demo.modes.cockpit import Cockpit
from pioneer3.demo.modes.mode import Mode
from pioneer3.demo.modes.row import Row
from pioneer3.state import Scan
from pioneer3.units import DEGREE, MM

Point = tuple[float, float]


def laser(cockpit: Cockpit) -> Mode:
    """Return the mode that shows the laser."""
    device = cockpit.robot.devices.laser
    raw, held = False, ExitStack()

    def on_key(key: str) -> bool:
        nonlocal raw
        if key in {"z", "Z"}:
            raw = not raw
        elif key == "1":
            cockpit.say("Laser 1 it is.")
        elif key in set("23456789"):
            cockpit.say(f"There is no laser {key}: laser 1 is the only one.")
        else:
            return False
        return True

    @contextmanager
    def enter() -> Iterator[None]:
        with held:
            connect()
            yield

    def connect() -> None:
        held.close()
        held.enter_context(device.wanted())

    def row() -> Row | None:
        scan = device.latest
        if scan is None or cockpit.snapshot is None:
            return None
        return Row(tail=raw_line(scan) if raw else buffer_line(scan))

    return Mode(
        key="l",
        name="laser",
        help=("1-9: choose the laser", "z: raw readings or not", "l: connect again"),
        presence=lambda: device.presence,
        enter=enter,
        on_key=on_key,
        again=connect,
        row=row,
    )


def points_in_robot(scan: Scan) -> list[Point]:
    """Return where the laser hit something, in the robot's frame [m]."""
    mount = scan.sensor_in_robot
    return [
        (
            mount.x + distance * cos(mount.theta + angle),
            mount.y + distance * sin(mount.theta + angle),
        )
        for angle, distance in zip(scan.angles, scan.ranges, strict=True)
        if isfinite(distance)
    ]


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
