"""The parameters that a node of ROS 2 declares: those of the table, and those of driving."""

from collections.abc import Iterator, Mapping

from pioneer3.ros.node.driving_parameters import DrivingParameter, DrivingParameters
from pioneer3.ros.node.names import Profile
from pioneer3.ros.node.parameter_table import ParameterKind, parameters_in
from pioneer3.ros.ros2.parameter_services import NodeParameter, Value

AT_START = "it is read when the node starts: set it with --ros-args -p, or in a parameter file"


def declared(raw: Mapping[str, object], driving: DrivingParameters) -> Iterator[NodeParameter]:
    """Yield the parameters with their present values; those of driving can be set.

    Args:
        raw: Values that somebody has given, and defaults that the table leaves open.
        driving: The parameters of driving.
    """
    for row in parameters_in(Profile.ROS2):
        value = raw.get(row.name, row.default)
        if value is not None:
            yield NodeParameter(
                name=row.name,
                kind=row.kind,
                value=_value(value),
                description=row.note,
                constraints=AT_START,
                read_only=True,
            )
    for each in driving.parameters:
        if each.standard is not None:
            kind = ParameterKind.INTEGER if each.whole else ParameterKind.DOUBLE
            yield NodeParameter(
                name=each.standard,
                kind=kind,
                value=_number(each, driving.values[each.name]),
                description=each.description,
                low=each.low,
                high=each.high,
            )


def set_driving(values: Mapping[str, Value], driving: DrivingParameters) -> dict[str, Value]:
    """Drive by new values of parameters with today's names; return those in force.

    Raises:
        ConfigError: one is not a finite number; nothing changes.
    """
    named = {each.standard: each for each in driving.parameters if each.standard in values}
    wanted = {each.name: values[name] for name, each in named.items() if name is not None}
    held = driving.set({**driving.values, **wanted})
    return {name: _number(each, held[each.name]) for name, each in named.items() if name}


def _number(each: DrivingParameter, value: float) -> int | float:
    return int(value) if each.whole else float(value)


def _value(value: object) -> Value:
    if isinstance(value, list):
        return tuple(value)
    assert isinstance(value, bool | int | float | str | tuple)
    return value
