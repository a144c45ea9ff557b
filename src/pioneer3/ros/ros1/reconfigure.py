"""dynamic_reconfigure in ROS 1: a server without a generated configuration."""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from types import SimpleNamespace
from typing import Any

from pioneer3.errors import ConfigError
from pioneer3.ros.node.driving_parameters import DrivingParameters, Values
from pioneer3.ros.node.parameter import Parameter


class Reconfigure:
    """The server of the driving parameters; made in a thread, as it talks to the master."""

    def __init__(self, parameters: DrivingParameters) -> None:
        import rospy
        from dynamic_reconfigure.server import Server

        self._rospy, self._parameters = rospy, parameters
        self._before: Mapping[str, object] = rospy.get_param("~", {})
        for name, value in self._values(parameters.wanted).items():
            rospy.set_param(f"~{name}", value)  # the server takes them for the present values
        Server(_description([row.in_rosaria for row in parameters.parameters]), self._set)

    def forget(self) -> None:
        """Put back the earlier parameters: the next node must not take these for new ones."""
        with suppress(OSError, KeyError, self._rospy.ROSException):  # the master may be gone
            for each in self._parameters.parameters:
                if each.rosaria in self._before:
                    self._rospy.set_param(f"~{each.rosaria}", self._before[each.rosaria])
                else:
                    self._rospy.delete_param(f"~{each.rosaria}")

    def _set(self, config: Any, _level: int) -> Any:
        """Take new values, in rospy's thread; return those in force."""
        try:
            self._parameters.set(
                {each.name: config[each.rosaria] for each in self._parameters.parameters}
            )
        except ConfigError as error:
            self._rospy.logwarn(str(error))
        config.update(self._values(self._parameters.values))
        return config

    def _values(self, values: Values) -> dict[str, float | None]:
        """Return values by RosAria's names, with its defaults for the robot's own."""
        return {
            each.rosaria: each.rosaria_default if values[each.name] is None else values[each.name]
            for each in self._parameters.parameters
        }


def _description(parameters: Sequence[Parameter]) -> Any:
    """Return the content of a generated configuration module."""
    from dynamic_reconfigure.encoding import Config

    listed = [
        {
            "name": each.name,
            "type": "int" if each.whole else "double",
            "level": 0,
            "description": f"{each.described}; {each.default:g} is {each.otherwise}"
            if each.whole
            else each.described,
            "edit_method": "",
        }
        for each in parameters
    ]
    return SimpleNamespace(
        defaults=Config({each.name: each.default for each in parameters}),
        min={each.name: each.low for each in parameters},
        max={each.name: each.high for each in parameters},
        config_description={
            "name": "Default",
            "id": 0,
            "parent": 0,
            "type": "",
            "state": True,
            "groups": [],
            "parameters": listed,
        },
    )
