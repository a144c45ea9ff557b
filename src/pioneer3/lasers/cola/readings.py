"""From LMDscandata to a scan in metres (cola.md 3.3, 3.4)."""

from dataclasses import dataclass
from math import inf, nan, radians
from typing import Final

from pioneer3.lasers.client import RawScan, ScanSettings
from pioneer3.lasers.cola.families import FRONT_TICK, FULL_TURN_TICK, exact_step
from pioneer3.lasers.cola.scan import ReadingChannel, ScanData
from pioneer3.lasers.cola.wire import TelegramError

CODES: Final = 16
"""Values below this are codes: 0 nothing measured, others no valid reading."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Geometry:
    """Angles and times of a scan.

    Attributes:
        first: Direction of the first reading, counter-clockwise from straight ahead [rad].
        step: From one reading to the next [rad].
        beam_time: From one reading to the next [s].
        turn_time: Of one turn of the mirror [s].
        span: From the first reading to the last one [s].
    """

    first: float
    step: float
    beam_time: float
    turn_time: float
    span: float


def geometry(scan: ScanData) -> Geometry:
    """Return the angles and times of `scan`.

    Raises:
        TelegramError: it has no ranges.
    """
    ranges = _distances(scan)
    step = exact_step(ranges.step_tick)
    turn_time = 100 / scan.frequency_chz
    beam_time = turn_time * step / FULL_TURN_TICK
    return Geometry(
        first=radians((ranges.first_tick - FRONT_TICK) / 1e4),
        step=radians(step / 1e4),
        beam_time=beam_time,
        turn_time=turn_time,
        span=beam_time * (len(ranges.values) - 1),
    )


def raw_scan(
    scan: ScanData,
    at: Geometry,
    *,
    stamp: float,
    interval: int,
    limits: tuple[float, float],
    wishes: ScanSettings,
) -> RawScan:
    """Return `scan` in metres.

    Args:
        scan: The telegram.
        at: Its :func:`geometry`.
        stamp: Time of the first reading [s, monotonic].
        interval: Every n-th scan is sent.
        limits: Shortest and longest range of the laser [m].
        wishes: Whether intensities and echoes are wanted.

    Raises:
        TelegramError: it has no ranges.
    """
    near, far = limits
    remission = scan.channel("RSSI1") if wishes.intensities else None
    return RawScan(
        stamp=stamp,
        first=at.first,
        step=at.step,
        beam_time=at.beam_time,
        period=at.turn_time * interval,
        near=near,
        far=far,
        ranges=_metres(_distances(scan), near),
        intensities=_remissions(remission) if remission else (),
        echoes=_echoes(scan) if wishes.multi_echo else (),
        device_time=scan.sensed_us / 1e6,
    )


def _distances(scan: ScanData) -> ReadingChannel:
    ranges = scan.channel("DIST1")
    if ranges is None:
        raise TelegramError("there are no ranges of the first echo")
    return ranges


def _metres(channel: ReadingChannel, near: float) -> tuple[float, ...]:
    scale, offset = channel.scale, channel.offset
    least = max((near * 1000 - offset) / scale, CODES)
    return tuple(
        (value * scale + offset) / 1000 if value >= least else _special(value)
        for value in channel.values
    )


def _special(value: int) -> float:
    """Return the range, as in REP 117, of a value that is a code or too near."""
    if value == 0:
        return inf
    return nan if value < CODES else -inf


def _remissions(channel: ReadingChannel) -> tuple[int, ...]:
    if channel.scale == 1 and not channel.offset:
        return channel.values
    return tuple(round(value * channel.scale + channel.offset) for value in channel.values)


def _echoes(scan: ScanData) -> tuple[tuple[float, ...], ...]:
    """Return for each reading the echoes that there are [m]."""
    channels = [c for n in range(1, 6) if (c := scan.channel(f"DIST{n}")) is not None]
    metres = [[(v * c.scale + c.offset) / 1000 for v in c.values] for c in channels]
    return tuple(
        tuple(m for m, v in zip(ms, vs, strict=True) if v >= CODES)
        for ms, vs in zip(
            zip(*metres, strict=True), zip(*(c.values for c in channels), strict=True), strict=True
        )
    )
