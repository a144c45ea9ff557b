"""Batteries, power switches and safety (arcos.md 3.2)."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

from pioneer3.arcos.commands.arguments import Bits
from pioneer3.arcos.commands.choices import SafetySystem
from pioneer3.arcos.commands.quantities import High, How, Low, LowOn, On
from pioneer3.arcos.wire import Enumerated, Rest

__all__ = [
    "Power5V",
    "Power12V",
    "PowerAudio",
    "PowerAuxPc",
    "PowerLrf",
    "PowerLrf2",
    "PowerPc",
    "PowerPtz",
    "PowerTouchscreen",
    "RequestBatteryInfo",
    "SafetyDisablePowerOffTimer",
    "SafetySetState",
    "SafetyStateInfo",
    "SafetyZoneActive",
    "SeekurPowerPort",
]


@dataclass(frozen=True, slots=True)
class RequestBatteryInfo:
    """Ask for what the batteries say themselves (ARCOS 62, BATTERYINFO)."""

    ID: ClassVar[int] = 62
    how: How


@dataclass(frozen=True, slots=True)
class PowerPc:
    """Switch the computer (ARCOS 95, POWER_PC)."""

    ID: ClassVar[int] = 95
    on: On


@dataclass(frozen=True, slots=True)
class PowerLrf:
    """Switch the laser range finder (ARCOS 96, POWER_LRF)."""

    ID: ClassVar[int] = 96
    on: On


@dataclass(frozen=True, slots=True)
class Power5V:
    """Switch the 5 V supply (ARCOS 97, POWER_5V)."""

    ID: ClassVar[int] = 97
    on: On


@dataclass(frozen=True, slots=True)
class Power12V:
    """Switch the 12 V supply, on some robots 24 V (ARCOS 98, POWER_12V)."""

    ID: ClassVar[int] = 98
    on: On


@dataclass(frozen=True, slots=True)
class SeekurPowerPort:
    """Switch a power port; Seekur only (ARCOS 116)."""

    ID: ClassVar[int] = 116
    port: High
    on: LowOn


@dataclass(frozen=True, slots=True)
class PowerAuxPc:
    """Switch the second computer (ARCOS 125, POWER_AUX_PC)."""

    ID: ClassVar[int] = 125
    on: On


@dataclass(frozen=True, slots=True)
class PowerTouchscreen:
    """Switch the touch screen (ARCOS 126, POWER_TOUCHSCREEN)."""

    ID: ClassVar[int] = 126
    on: On


@dataclass(frozen=True, slots=True)
class PowerPtz:
    """Switch the camera (ARCOS 127, POWER_PTZ)."""

    ID: ClassVar[int] = 127
    on: On


@dataclass(frozen=True, slots=True)
class PowerAudio:
    """Switch the loudspeakers (ARCOS 128, POWER_AUDIO)."""

    ID: ClassVar[int] = 128
    on: On


@dataclass(frozen=True, slots=True)
class PowerLrf2:
    """Switch the second laser range finder (ARCOS 129, POWER_LRF2)."""

    ID: ClassVar[int] = 129
    on: On


@dataclass(frozen=True, slots=True)
class SafetyStateInfo:
    """Ask for the safety state; MTX (ARCOS 214, SAFETY_STATE_INFO)."""

    ID: ClassVar[int] = 214
    how: How


@dataclass(frozen=True, slots=True)
class SafetySetState:
    """Set the `state` [raw] of a safety system; MTX (ARCOS 215, SAFETY_SET_STATE)."""

    ID: ClassVar[int] = 215
    system: Annotated[SafetySystem, Enumerated(Bits(8, 8), SafetySystem)]
    state: Low


@dataclass(frozen=True, slots=True)
class SafetyDisablePowerOffTimer:
    """Keep the power on; MTX, arguments unknown (ARCOS 216)."""

    ID: ClassVar[int] = 216
    arguments: Rest = b""


@dataclass(frozen=True, slots=True)
class SafetyZoneActive:
    """Choose a safety zone; MTX, arguments unknown (ARCOS 217, SAFETY_ZONE_ACTIVE)."""

    ID: ClassVar[int] = 217
    arguments: Rest = b""
