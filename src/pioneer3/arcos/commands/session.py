"""Beginning, keeping and ending a session (arcos.md 2, 3.1)."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

from pioneer3.arcos.commands.choices import Baud
from pioneer3.arcos.commands.quantities import WORD, How, Number
from pioneer3.arcos.wire import Enumerated

__all__ = [
    "Aux1Baud",
    "Aux2Baud",
    "Close",
    "HostBaud",
    "Open",
    "Pulse",
    "RequestConfig",
    "RequestEncoders",
]


@dataclass(frozen=True, slots=True)
class Pulse:
    """Do nothing but feed the watchdog (ARCOS 0, PULSE; SYNC0 before the session is open).

    ARIA's SETLATV has number 0 too, with an argument that is ignored.
    """

    ID: ClassVar[int] = 0


@dataclass(frozen=True, slots=True)
class Open:
    """Start the reports (ARCOS 1, OPEN; SYNC1 without argument before the session is open).

    Attributes:
        argument: Ignored by the robot; ARIA sends 1, Player none.
    """

    ID: ClassVar[int] = 1
    argument: Number = 1


@dataclass(frozen=True, slots=True)
class Close:
    """Stop everything and wait for SYNC0 (ARCOS 2, CLOSE; SYNC2 while shaking hands).

    Attributes:
        argument: Ignored by the robot; ARIA sends 1, Player none.
    """

    ID: ClassVar[int] = 2
    argument: Number = 1


@dataclass(frozen=True, slots=True)
class RequestConfig:
    """Ask for one configuration report (ARCOS 18, CONFIG).

    Attributes:
        argument: Ignored by the robot.
    """

    ID: ClassVar[int] = 18
    argument: Number = 1


@dataclass(frozen=True, slots=True)
class RequestEncoders:
    """Ask for the encoder counts (ARCOS 19, ENCODER)."""

    ID: ClassVar[int] = 19
    how: How


@dataclass(frozen=True, slots=True)
class HostBaud:
    """Change the speed of the host's serial line (ARCOS 50, HOSTBAUD)."""

    ID: ClassVar[int] = 50
    baud: Annotated[Baud, Enumerated(WORD, Baud)]


@dataclass(frozen=True, slots=True)
class Aux1Baud:
    """Change the speed of serial port AUX1 (ARCOS 51, AUX1BAUD)."""

    ID: ClassVar[int] = 51
    baud: Annotated[Baud, Enumerated(WORD, Baud)]


@dataclass(frozen=True, slots=True)
class Aux2Baud:
    """Change the speed of serial port AUX2 (ARCOS 52, AUX2BAUD)."""

    ID: ClassVar[int] = 52
    baud: Annotated[Baud, Enumerated(WORD, Baud)]
