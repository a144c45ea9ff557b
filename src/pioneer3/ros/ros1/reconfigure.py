"""dynamic_reconfigure in ROS 1: a server without a generated configuration."""

import threading
from collections.abc import Callable, Sequence
from contextlib import suppress
from types import SimpleNamespace
from typing import Any, Final

from pioneer3.arcos.reports import Config
from pioneer3.errors import ConfigError
from pioneer3.limits import Limits
from pioneer3.ros.interface.settings import (
    PARAMETERS,
    Parameter,
    in_force,
    parameters_of,
    settled,
    written,
)

LEVEL: Final = 0


class Reconfigure:
    """The server of the node's own parameters.

    Made in a thread: it talks to the master.

    Args:
        limits: The robot's own.
        config: What the robot sent of itself, if it did.
        given: Parameters that somebody has written below the node's name.
        apply: Given all values whenever one has been set; by one of rospy's threads.

    Raises:
        ConfigError: a given one is not a number.
    """

    def __init__(
        self,
        limits: Limits,
        config: Config | None,
        given: dict[str, Any],
        apply: Callable[[dict[str, float]], None],
    ) -> None:
        import rospy  # noqa: PLC0415
        from dynamic_reconfigure.server import Server  # noqa: PLC0415

        self._limits = limits
        self._parameters = parameters_of(limits, config)
        self._apply = apply
        self._given = {each.name: given[each.name] for each in PARAMETERS if each.name in given}
        self._values = in_force(limits)
        self._lock = threading.Lock()
        wanted = {**self._values, **written(given)}
        for name, value in settled(wanted, limits, self._parameters).items():
            rospy.set_param(f"~{name}", value)  # the server takes what it finds for the present
        Server(_description(self._parameters), self._set)

    def forget(self) -> None:
        """Leave on the parameter server what was there: the next node must not take it for new."""
        import rospy  # noqa: PLC0415

        with suppress(OSError, KeyError, rospy.ROSException):  # the master may be gone
            for each in PARAMETERS:
                if each.name in self._given:
                    rospy.set_param(f"~{each.name}", self._given[each.name])
                else:
                    rospy.delete_param(f"~{each.name}")

    def _set(self, config: Any, _level: int) -> Any:
        """Take new values, in rospy's thread; return those that hold."""
        import rospy  # noqa: PLC0415

        with self._lock:
            try:
                values = settled(config, self._limits, self._parameters)
            except ConfigError as error:
                rospy.logwarn(str(error))
                values = self._values
            if values != self._values:
                self._values = values
                self._apply(values)
        config.update(values)
        return config


def _description(parameters: Sequence[Parameter]) -> Any:
    """Return what a generated configuration module would hold."""
    told = [
        {
            "name": each.name,
            "type": "int" if each.whole else "double",
            "level": LEVEL,
            "description": each.description,
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
            "parameters": told,
        },
    )


def _config(values: dict[str, float]) -> Any:
    from dynamic_reconfigure.encoding import Config  # noqa: PLC0415

    return Config(values)
