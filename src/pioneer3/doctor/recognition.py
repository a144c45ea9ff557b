"""Recognises devices that are not Pioneer robots by the bytes they send. Pure.

Sources: SCIP, scip.md 1. SICK LMS 2xx telegrams: STX (02), address (80 from the laser), length of
the data (2 bytes, low first), data, CRC (2 bytes, low first).
"""

import re
from dataclasses import dataclass
from enum import StrEnum
from typing import Final

from pioneer3.arcos.packet import PacketReader

LMS_START: Final = b"\x02\x80"
LMS_LONGEST: Final = 812
LMS_POLYNOMIAL: Final = 0x8005
SCIP_QUESTION: Final = b"\nVV\n"
"""Asks a SCIP laser for its version, and changes no setting. The first LF ends earlier bytes that
the laser took for the beginning of a command."""
ECHO_ENOUGH: Final = 18
"""Three packets: a robot sends SYNC0 and SYNC1 back as they are, and answers SYNC2 otherwise."""
TEXT_ENOUGH: Final = 4
TEXT_SHARE: Final = 0.9


class Kind(StrEnum):
    """Kinds of devices that are no Pioneer robot."""

    LASER = "laser"
    ECHO = "echo"
    PACKETS = "packets"
    TEXT = "text"
    NOISE = "noise"


@dataclass(frozen=True, slots=True)
class OtherDevice:
    """Something that answers, but not as a robot.

    Attributes:
        kind: Of the device.
        name: Its name, as far as it sent one, for people.
    """

    kind: Kind
    name: str


def recognise(heard: bytes, sent: bytes = b"") -> OtherDevice | None:
    """Return the device that sent `heard` after we sent `sent`; `None` when `heard` is empty."""
    if not heard:
        return None
    if len(sent) >= ECHO_ENOUGH and sent[:ECHO_ENOUGH] in heard:
        return OtherDevice(Kind.ECHO, "what was sent comes back")
    return scip_laser(heard) or lms_laser(heard) or _packets(heard) or _text(heard) or _noise(heard)


def scip_laser(heard: bytes) -> OtherDevice | None:
    """Return the Hokuyo laser that repeats a SCIP command, with a status on the next line."""
    answer = rb"(?:^|\n)(VV|QT|PP|II|V|[MGNH][DSE]\d{10,13}|G\d{8})[^\n]*\r?\n(0|E|\d\w.?)\r?\n"
    if re.search(answer, heard) is None:
        return None
    told = dict(re.findall(rb"(VEND|PROD|SERI):([^;\r\n]+)", heard))
    parts = [
        told[key].decode("ascii", "replace").strip() for key in (b"VEND", b"PROD") if key in told
    ]
    serial = told.get(b"SERI")
    if serial:
        parts.append(f"serial number {serial.decode('ascii', 'replace').strip()}")
    return OtherDevice(Kind.LASER, ", ".join(parts) or "a laser that speaks SCIP (Hokuyo)")


def lms_laser(heard: bytes) -> OtherDevice | None:
    """Return the SICK LMS 2xx that sent a telegram with a right checksum."""
    start = -1
    while (start := heard.find(LMS_START, start + 1)) >= 0:
        end = start + 4 + int.from_bytes(heard[start + 2 : start + 4], "little")
        if not start + 4 < end <= min(start + 4 + LMS_LONGEST, len(heard) - 2):
            continue
        if lms_checksum(heard[start:end]) == int.from_bytes(heard[end : end + 2], "little"):
            return OtherDevice(Kind.LASER, "SICK LMS 2xx")
    return None


def lms_checksum(telegram: bytes) -> int:
    """Return the CRC of a SICK LMS 2xx telegram: each byte is paired with the one before."""
    crc, before = 0, 0
    for byte in telegram:
        crc = (crc & 0x7FFF) << 1 ^ LMS_POLYNOMIAL if crc & 0x8000 else crc << 1
        crc ^= before << 8 | byte
        before = byte
    return crc


def _packets(heard: bytes) -> OtherDevice | None:
    """Return the device if most of its bytes are packets of the robot's protocol."""
    reader = PacketReader()
    numbers = [payload[0] for payload in reader.feed(heard)]
    if not numbers or reader.bytes_skipped > len(heard) // 2:
        return None
    amount = "1 well-formed packet" if len(numbers) == 1 else f"{len(numbers)} well-formed packets"
    kinds = ", ".join(map(str, sorted(set(numbers))))
    return OtherDevice(Kind.PACKETS, f"{amount} (number {kinds})")


def _text(heard: bytes) -> OtherDevice | None:
    """Return the device if it sends text: a console, a web server, a GPS."""
    readable = sum(0x20 <= byte < 0x7F or byte in b"\r\n\t" for byte in heard)
    if len(heard) < TEXT_ENOUGH or readable < TEXT_SHARE * len(heard):
        return None
    lines = re.split(r"[\r\n]+", heard.decode("ascii", "replace").strip())
    return OtherDevice(Kind.TEXT, f"something that writes {lines[0][:40]!r}")


def _noise(heard: bytes) -> OtherDevice:
    return OtherDevice(Kind.NOISE, f"{len(heard)} bytes such as {heard[:8].hex(' ')}")
