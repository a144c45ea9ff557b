import pytest

from pioneer3.sim.accessories import TableSensor
from pioneer3.sim.accessories.digital_io import TableIr

T = TableSensor


@pytest.mark.parametrize(
    ("covered", "old", "new"),
    [
        (T(0), 0, 0),
        (T.LEFT, 1 << 0, 1 << 25),
        (T.RIGHT, 1 << 1, 1 << 24),
        (T.LEFT_BEAM, 1 << 3, 1 << 26),
        (T.RIGHT_BEAM, 1 << 2, 1 << 27),
        (T.LEFT | T.RIGHT, 0b11, 0b11 << 24),
    ],
)
def test_each_sensor_has_its_line(covered: TableSensor, old: int, new: int) -> None:
    for wiring, low in (("old", old), ("new", new)):
        sensors = TableIr("old" if wiring == "old" else "new")
        sensors.covered = covered
        assert sensors.held_low() == low
