"""Recognises a laser by the bytes it sends, whatever its protocol. Pure."""

import re
from typing import Final

from pioneer3.lasers.lms2xx.commands import CommandCode, Unasked
from pioneer3.lasers.lms2xx.scans import COUNT
from pioneer3.lasers.lms2xx.telegram import PAUSE, UNITS, LmsTelegramReader, Telegram, encode
from pioneer3.lasers.scip.wire import unseal
from pioneer3.models.lasers import LaserProtocol

SCIP_QUESTION: Final = b"\nVV\n"
"""Asks a SCIP laser for its version (scip.md 1.4). The first LF ends earlier bytes that the laser
took for the beginning of a command."""
LMS_QUESTION: Final = encode(CommandCode.TYPE)
"""Asks an LMS-2xx for its type (lms2xx.md 1.5)."""
COLA_QUESTION: Final = b"\x02sRN DeviceIdent\x03"
"""Asks a CoLa-A laser for its type (cola.md 1.2)."""
QUESTION: Final = LMS_QUESTION + SCIP_QUESTION + COLA_QUESTION
"""All three: each is ignored by the devices of the others, and changes no setting."""

SCIP_ANSWER: Final = re.compile(
    rb"(?:^|\n)(?:VV|QT|PP|II|V|[MGNH][DSE]\d{10,13}|G\d{8})[^\n]*\r?\n(?:0|E|\d\w.?)\r?\n"
)
"""The command, repeated, and a status (scip.md 1.2)."""
SCIP_DATA: Final = re.compile(rb"(?<=\n)([0-o]{65})\r?\n")
"""A full line of a scan, with its checksum: the head of a scan may be a second away (scip.md 3)."""
LMS_SCAN: Final = re.compile(rb"(?=\x02[\x80-\x84](..)\xb0(..))", re.DOTALL)
"""The head of a scan: the length of the telegram, and the header with the number of values."""
LMS_MORE: Final = {4, 6}
"""Bytes that the telegram of a scan has besides its values: without and with real-time indices."""
FEWEST: Final = 100
"""Values of a scan."""
COLA_ANSWER: Final = re.compile(rb"\x02s(?:(?:RA|AN|WA|EA|SN) \w+|FA)[ -~]*\x03")
SCIP_NAMES: Final = re.compile(r"(VEND|PROD|SERI):([^;\r\n]+);?.?\r?\n")
COLA_NAME: Final = re.compile(rb"\x02sRA DeviceIdent ([0-9A-F]{1,2}) ([ -~]*)\x03")
TYPES: Final = {CommandCode.TYPE + 0x80, Unasked.READY}
"""Codes of the telegrams in which an LMS-2xx says its type."""


def recognise(heard: bytes) -> LaserProtocol | None:
    """Return the protocol of the laser that sent `heard`, or `None` if that is no laser."""
    if SCIP_ANSWER.search(heard) or any(unseal(line) for line in SCIP_DATA.findall(heard)):
        return LaserProtocol.SCIP
    if COLA_ANSWER.search(heard):
        return LaserProtocol.COLA
    return LaserProtocol.LMS2XX if _begins_scan(heard) or _telegrams(heard) else None


def name_in(heard: bytes) -> str:
    """Return the name by which a laser introduces itself in `heard`; empty where it does not."""
    return _scip_name(heard) or _cola_name(heard) or _lms_name(heard)


def _scip_name(heard: bytes) -> str:
    told = dict(SCIP_NAMES.findall(heard.decode("ascii", "replace")))
    parts = [told[key].strip() for key in ("VEND", "PROD") if key in told]
    if "SERI" in told:
        parts.append(f"serial number {told['SERI'].strip()}")
    return ", ".join(parts)


def _cola_name(heard: bytes) -> str:
    told = COLA_NAME.search(heard)
    return f"SICK {told[2][: int(told[1], 16)].decode('ascii').strip()}" if told else ""


def _lms_name(heard: bytes) -> str:
    """Return such as `SICK LMS200-301061`, from `LMS200;301061;V02.30 `."""
    for telegram in _telegrams(heard):
        if telegram.code in TYPES and telegram.body:
            *names, _ = telegram.body.decode("ascii", "replace").split(";")
            return f"SICK {'-'.join(name.strip() for name in names if name.strip())}"
    return ""


def _begins_scan(heard: bytes) -> bool:
    """Whether a scan of an LMS-2xx begins; at 9600 baud the whole takes 0.8 s."""
    for length, header in LMS_SCAN.findall(heard):
        count = int.from_bytes(header, "little") & COUNT
        if count >= FEWEST and int.from_bytes(length, "little") - 2 * count in LMS_MORE:
            return True
    return False


def _telegrams(heard: bytes) -> list[Telegram]:
    reader = LmsTelegramReader(UNITS)
    items = reader.feed(heard, 0.0) + reader.feed(b"", PAUSE)  # a false beginning hides none
    return [item for item in items if isinstance(item, Telegram)]
