"""Gripper, sounds, lamps, pan-tilt unit and auxiliary serial ports (arcos.md 3.2)."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

from pioneer3.arcos.commands.arguments import String
from pioneer3.arcos.commands.choices import GripperAction
from pioneer3.arcos.commands.quantities import (
    POSITIVE,
    TWENTY_MS,
    WORD,
    Data,
    High,
    How,
    Low,
    On,
    Word,
)
from pioneer3.arcos.lists import Record, Repeated
from pioneer3.arcos.wire import U8, Enumerated, Integer, Rest, Scaled

__all__ = [
    "GetAux",
    "GetAux2",
    "GetAux3",
    "Gripper",
    "GripperPacRequest",
    "GripperVal",
    "JoyDrive",
    "MovingBlink",
    "PtuPos",
    "RequestPlaylist",
    "Say",
    "Sound",
    "SoundTog",
    "Tone",
    "Tty2",
    "Tty3",
    "Tty4",
    "WheelLight",
]


@dataclass(frozen=True, slots=True)
class Tone:
    """One tone of SAY.

    Attributes:
        duration: [s], in steps of 20 ms.
        half_cycle: Half the period of the wave [raw]; the greater, the lower; 0 is silence.
    """

    duration: Annotated[float, Scaled(Integer(1), TWENTY_MS)]
    half_cycle: U8


@dataclass(frozen=True, slots=True)
class Say:
    """Play up to 20 tones one after the other (ARCOS 15, SAY)."""

    ID: ClassVar[int] = 15
    tones: Annotated[tuple[Tone, ...], String(Repeated(Record(Tone)), limit=40)]


@dataclass(frozen=True, slots=True)
class Gripper:
    """Move the gripper (ARCOS 33, GRIPPER)."""

    ID: ClassVar[int] = 33
    action: Annotated[GripperAction, Enumerated(WORD, GripperAction)]


@dataclass(frozen=True, slots=True)
class GripperVal:
    """Set how long PRESSURE or LIFT_CARRY last [s] (ARCOS 36, GRIPPERVAL)."""

    ID: ClassVar[int] = 36
    duration: Annotated[float, Scaled(POSITIVE, TWENTY_MS)]


@dataclass(frozen=True, slots=True)
class GripperPacRequest:
    """Ask for the state of the gripper (ARCOS 37, GRIPPERPACREQUEST)."""

    ID: ClassVar[int] = 37
    how: How


@dataclass(frozen=True, slots=True)
class PtuPos:
    """Set a pan-tilt servo by its pulse width [raw] (ARCOS 41, PTUPOS)."""

    ID: ClassVar[int] = 41
    port: High
    pulse_width_raw: Low


@dataclass(frozen=True, slots=True)
class Tty2:
    """Send `data` out of serial port AUX1 (ARCOS 42, TTY2)."""

    ID: ClassVar[int] = 42
    data: Data


@dataclass(frozen=True, slots=True)
class Tty3:
    """Send `data` out of serial port AUX2 (ARCOS 66, TTY3)."""

    ID: ClassVar[int] = 66
    data: Data


@dataclass(frozen=True, slots=True)
class Tty4:
    """Send `data` out of serial port AUX3 (ARCOS 60, TTY4)."""

    ID: ClassVar[int] = 60
    data: Data


@dataclass(frozen=True, slots=True)
class GetAux:
    """Ask for `count` bytes received on AUX1; 0 forgets them (ARCOS 43, GETAUX)."""

    ID: ClassVar[int] = 43
    count: Word


@dataclass(frozen=True, slots=True)
class GetAux2:
    """Ask for `count` bytes received on AUX2; 0 forgets them (ARCOS 67, GETAUX2)."""

    ID: ClassVar[int] = 67
    count: Word


@dataclass(frozen=True, slots=True)
class GetAux3:
    """Ask for `count` bytes received on AUX3; 0 forgets them (ARCOS 61, GETAUX3)."""

    ID: ClassVar[int] = 61
    count: Word


@dataclass(frozen=True, slots=True)
class JoyDrive:
    """Let the joystick on the robot drive it (ARCOS 47, JOYDRIVE)."""

    ID: ClassVar[int] = 47
    on: On


@dataclass(frozen=True, slots=True)
class MovingBlink:
    """Blink a lamp before moving; PatrolBot (ARCOS 49, MOVINGBLINK)."""

    ID: ClassVar[int] = 49
    on: On


@dataclass(frozen=True, slots=True)
class Sound:
    """Play sound `number`; AmigoBot (ARCOS 90, SOUND)."""

    ID: ClassVar[int] = 90
    number: Word


@dataclass(frozen=True, slots=True)
class RequestPlaylist:
    """Ask for the name of sound `number`, 0 for all; AmigoBot (ARCOS 91, PLAYLIST)."""

    ID: ClassVar[int] = 91
    number: Word


@dataclass(frozen=True, slots=True)
class SoundTog:
    """Switch sounds on or off; AmigoBot (ARCOS 92, SOUNDTOG)."""

    ID: ClassVar[int] = 92
    on: On


@dataclass(frozen=True, slots=True)
class WheelLight:
    """Set the wheel lamps; MTX, arguments unknown (ARCOS 212, WHEEL_LIGHT)."""

    ID: ClassVar[int] = 212
    arguments: Rest = b""
