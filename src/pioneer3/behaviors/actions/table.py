"""Sensors that look up at tables, which sonars miss."""

from dataclasses import dataclass

from pioneer3.behaviors.situation import Situation

LEFT, RIGHT = 1 << 0, 1 << 1
"""Of the digital inputs, low when triggered (arcos.md 4.7, old wiring)."""


@dataclass(frozen=True, slots=True)
class Table:
    """Which of the two sees the edge of a table."""

    left: bool = False
    right: bool = False

    def __bool__(self) -> bool:
        """Whether either does."""
        return self.left or self.right

    def __str__(self) -> str:
        sides = [side for side, seen in (("left", self.left), ("right", self.right)) if seen]
        return f"a table on the {' and '.join(sides)}" if sides else "no table"


def table_seen(situation: Situation) -> Table:
    """Return what the table sensors see; nothing without such sensors."""
    if not situation.model.table_irs:
        return Table()
    bits = situation.snapshot.inputs.digital_in
    return Table(not bits & LEFT, not bits & RIGHT)
