"""Quality of service by parameters: `qos_overrides./scan.publisher.reliability`."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

from pioneer3.errors import ConfigError
from pioneer3.ros.ros2.backend import Kind, Qos

OWNERS: Final = {Kind.PUBLISHER: "publisher", Kind.SUBSCRIBER: "subscription"}
RELIABILITY: Final = {"reliable": True, "best_effort": False}
DURABILITY: Final = {"transient_local": True, "volatile": False}


def overridden(qos: Qos, topic: str, kind: Kind, parameters: Mapping[str, object]) -> Qos:
    """Return `qos` as the parameters want it for a topic with this full name.

    Raises:
        ConfigError: a value is none of those that ROS 2 has.
    """
    prefix = f"qos_overrides.{topic}.{OWNERS[kind]}."
    for name, value in parameters.items():
        if name.startswith(prefix):
            qos = _changed(qos, name, name.removeprefix(prefix), value)
    return qos


def _changed(qos: Qos, name: str, policy: str, value: object) -> Qos:
    match policy:
        case "reliability":
            return replace(qos, reliable=_chosen(name, value, RELIABILITY))
        case "durability":
            return replace(qos, transient_local=_chosen(name, value, DURABILITY))
        case "depth" if isinstance(value, int) and 1 <= value <= 1000:
            return replace(qos, depth=value)
        case "history" if value == "keep_last":
            return qos
        case "depth" | "history":
            wanted = "a number from 1 to 1000" if policy == "depth" else "keep_last"
            raise ConfigError(f"{name} must be {wanted}, not {value!r}")
        case _:
            raise ConfigError(
                f"{name}: reliability, durability, history and depth can be overridden"
            )


def _chosen(name: str, value: object, known: Mapping[str, bool]) -> bool:
    if not isinstance(value, str) or value not in known:
        raise ConfigError(f"{name} must be {' or '.join(known)}, not {value!r}")
    return known[value]
