"""A PeopleBot's sensors that look up for table tops (arcos.md 4.7), active low."""

from dataclasses import dataclass
from enum import IntFlag

from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.sim.equipment import TableWiring
from pioneer3.sim.firmware.accessories.base import Carrier


class TableSensor(IntFlag):
    """The four sensors; bit i is the model's sensor i, and the line of the new wiring.

    The sides are those of arcos.md 4.7. ARIA's `ArIRs` goes by the number alone: bit i of the
    fourth input byte is IRUnit i of the parameter file.
    """

    RIGHT = 1 << 0
    LEFT = 1 << 1
    LEFT_BEAM = 1 << 2
    RIGHT_BEAM = 1 << 3


OLD_LINES = {
    TableSensor.LEFT: 0,
    TableSensor.RIGHT: 1,
    TableSensor.RIGHT_BEAM: 2,
    TableSensor.LEFT_BEAM: 3,
}
"""Digital inputs of the old wiring."""
NEW_LINES = {
    TableSensor.RIGHT: 24,
    TableSensor.LEFT: 25,
    TableSensor.LEFT_BEAM: 26,
    TableSensor.RIGHT_BEAM: 27,
}
"""The fourth byte of the inputs."""
NONE = TableSensor(0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Table:
    """A rectangular table top, or whatever else hangs above the robot.

    Attributes:
        center: In the world [m, rad].
        length: Along its x axis [m].
        width: Along its y axis [m].
    """

    center: Pose2
    length: float
    width: float

    def __post_init__(self) -> None:
        """Refuse a table without surface."""
        if not (self.length > 0 and self.width > 0):
            raise ConfigError(f"table of {self.length} x {self.width} m: both must be positive")

    def covers(self, x: float, y: float) -> bool:
        """Whether the point [m, world] lies below it."""
        point = self.center.inverse() @ Pose2(x, y)
        return abs(point.x) <= self.length / 2 and abs(point.y) <= self.width / 2


class TableIr:
    """Holds input lines low where something is above a sensor.

    Attributes:
        tables: What there is in the world.
        covered: Sensors that somebody holds a hand over.
    """

    def __init__(self, body: Carrier, wiring: TableWiring = "new") -> None:
        self.tables: tuple[Table, ...] = ()
        self.covered = NONE
        self._body = body
        self._lines = OLD_LINES if wiring == "old" else NEW_LINES

    def triggered(self) -> TableSensor:
        """Return the sensors that see something."""
        seen = self.covered
        if not self.tables:
            return seen
        for sensor, mount in zip(TableSensor, self._body.model.table_irs, strict=False):
            at = self._body.robot_in_world @ Pose2(mount.x, mount.y)
            if any(table.covers(at.x, at.y) for table in self.tables):
                seen |= sensor
        return seen

    def held_low(self) -> int:
        """Return the digital inputs that are low because of this, as bits."""
        seen = self.triggered()
        return sum(1 << line for sensor, line in self._lines.items() if sensor in seen)
