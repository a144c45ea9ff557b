"""Commands to payloads and back."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from typing import ClassVar, Final, Protocol

from pioneer3.arcos.layout import pack, unpack
from pioneer3.arcos.wire import U8, Rest


class Command(Protocol):
    """What a host tells a robot: a dataclass of this package."""

    ID: ClassVar[int]


@dataclass(frozen=True, slots=True)
class Unknown:
    """A command that this package does not know, or whose arguments make no sense.

    Attributes:
        number: Of the command; `None` if there was not a single byte.
        arguments: The bytes after the number.
    """

    ID: ClassVar[int] = -1
    number: U8 | None = None
    arguments: Rest = b""


MODULES: Final = (
    "session",
    "motion",
    "sensors",
    "tuning",
    "power",
    "accessories",
    "arm",
    "service",
    "simulator",
    "srisim",
)
"""The modules that hold commands, the most used first."""

OLD_SIMULATOR: Final = "srisim"
"""The one whose numbers mean something else to a robot."""


def _classes(module: str) -> tuple[type[Command], ...]:
    home = import_module(f"pioneer3.arcos.commands.{module}")
    members = (getattr(home, name) for name in home.__all__)
    return tuple(member for member in members if hasattr(member, "ID"))


@cache
def every_command() -> tuple[type[Command], ...]:
    """Return every command class but :class:`Unknown`, grouped by meaning."""
    return tuple(cls for module in MODULES for cls in _classes(module))


@cache
def _meanings(simulator: bool) -> Mapping[int, type[Command]]:
    """Return the class of each number, as a robot or an old simulator understands it."""
    old = _classes(OLD_SIMULATOR)
    return {cls.ID: cls for cls in every_command() if simulator or cls not in old}


def to_payload(command: Command) -> bytes:
    """Return id and arguments of `command`.

    Raises:
        CommandError: a value is not finite, of the wrong type or out of the protocol's range.
    """
    if isinstance(command, Unknown):
        return pack(command)
    return bytes([command.ID]) + pack(command)


def from_payload(payload: bytes, *, simulator: bool = False) -> Command:
    """Return what `payload` means; never raises.

    Args:
        payload: Id and arguments.
        simulator: Whether numbers with two meanings (35-38, 59, 61-64, 66-69) have the one
            that old simulators give them, rather than the robot's.
    """
    if not payload:
        return Unknown()
    meaning = _meanings(simulator).get(payload[0])
    try:
        return unpack(meaning, payload[1:]) if meaning else Unknown(payload[0], payload[1:])
    except (EOFError, ValueError):
        return Unknown(payload[0], payload[1:])
