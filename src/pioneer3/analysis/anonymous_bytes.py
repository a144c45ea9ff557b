"""The bytes of a robot's link without its names, in frames that stay valid and as long as before.

A robot tells its name and serial number when a session begins, and in its configuration; texts of
its firmware and of other devices may tell anything. Numbers stay. Bytes of no frame become zeros.
"""

from dataclasses import replace
from typing import Any, Final

from pioneer3.arcos import reports
from pioneer3.arcos.packet import HEADER, checksum

OF_FRAME: Final = 5
"""Bytes of a frame beside its payload."""
NAMED: Final = {reports.SyncIdentity: ("name",), reports.Config: ("name", "serial_number")}
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


def without_names(data: bytes, *, is_command: bool) -> tuple[bytes, set[str]]:
    """Return bytes of a link without names, and the names that they had."""
    clean, names, at = bytearray(len(data)), set[str](), 0
    while (at := data.find(HEADER, at)) >= 0 and at + OF_FRAME < len(data):
        end = at + 3 + data[at + 2]
        payload = data[at + 3 : end - 2]
        if end > len(data) or not payload or data[end - 2 : end] != _sum(payload):
            at += 1
            continue
        kept = _command(payload) if is_command else _report(payload, names)
        clean[at:end] = data[at : at + 3] + kept + _sum(kept)
        at = end
    return bytes(clean), names


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
