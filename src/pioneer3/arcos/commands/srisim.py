"""Old simulator commands, whose numbers mean something else to a robot (arcos.md 3.3).

ARIA 2.9.1 still sets up simulated lasers with 35 to 38.
"""

from dataclasses import dataclass
from typing import Annotated, ClassVar

from pioneer3.arcos.commands.choices import SimLaserMode
from pioneer3.arcos.commands.quantities import (
    CENTIDEGREES,
    WORD,
    Data,
    Message,
    Number,
    SignedDegrees,
    SignedMillis,
)
from pioneer3.arcos.wire import Enumerated, Rest, Scaled

__all__ = [
    "EndSim",
    "LoadParam",
    "LoadWorld",
    "OldLaser",
    "OldLaserEnd",
    "OldLaserStart",
    "OldLaserStep",
    "OldMessage",
    "OldReset",
    "OldSetTh",
    "OldSetX",
    "OldSetY",
    "Step",
]


@dataclass(frozen=True, slots=True)
class OldLaser:
    """Switch the simulated laser (ARCOS 35 of simulators)."""

    ID: ClassVar[int] = 35
    mode: Annotated[SimLaserMode, Enumerated(WORD, SimLaserMode)]


@dataclass(frozen=True, slots=True)
class OldLaserStart:
    """Set where the scan begins [rad], from straight ahead (ARCOS 36 of simulators)."""

    ID: ClassVar[int] = 36
    angle: SignedDegrees


@dataclass(frozen=True, slots=True)
class OldLaserEnd:
    """Set where the scan ends [rad], from straight ahead (ARCOS 37 of simulators)."""

    ID: ClassVar[int] = 37
    angle: SignedDegrees


@dataclass(frozen=True, slots=True)
class OldLaserStep:
    """Set the angle between two readings [rad] (ARCOS 38 of simulators)."""

    ID: ClassVar[int] = 38
    step: Annotated[float, Scaled(WORD, CENTIDEGREES)]


@dataclass(frozen=True, slots=True)
class OldMessage:
    """Show a text; three bytes of code come before it (ARCOS 59 of simulators)."""

    ID: ClassVar[int] = 59
    data: Data


@dataclass(frozen=True, slots=True)
class LoadParam:
    """Load the parameter file `name` (ARCOS 61 of simulators, LOADPARAM)."""

    ID: ClassVar[int] = 61
    name: Message


@dataclass(frozen=True, slots=True)
class EndSim:
    """End the simulator (ARCOS 62 of simulators, END_SIM)."""

    ID: ClassVar[int] = 62


@dataclass(frozen=True, slots=True)
class LoadWorld:
    """Load the world file `name` (ARCOS 63 of simulators, LOADWORLD)."""

    ID: ClassVar[int] = 63
    name: Message


@dataclass(frozen=True, slots=True)
class Step:
    """Simulate one step; arguments unknown (ARCOS 64 of simulators, STEP)."""

    ID: ClassVar[int] = 64
    arguments: Rest = b""


@dataclass(frozen=True, slots=True)
class OldSetX:
    """Set the true x [m] (ARCOS 66 of simulators)."""

    ID: ClassVar[int] = 66
    x: SignedMillis


@dataclass(frozen=True, slots=True)
class OldSetY:
    """Set the true y [m] (ARCOS 67 of simulators)."""

    ID: ClassVar[int] = 67
    y: SignedMillis


@dataclass(frozen=True, slots=True)
class OldSetTh:
    """Set the true heading [rad] (ARCOS 68 of simulators)."""

    ID: ClassVar[int] = 68
    heading: SignedDegrees


@dataclass(frozen=True, slots=True)
class OldReset:
    """Put the robot back to the origin (ARCOS 69 of simulators)."""

    ID: ClassVar[int] = 69
    argument: Number = 1
