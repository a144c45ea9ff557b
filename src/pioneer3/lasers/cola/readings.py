"""From LMDscandata to a scan in metres (cola.md 3.3, 3.4)."""

from math import inf, nan, radians
from typing import Final

from pioneer3.lasers.client import RawScan, ScanSettings
from pioneer3.lasers.cola.families import FRONT_TICK, FULL_TURN_TICK, exact_step
from pioneer3.lasers.cola.scan import ReadingChannel, ScanData
from pioneer3.lasers.cola.wire import TelegramError

CODES: Final = 16
"""Values below this are codes: 0 nothing measured, others no valid reading."""


def raw_scan(
    scan: ScanData,
    *,
    arrival: float,
    interval: int,
    limits: tuple[float, float],
    wishes: ScanSettings,
) -> RawScan:
    """Return `scan` in metres, dated as if it had arrived at once.

    It came at `arrival` [s, monotonic]; every `interval`-th scan is sent; `limits` are the shortest
    and the longest range of the laser [m]. Raises TelegramError if it has no ranges.
    """
    near, far = limits
    distances = scan.channel("DIST1")
    if distances is None:
        raise TelegramError("there are no ranges of the first echo")
    remission = scan.channel("RSSI1") if wishes.intensities else None
    step = exact_step(distances.step_tick)
    turn_time = 100 / scan.frequency_chz
    beam_time = turn_time * step / FULL_TURN_TICK
    return RawScan(
        stamp=arrival - beam_time * (len(distances.values) - 1),
        first=radians((distances.first_tick - FRONT_TICK) / 1e4),
        step=radians(step / 1e4),
        beam_time=beam_time,
        period=turn_time * interval,
        near=near,
        far=far,
        ranges=_metres(distances, near),
        intensities=_remissions(remission) if remission else (),
        echoes=_echoes(scan) if wishes.multi_echo else (),
        device_time=scan.sensed_us / 1e6,
    )


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
