"""The parameters that a node of ROS 2 declares: those of the table, and those of driving."""

from collections.abc import Iterator, Mapping

from pioneer3.ros.node.driving_parameters import DrivingParameters
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
        value = _value(raw.get(row.name, row.default))
        limits = (
            " or ".join(row.choices),
            f"not set means {row.otherwise}" if value is None else "",
            AT_START,
        )
        yield NodeParameter(
            name=row.name,
            kind=row.kind,
            value=value,
            description=row.note,
            constraints="; ".join(filter(None, limits)),
            low=row.low,
            high=row.high,
            read_only=True,
        )
    for each in driving.parameters:
        if each.standard is not None:
            kind = ParameterKind.INTEGER if each.whole else ParameterKind.DOUBLE
            yield NodeParameter(
                name=each.standard,
                kind=kind,
                value=each.known(driving.values[each.name]),
                description=each.description,
                constraints="not set means the robot's own" if each.whole else "",
                low=each.lowest_told,
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
    known = {name: each.known(held[each.name]) for name, each in named.items() if name}
    return {name: value for name, value in known.items() if value is not None}


def _value(value: object) -> Value | None:
    if isinstance(value, list):
        return tuple(value)
    assert isinstance(value, bool | int | float | str | tuple | None)
    return value
