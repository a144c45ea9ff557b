"""The answers to VV, PP and II: the laser's identity and geometry (scip.md 4). No I/O."""

import re
from collections.abc import Mapping
from dataclasses import replace
from typing import Final

from pioneer3.lasers.client import LaserIdentity
from pioneer3.models.lasers import LASERS, Steps

FIRMWARE: Final = re.compile(r"([^(]*)(?:\((.*)\))?")
"""Such as `3.3.00(12/Sep./2012)`."""
SIZES: Final = {
    "DMIN": "shortest",
    "DMAX": "longest",
    "ARES": "per_turn",
    "AMIN": "first",
    "AMAX": "last",
    "AFRT": "front",
    "SCAN": "rpm",
}
HEALTHY: Final = ("sensor works well", "stable")
"""How lasers say that nothing is wrong, in lower case."""
_URG = LASERS["urg-04lx"].steps
assert _URG is not None
FIRST_URG: Final = replace(_URG, longest=4095)
"""Geometry of the only laser that speaks nothing but SCIP 1.1, which has no PP."""


def identity_from(version: Mapping[str, str], state: Mapping[str, str]) -> LaserIdentity:
    """Return the identity in the answers to VV and II; the latter may be empty."""
    firmware = FIRMWARE.match(version.get("FIRM", ""))
    assert firmware is not None
    return LaserIdentity(
        vendor=version.get("VEND", "").strip(),
        product=version.get("PROD", "").strip(),
        serial=device_id(version.get("SERI", "").strip()),
        firmware=firmware[1].strip(),
        firmware_date=(firmware[2] or "").strip(),
        protocol=version.get("PROT", "").strip(),
        status=state.get("STAT", version.get("STAT", "")).strip(),
    )


def device_id(serial: str) -> str:
    """Return a serial number as it stands on the laser's label: H and the rest."""
    if not serial or serial.startswith("H"):
        return serial
    return "H" + serial.removeprefix("0")


def is_healthy(status: str) -> bool:
    """Tell whether STAT of II means that nothing is wrong; an empty one says nothing."""
    return not status or status.lower().startswith(HEALTHY)


def steps_from(parameters: Mapping[str, str]) -> Steps | None:
    """Return the geometry in an answer to PP, or `None` if that is no geometry of a laser."""
    if any(not parameters.get(key, "").isdecimal() for key in SIZES):
        return None
    steps = Steps(**{name: int(parameters[key]) for key, name in SIZES.items()})
    sensible = (
        0 < steps.per_turn <= 1 << 16
        and 0 <= steps.first < steps.last < 2 * steps.per_turn
        and 0 <= steps.front < 2 * steps.per_turn
        and steps.rpm > 0
        and 0 <= steps.shortest < steps.longest < 1 << 18
    )
    return steps if sensible else None
