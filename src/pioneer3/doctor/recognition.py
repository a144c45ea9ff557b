"""Recognises devices that are not Pioneer robots by the bytes they send. Pure."""

import re
from dataclasses import dataclass
from enum import StrEnum
from typing import Final

from pioneer3.arcos.packet import PacketReader
from pioneer3.lasers import recognition as lasers
from pioneer3.models.lasers import LaserProtocol

UNNAMED: Final = {
    LaserProtocol.SCIP: "a laser that speaks SCIP (Hokuyo)",
    LaserProtocol.LMS2XX: "SICK LMS 2xx",
    LaserProtocol.COLA: "a laser that speaks CoLa-A (SICK)",
}
"""Lasers whose name was not among what was heard."""
ECHO_ENOUGH: Final = 18
"""Three packets: a robot sends SYNC0 and SYNC1 back as they are, and answers SYNC2 otherwise."""
TEXT_ENOUGH: Final = 4
TEXT_SHARE: Final = 0.9


class DeviceKind(StrEnum):
    """Kinds of devices that are no Pioneer robot."""

    LASER = "laser"
    ECHO = "echo"
    PACKETS = "packets"
    TEXT = "text"
    NOISE = "noise"


@dataclass(frozen=True, slots=True)
class OtherDevice:
    """Something that answers, but not as a robot; its name as far as it sent one, for people."""

    kind: DeviceKind
    name: str


def recognise(heard: bytes, sent: bytes = b"") -> OtherDevice | None:
    """Return the device that sent `heard` after we sent `sent`; `None` when `heard` is empty."""
    if not heard:
        return None
    if len(sent) >= ECHO_ENOUGH and sent[:ECHO_ENOUGH] in heard:
        return OtherDevice(DeviceKind.ECHO, "what was sent comes back")
    noise = OtherDevice(DeviceKind.NOISE, f"{len(heard)} bytes such as {heard[:8].hex(' ')}")
    return laser(heard) or _packets(heard) or _text(heard) or noise


def laser(heard: bytes) -> OtherDevice | None:
    """Return the laser that sent `heard`, with its name where that is among it."""
    protocol = lasers.recognise(heard)
    if protocol is None:
        return None
    return OtherDevice(DeviceKind.LASER, lasers.name_in(heard) or UNNAMED[protocol])


def _packets(heard: bytes) -> OtherDevice | None:
    """Return the device if most of its bytes are packets of the robot's protocol."""
    reader = PacketReader()
    numbers = [payload[0] for payload in reader.feed(heard)]
    if not numbers or reader.bytes_skipped > len(heard) // 2:
        return None
    amount = "1 well-formed packet" if len(numbers) == 1 else f"{len(numbers)} well-formed packets"
    kinds = ", ".join(map(str, sorted(set(numbers))))
    return OtherDevice(DeviceKind.PACKETS, f"{amount} (number {kinds})")


def _text(heard: bytes) -> OtherDevice | None:
    """Return the device if it sends text: a console, a web server, a GPS."""
    readable = sum(0x20 <= byte < 0x7F or byte in b"\r\n\t" for byte in heard)
    if len(heard) < TEXT_ENOUGH or readable < TEXT_SHARE * len(heard):
        return None
    lines = re.split(r"[\r\n]+", heard.decode("ascii", "replace").strip())
    return OtherDevice(DeviceKind.TEXT, f"something that writes {lines[0][:40]!r}")
