"""Readings that come when asked for (arcos.md 5.2 to 5.10)."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

from pioneer3.arcos.lists import Counted, Record, Repeated
from pioneer3.arcos.wire import S8, S16, S32, U8, U16, Integer, Rest

_U8 = Integer(1)
_S8 = Integer(1, signed=True)
_U16 = Integer(2)


@dataclass(frozen=True, slots=True)
class Encoders:
    """Encoder counts (0x90), as an answer to ENCODER."""

    ID: ClassVar[int] = 0x90
    left_counts: S32
    right_counts: S32
    extra: Rest = b""


@dataclass(frozen=True, slots=True)
class Io:
    """All inputs and outputs (0xF0), as an answer to IOREQUEST.

    Attributes:
        digital_in: Bytes of 8 inputs each.
        digital_out: Bytes of 8 outputs each.
        analog_raw: Of which 12 bits count, [4.8828 mV].
        extra: Bytes that belong to no field.
    """

    ID: ClassVar[int] = 0xF0
    digital_in: Annotated[tuple[int, ...], Counted(_U8, _U8)]
    digital_out: Annotated[tuple[int, ...], Counted(_U8, _U8)]
    analog_raw: Annotated[tuple[int, ...], Counted(_U8, _U16)]
    extra: Rest = b""


@dataclass(frozen=True, slots=True)
class GyroSample:
    """One sample of the gyro, 25 ms after the one before.

    Attributes:
        rate_raw: 0..1023; 512 stands still, less is counter-clockwise.
        temperature_raw: Uncalibrated.
    """

    rate_raw: S16
    temperature_raw: U8


@dataclass(frozen=True, slots=True)
class GyroRates:
    """Samples of a gyro that the host corrects the heading with (0x98)."""

    ID: ClassVar[int] = 0x98
    samples: Annotated[tuple[GyroSample, ...], Counted(_S8, Record(GyroSample))]
    extra: Rest = b""


@dataclass(frozen=True, slots=True)
class Imu:
    """An inertial sensor (0x9A), undecoded: only an example of ARIA reads it."""

    ID: ClassVar[int] = 0x9A
    data: Rest = b""


@dataclass(frozen=True, slots=True, kw_only=True)
class Compass:
    """The TCM2 compass (0xC0).

    Attributes:
        heading_decidegrees: [0.1 degree], clockwise from magnetic north; pitch, roll likewise.
        magnetic_x_hundredths: [0.01] of the field's unit; y, z likewise.
        temperature_decicelsius: [0.1 degree Celsius].
        error: Bits of the module.
        calibration_h: Score of the horizontal calibration.
        calibration_v: Score of the vertical calibration.
        calibration_m_hundredths: Score of the magnetic calibration [0.01].
        extra: Bytes that belong to no field.
    """

    ID: ClassVar[int] = 0xC0
    heading_decidegrees: S16
    pitch_decidegrees: S16
    roll_decidegrees: S16
    magnetic_x_hundredths: S16
    magnetic_y_hundredths: S16
    magnetic_z_hundredths: S16
    temperature_decicelsius: S16
    error: S16
    calibration_h: S8
    calibration_v: S8
    calibration_m_hundredths: S16
    extra: Rest = b""


@dataclass(frozen=True, slots=True)
class IrRing:
    """A ring of 91 infrared range finders (0x10).

    Attributes:
        port: Where it is connected.
        ranges_raw: [1/2.88 mm]; the i-th looks to -81 + 1.8 i degrees.
        extra: Bytes that belong to no field.
    """

    ID: ClassVar[int] = 0x10
    port: S16
    ranges_raw: Annotated[tuple[int, ...], Repeated(_U16, 91)]
    extra: Rest = b""


@dataclass(frozen=True, slots=True, kw_only=True)
class Joystick:
    """The joystick at the robot (0xF8), as an answer to JOYINFO.

    Attributes:
        button1: 1 if pressed.
        button2: Likewise.
        x_raw: 0..1023, 512 is the centre, less is right.
        y_raw: 0..1023, 512 is the centre, more is forward.
        throttle_raw: 0..1023.
        extra: Bytes that belong to no field.
    """

    ID: ClassVar[int] = 0xF8
    button1: U8
    button2: U8
    x_raw: U16
    y_raw: U16
    throttle_raw: U16
    extra: Rest = b""
