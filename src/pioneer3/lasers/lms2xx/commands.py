"""Commands of the LMS-2xx, their answers' codes, and the requests that hosts send (lms2xx.md 1.5).

An answer has the code of its command plus :data:`ANSWER`; that of the request for one scan is the
telegram of measurements itself.
"""

from enum import IntEnum
from struct import pack
from typing import Final

from pioneer3.lasers.lms2xx.measuring import Variant
from pioneer3.lasers.lms2xx.telegram import encode

ANSWER: Final = 0x80
ACCEPTED: Final = 0x01
"""First byte of the answer to a variant, configuration or speed to keep that the unit has taken."""
NOT_ACCEPTED: Final = 0x00
MODE_ACCEPTED: Final = 0x00
"""The byte of the answer to a mode that the unit has taken."""
MODE_WRONG_PASSWORD: Final = 0x01
PASSWORD: Final = b"SICK_LMS"


class CommandCode(IntEnum):
    """Codes of requests."""

    RESET = 0x10
    MODE = 0x20
    SCAN = 0x30
    STATUS = 0x31
    ERRORS = 0x32
    TYPE = 0x3A
    VARIANT = 0x3B
    KEEP_SPEED = 0x66
    CONFIG = 0x74
    CONFIGURE = 0x77


class Unasked(IntEnum):
    """Codes of answers that no command has."""

    READY = 0x90
    """The unit has started; the text of its type."""
    RESETTING = 0x91
    REFUSED = 0x92


class OperatingMode(IntEnum):
    """Operating modes, the first byte of MODE (lms2xx.md 1.6)."""

    INSTALLATION = 0x00
    ALL_VALUES = 0x24
    ON_REQUEST = 0x25
    MEAN = 0x26
    SUBRANGE = 0x27
    MEAN_OF_SUBRANGE = 0x28
    PARTIAL_SCANS = 0x2A
    SPEED_38400 = 0x40
    SPEED_19200 = 0x41
    SPEED_9600 = 0x42
    SPEED_500000 = 0x48
    RANGE_AND_REFLECTIVITY = 0x50


MODE_OF_SPEED: Final = {
    9600: OperatingMode.SPEED_9600,
    19200: OperatingMode.SPEED_19200,
    38400: OperatingMode.SPEED_38400,
    500000: OperatingMode.SPEED_500000,
}
"""By baud; only these exist."""
SPEED_OF_MODE: Final[dict[int, int]] = {mode: baud for baud, mode in MODE_OF_SPEED.items()}
STREAMS: Final = frozenset(
    {
        OperatingMode.ALL_VALUES,
        OperatingMode.MEAN,
        OperatingMode.SUBRANGE,
        OperatingMode.MEAN_OF_SUBRANGE,
        OperatingMode.PARTIAL_SCANS,
        OperatingMode.RANGE_AND_REFLECTIVITY,
    }
)
"""Modes in which a unit sends scans unasked."""

MEANS: Final = frozenset({OperatingMode.MEAN, OperatingMode.MEAN_OF_SUBRANGE})
"""Modes in which each telegram is the mean of several scans."""
PARTS: Final = frozenset({OperatingMode.SUBRANGE, OperatingMode.MEAN_OF_SUBRANGE})
"""Modes in which a part of the field is sent."""
SAMPLES: Final = range(2, 251)
"""Scans that a mean may be of."""


def mode(wanted: OperatingMode, data: bytes = b"") -> bytes:
    """Return the request for a mode, with the data that it needs."""
    return encode(CommandCode.MODE, bytes((wanted,)) + data)


def variant(wanted: Variant) -> bytes:
    """Return the request for a field and a step."""
    return encode(CommandCode.VARIANT, variant_data(wanted))


def variant_data(wanted: Variant) -> bytes:
    """Return field and step as VARIANT and its answer carry them."""
    return pack("<HH", wanted.field_deg, wanted.step_cdeg)
