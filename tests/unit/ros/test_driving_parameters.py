from math import inf, nan, radians
from typing import Any

import pytest

from pioneer3.arcos import commands
from pioneer3.arcos.reports import Config
from pioneer3.errors import ConfigError
from pioneer3.limits import Limits
from pioneer3.ros.node.driving_parameters import (
    ACCELERATIONS,
    PARAMETERS,
    DrivingParameters,
    DrivingSettings,
    changed,
    own_values,
    parameters_of,
    to_send,
    within_bounds,
)
from pioneer3.ros.node.parameter_reading import read_parameters

LIMITS = Limits(max_speed=0.7, max_turn_rate=1.5, deceleration=1.5)


def test_defaults_and_bounds_are_rosarias() -> None:
    several = [row.in_rosaria for row in PARAMETERS]
    rows = {each.name: (each.default, each.low, each.high) for each in several}
    assert rows == {
        "trans_accel": (0.3, 0, 9.999),
        "trans_decel": (0.3, 0, 9.999),
        "lat_accel": (0, 0, 0.0001),
        "lat_decel": (0, 0, 0.0001),
        "rot_accel": (1.745, 0, 174.5),
        "rot_decel": (1.745, 0, 174.5),
        "TicksMM": (0, 0, 200),
        "DriftFactor": (-99999, -99999, 32767),
        "RevCount": (0, 0, 65535),
    }


def test_accelerations_go_up_to_the_robots_own_tops() -> None:
    config = Config(
        family="Pioneer",
        model="p3at-sh",
        serial_number="1",
        accel_top_mm_s2=2000,
        rotation_accel_top_deg_s2=300,
    )
    own = parameters_of(LIMITS, config)
    highest = {each.name: each.high for each in own if each.name in ACCELERATIONS}
    assert highest == pytest.approx(
        {
            "max_linear_acceleration": 2.0,
            "max_linear_deceleration": 2.0,
            "max_angular_acceleration": radians(300),
            "max_angular_deceleration": radians(300),
        }
    )
    got = within_bounds(
        {**own_values(LIMITS), "max_linear_acceleration": 50.0, "max_angular_deceleration": 50.0},
        LIMITS,
        own,
    )
    assert got["max_linear_acceleration"] == 2.0
    assert got["max_angular_deceleration"] == pytest.approx(radians(300))
    for row in (each.in_rosaria for each in own):
        assert isinstance(row.default, float | int)
        assert row.low <= row.default <= row.high


def test_without_config_they_go_up_to_what_the_robot_is_driven_with() -> None:
    highest = {each.name: each.high for each in parameters_of(LIMITS, None)}
    assert (highest["max_linear_acceleration"], highest["max_linear_deceleration"]) == (1.5, 1.5)
    assert highest["max_angular_acceleration"] == LIMITS.turn_acceleration


def test_what_holds_before_anybody_sets_anything_sends_nothing() -> None:
    holds = own_values(LIMITS)
    assert (holds["max_linear_acceleration"], holds["max_linear_deceleration"]) == (0.3, 1.5)
    assert within_bounds(holds, LIMITS) == holds
    assert changed(LIMITS, holds) == LIMITS
    assert to_send(holds) == []


def test_bounds_hold_and_zero_is_the_robots_own() -> None:
    wanted = {
        "max_linear_acceleration": 50.0,
        "max_linear_deceleration": 0,
        "max_angular_acceleration": -1,
        "ticks_mm": 138.4,
    }
    got = within_bounds({**own_values(LIMITS), **wanted}, LIMITS)
    assert got["max_linear_acceleration"] == 9.999
    assert got["max_linear_deceleration"] == 1.5
    assert got["max_angular_acceleration"] == LIMITS.turn_acceleration
    assert got["ticks_mm"] == 138
    assert isinstance(got["ticks_mm"], int)


def test_nobody_takes_the_brakes_away() -> None:
    got = within_bounds(
        {**own_values(LIMITS), "max_linear_deceleration": 0.01, "max_angular_deceleration": 0.01},
        LIMITS,
    )
    assert (got["max_linear_deceleration"], got["max_angular_deceleration"]) == (0.3, 1.745)


@pytest.mark.parametrize("bad", [nan, inf, "1", True])
def test_what_is_no_number_is_refused(bad: object) -> None:
    with pytest.raises(ConfigError, match="max_angular_acceleration"):
        within_bounds({"max_angular_acceleration": bad}, LIMITS)


def test_wheels_are_told_of_what_somebody_set() -> None:
    holds = {**own_values(LIMITS), "ticks_mm": 138, "drift_factor": 12, "rev_count": 16570}
    assert to_send(holds) == [
        commands.TicksMM(ticks_per_mm=138),
        commands.DriftFactor(correction=12),
        commands.RevCount(ticks=16570),
    ]
    assert to_send({**own_values(LIMITS), "drift_factor": 0}) == [
        commands.DriftFactor(correction=0)
    ]


def test_either_name_is_understood_and_rosarias_comes_first() -> None:
    given = {"max_linear_acceleration": 0.5, "ticks_mm": 138, "TicksMM": 139, "port": "x"}
    read = read_parameters(given).driving
    assert read == DrivingSettings(max_linear_acceleration=0.5, ticks_mm=139)


def driving(**given: Any) -> DrivingParameters:
    return DrivingParameters(LIMITS, None, DrivingSettings(**given), lambda values: None)


def test_no_number_stands_for_what_the_robot_does_not_tell() -> None:
    values = {row.name: value for row, value in driving().declared.items()}
    assert [values[name] for name in ("ticks_mm", "drift_factor", "rev_count")] == [None] * 3
    assert values["max_linear_deceleration"] == 1.5
    assert not {"lat_accel", "lat_decel"} & set(values)


def test_driving_parameters_have_the_values_in_force_once_they_are_set() -> None:
    held = driving(ticks_mm=138)
    held.set(held.wanted)
    (ticks,) = (value for row, value in held.declared.items() if row.name == "ticks_mm")
    assert ticks == 138
    taken = held.change({"drift_factor": -7, "max_linear_deceleration": 0.0})
    assert taken == {"drift_factor": -7, "max_linear_deceleration": 1.5}
    assert held.change({"ticks_mm": 0}) == {}  # the robot's own, which nobody knows
