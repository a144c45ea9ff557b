from math import inf, nan, radians

import pytest

from pioneer3.arcos import commands
from pioneer3.arcos.reports import Config
from pioneer3.errors import ConfigError
from pioneer3.limits import Limits
from pioneer3.ros.node.driving_parameters import (
    ACCELERATIONS,
    PARAMETERS,
    by_name,
    changed,
    own_values,
    parameters_of,
    to_send,
    within_bounds,
)

LIMITS = Limits(max_speed=0.7, max_turn_rate=1.5, deceleration=1.5)


def test_defaults_and_bounds_are_rosarias() -> None:
    rows = {each.name: (each.default, each.low, each.high) for each in PARAMETERS}
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
            "trans_accel": 2.0,
            "trans_decel": 2.0,
            "rot_accel": radians(300),
            "rot_decel": radians(300),
        }
    )
    got = within_bounds({**own_values(LIMITS), "trans_accel": 50.0, "rot_decel": 50.0}, LIMITS, own)
    assert got["trans_accel"] == 2.0
    assert got["rot_decel"] == pytest.approx(radians(300))
    assert all(each.low <= each.default <= each.high for each in own)


def test_without_config_they_go_up_to_what_the_robot_is_driven_with() -> None:
    highest = {each.name: each.high for each in parameters_of(LIMITS, None)}
    assert (highest["trans_accel"], highest["trans_decel"]) == (1.5, 1.5)
    assert highest["rot_accel"] == LIMITS.turn_acceleration


def test_what_holds_before_anybody_sets_anything_sends_nothing() -> None:
    holds = own_values(LIMITS)
    assert (holds["trans_accel"], holds["trans_decel"]) == (0.3, 1.5)
    assert within_bounds(holds, LIMITS) == holds
    assert changed(LIMITS, holds) == LIMITS
    assert to_send(holds) == []


def test_bounds_hold_and_zero_is_the_robots_own() -> None:
    wanted = {"trans_accel": 50.0, "trans_decel": 0, "rot_accel": -1, "TicksMM": 138.4}
    got = within_bounds({**own_values(LIMITS), **wanted}, LIMITS)
    assert got["trans_accel"] == 9.999
    assert got["trans_decel"] == 1.5
    assert got["rot_accel"] == LIMITS.turn_acceleration
    assert got["TicksMM"] == 138
    assert isinstance(got["TicksMM"], int)


def test_nobody_takes_the_brakes_away() -> None:
    got = within_bounds({**own_values(LIMITS), "trans_decel": 0.01, "rot_decel": 0.01}, LIMITS)
    assert (got["trans_decel"], got["rot_decel"]) == (0.3, 1.745)


@pytest.mark.parametrize("bad", [nan, inf, "1", True, None])
def test_what_is_no_number_is_refused(bad: object) -> None:
    with pytest.raises(ConfigError, match="rot_accel"):
        within_bounds({"rot_accel": bad}, LIMITS)


def test_wheels_are_told_of_what_somebody_set() -> None:
    holds = {**own_values(LIMITS), "TicksMM": 138, "DriftFactor": 12, "RevCount": 16570}
    assert to_send(holds) == [
        commands.TicksMM(ticks_per_mm=138),
        commands.DriftFactor(correction=12),
        commands.RevCount(ticks=16570),
    ]
    assert to_send({**own_values(LIMITS), "DriftFactor": 0}) == [commands.DriftFactor(correction=0)]


def test_either_name_is_understood_and_rosarias_comes_first() -> None:
    given = {"max_linear_acceleration": 0.5, "ticks_mm": 138, "TicksMM": 139, "port": "x"}
    assert by_name(given) == {"trans_accel": 0.5, "TicksMM": 139}
