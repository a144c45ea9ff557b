"""The parameter services: requests in, responses and events out."""

from collections.abc import Mapping
from math import inf, nan
from typing import Any

import pytest

from pioneer3.errors import ConfigError
from pioneer3.ros.node.parameter import Effect, Parameter, Value
from pioneer3.ros.node.parameter import ParameterKind as Kind
from pioneer3.ros.ros2.distros import distro_of
from pioneer3.ros.ros2.parameter_services import ParameterServices
from pioneer3.ros.ros2.types import MessageTypes

TYPES = MessageTypes(distro_of("jazzy"))


FIRST: Mapping[str, Value] = {
    "on": True,
    "baud": 9600,
    "speed": 0.5,
    "port": "auto",
    "laser1.flags": (True, False),
    "laser1.pins": (-1, 2**40),
    "laser1.pose.offsets": (0.1, -0.2),
    "laser2.names": ("left", "right"),
}
TABLE: Mapping[Parameter, Value | None] = {
    **{
        Parameter("", name=n, kind=k, acts=Effect.AT_ONCE): v
        for (n, v), k in zip(FIRST.items(), Kind, strict=True)
    },
    Parameter(
        "of the robot",
        name="limit",
        kind=Kind.DOUBLE,
        low=0.001,
        high=10.0,
        unit="m/s",
        acts=Effect.AT_ONCE,
    ): 1,
    Parameter("", name="count", kind=Kind.INTEGER, low=0, high=2**40, acts=Effect.AT_ONCE): 3,
    Parameter(
        "",
        name="drift",
        kind=Kind.INTEGER,
        low=-200,
        high=200,
        acts=Effect.AT_ONCE,
        otherwise="the robot's own",
    ): None,
    Parameter("", name="frame", kind=Kind.STRING): "odom",
}


class Node:
    """A node whose parameters are called over the wire; `wrong` is a value that it refuses."""

    def __init__(self, in_force: Mapping[str, Value] | None = None) -> None:
        self.applied: list[dict[str, Value]] = []
        self.events: list[Any] = []
        self.in_force = in_force
        self.services = ParameterServices(TYPES, TABLE, self.set, self.events.append)

    def set(self, values: Mapping[str, Value]) -> Mapping[str, Value] | None:
        if "wrong" in values.values():
            raise ConfigError("port must be right")
        self.applied.append(dict(values))
        return self.in_force

    def call(self, name: str, **fields: object) -> Any:
        type_name, respond = self.services.services[f"~/{name}"]
        type_ = TYPES.service_type(type_name)
        request = TYPES.make(type_.request.name)
        for key, value in fields.items():
            setattr(request, key, value)
        response = respond(TYPES.decode(TYPES.encode(request), type_.request.name))
        return TYPES.decode(TYPES.encode(response), type_.response.name)

    def get(self, *names: str) -> list[Any]:
        return [value_of(each) for each in self.call("get_parameters", names=list(names)).values]

    def reasons(self, *messages: Any) -> list[str]:
        """Set each; return the reasons of refusals, and `` of successes."""
        results = self.call("set_parameters", parameters=list(messages)).results
        assert all(each.successful == (not each.reason) for each in results)
        return [each.reason for each in results]

    def at_once(self, *messages: Any) -> str:
        result = self.call("set_parameters_atomically", parameters=list(messages)).result
        assert result.successful == (not result.reason)
        return str(result.reason)


FIELDS = ("", *(f"{k}_value" for k in ("bool", "integer", "double", "string", "byte_array")))
FIELDS += tuple(f"{kind}_value" for kind in list(Kind)[4:])


def value_of(message: Any) -> Any:
    value = getattr(message, FIELDS[message.type])
    return value if isinstance(value, bool | int | float | str) else tuple(value)


def a(name: str, type_: int, value: object = None) -> Any:
    message = TYPES.make("rcl_interfaces/Parameter")
    message.name, message.value.type = name, type_
    if value is not None:
        setattr(message.value, FIELDS[type_], value)
    return message


def test_values_and_types_of_every_kind_come_back() -> None:
    node = Node()
    assert node.get(*FIRST) == list(FIRST.values())
    types = node.call("get_parameter_types", names=list(FIRST)).types
    assert list(types) == [1, 2, 3, 4, 6, 7, 8, 9]
    assert node.get("limit") == [1.0]


def test_one_undeclared_name_empties_the_response() -> None:
    node, names = Node(), ["speed", "none"]
    assert node.get(*names) == []
    assert list(node.call("get_parameter_types", names=names).types) == []
    assert node.call("describe_parameters", names=names).descriptors == []


def test_descriptors_have_bounds() -> None:
    limit, count, frame = (
        Node().call("describe_parameters", names=["limit", "count", "frame"]).descriptors
    )
    (between,) = limit.floating_point_range
    assert (between.from_value, between.to_value, between.step) == (0.001, 10.0, 0.0)
    assert (limit.name, limit.type, limit.description) == ("limit", 3, "[m/s] of the robot")
    assert (limit.read_only, limit.dynamic_typing, limit.integer_range) == (False, False, [])
    (between,) = count.integer_range
    assert (between.from_value, between.to_value) == (0, 2**40)
    assert (count.read_only, count.additional_constraints) == (False, "")
    assert (frame.read_only, frame.additional_constraints[:11]) == (True, "it is read ")
    assert frame.floating_point_range == frame.integer_range == []


@pytest.mark.parametrize(
    ("prefixes", "depth", "names"),
    [
        ([], 0, [each.name for each in TABLE]),
        ([], 1, [each.name for each in TABLE if "." not in each.name]),
        ([], 2, [each.name for each in TABLE if each.name.count(".") < 2]),
        (["laser1"], 0, ["laser1.flags", "laser1.pins", "laser1.pose.offsets"]),
        (["laser1"], 1, ["laser1.flags", "laser1.pins"]),
        (["laser1.pose", "speed"], 1, ["speed", "laser1.pose.offsets"]),
        (["las", "none"], 0, []),
    ],
)
def test_prefixes_and_depth_choose_the_names(
    prefixes: list[str], depth: int, names: list[str]
) -> None:
    result = Node().call("list_parameters", prefixes=prefixes, depth=depth).result
    assert result.names == names


def test_a_list_has_the_prefixes_of_its_names_once() -> None:
    result = Node().call("list_parameters").result
    assert result.prefixes == ["laser1", "laser1.pose", "laser2"]


def test_set_values_are_applied_one_by_one_and_told() -> None:
    node = Node()
    new = [a("speed", 3, 0.25), a("laser1.pins", 7, [1]), a("laser2.names", 9, [])]
    assert node.reasons(*new) == ["", "", ""]
    assert node.applied == [{"speed": 0.25}, {"laser1.pins": (1,)}, {"laser2.names": ()}]
    assert node.get("speed", "laser1.pins", "laser2.names") == [0.25, (1,), ()]
    told = [each.changed_parameters[0] for each in node.events]
    assert [(each.name, value_of(each.value)) for each in told] == [
        ("speed", 0.25),
        ("laser1.pins", (1,)),
        ("laser2.names", ()),
    ]
    assert TYPES.encode(node.events[0])


@pytest.mark.parametrize(
    ("message", "reason"),
    [
        (a("none", 3, 1.0), "no parameter 'none' is declared"),
        (a("speed", 2, 1), "speed must be of type double, not integer"),
        (a("on", 2, 1), "on must be of type bool, not integer"),
        (a("speed", 0), "speed cannot be undeclared"),
        (a("drift", 0), "drift cannot be undeclared"),
        (a("drift", 4, "own"), "drift must be of type integer, not string"),
        (a("drift", 2, 300), "drift must be a whole number from -200 to 200, not 300"),
        (a("speed", 77), "speed must be of type double, not 77"),
        (a("laser1.pose.offsets", 5, [1]), "must be of type double_array, not byte_array"),
        (a("speed", 3, nan), "speed must be a number, not nan"),
        (a("speed", 3, inf), "speed must be a number, not inf"),
        (a("laser1.pose.offsets", 8, [0.0, nan]), "must be a list of numbers, not (0.0, nan)"),
        (a("limit", 3, 10.5), "limit must be a number from 0.001 to 10 m/s, not 10.5"),
        (a("limit", 3, 0.0), "limit must be a number from 0.001 to 10 m/s, not 0.0"),
        (a("count", 2, -1), "count must be a whole number from 0 to 1.099512e+12, not -1"),
        (a("frame", 4, "map"), "frame is read-only"),
        (a("port", 4, "wrong"), "port must be right"),
    ],
)
def test_refusals_say_the_reason(message: Any, reason: str) -> None:
    node = Node()
    names = [each.name for each, value in TABLE.items() if value is not None]
    before = node.get(*names)
    assert reason in node.reasons(message)[0]
    assert reason in node.at_once(a("speed", 3, 0.1), message)
    assert (node.get(*names), node.applied, node.events) == (before, [], [])
    assert list(node.call("get_parameter_types", names=["drift"]).types) == [0]


def test_a_parameter_without_a_value_is_declared_as_in_rclpy_until_it_gets_one() -> None:
    node = Node()

    def described() -> tuple[int, bool, float]:
        (drift,) = node.call("describe_parameters", names=["drift"]).descriptors
        (between,) = drift.integer_range
        return drift.type, drift.dynamic_typing, between.to_value

    (value,) = node.call("get_parameters", names=["drift"]).values
    assert value.type == 0
    assert list(node.call("get_parameter_types", names=["drift"]).types) == [0]
    assert "drift" in node.call("list_parameters").result.names
    assert described() == (0, True, 200)
    assert node.reasons(a("drift", 2, 12), a("drift", 2, 13)) == ["", ""]
    assert node.get("drift") == [13]
    assert described() == (2, True, 200)
    first, second = node.events
    assert [len(e.new_parameters) for e in (first, second)] == [1, 0]
    assert [len(e.changed_parameters) for e in (first, second)] == [0, 1]


def test_one_refusal_does_not_hold_up_the_others() -> None:
    node = Node()
    assert [bool(each) for each in node.reasons(a("on", 1, False), a("none", 1), a("baud", 2))] == [
        False,
        True,
        False,
    ]
    assert node.get("on", "baud") == [False, 0]


def test_what_is_set_at_once_is_applied_and_told_at_once() -> None:
    node = Node()
    assert node.at_once(a("speed", 3, 0.1), a("port", 4, "tcp"), a("speed", 3, 0.2)) == ""
    assert node.applied == [{"speed": 0.2, "port": "tcp"}]
    (event,) = node.events
    assert [each.name for each in event.changed_parameters] == ["speed", "port"]
    assert node.at_once() == ""
    assert len(node.events) == 1


def test_the_values_in_force_are_told_where_they_differ() -> None:
    node = Node(in_force={"speed": 0.3})
    assert node.reasons(a("speed", 3, 0.7)) == [""]
    assert node.get("speed") == [0.3]
    assert value_of(node.events[0].changed_parameters[0].value) == 0.3


def test_all_parameters_are_new_at_first() -> None:
    event = Node().services.declared()
    assert [each.name for each in event.new_parameters] == [each.name for each in TABLE]
    assert TYPES.encode(event)


@pytest.mark.parametrize("value", [True, "1", nan, (1.0,)])
def test_a_first_value_must_fit(value: Any) -> None:
    table = {Parameter("", name="speed", kind=Kind.DOUBLE): value}
    with pytest.raises(ConfigError, match="speed must be"):
        ParameterServices(TYPES, table, lambda values: None, lambda event: None)
