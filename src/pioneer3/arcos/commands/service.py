"""Diagnosis, maintenance and faked readings for tests (arcos.md 3.2)."""

from dataclasses import dataclass
from typing import ClassVar

from pioneer3.arcos.commands.quantities import Celsius, Decivolts, Message, On, Word
from pioneer3.arcos.wire import Rest

__all__ = [
    "BatTest",
    "DigTempTest",
    "LaserLogText",
    "Maintenance",
    "MarcConfigGet",
    "MarcConfigSet",
    "MarcDebug",
    "PowerOnLikeReset",
    "SRecord",
    "SpoofAnalogTemp",
]


@dataclass(frozen=True, slots=True)
class LaserLogText:
    """Put `text` into the laser log (ARCOS 94)."""

    ID: ClassVar[int] = 94
    text: Message


@dataclass(frozen=True, slots=True)
class SRecord:
    """Download one byte of firmware (ARCOS 210, SRECORD)."""

    ID: ClassVar[int] = 210
    byte: Word


@dataclass(frozen=True, slots=True)
class MarcDebug:
    """Send `text` to the firmware for debugging (ARCOS 211, MARCDEBUG)."""

    ID: ClassVar[int] = 211
    text: Message


@dataclass(frozen=True, slots=True)
class MarcConfigSet:
    """Set firmware parameters; MTX, arguments unknown (ARCOS 219, MARC_CONFIG_SET)."""

    ID: ClassVar[int] = 219
    arguments: Rest = b""


@dataclass(frozen=True, slots=True)
class MarcConfigGet:
    """Read firmware parameters; MTX, arguments unknown (ARCOS 220, MARC_CONFIG_GET)."""

    ID: ClassVar[int] = 220
    arguments: Rest = b""


@dataclass(frozen=True, slots=True)
class BatTest:
    """Pretend a battery of `voltage` [V]; 0 ends it (ARCOS 250, BATTEST)."""

    ID: ClassVar[int] = 250
    voltage: Decivolts


@dataclass(frozen=True, slots=True)
class DigTempTest:
    """Pretend a high motor temperature (ARCOS 251, DIGTEMPTEST)."""

    ID: ClassVar[int] = 251
    on: On


@dataclass(frozen=True, slots=True)
class SpoofAnalogTemp:
    """Pretend a motor temperature [degrees Celsius]; -128 ends it (ARCOS 252)."""

    ID: ClassVar[int] = 252
    celsius: Celsius


@dataclass(frozen=True, slots=True)
class PowerOnLikeReset:
    """Restart the firmware (ARCOS 253, POWERONLIKE_RESET)."""

    ID: ClassVar[int] = 253


@dataclass(frozen=True, slots=True)
class Maintenance:
    """Restart the firmware for maintenance (ARCOS 255)."""

    ID: ClassVar[int] = 255
