"""dynamic_reconfigure in ROS 1: a server without a generated configuration."""

from collections.abc import Sequence
from contextlib import suppress
from types import SimpleNamespace
from typing import Any, Final

from pioneer3.errors import ConfigError
from pioneer3.ros.node.driving_parameters import PARAMETERS, DrivingParameter, DrivingParameters

LEVEL: Final = 0


class Reconfigure:
    """The server of the driving parameters; made in a thread, as it talks to the master."""

    def __init__(self, parameters: DrivingParameters) -> None:
        import rospy
        from dynamic_reconfigure.server import Server

        self._parameters = parameters
        for name, value in parameters.wanted.items():
            rospy.set_param(f"~{name}", value)  # the server takes them for the present values
        Server(_description(parameters.parameters), self._set)

    def forget(self) -> None:
        """Put back the earlier parameters: the next node must not take these for new ones."""
        import rospy

        before = self._parameters.before
        with suppress(OSError, KeyError, rospy.ROSException):  # the master may be gone
            for each in PARAMETERS:
                if each.name in before:
                    rospy.set_param(f"~{each.name}", before[each.name])
                else:
                    rospy.delete_param(f"~{each.name}")

    def _set(self, config: Any, _level: int) -> Any:
        """Take new values, in rospy's thread; return those in force."""
        import rospy

        try:
            values = self._parameters.set(config)
        except ConfigError as error:
            rospy.logwarn(str(error))
            values = dict(self._parameters.values)
        config.update(values)
        return config


def _description(parameters: Sequence[DrivingParameter]) -> Any:
    """Return the content of a generated configuration module."""
    listed = [
        {
            "name": each.name,
            "type": "int" if each.whole else "double",
            "level": LEVEL,
            "description": f"{each.description}; {each.default:g} is the robot's own"
            if each.whole
            else each.description,
            "edit_method": "",
        }
        for each in parameters
    ]
    return SimpleNamespace(
        defaults=_config({each.name: each.default for each in parameters}),
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


def _config(values: dict[str, float]) -> Any:
    from dynamic_reconfigure.encoding import Config

    return Config(values)
