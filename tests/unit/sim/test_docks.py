"""Docks of a map charge the robots that stand in them, and nobody else."""

from math import exp, radians
from pathlib import Path

import pytest

from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap, empty_map, read_map
from pioneer3.models import load_model
from pioneer3.sim.body import AMBIENT, Body
from pioneer3.sim.kernels.drives import CAPACITY, HEAT_TIME, IDLE_POWER, STALL_HEAT
from pioneer3.sim.world import CHARGE_POWER, DOCKED, DOCKED_ANGLE, World
from tests.support import moves, wall_at

MAP = """2D-Map
LineMinPos: -5000 -5000
LineMaxPos: 5000 5000
NumLines: 1
LinesAreSorted: false
MapInfo: DockType Name=DockPioneer "Label=Pioneer dock"
Cairn: Dock 1000 2000 90 "" ICON "charger"
Cairn: DockPioneer -1000 0 0 "" ICON "other"
LINES
-5000 -5000 5000 -5000
DATA
"""
MODEL = load_model("p3dx-sh")
DOCK = Pose2(1.0, 2.0, radians(90))


@pytest.fixture
def docks(tmp_path: Path) -> LineMap:
    path = tmp_path / "docks.map"
    path.write_text(MAP)
    return read_map(path)


@pytest.mark.parametrize(
    ("home", "charges"),
    [
        (DOCK, True),
        (Pose2(-1.0, 0.0, 0.0), True),
        (Pose2(1.0 + 0.9 * DOCKED, 2.0, radians(90)), True),
        (Pose2(1.0 + 1.1 * DOCKED, 2.0, radians(90)), False),
        (Pose2(1.0, 2.0, radians(90) - 0.9 * DOCKED_ANGLE), True),
        (Pose2(1.0, 2.0, radians(90) + 1.1 * DOCKED_ANGLE), False),
        (Pose2(1.0, 2.0, radians(-90)), False),
        (Pose2(0.0, 0.0, 0.0), False),
    ],
)
def test_a_dock_charges_who_stands_in_it_the_right_way_round(
    docks: LineMap, home: Pose2, *, charges: bool
) -> None:
    body = Body(MODEL, home)
    body.battery.energy = CAPACITY / 2
    world = World(docks, [body])
    world.step(10.0)
    power = CHARGE_POWER * charges - IDLE_POWER
    assert body.charging == charges
    # the first step, of 0.1 s, finds out
    assert body.battery.energy - CAPACITY / 2 == pytest.approx(10 * power, abs=0.1 * CHARGE_POWER)


def test_a_robot_drives_into_a_dock_and_out_again(docks: LineMap) -> None:
    body = Body(MODEL, DOCK @ Pose2(-1.0))
    body.battery.energy = CAPACITY / 2
    body.enable_motors(on=True)
    world = World(docks, [body])
    assert not body.charging
    low = body.battery.voltage
    for distance, charges in ((1.0, True), (-1.0, False)):
        body.drive.linear.travel(distance)
        while moves(body.drive):
            world.step(0.1)
        world.step(60.0 if charges else 1.0)
        assert body.charging == charges
        if charges:
            assert body.battery.voltage > low


def test_a_battery_is_never_more_than_full(docks: LineMap) -> None:
    body = Body(MODEL, DOCK)
    World(docks, [body]).step(10.0)
    assert body.battery.energy == CAPACITY


def test_a_dock_that_is_taken_away_charges_no_more(docks: LineMap) -> None:
    body = Body(MODEL, DOCK)
    world = World(docks, [body])
    world.step(1.0)
    assert body.charging
    world.change_map(empty_map())
    world.step(1.0)
    assert not body.charging


def test_motors_that_push_in_vain_get_hotter_than_motors_that_run() -> None:
    bodies = [Body(MODEL), Body(MODEL, Pose2(0.0, 2.0))]
    for body in bodies:
        body.enable_motors(on=True)
        body.drive.linear.go(0.5)
    world = World(wall_at(1.0), bodies[:1])
    free = World(None, bodies[1:])
    world.step(40.0)
    free.step(40.0)
    assert bodies[0].stalled
    warmer = [body.motor_temperature - AMBIENT for body in bodies]
    assert warmer[1] < warmer[0]
    assert warmer[0] == pytest.approx(STALL_HEAT * (1 - exp(-40.0 / HEAT_TIME)), rel=0.1)
