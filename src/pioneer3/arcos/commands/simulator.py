"""What only simulators understand (arcos.md 3.3)."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

from pioneer3.arcos.commands.arguments import Prefixed
from pioneer3.arcos.commands.choices import Request, SimLaserMode, SimOperation
from pioneer3.arcos.commands.quantities import (
    DEGREES,
    HUNDREDTHS_OR_DEGREES,
    MILLI,
    WORD,
    How,
    Message,
    Number,
    SignedDegrees,
)
from pioneer3.arcos.lists import CountedText
from pioneer3.arcos.wire import U8, Enumerated, Integer, Rest, Scaled

__all__ = [
    "RequestSimStat",
    "SimCtrl",
    "SimExit",
    "SimLrfEnable",
    "SimLrfSetFovEnd",
    "SimLrfSetFovStart",
    "SimLrfSetRes",
    "SimMessage",
    "SimModelConfig",
    "SimReset",
    "SimSetPose",
]

_S32 = Integer(4, signed=True)


@dataclass(frozen=True, slots=True)
class SimSetPose:
    """Move the simulated robot, and leave its odometry (ARCOS 224, SIM_SET_POSE).

    Attributes:
        x: In the map [m].
        y: In the map [m].
        heading: In the map [rad], in whole degrees.
    """

    ID: ClassVar[int] = 224
    x: Annotated[float, Prefixed(Scaled(_S32, MILLI), 0)]
    y: Annotated[float, Scaled(_S32, MILLI)]
    heading: Annotated[float, Scaled(_S32, DEGREES)]


@dataclass(frozen=True, slots=True)
class SimReset:
    """Put robot and odometry back to the start (ARCOS 225, SIM_RESET)."""

    ID: ClassVar[int] = 225


@dataclass(frozen=True, slots=True)
class SimModelConfig:
    """Describe the robot's model; arguments unknown (ARCOS 226, SIM_MODEL_CONFIG)."""

    ID: ClassVar[int] = 226
    arguments: Rest = b""


@dataclass(frozen=True, slots=True)
class SimLrfEnable:
    """Switch the simulated laser (ARCOS 230, SIM_LRF_ENABLE).

    Attributes:
        mode: Which packets it sends.
        laser: Which laser; `None` is the first.
    """

    ID: ClassVar[int] = 230
    mode: Annotated[SimLaserMode, Enumerated(WORD, SimLaserMode)]
    laser: U8 | None = None


@dataclass(frozen=True, slots=True)
class SimLrfSetFovStart:
    """Set where the scan begins (ARCOS 231, SIM_LRF_SET_FOV_START).

    Attributes:
        angle: From straight ahead [rad].
        laser: Which laser; `None` is the first.
    """

    ID: ClassVar[int] = 231
    angle: SignedDegrees
    laser: U8 | None = None


@dataclass(frozen=True, slots=True)
class SimLrfSetFovEnd:
    """Set where the scan ends (ARCOS 232, SIM_LRF_SET_FOV_END).

    Attributes:
        angle: From straight ahead [rad].
        laser: Which laser; `None` is the first.
    """

    ID: ClassVar[int] = 232
    angle: SignedDegrees
    laser: U8 | None = None


@dataclass(frozen=True, slots=True)
class SimLrfSetRes:
    """Set the angle between two readings (ARCOS 233, SIM_LRF_SET_RES).

    Attributes:
        step: [rad], in hundredths of a degree; received numbers up to 5 are whole degrees.
        laser: Which laser; `None` is the first.
    """

    ID: ClassVar[int] = 233
    step: Annotated[float, Scaled(WORD, HUNDREDTHS_OR_DEGREES)]
    laser: U8 | None = None


@dataclass(frozen=True, slots=True)
class SimCtrl:
    """Control the simulator itself (ARCOS 236, SIM_CTRL).

    Attributes:
        operation: What to do.
        text: Name of the map to load, or what to write to the log.
    """

    ID: ClassVar[int] = 236
    operation: Annotated[SimOperation, Enumerated(WORD, SimOperation)]
    text: Annotated[str, CountedText(Integer(2))] | None = None


@dataclass(frozen=True, slots=True)
class RequestSimStat:
    """Ask for the state of the simulation (ARCOS 237, SIM_STAT)."""

    ID: ClassVar[int] = 237
    how: How = Request.ONCE


@dataclass(frozen=True, slots=True)
class SimMessage:
    """Show `text` in the simulator's window (ARCOS 238, SIM_MESSAGE)."""

    ID: ClassVar[int] = 238
    text: Message


@dataclass(frozen=True, slots=True)
class SimExit:
    """End the simulator with exit `code` (ARCOS 239, SIM_EXIT)."""

    ID: ClassVar[int] = 239
    code: Number
