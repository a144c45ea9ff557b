"""SICK's LMS-2xx: the LMS-200, 211, 220, 221, 291 on a serial line, both sides.

=========  ===================================================
module     contents
=========  ===================================================
telegram   frame, checksum, the reader
commands   codes of requests, modes
measuring  variants, units, measuring modes: the 16-bit values
blocks     configuration and status
scans      telegrams of measurements
client     :class:`LmsClient`: the host
device     :class:`LmsDevice`: the laser
setup      the set-up of an LMS-2xx
unit       the settings of a simulated LMS-2xx
mirror     the mirror of an LMS-2xx
=========  ===================================================

Facts: docs/reference/lms2xx.md.
"""

from pioneer3.lasers.lms2xx.client import LmsClient
from pioneer3.lasers.lms2xx.device import LmsDevice

__all__ = ["LmsClient", "LmsDevice"]
