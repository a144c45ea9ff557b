"""Answers of the master and of other nodes. Any program may be odd: their shape is checked here."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Final

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


def value_of(method: str, answer: object) -> Any:
    """Return the value in the answer to a method; MasterRefusalError if it is no.

    Raises:
        OddAnswerError: it is none of ROS.
    """
    match answer:
        case [int(code), words, value]:
            if code != DONE:
                raise MasterRefusalError(str(words))
            fits = SHAPES.get(method)
            if fits is None or fits(value):
                return value
    raise OddAnswerError(f"the answer to {method} is none of ROS: {str(answer)[:80]}")


def are_texts(value: object) -> bool:
    """Return whether this is a list of strings."""
    return isinstance(value, list) and all(isinstance(each, str) for each in value)


def _is_text(value: object) -> bool:
    return isinstance(value, str)


def _is_state(value: object) -> bool:
    match value:
        case [publishers, subscribers, *_]:
            return _are_rows(publishers) and _are_rows(subscribers)
    return False


def _are_rows(value: object) -> bool:
    return isinstance(value, list) and all(
        isinstance(row, list) and len(row) == 2 and isinstance(row[0], str) and are_texts(row[1])
        for row in value
    )


def _is_address(value: object) -> bool:
    match value:
        case [str(), str(), int(port), *_]:
            return 0 < port < 1 << 16
    return False


SHAPES: Final[Mapping[str, Callable[[object], bool]]] = {
    "lookupNode": _is_text,
    "lookupService": _is_text,
    "registerSubscriber": are_texts,
    "getSystemState": _is_state,
    "requestTopic": _is_address,
}
"""Checks of values by method; those of others are not used."""
