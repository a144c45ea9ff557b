"""From the readings of a simulated mirror to LMDscandata (cola.md 3, 6.2)."""

from collections.abc import Iterable
from math import degrees, inf, isfinite
from typing import Final

from pioneer3.geometry import TURN
from pioneer3.lasers.cola.configuration import DataConfig, LaserSettings
from pioneer3.lasers.cola.families import FRONT_TICK, Family
from pioneer3.lasers.cola.readings import CODES
from pioneer3.lasers.cola.scan import MAX_ENCODERS, Encoder, ReadingChannel, ScanData
from pioneer3.lasers.device import Sweep

WHITE: Final = {8: 200, 16: 51_200}
"""Remission of a perfect matt white wall, by the bits of the channel; reflectors have more."""
LARGEST: Final = {8: 254, 16: 65_535}
"""Largest remissions by their bits: 255 in 8 bits means dazzled."""
LONGEST: Final = 65_535
ALL_ECHOES = 1
"""Value of FREchoFilter for all echoes."""
LAST_ECHO = 2
"""Value of FREchoFilter for the last echo."""


def scan_data(sweep: Sweep, family: Family, settings: LaserSettings) -> ScanData:
    """Return the readings and angles of `sweep` as `settings` have them, without times and names.

    The angles are those of the turn: the settings may have changed since it began.
    """
    wide, narrow = _channels(sweep, family, settings)
    frequency = 1 / sweep.turn.period
    return ScanData(
        frequency_chz=round(100 * frequency),
        pulses=round(frequency * TURN / sweep.turn.step / 100),
        encoders=(Encoder(),) * min(settings.data.encoders.bit_count(), MAX_ENCODERS),
        channels=wide,
        narrow_channels=narrow,
    )


def _channels(
    sweep: Sweep, family: Family, settings: LaserSettings
) -> tuple[tuple[ReadingChannel, ...], tuple[ReadingChannel, ...]]:
    """Return the channels of 16 and of 8 bits."""
    first_tick = round(degrees(sweep.turn.first) * 1e4) + FRONT_TICK
    step_tick = round(degrees(sweep.turn.step) * 1e4)

    def channel(content: str, values: Iterable[int], scale: float = 1.0) -> ReadingChannel:
        return ReadingChannel(
            content=content,
            scale=scale,
            first_tick=first_tick,
            step_tick=step_tick,
            values=tuple(values),
        )

    config, echo_filter = settings.data, settings.echo_filter
    wide = tuple(
        channel(f"DIST{echo}", _ranges(sweep, echo, echo_filter, family.scale), family.scale)
        for echo in _echoes(family, config, echo_filter)
    )
    if not config.remission:
        return wide, ()
    remission = channel("RSSI1", _remissions(sweep, 16 if config.wide else 8))
    return ((*wide, remission), ()) if config.wide else (wide, (remission,))


def _echoes(family: Family, config: DataConfig, echo_filter: int) -> list[int]:
    """Return the numbers of the echoes to send, from 1."""
    if family.echo_filter and echo_filter != ALL_ECHOES:
        return [1]
    return [echo for echo in range(1, family.echoes + 1) if config.echoes >> (echo - 1) & 1]


def _ranges(sweep: Sweep, echo: int, echo_filter: int, scale: float) -> list[int]:
    if echo_filter == LAST_ECHO and sweep.echoes:
        pairs = zip(sweep.echoes, sweep.ranges, strict=True)
        metres = [own[-1] if own else reading for own, reading in pairs]
    elif echo == 1:
        metres = list(sweep.ranges)
    elif sweep.echoes:
        metres = [own[echo - 1] if len(own) >= echo else inf for own in sweep.echoes]
    else:
        return [0] * len(sweep.ranges)
    factor = 1000 / scale
    return [_value(reading * factor) for reading in metres]


def _value(units: float) -> int:
    """Return the number for a range: 0 where nothing came back, never another code."""
    if not isfinite(units) or units > LONGEST:
        return 0
    return max(round(units), CODES)


def _remissions(sweep: Sweep, bits: int) -> list[int]:
    white, largest = WHITE[bits], LARGEST[bits]
    return [
        min(max(round(share * white), 1), largest) if isfinite(reading) else 0
        for share, reading in zip(sweep.intensities, sweep.ranges, strict=True)
    ]
