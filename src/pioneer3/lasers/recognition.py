"""Recognises a laser by the bytes it sends, whatever its protocol. Pure."""

import re
from typing import Final

from pioneer3.lasers.lms2xx.commands import Command
from pioneer3.lasers.lms2xx.telegram import UNITS, Telegram, TelegramReader, encode
from pioneer3.models.lasers import LaserProtocol

SCIP_QUESTION: Final = b"\nVV\n"
"""Asks a SCIP laser for its version (scip.md 1.4). The first LF ends earlier bytes that the laser
took for the beginning of a command."""
LMS_QUESTION: Final = encode(Command.TYPE)
"""Asks an LMS-2xx for its type (lms2xx.md 1.5)."""
COLA_QUESTION: Final = b"\x02sRN DeviceIdent\x03"
"""Asks a CoLa-A laser for its type (cola.md 1.2)."""
QUESTION: Final = LMS_QUESTION + SCIP_QUESTION + COLA_QUESTION
"""All three: each is ignored by the devices of the others, and changes no setting."""

SCIP_ANSWER: Final = re.compile(
    rb"(?:^|\n)(?:VV|QT|PP|II|V|[MGNH][DSE]\d{10,13}|G\d{8})[^\n]*\r?\n(?:0|E|\d\w.?)\r?\n"
)
"""The command, repeated, and a status (scip.md 1.2)."""
COLA_ANSWER: Final = re.compile(rb"\x02s(?:(?:RA|AN|WA|EA|SN) \w+|FA)[ -~]*\x03")


def recognise(heard: bytes) -> LaserProtocol | None:
    """Return the protocol of the laser that sent `heard`, or `None` if that is no laser."""
    if SCIP_ANSWER.search(heard):
        return LaserProtocol.SCIP
    if COLA_ANSWER.search(heard):
        return LaserProtocol.COLA
    telegrams = TelegramReader(UNITS).feed(heard, 0.0)
    if any(isinstance(item, Telegram) for item in telegrams):
        return LaserProtocol.LMS2XX
    return None
