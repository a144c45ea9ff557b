"""The parameters that a node declares, and those of driving that are set."""

from collections.abc import Mapping

from pioneer3.limits import Limits
from pioneer3.ros.node.driving_parameters import DrivingParameters
from pioneer3.ros.node.names import Profile
from pioneer3.ros.node.parameter_table import parameters_in
from pioneer3.ros.ros2.declared import declared, set_driving
from pioneer3.ros.ros2.parameter_services import NodeParameter

LIMITS = Limits(max_speed=0.7, max_turn_rate=1.5, acceleration=0.4)


def driving(**raw: object) -> DrivingParameters:
    return DrivingParameters(LIMITS, None, raw, lambda values: None)


def rows(**raw: object) -> Mapping[str, NodeParameter]:
    return {each.name: each for each in declared(raw, driving())}


def test_each_parameter_is_declared_with_its_range_also_without_a_value() -> None:
    found = rows(goal_speed=0.5)
    for row in parameters_in(Profile.ROS2):
        assert (found[row.name].low, found[row.name].high) == (row.low, row.high)
        assert found[row.name].read_only
    not_set = {name for name, each in found.items() if each.value is None}
    assert {"max_linear_velocity", "max_angular_velocity", "sonar_z_offset_m"} <= not_set
    assert {"baud", "camera_view_deg", "wheel_joint_names"} <= not_set
    assert found["goal_speed"].value == 0.5
    assert rows(max_linear_velocity=0.4)["max_linear_velocity"].value == 0.4
    assert found["baud"].constraints.startswith("not set means any; ")
    assert found["sonar_no_echo"].constraints.startswith("max_range or inf; ")


def test_no_number_stands_for_what_the_robot_does_not_tell() -> None:
    found = rows()
    for name in ("ticks_mm", "drift_factor", "rev_count"):
        assert found[name].value is None
        assert found[name].bounds[0] in {1, -32768}
    assert found["max_linear_acceleration"].value == 0.4


def test_driving_parameters_have_the_values_in_force_once_they_are_set() -> None:
    held = driving(ticks_mm=138)
    held.set(held.wanted)
    (ticks,) = (each for each in declared({}, held) if each.name == "ticks_mm")
    assert ticks.value == 138
    taken = set_driving({"drift_factor": -7, "max_linear_acceleration": 0.0}, held)
    assert taken == {"drift_factor": -7, "max_linear_acceleration": 0.4}
