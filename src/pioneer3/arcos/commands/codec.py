"""Commands to payloads and back."""

from typing import Any, ClassVar, Final

from msgspec import defstruct

from pioneer3.arcos.commands import devices, driving, simulators
from pioneer3.arcos.commands.table import DEVICES, DRIVING, OLD_SIMULATOR, UNKNOWN, CommandRow
from pioneer3.arcos.layout import Command, pack, unpack
from pioneer3.arcos.wire import U8, Rest


class Unknown(Command, frozen=True):
    """A command without a class here, or with arguments that do not decode.

    `number` is `None` if there was not a single byte.
    """

    ID: ClassVar[int] = -1
    number: U8 | None = None
    arguments: Rest = b""


def _from_row(row: CommandRow) -> type[Command]:
    """Return the class of a line of the table."""
    arguments = [
        (argument, kind, b"") if row.arguments is UNKNOWN else (argument, kind)
        for argument, kind in row.arguments.items()
    ]
    doc = f"{row.meaning} (ARCOS {row.number}, {row.name})."
    members = {"ID": row.number, "__doc__": doc}
    cls: Any = defstruct(
        row.name, arguments, bases=(Command,), module=__name__, namespace=members, frozen=True
    )
    return cls  # type: ignore[no-any-return]


_FROM_ROWS: Final = {row.name: _from_row(row) for row in (*DRIVING, *DEVICES, *OLD_SIMULATOR)}
NUMBERS: Final = {name: cls.ID for name, cls in _FROM_ROWS.items()}
"""Numbers of the commands in the table, by name."""

MOTION: Final = {bytes([number]) for number in (4, 8, 9, 11, 12, 13, 21, 22, 32, 110)}
"""Numbers of the commands that can move the robot: ENABLE, MOVE, ROTATE, VEL, HEAD, DHEAD, RVEL,
DCHEAD, VEL2 and LATVEL (protocol.md 3.1)."""

_WRITTEN: Final[tuple[type[Command], ...]] = tuple(
    member
    for module in (driving, devices, simulators)
    for name in module.__all__
    if hasattr(member := getattr(module, name), "ID")
)
_OLD: Final[dict[int, type[Command]]] = {
    **{row.number: _FROM_ROWS[row.name] for row in OLD_SIMULATOR},
    **{cls.ID: cls for cls in simulators.OLD},
}
_MEANINGS: Final[dict[int, type[Command]]] = {
    **{row.number: _FROM_ROWS[row.name] for row in (*DRIVING, *DEVICES)},
    **{cls.ID: cls for cls in _WRITTEN if cls not in simulators.OLD},
}


def named(name: str, *values: object) -> Command:
    """Return the command of the table that is called `name`, with its arguments in wire order."""
    return _FROM_ROWS[name](*values)


def every_command() -> tuple[type[Command], ...]:
    """Return every command class but :class:`Unknown`."""
    return (*_WRITTEN, *_FROM_ROWS.values())


def is_old(cls: type[Command]) -> bool:
    """Whether only old simulators give this meaning to the number of `cls`."""
    return cls in _OLD.values()


def to_payload(command: Command) -> bytes:
    """Return id and arguments of `command`; CommandError if a value does not fit the protocol."""
    if isinstance(command, Unknown):
        return pack(command)
    return bytes([command.ID]) + pack(command)


def moves(command: Command) -> bool:
    """Return whether a command can move the robot; CommandError if it does not fit the protocol."""
    return to_payload(command)[:1] in MOTION


def from_payload(payload: bytes, *, simulator: bool = False) -> Command:
    """Return the command that `payload` spells; never raises.

    Of `simulator`, numbers with two meanings (35-38, 59, 61-64, 66-69) have the one that old
    simulators give them, rather than the robot's.
    """
    if not payload:
        return Unknown()
    number, arguments = payload[0], payload[1:]
    meaning = _OLD.get(number) if simulator else None
    meaning = meaning or _MEANINGS.get(number)
    try:
        return unpack(meaning, arguments) if meaning else Unknown(number, arguments)
    except (EOFError, ValueError):
        return Unknown(number, arguments)
