"""dynamic_reconfigure in ROS 1: a server without its package and a generated configuration.

It is two latched topics, a service, and a parameter for each value
(http://wiki.ros.org/dynamic_reconfigure).
"""

import asyncio
from collections.abc import Callable, Mapping
from contextlib import suppress
from types import SimpleNamespace
from typing import Any, Final

from pioneer3.errors import ConfigError
from pioneer3.ros.node.driving_parameters import DrivingParameters, Values
from pioneer3.ros.node.middleware import Middleware, Publisher
from pioneer3.ros.tcpros.answers import MasterRefusalError
from pioneer3.ros.tcpros.node import Ros1Node
from pioneer3.ros.tcpros.types import Ros1Types

GROUP: Final = "Default"
"""Name of the only group of parameters."""
PACKAGE: Final = "dynamic_reconfigure"
DESCRIPTION: Final = f"{PACKAGE}/ConfigDescription"
CONFIG: Final = f"{PACKAGE}/Config"
SERVICE: Final = f"{PACKAGE}/Reconfigure"


class Reconfigure:
    """The server of the driving parameters of a node; `warn` is given a sentence."""

    def __init__(
        self,
        driving: DrivingParameters,
        node: Ros1Node,
        types: Ros1Types,
        warn: Callable[[str], None],
    ) -> None:
        self._driving, self._node, self._types, self._warn = driving, node, types, warn
        self._loop = asyncio.get_running_loop()
        self._before: Mapping[str, object] = {}
        self._updates: Publisher | None = None
        self._rows = [row.in_rosaria for row in driving.parameters]

    async def open(self, middleware: Middleware) -> None:
        """Take the first values, and offer to set them; errors as of :meth:`Api.call`."""
        before = await self._node.get(self._node.name)
        self._before = before if isinstance(before, dict) else {}
        described = middleware.advertise("~parameter_descriptions", DESCRIPTION, latched=True)
        described.publish(self._description())
        self._updates = middleware.advertise("~parameter_updates", CONFIG, latched=True)
        await self._set(self._driving.wanted)
        middleware.serve("~set_parameters", SERVICE, self._respond)

    async def forget(self) -> None:
        """Put back the earlier parameters: the next node must not take these for new ones."""
        for each in self._driving.parameters:
            name = f"{self._node.name}/{each.rosaria}"
            if each.rosaria in self._before:
                await self._node.master.call("setParam", name, self._before[each.rosaria])
                continue
            with suppress(MasterRefusalError):  # somebody has deleted it
                await self._node.master.call("deleteParam", name)

    def _respond(self, request: Any) -> Any:
        """Take new values, in a thread of a service; return those in force."""
        config = request.config
        sent = {each.name: each.value for each in (*config.ints, *config.doubles)}
        wanted = {each.name: sent.get(each.rosaria) for each in self._driving.parameters}
        given = {name: value for name, value in wanted.items() if value is not None}
        present = self._in_rosaria(self._driving.values)
        rest = {each.name: present[each.rosaria] for each in self._driving.parameters}
        work = self._set(rest | given)
        return SimpleNamespace(config=asyncio.run_coroutine_threadsafe(work, self._loop).result())

    async def _set(self, wanted: Mapping[str, object]) -> Any:
        """Take new values; publish those in force, and return them as a message."""
        try:
            self._driving.set(wanted)
        except ConfigError as error:
            self._warn(str(error))
        values = self._in_rosaria(self._driving.values)
        for name, value in values.items():
            await self._node.master.call("setParam", f"{self._node.name}/{name}", value)
        message = self._config(values)
        assert self._updates is not None
        self._updates.publish(message)
        return message

    def _in_rosaria(self, values: Values) -> dict[str, float | None]:
        """Return values by RosAria's names, with its defaults for the robot's own."""
        return {
            each.rosaria: each.rosaria_default if values[each.name] is None else values[each.name]
            for each in self._driving.parameters
        }

    def _config(self, values: Mapping[str, Any]) -> Any:
        """Return a message of values by RosAria's names."""
        config, state = self._types.make(CONFIG), self._types.make(f"{PACKAGE}/GroupState")
        state.name, state.state = GROUP, True
        config.groups = [state]
        for row in self._rows:
            kind, rows = ("Int", config.ints) if row.whole else ("Double", config.doubles)
            made = self._types.make(f"{PACKAGE}/{kind}Parameter")
            made.name, made.value = row.name, values[row.name]
            rows.append(made)
        return config

    def _description(self) -> Any:
        """Return a message that describes the parameters."""
        described, group = self._types.make(DESCRIPTION), self._types.make(f"{PACKAGE}/Group")
        group.name, described.groups = GROUP, [group]
        for row in self._rows:
            each = self._types.make(f"{PACKAGE}/ParamDescription")
            each.name, each.type = row.name, "int" if row.whole else "double"
            own = f"; {row.default:g} is {row.otherwise}" if row.whole else ""
            each.description = f"{row.described}{own}"
            group.parameters.append(each)
        described.dflt = self._config({row.name: row.default for row in self._rows})
        described.min = self._config({row.name: row.low for row in self._rows})
        described.max = self._config({row.name: row.high for row in self._rows})
        return described
