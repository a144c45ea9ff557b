"""Which bumpers touch something (facts.md 8.8)."""

from pioneer3.demo.modes.cockpit import Cockpit
from pioneer3.demo.modes.mode import Mode
from pioneer3.demo.modes.row import Cell, Row
from pioneer3.robot.devices import Presence
from pioneer3.state import Bumpers

WIDTH = 6
SEPARATOR = Cell(" |", 2, " |")


def bumps(cockpit: Cockpit) -> Mode:
    """Return the mode that shows bumpers by segment."""

    def presence() -> Presence:
        snapshot, config = cockpit.snapshot, cockpit.robot.info.config
        if snapshot is None:
            return Presence(None, "Nobody knows of bumpers: no robot is connected.")
        front, rear = len(snapshot.bumpers.front), len(snapshot.bumpers.rear)
        source = "CONFIG" if config and (config.front_bumpers or config.rear_bumpers) else "model"
        if front or rear:
            return Presence(
                True, f"The robot's {source} says {front} front and {rear} rear segments."
            )
        return Presence(False, "The robot has no bumpers: neither its CONFIG nor its model has.")

    return Mode(
        key="b",
        name="bumps",
        help=("front: left to right", "rear: right to left"),
        presence=presence,
        row=lambda: bumps_row(cockpit.snapshot.bumpers) if cockpit.snapshot else None,
    )


def bumps_row(bumpers: Bumpers) -> Row:
    """Return front and rear segments, `trig` or `clear`."""
    return Row((*_segments(bumpers.front), SEPARATOR, *_segments(bumpers.rear)))


def _segments(segments: tuple[bool, ...]) -> tuple[Cell, ...]:
    return tuple(
        Cell(str(number), WIDTH, "trig" if pressed else "clear")
        for number, pressed in enumerate(segments, 1)
    )
