from math import pi

import pytest

from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.models import load_model
from pioneer3.sim.accessories import TableSensor, TableTop
from pioneer3.sim.accessories.digital_io import TableIr
from tests.unit.sim.accessories.carrier import FakeCarrier

T = TableSensor


def people_bot(pose: Pose2 = Pose2()) -> FakeCarrier:  # noqa: B008
    return FakeCarrier(load_model("peoplebot-sh"), robot_in_world=pose)


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
        sensors = TableIr(people_bot(), "old" if wiring == "old" else "new")
        sensors.covered = covered
        assert sensors.held_low() == low


def test_sensors_see_the_table_above_them() -> None:
    sensors = TableIr(people_bot())
    sensors.tables = (TableTop(center=Pose2(0.5, 0.4), length=0.5, width=0.5),)
    assert sensors.triggered() == T.LEFT
    sensors.tables = (TableTop(center=Pose2(1.0, 0.0), length=1.4, width=2.0),)
    assert sensors.triggered() == T.LEFT | T.RIGHT
    sensors.tables += (TableTop(center=Pose2(), length=0.1, width=0.5),)
    assert sensors.triggered() == T.LEFT | T.RIGHT | T.LEFT_BEAM | T.RIGHT_BEAM


def test_the_robot_carries_its_sensors_along() -> None:
    table = TableTop(center=Pose2(5.0, 5.0), length=1.0, width=1.0)
    away, below = TableIr(people_bot()), TableIr(people_bot(Pose2(5.0, 4.4, pi / 2)))
    away.tables = below.tables = (table,)
    assert away.triggered() == T(0)
    assert below.triggered() == T.LEFT | T.RIGHT


def test_a_table_may_stand_askew() -> None:
    table = TableTop(center=Pose2(0, 0, pi / 4), length=2.0, width=0.2)
    assert table.covers(0.6, 0.6)
    assert not table.covers(0.6, -0.6)


def test_a_robot_without_mounts_can_still_be_covered_by_hand() -> None:
    sensors = TableIr(FakeCarrier())
    sensors.tables = (TableTop(center=Pose2(), length=9.0, width=9.0),)
    assert sensors.held_low() == 0
    sensors.covered = T.LEFT
    assert sensors.held_low() == 1 << 25


def test_a_table_has_a_surface() -> None:
    with pytest.raises(ConfigError, match="both must be positive"):
        TableTop(center=Pose2(), length=0.0, width=1.0)
