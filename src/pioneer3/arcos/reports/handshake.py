"""What a robot answers before a session is open, and when it ends (arcos.md 2.1, 2.4)."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

from pioneer3.arcos.wire import Number, Rest, Text

SYNC_NUMBERS = (0, 1, 2)
LINK_LOST_NUMBERS = (0xFE, 0xFF)


@dataclass(frozen=True, slots=True)
class SyncEcho:
    """The same SYNC back (0, 1; AMRISim also 2).

    Attributes:
        number: Of the SYNC.
    """

    ID: ClassVar[int] = 0
    number: Annotated[int, Number(SYNC_NUMBERS)]


@dataclass(frozen=True, slots=True)
class SyncIdentity:
    """The answer to SYNC2 (2): who the robot is.

    Attributes:
        name: Given by its owner; simulators say `MobileSim`.
        family: `Pioneer` for every P2, P3, PeopleBot and AmigoBot.
        model: Parameter-file name such as `p3at-sh`, in any case of letters.
        extra: Bytes that belong to no field.
    """

    ID: ClassVar[int] = 2
    name: Text
    family: Text
    model: Text
    extra: Rest = b""


@dataclass(frozen=True, slots=True)
class LinkLost:
    """The end of the session (0xFE, 0xFF).

    Attributes:
        number: 0xFE or 0xFF.
        extra: Bytes that belong to no field.
    """

    ID: ClassVar[int] = 0xFF
    number: Annotated[int, Number(LINK_LOST_NUMBERS)] = 0xFF
    extra: Rest = b""
