"""The parameter services of a node, and the content of `/parameter_events`; no network.

They respond as those of rclpy do: undeclared names empty a whole response, a value must have the
declared type (so an integer where a double is declared is refused), nothing can be undeclared.
A parameter without a value is declared with `dynamic_typing`, and is not set until it gets one.
Beyond rclpy, numbers must be finite, and numbers in arrays keep within the bounds, too.
"""

import threading
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from enum import StrEnum
from math import ceil, floor, inf, isfinite
from types import MappingProxyType
from typing import Any, Final

import numpy as np

from pioneer3.errors import ConfigError
from pioneer3.ros.ros2.types import MessageTypes

Scalar = bool | int | float | str
Value = Scalar | tuple[bool, ...] | tuple[int, ...] | tuple[float, ...] | tuple[str, ...]
Service = tuple[str, Callable[[Any], Any]]
"""A type of services, and the function from request to response."""
NOT_SET: Final = 0
SEPARATOR: Final = "."
INT64: Final = (-(2**63), 2**63 - 1)


@dataclass(frozen=True, slots=True)
class Form:
    """The form of values of one kind.

    Attributes:
        number: In `rcl_interfaces/msg/ParameterType`.
        field: Of `rcl_interfaces/msg/ParameterValue` that has the value.
        type: Of the value, or of each part of an array.
        array: Whether there may be any number of them.
    """

    number: int
    field: str
    type: type[Scalar]
    array: bool = False


FORMS: Final[Mapping[str, Form]] = {
    "bool": Form(1, "bool_value", bool),
    "integer": Form(2, "integer_value", int),
    "double": Form(3, "double_value", float),
    "string": Form(4, "string_value", str),
    "bool_array": Form(6, "bool_array_value", bool, array=True),
    "integer_array": Form(7, "integer_array_value", int, array=True),
    "double_array": Form(8, "double_array_value", float, array=True),
    "string_array": Form(9, "string_array_value", str, array=True),
}
"""By the names of kinds in ROS 2; 5 are arrays of bytes, which no parameter here has."""
KINDS: Final = {form.number: kind for kind, form in FORMS.items()} | {
    NOT_SET: "not_set",
    5: "byte_array",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class NodeParameter:
    """A declared parameter.

    Attributes:
        name: With `.` between its parts.
        kind: One of those in `FORMS`.
        value: At first; a whole number may stand for a double here. `None` for none.
        description: For people.
        constraints: Sentence about limits that are not bounds; for people.
        low: Least number.
        high: Greatest number.
        read_only: Whether nobody may set it.
    """

    name: str
    kind: StrEnum
    value: Value | None
    description: str = ""
    constraints: str = ""
    low: float | None = None
    high: float | None = None
    read_only: bool = False

    @property
    def form(self) -> Form:
        """The form of its values."""
        return FORMS[self.kind]

    def checked(self, value: Value) -> Value:
        """Return `value`, which has the type of this parameter.

        Raises:
            ConfigError: it is not finite or out of bounds.
        """
        low, high = self.bounds
        for each in value if isinstance(value, tuple) else (value,):
            if isinstance(each, str | bool):
                continue
            if not isfinite(each):
                raise ConfigError(f"{self.name} must be finite, not {each}")
            if not low <= each <= high:
                raise ConfigError(f"{self.name} must be from {low} to {high}, not {each}")
        return value

    @property
    def bounds(self) -> tuple[float, float]:
        """The least and the greatest number."""
        if self.form.type is int:
            least, most = INT64
            return (
                least if self.low is None else ceil(self.low),
                most if self.high is None else floor(self.high),
            )
        return (
            -inf if self.low is None else float(self.low),
            inf if self.high is None else float(self.high),
        )


class ParameterServices:
    """The values of the parameters of a node, and its services; any thread may use them.

    Args:
        types: Of the node's distribution.
        parameters: All that are declared.
        set_: Given new values by name, which have the right types and are within the bounds. It
            may refuse them by a ConfigError, and may return others, which are in force instead.
        changed: Given `rcl_interfaces/msg/ParameterEvent` after each change, without node and
            stamp, which the caller fills in. The next change waits for it to return.

    Attributes:
        services: Type and function of each service, by names such as `~/get_parameters`.

    Raises:
        ConfigError: a first value does not fit its parameter.
    """

    def __init__(
        self,
        types: MessageTypes,
        parameters: Iterable[NodeParameter],
        set_: Callable[[Mapping[str, Value]], Mapping[str, Value] | None],
        changed: Callable[[Any], None],
    ) -> None:
        self._types, self._set, self._changed = types, set_, changed
        self._table = {each.name: each for each in parameters}
        self._values: Mapping[str, Value | None] = {
            name: None if each.value is None else _native(each, each.value)
            for name, each in self._table.items()
        }
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

    @property
    def values(self) -> Mapping[str, Value | None]:
        """The values in force; `None` for those that are not set."""
        return MappingProxyType(dict(self._values))

    def declared(self) -> Any:
        """Return the event of the beginning: all parameters are new; without node and stamp."""
        event = self._make("ParameterEvent")
        event.new_parameters = self._messages(self._values)
        return event

    def update(self, values: Mapping[str, Value]) -> None:
        """Take values that were changed otherwise; must not be called by `set_` or `changed`.

        Raises:
            ConfigError: a value does not fit its parameter; nothing changes.
        """
        with self._setting:
            native = {name: _native(self._table[name], each) for name, each in values.items()}
            self._take({k: v for k, v in native.items() if v != self._values[k]})

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
        """Return the value in `rcl_interfaces/msg/Parameter`.

        Raises:
            ConfigError: it cannot be set.
        """
        if (parameter := self._table.get(message.name)) is None:
            raise ConfigError(f"no parameter {message.name!r} is declared")
        if parameter.read_only:
            raise ConfigError(f"{parameter.name} is read-only")
        form, number = parameter.form, message.value.type
        if number == NOT_SET:
            raise ConfigError(f"{parameter.name} cannot be undeclared")
        if number != form.number:
            got = KINDS.get(number, number)
            raise ConfigError(f"{parameter.name} must be of type {parameter.kind}, not {got}")
        value = getattr(message.value, form.field)
        return _native(parameter, tuple(value) if form.array else value)

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
        message, form = self._make("Parameter"), self._table[name].form
        message.name = name
        if value is not None:
            message.value.type = form.number
            setattr(message.value, form.field, list(value) if isinstance(value, tuple) else value)
        return message

    def _type(self, name: str) -> int:
        """Return the type of a parameter, which it has while it has a value."""
        return NOT_SET if self._values[name] is None else self._table[name].form.number

    def _descriptor(self, parameter: NodeParameter) -> Any:
        descriptor, form = self._make("ParameterDescriptor"), parameter.form
        descriptor.name, descriptor.type = parameter.name, self._type(parameter.name)
        descriptor.dynamic_typing = parameter.value is None
        descriptor.description = parameter.description
        descriptor.additional_constraints = parameter.constraints
        descriptor.read_only = parameter.read_only
        unbounded = parameter.low is None and parameter.high is None
        if form.array or unbounded or form.type not in {int, float}:
            return descriptor
        whole = form.type is int
        between = self._make("IntegerRange" if whole else "FloatingPointRange")
        between.from_value, between.to_value = parameter.bounds
        setattr(descriptor, "integer_range" if whole else "floating_point_range", [between])
        return descriptor

    def _make(self, name: str, kind: str = "msg") -> Any:
        return self._types.make(f"rcl_interfaces/{kind}/{name}")


def is_listed(name: str, prefixes: Iterable[str], depth: int) -> bool:
    """Return whether `list_parameters` lists a parameter.

    Args:
        name: Of the parameter.
        prefixes: One of them must be the name, or some of its first parts; without any, all are.
        depth: The most parts that may follow the prefix; 0 for any number.
    """
    prefixes = tuple(prefixes)
    rests = [name] if not prefixes else []
    for prefix in prefixes:
        if name == prefix:
            return True
        if name.startswith(prefix + SEPARATOR):
            rests.append(name.removeprefix(prefix + SEPARATOR))
    return any(depth == 0 or rest.count(SEPARATOR) < depth for rest in rests)


def _native(parameter: NodeParameter, value: object) -> Value:
    """Return `value` in the type of a parameter; whole numbers may stand for doubles.

    Raises:
        ConfigError: it does not fit.
    """
    form = parameter.form
    accepted = (int, float) if form.type is float else form.type
    given = value if isinstance(value, tuple) else (value,)
    fits = isinstance(value, tuple) == form.array
    parts = [each.item() if isinstance(each, np.generic) else each for each in given]
    for each in parts:
        fits &= isinstance(each, accepted) and isinstance(each, bool) == (form.type is bool)
    if not fits:
        raise ConfigError(f"{parameter.name} must be of type {parameter.kind}, not {value!r}")
    native: Any = tuple(form.type(each) for each in parts)
    return parameter.checked(native if form.array else native[0])
