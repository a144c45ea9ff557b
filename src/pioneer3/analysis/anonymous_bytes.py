"""The bytes of a robot's link without its names, in frames that stay valid and as long as before.

A robot tells its name and serial number when a session begins, and in its configuration; texts of
its firmware and of other devices may tell anything. Numbers stay. Bytes of no frame become zeros.
"""

from collections import deque
from typing import Any, Final

from msgspec.structs import replace

from pioneer3.arcos import reports
from pioneer3.arcos.packet import HEADER, checksum

GIVEN_UP: Final = 2 * 10**9
"""After such a silence [ns] no driver waits for the rest of a frame."""
NAMED: Final[dict[type[reports.Report], tuple[str, ...]]] = {
    reports.SyncIdentity: ("name",),
    reports.Config: ("name", "serial_number"),
}
"""Reports with names, and their fields."""
KEPT: Final = (
    *(reports.Sip, reports.SyncEcho, reports.LinkLost, reports.Encoders, reports.GyroRates),
    *(reports.Imu, reports.IrRing, reports.GripperState, reports.Io, reports.Joystick),
    *(reports.BatteryInfo, reports.SimLaser, reports.SimLaserExtended, reports.SafetyState),
)
"""Reports of numbers alone; of all others only the kind stays."""
TEXT: Final = 0x2B
"""Type of a text as the argument of a command (protocol.md 1.3)."""
NUMBERS: Final = (0x3B, 0x1B)
"""Types of numbers as arguments."""
NUMBER_SIZE: Final = 4
"""Bytes of a command with a number: its id, the type, and two for the number."""
STRANGER: Final = "x"
"""Letter in place of each letter of a name."""


class LinkScrubber:
    """The bytes of one link without names, piece by piece; a frame that is not whole waits.

    Attributes:
        names: That the bytes had.
        ready: Pieces of which each byte is known, as many bytes as before.
    """

    def __init__(self, *, is_command: bool) -> None:
        self.names: set[str] = set()
        self.ready: deque[bytes] = deque()
        self._is_command, self._time = is_command, 0
        self._raw, self._clean = bytearray(), bytearray()
        self._sizes: deque[int] = deque()

    def feed(self, time: int, data: bytes) -> None:
        """Take a piece of a time [ns]; after a long silence nothing waits for it."""
        if time - self._time > GIVEN_UP:
            self.end()
        self._time = time
        self._raw += data
        self._sizes.append(len(data))
        self._scrub(is_end=False)

    def end(self) -> None:
        """Take the end: a frame that is not whole is none."""
        self._scrub(is_end=True)

    def _scrub(self, *, is_end: bool) -> None:
        raw, at, done = self._raw, 0, 0
        clean = bytearray(len(raw))
        while (at := raw.find(HEADER, at)) >= 0:
            end = at + 3 + (raw[at + 2] if at + 2 < len(raw) else len(raw))
            if end > len(raw) and not is_end:
                break
            payload = bytes(raw[at + 3 : end - 2])
            if end > len(raw) or not payload or raw[end - 2 : end] != _sum(payload):
                at += 1
                continue
            kept = _command(payload) if self._is_command else _report(payload, self.names)
            clean[at:end] = raw[at : at + 3] + kept + _sum(kept)
            at = done = end
        known = len(raw) if is_end else at
        if known < 0:  # the last byte may begin a frame
            known = max(done, len(raw) - raw.endswith(HEADER[:1]))
        self._clean += clean[:known]
        del raw[:known]
        while self._sizes and len(self._clean) >= self._sizes[0]:
            size = self._sizes.popleft()
            self.ready.append(bytes(self._clean[:size]))
            del self._clean[:size]


def _report(payload: bytes, names: set[str]) -> bytes:
    report: Any = reports.from_payload(payload)
    if isinstance(report, KEPT):
        return payload
    kept = b""
    if fields := NAMED.get(type(report)):
        known = {field: name for field in fields if (name := getattr(report, field))}
        names.update(known.values())
        aliases: Any = {field: STRANGER * len(name) for field, name in known.items()}
        kept = reports.to_payload(replace(report, **aliases, extra=bytes(len(report.extra))))
    return kept if len(kept) == len(payload) else payload[:1] + bytes(len(payload) - 1)


def _command(payload: bytes) -> bytes:
    if len(payload) == 1 or (payload[1] in NUMBERS and len(payload) == NUMBER_SIZE):
        return payload
    told = 3 if payload[1] == TEXT else 1
    return payload[:told] + bytes(len(payload) - min(told, len(payload)))


def _sum(payload: bytes) -> bytes:
    return checksum(payload).to_bytes(2, "big")
