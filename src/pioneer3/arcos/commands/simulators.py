"""Commands that only simulators know, new and old (protocol.md 3.3).

The numbers of the old ones, :data:`OLD`, mean something else to a robot. ARIA 2.9.1 still sets up
simulated lasers with 35 to 38. A `laser` of `None` is the first one; angles [rad] of a scan count
from straight ahead.
"""

from enum import IntEnum
from typing import Annotated, ClassVar

from pioneer3.arcos.commands.arguments import (
    CENTIDEGREES,
    DEGREES,
    HUNDREDTHS_OR_DEGREES,
    MILLI,
    WORD,
    Data,
    Message,
    Number,
    Prefixed,
    RequestMode,
    RequestModeCode,
    SignedDegrees,
)
from pioneer3.arcos.layout import Command
from pioneer3.arcos.lists import CountedText
from pioneer3.arcos.wire import U8, Enumerated, Integer, Rest, Scaled

__all__ = [
    "OldLaser",
    "OldLaserEnd",
    "OldLaserStart",
    "OldLaserStep",
    "OldMessage",
    "RequestSimStat",
    "SimCtrl",
    "SimExit",
    "SimLaserMode",
    "SimLrfEnable",
    "SimLrfSetFovEnd",
    "SimLrfSetFovStart",
    "SimLrfSetRes",
    "SimMessage",
    "SimModelConfig",
    "SimOperation",
    "SimReset",
    "SimSetPose",
]

_S32 = Integer(4, signed=True)


class SimLaserMode(IntEnum):
    """Packets of the simulated laser."""

    OFF = 0
    RANGES = 1
    """Packets 0x60."""
    EXTENDED = 2
    """Packets 0x61, with reflectance."""


class SimOperation(IntEnum):
    """Operations of SIM_CTRL."""

    LOAD_MAP = 1
    LOAD_MASTER_MAP = 2
    CLEAR_MASTER_MAP = 3
    ROTATE_LOGS = 4
    LOG_STATE = 5
    REQUEST_INFO = 6
    GHOST = 7
    SNAPSHOT = 8


class SimSetPose(Command, frozen=True):
    """Move the simulated robot, and leave its odometry (ARCOS 224, SIM_SET_POSE).

    The pose is that in the map [m, rad], its heading in whole degrees.
    """

    ID: ClassVar[int] = 224
    x: Annotated[float, Prefixed(Scaled(_S32, MILLI), 0)]
    y: Annotated[float, Scaled(_S32, MILLI)]
    heading: Annotated[float, Scaled(_S32, DEGREES)]


class SimReset(Command, frozen=True):
    """Put robot and odometry back to the start (ARCOS 225, SIM_RESET)."""

    ID: ClassVar[int] = 225


class SimModelConfig(Command, frozen=True):
    """Describe the robot's model; arguments unknown (ARCOS 226, SIM_MODEL_CONFIG)."""

    ID: ClassVar[int] = 226
    arguments: Rest = b""


class SimLrfEnable(Command, frozen=True):
    """Switch the simulated laser (ARCOS 230, SIM_LRF_ENABLE)."""

    ID: ClassVar[int] = 230
    mode: Annotated[SimLaserMode, Enumerated(WORD, SimLaserMode)]
    laser: U8 | None = None


class SimLrfSetFovStart(Command, frozen=True):
    """Set where the scan begins (ARCOS 231, SIM_LRF_SET_FOV_START)."""

    ID: ClassVar[int] = 231
    angle: SignedDegrees
    laser: U8 | None = None


class SimLrfSetFovEnd(Command, frozen=True):
    """Set where the scan ends (ARCOS 232, SIM_LRF_SET_FOV_END)."""

    ID: ClassVar[int] = 232
    angle: SignedDegrees
    laser: U8 | None = None


class SimLrfSetRes(Command, frozen=True):
    """Set the angle between two readings (ARCOS 233, SIM_LRF_SET_RES).

    `step` [rad] is in hundredths of a degree; received numbers up to 5 are whole degrees.
    """

    ID: ClassVar[int] = 233
    step: Annotated[float, Scaled(WORD, HUNDREDTHS_OR_DEGREES)]
    laser: U8 | None = None


class SimCtrl(Command, frozen=True):
    """Control the simulator itself (ARCOS 236, SIM_CTRL).

    `text` is the name of the map to load, or a line for the log.
    """

    ID: ClassVar[int] = 236
    operation: Annotated[SimOperation, Enumerated(WORD, SimOperation)]
    text: Annotated[str, CountedText(Integer(2))] | None = None


class RequestSimStat(Command, frozen=True):
    """Ask for the state of the simulation (ARCOS 237, SIM_STAT)."""

    ID: ClassVar[int] = 237
    how: RequestModeCode = RequestMode.ONCE


class SimMessage(Command, frozen=True):
    """Show `text` in the simulator's window (ARCOS 238, SIM_MESSAGE)."""

    ID: ClassVar[int] = 238
    text: Message


class SimExit(Command, frozen=True):
    """End the simulator with exit `code` (ARCOS 239, SIM_EXIT)."""

    ID: ClassVar[int] = 239
    code: Number


class OldLaser(Command, frozen=True):
    """Switch the simulated laser (ARCOS 35 of simulators)."""

    ID: ClassVar[int] = 35
    mode: Annotated[SimLaserMode, Enumerated(WORD, SimLaserMode)]


class OldLaserStart(Command, frozen=True):
    """Set where the scan begins [rad], from straight ahead (ARCOS 36 of simulators)."""

    ID: ClassVar[int] = 36
    angle: SignedDegrees


class OldLaserEnd(Command, frozen=True):
    """Set where the scan ends [rad], from straight ahead (ARCOS 37 of simulators)."""

    ID: ClassVar[int] = 37
    angle: SignedDegrees


class OldLaserStep(Command, frozen=True):
    """Set the angle between two readings [rad] (ARCOS 38 of simulators)."""

    ID: ClassVar[int] = 38
    step: Annotated[float, Scaled(WORD, CENTIDEGREES)]


class OldMessage(Command, frozen=True):
    """Show a text; three bytes of code come before it (ARCOS 59 of simulators)."""

    ID: ClassVar[int] = 59
    data: Data


OLD = (OldLaser, OldLaserStart, OldLaserEnd, OldLaserStep, OldMessage)
"""Commands of old simulators."""
