"""Reports that only simulators send (protocol.md 5.13)."""

from enum import IntFlag
from typing import Annotated, ClassVar, NamedTuple

from msgspec import Struct

from pioneer3.arcos.layout import Report
from pioneer3.arcos.lists import Counted, CountedStructs, Record
from pioneer3.arcos.wire import S8, S16, S32, U8, U16, U32, Enumerated, Flag, Integer, Rest, Text

__all__ = [
    "LaserReading",
    "MapChanged",
    "SimDevice",
    "SimFlag",
    "SimInfo",
    "SimLaser",
    "SimLaserExtended",
    "SimStat",
]

_U8 = Integer(1)
_U16 = Integer(2)
_U32 = Integer(4)


class SimLaser(Report, frozen=True, kw_only=True):
    """A part of a laser sweep (0x60).

    Attributes:
        x_mm: Of the robot; ARIA ignores it.
        y_mm: Likewise.
        heading_deg: Likewise.
        total: Number of readings in the sweep.
        first: Index of the first reading here; 0 begins a sweep.
        ranges_mm: Counter-clockwise; 0x7FFF and more is nothing.
    """

    ID: ClassVar[int] = 0x60
    x_mm: S16 = 0
    y_mm: S16 = 0
    heading_deg: S16 = 0
    total: U16
    first: U16
    ranges_mm: Annotated[tuple[int, ...], Counted(_U8, _U16)]
    extra: Rest = b""


class LaserReading(NamedTuple):
    """One reading with its brightness; `reserved` is 0."""

    range_mm: U16
    reflectance: U8 = 0
    reserved: U16 = 0


class SimLaserExtended(Report, frozen=True, kw_only=True):
    """A part of a laser sweep with reflectances (0x61).

    Attributes:
        total: Number of readings in the sweep.
        first: Index of the first reading here; 0 begins a sweep.
        readings: Counter-clockwise.
        laser: Which laser.
        flags: Bit 0: the robot was moved by hand.
    """

    ID: ClassVar[int] = 0x61
    total: U16
    first: U16
    readings: Annotated[tuple[LaserReading, ...], CountedStructs(LaserReading, "HBH")]
    laser: U8 | None = None
    flags: U8 | None = None
    extra: Rest = b""


class SimFlag(IntFlag):
    """Abilities of the simulation in a SIMSTAT report (protocol.md 5.13)."""

    HAS_MAP = 1 << 0
    HAS_GEO_REFERENCE = 1 << 1
    HAS_ODOMETRY_ERROR = 1 << 2


class SimStat(Report, frozen=True, kw_only=True):
    """The state of the simulation (0x62), as an answer to SIM_STAT.

    Attributes:
        obsolete1: Empty.
        obsolete2: Empty.
        flags: Which of the other fields are valid.
        step_ms: Simulated time of a step.
        interval_ms: Real time that a step should take.
        measured_ms: Real time that a step takes.
        x_mm: True place; y, z likewise.
        heading_deg: True heading.
        latitude_e7: [degrees / 10^7]; longitude likewise.
        altitude_cm: [cm].
        gps_quality: DOP x 100; 0 without reception, -1 without a geo-reference.
        odometry_error_x_e7: Per metre [1/10^7]; y likewise, heading per radian.
    """

    ID: ClassVar[int] = 0x62
    obsolete1: Text = ""
    obsolete2: Text = ""
    flags: Annotated[SimFlag, Enumerated(_U32, SimFlag)]
    step_ms: U16
    interval_ms: U16
    measured_ms: U16
    x_mm: S32
    y_mm: S32
    z_mm: S32
    heading_deg: S32
    latitude_e7: S32
    longitude_e7: S32
    altitude_cm: S32
    gps_quality: S32
    odometry_error_x_e7: S32
    odometry_error_y_e7: S32
    odometry_error_heading_e7: S32
    extra: Rest = b""


class SimDevice(Struct, frozen=True, kw_only=True):
    """A simulated device."""

    name: Text
    kind: Text
    which: U8
    status: U32


class SimInfo(Report, frozen=True, kw_only=True):
    """The simulator and its devices (0x63), as an answer to SIM_CTRL 6.

    Attributes:
        application: Name of the program.
        version: Of the program.
        flags: Bit 0 has a window, bit 1 restarted after a crash.
        devices: The simulated devices.
    """

    ID: ClassVar[int] = 0x63
    application: Text
    version: Text
    flags: U32
    devices: Annotated[tuple[SimDevice, ...], Counted(_U32, Record(SimDevice))]
    extra: Rest = b""


class MapChanged(Report, frozen=True):
    """Another map was loaded (0x66).

    Attributes:
        by_user: Whether a person did it, rather than a client.
        reloaded: 1 if it was loaded again, 0 if it is unchanged.
        file_name: Of the map.
    """

    ID: ClassVar[int] = 0x66
    by_user: Flag
    reloaded: S8
    file_name: Text
    extra: Rest = b""
