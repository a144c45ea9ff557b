"""The parameter services of a node, and the content of `/parameter_events`; no network.

They respond as those of rclpy do: undeclared names empty a whole response, a value must have the
declared type (so an integer where a double is declared is refused), nothing can be undeclared.
A parameter without a value is declared with `dynamic_typing`, and is not set until it gets one.
Beyond rclpy, numbers must be finite, and numbers in arrays keep within the bounds, too.
"""

import threading
from collections.abc import Callable, Iterable, Mapping
from types import MappingProxyType
from typing import Any, Final

import numpy as np

from pioneer3.errors import ConfigError
from pioneer3.ros.node.parameter import Effect, Parameter, ParameterKind, Value
from pioneer3.ros.ros2.types import MessageTypes

Service = tuple[str, Callable[[Any], Any]]
"""A type of services, and the function from request to response."""
NOT_SET: Final = 0
SEPARATOR: Final = "."
NUMBERS: Final = dict(zip(ParameterKind, (1, 2, 3, 4, 6, 7, 8, 9), strict=True))
"""Numbers of kinds in `rcl_interfaces/msg/ParameterType`; 5 are arrays of bytes."""
KINDS: Final = {number: str(kind) for kind, number in NUMBERS.items()} | {
    NOT_SET: "not_set",
    5: "byte_array",
}


class ParameterServices:
    """The values of the parameters of a node, and its services; any thread may use them.

    All parameters that are declared come with their values at first. `set_` is given new values by
    name, which have the right types and are within the bounds. It may refuse them by a ConfigError,
    and may return others, which are in force instead. `changed` is given
    `rcl_interfaces/msg/ParameterEvent` after each change, without node and stamp, which the caller
    fills in. The next change waits for it to return.

    Attributes:
        services: Type and function of each service, by names such as `~/get_parameters`.

    Raises:
        ConfigError: a first value does not fit its parameter.
    """

    def __init__(
        self,
        types: MessageTypes,
        parameters: Mapping[Parameter, Value | None],
        set_: Callable[[Mapping[str, Value]], Mapping[str, Value] | None],
        changed: Callable[[Any], None],
    ) -> None:
        self._types, self._set, self._changed = types, set_, changed
        self._table = {each.name: each for each in parameters}
        self._values: Mapping[str, Value | None] = {
            each.name: None if value is None else _native(each, value)
            for each, value in parameters.items()
        }
        self._dynamic = {name for name, value in self._values.items() if value is None}
        self._setting = threading.Lock()
        self.services: Mapping[str, Service] = MappingProxyType(
            {
                f"~/{name}": (f"rcl_interfaces/srv/{type_}", respond)
                for name, type_, respond in (
                    ("describe_parameters", "DescribeParameters", self._describe),
                    ("get_parameters", "GetParameters", self._get),
                    ("get_parameter_types", "GetParameterTypes", self._get_types),
                    ("list_parameters", "ListParameters", self._list),
                    ("set_parameters", "SetParameters", self._set_each),
                    ("set_parameters_atomically", "SetParametersAtomically", self._set_all),
                )
            }
        )

    def declared(self) -> Any:
        """Return the event of the beginning: all parameters are new; without node and stamp."""
        event = self._make("ParameterEvent")
        event.new_parameters = self._messages(self._values)
        return event

    def _describe(self, request: Any) -> Any:
        response = self._make("DescribeParameters_Response", "srv")
        if all(name in self._table for name in request.names):
            response.descriptors = [self._descriptor(self._table[name]) for name in request.names]
        return response

    def _get(self, request: Any) -> Any:
        response, values = self._make("GetParameters_Response", "srv"), self._values
        if all(name in values for name in request.names):
            response.values = [self._message(name, values[name]).value for name in request.names]
        return response

    def _get_types(self, request: Any) -> Any:
        response = self._make("GetParameterTypes_Response", "srv")
        if all(name in self._table for name in request.names):
            response.types = [self._type(name) for name in request.names]
        return response

    def _list(self, request: Any) -> Any:
        response = self._make("ListParameters_Response", "srv")
        names = [each for each in self._table if is_listed(each, request.prefixes, request.depth)]
        parents = [name.rpartition(SEPARATOR)[0] for name in names]
        response.result.names = names
        response.result.prefixes = [each for each in dict.fromkeys(parents) if each]
        return response

    def _set_each(self, request: Any) -> Any:
        response = self._make("SetParameters_Response", "srv")
        response.results = [self._result([each]) for each in request.parameters]
        return response

    def _set_all(self, request: Any) -> Any:
        response = self._make("SetParametersAtomically_Response", "srv")
        response.result = self._result(request.parameters)
        return response

    def _result(self, messages: Iterable[Any]) -> Any:
        """Set all parameters in `rcl_interfaces/msg/Parameter` or none; return the result."""
        result = self._make("SetParametersResult")
        with self._setting:
            try:
                wanted = {each.name: self._wanted(each) for each in messages}
                others = self._set(MappingProxyType(wanted)) or {} if wanted else {}
                inside = {name: _native(self._table[name], each) for name, each in others.items()}
            except ConfigError as error:
                result.reason = str(error)
                return result
            self._take(wanted | inside)
        result.successful = True
        return result

    def _wanted(self, message: Any) -> Value:
        """Return the value in `rcl_interfaces/msg/Parameter`; ConfigError if it cannot be set."""
        if (parameter := self._table.get(message.name)) is None:
            raise ConfigError(f"no parameter {message.name!r} is declared")
        if parameter.acts is not Effect.AT_ONCE:
            raise ConfigError(f"{parameter.name} is read-only")
        kind, number = parameter.kind, message.value.type
        if number == NOT_SET:
            raise ConfigError(f"{parameter.name} cannot be undeclared")
        if number != NUMBERS[kind]:
            got = KINDS.get(number, number)
            raise ConfigError(f"{parameter.name} must be of type {kind}, not {got}")
        value = getattr(message.value, f"{kind}_value")
        return _native(parameter, tuple(value) if kind.is_array else value)

    def _take(self, values: Mapping[str, Value]) -> None:
        if not values:
            return
        before, self._values = self._values, {**self._values, **values}
        event = self._make("ParameterEvent")
        event.new_parameters = self._messages(
            {name: value for name, value in values.items() if before[name] is None}
        )
        event.changed_parameters = self._messages(
            {name: value for name, value in values.items() if before[name] is not None}
        )
        self._changed(event)

    def _messages(self, values: Mapping[str, Value | None]) -> list[Any]:
        return [self._message(name, value) for name, value in values.items()]

    def _message(self, name: str, value: Value | None) -> Any:
        message, kind = self._make("Parameter"), self._table[name].kind
        message.name = name
        if value is not None:
            message.value.type = NUMBERS[kind]
            field = list(value) if isinstance(value, tuple) else value
            setattr(message.value, f"{kind}_value", field)
        return message

    def _type(self, name: str) -> int:
        """Return the type of a parameter, which it has while it has a value."""
        return NOT_SET if self._values[name] is None else NUMBERS[self._table[name].kind]

    def _descriptor(self, parameter: Parameter) -> Any:
        descriptor = self._make("ParameterDescriptor")
        descriptor.name, descriptor.type = parameter.name, self._type(parameter.name)
        descriptor.dynamic_typing = parameter.name in self._dynamic
        descriptor.description = parameter.described
        descriptor.additional_constraints = parameter.constraints
        descriptor.read_only = parameter.acts is not Effect.AT_ONCE
        bounds = parameter.low, parameter.high
        if not parameter.bounded or parameter.kind.is_array:
            return descriptor
        if parameter.whole:
            descriptor.integer_range = [self._between("IntegerRange", *map(int, bounds))]
        else:
            descriptor.floating_point_range = [self._between("FloatingPointRange", *bounds)]
        return descriptor

    def _between(self, name: str, low: float, high: float) -> Any:
        between = self._make(name)
        between.from_value, between.to_value = low, high
        return between

    def _make(self, name: str, kind: str = "msg") -> Any:
        return self._types.make(f"rcl_interfaces/{kind}/{name}")


def is_listed(name: str, prefixes: Iterable[str], depth: int) -> bool:
    """Return whether `list_parameters` lists a parameter.

    One of the prefixes must be its name, or some of its first parts; at most `depth` more may
    follow, any number for 0. Without prefixes all parts follow.
    """
    prefixes = tuple(prefixes)
    rests = [name] if not prefixes else []
    for prefix in prefixes:
        if name == prefix:
            return True
        if name.startswith(prefix + SEPARATOR):
            rests.append(name.removeprefix(prefix + SEPARATOR))
    return any(depth == 0 or rest.count(SEPARATOR) < depth for rest in rests)


def _native(parameter: Parameter, value: object) -> Value:
    """Return `value`, which may come from numpy, in the type of a parameter; else ConfigError."""
    if isinstance(value, tuple):
        return parameter.checked(tuple(map(_scalar, value)))
    return parameter.checked(_scalar(value))


def _scalar(value: object) -> object:
    return value.item() if isinstance(value, np.generic) else value
