"""The state of a laser range finder, with the keys of REP 138."""

from typing import Final
from urllib.parse import urlsplit

from pioneer3.lasers.client import LaserIdentity
from pioneer3.robot.lasers.driver import LaserDriver
from pioneer3.ros.messages.diagnostics import DiagnosticLevel, DiagnosticStatus

SLOW: Final = 0.8
"""Fewer scans than this share of what the laser is to give are a warning."""
LATE: Final = 2.0
"""For so long after the first scan the rate is not judged [s]."""


def laser_status(laser: LaserDriver) -> DiagnosticStatus:
    """Return the state of a laser."""
    scan, state = laser.latest, laser.status.latest
    level, message = DiagnosticLevel.OK, "scans"
    expected = 1 / scan.period if scan is not None and scan.period else 0.0
    if not laser.connected:
        level, message = DiagnosticLevel.ERROR, state.message if state else "not asked yet"
    elif laser.scans > LATE * expected and laser.rate < SLOW * expected:
        level = DiagnosticLevel.WARN
        message = f"{laser.rate:.1f} scans/s, {expected:.1f} expected"
    return DiagnosticStatus(
        part=laser.name.capitalize(),
        level=level,
        message=message,
        values=(
            *_place(laser.config.url),
            *_identity(laser.identity or LaserIdentity()),
            ("Computed Latency", f"{laser.latency:.4f}"),
            ("User Time Offset", f"{laser.config.time_offset:.4f}"),
            ("Scan Rate", f"{laser.rate:.2f}"),
            ("Scans", str(laser.scans)),
            ("Scan Thread Lost Count", str(laser.losses)),
        ),
    )


def device_id(identity: LaserIdentity) -> str:
    """Return the serial number as hokuyo_node writes it: `H` in place of a leading 0."""
    serial = identity.serial
    if not serial or serial.startswith("H"):
        return serial
    return f"H{serial[1:]}" if serial.startswith("0") else f"H{serial}"


def _place(url: str) -> tuple[tuple[str, str], ...]:
    scheme, _, rest = url.partition(":")
    if scheme == "tcp":
        parts = urlsplit(url)
        return ("IP Address", parts.hostname or ""), ("IP Port", str(parts.port or ""))
    return (("Serial Port", rest if scheme == "serial" else url),)


def _identity(identity: LaserIdentity) -> tuple[tuple[str, str], ...]:
    return (
        ("Vendor Name", identity.vendor),
        ("Product Name", identity.product),
        ("Firmware Version", identity.firmware),
        ("Firmware Date", identity.firmware_date),
        ("Protocol Version", identity.protocol),
        ("Device ID", device_id(identity)),
        ("Device Status", identity.status),
    )
