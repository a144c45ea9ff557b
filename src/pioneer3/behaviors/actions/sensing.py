"""Table sensors, and words for obstacles, as several actions use them."""

from dataclasses import dataclass
from math import degrees

from pioneer3.behaviors.action import Situation
from pioneer3.behaviors.surroundings import Echo

LEFT_BEAM = 1 << 0
"""Bit of the left table sensor in the digital inputs, low when triggered (protocol.md 4.7, old
wiring)."""
RIGHT_BEAM = 1 << 1
"""Bit of the right table sensor in the digital inputs, low when triggered."""


@dataclass(frozen=True, slots=True)
class TableSensors:
    """Sensors of table edges, left and right; true where one sees an edge."""

    left: bool = False
    right: bool = False

    def __bool__(self) -> bool:
        """Whether either does."""
        return self.left or self.right

    def __str__(self) -> str:
        sides = [side for side, seen in (("left", self.left), ("right", self.right)) if seen]
        return f"a table on the {' and '.join(sides)}" if sides else "no table"


def table_seen(situation: Situation) -> TableSensors:
    """Return the state of the table sensors; no table without such sensors."""
    if not situation.model.table_irs:
        return TableSensors()
    bits = situation.snapshot.inputs.digital_in
    return TableSensors(not bits & LEFT_BEAM, not bits & RIGHT_BEAM)


BLIND = "no range sensor works"


def blind_behind(situation: Situation) -> str | None:
    """Return the words for that no sensor looks behind, or `None` if one does."""
    if situation.around.sees_behind:
        return None
    on = situation.snapshot.sonar.enabled
    return "nothing looks behind" if on else "nothing looks behind: switch the sonars on"


def ahead(distance: float, echo: Echo) -> str:
    """Return where an echo is: `distance` [m] from the robot's edge, in its direction."""
    return f"{distance:.2f} m ahead at {round(degrees(echo.bearing))} deg"


def behind(distance: float) -> str:
    """Return how far [m] behind the robot's edge something is."""
    return f"{distance:.2f} m behind"


def beside(distance: float, side: str) -> str:
    """Return how far [m] from the robot's edge something is, and on which side."""
    return f"{distance:.2f} m to the {side}"
