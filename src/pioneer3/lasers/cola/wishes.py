"""The settings that fulfil a program's wishes, as near as the laser can (cola.md 6.1)."""

from dataclasses import replace
from math import ceil, degrees, floor
from typing import Final

from pioneer3.lasers.client import ScanSettings
from pioneer3.lasers.cola.configuration import DataConfig, OutputRange, ScanConfig
from pioneer3.lasers.cola.families import FRONT_TICK, Family, exact_step

_ALMOST: Final = 1e-3
"""Angles that differ by less than this many steps are the same."""


def wished_scan(present: ScanConfig, wishes: ScanSettings, family: Family) -> ScanConfig:
    """Return the wished frequency, step and area; `present` as far as it fulfils them."""
    if not family.adjustable:
        return present
    step, frequency = present.step_tick, present.frequency_chz
    if wishes.step is not None:
        wanted = degrees(wishes.step) * 1e4
        step = min(family.steps_tick, key=lambda own: abs(exact_step(own) - wanted))
    if step in family.steps_tick and not family.fits(frequency, step):
        frequency = max(f for f in family.frequencies_chz if family.fits(f, step))
    output = wished_output(replace(present, step_tick=step), wishes, family)
    first, last = present.first_tick, present.last_tick
    if output.first_tick < first or output.last_tick > last:
        first, last = family.first_tick, family.last_tick
    return replace(
        present, frequency_chz=frequency, step_tick=step, first_tick=first, last_tick=last
    )


def wished_output(scan: ScanConfig, wishes: ScanSettings, family: Family) -> OutputRange:
    """Return the part of the scan to send: whole steps from the begin of the laser's field."""
    step, first, last = exact_step(scan.step_tick), family.first_tick, family.last_tick
    steps = floor((last - first) / step + _ALMOST)
    begin, end = 0, steps
    if wishes.first is not None:
        begin = floor((_tick(wishes.first) - first) / step + _ALMOST)
    if wishes.last is not None:
        end = ceil((_tick(wishes.last) - first) / step - _ALMOST)
    begin = min(max(begin, 0), steps - 1)
    end = min(max(end, begin + 1), steps)
    return OutputRange(
        step_tick=scan.step_tick,
        first_tick=first + round(begin * step),
        last_tick=first + round(end * step),
    )


def wished_data(present: DataConfig, wishes: ScanSettings, family: Family) -> DataConfig:
    """Return the wished content of scans; all else stays as in `present`."""
    return replace(
        present,
        echoes=(1 << family.echoes) - 1 if wishes.multi_echo else 1,
        remission=wishes.intensities,
        interval=wishes.skip + 1,
    )


def _tick(angle: float) -> float:
    return degrees(angle) * 1e4 + FRONT_TICK
