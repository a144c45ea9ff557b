"""Answers of the master and of other nodes. Any program may be odd: their shape is checked here."""

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Annotated, Any, Final

from msgspec import Meta, ValidationError, convert

DONE: Final = 1


class MasterRefusalError(ValueError):
    """The master, or a node, has refused a request, and says why."""


class OddAnswerError(OSError):
    """The answer is none of ROS."""


@dataclass(frozen=True, slots=True)
class SystemState:
    """The graph as the master knows it: names of nodes that publish and subscribe, by topic."""

    publishers: Mapping[str, list[str]] = field(default_factory=dict)
    subscribers: Mapping[str, list[str]] = field(default_factory=dict)


Rows = list[tuple[str, list[str]]]
"""Names of nodes by topic, as they are sent."""
SHAPES: Final[Mapping[str, Any]] = {
    "lookupNode": str,
    "lookupService": str,
    "registerSubscriber": list[str],
    "getSystemState": Annotated[list[Rows], Meta(min_length=2)],
    "requestTopic": tuple[str, str, Annotated[int, Meta(gt=0, lt=1 << 16)]],
}
"""Types of values by method; those of others are not used."""


def value_of(method: str, answer: object) -> Any:
    """Return the value in an answer; MasterRefusalError for a no, OddAnswerError for nonsense."""
    match answer:
        case [int(code), words, value]:
            if code != DONE:
                raise MasterRefusalError(str(words))
            with suppress(ValidationError):
                convert(value, SHAPES.get(method, Any))
                return value
    raise OddAnswerError(f"the answer to {method} is none of ROS: {str(answer)[:80]}")
