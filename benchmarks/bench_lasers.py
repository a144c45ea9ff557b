"""The cost of a laser's scans, from received bytes to readings, and back in the simulator.

Each protocol has its own function that returns rows; :func:`rows` lists them.
"""

from itertools import chain
from random import Random
from statistics import median
from time import perf_counter

from benchmarks.table import Row
from pioneer3.lasers.client import LaserClient, Measured, ScanSettings
from pioneer3.lasers.device import MirrorTurn, Sweep
from pioneer3.lasers.scip.client import ScipClient
from pioneer3.lasers.scip.device import ScipDevice
from pioneer3.models import lasers

ROUNDS = 200
PIECE = 1460
"""Bytes that a network hands on at a time."""


def walls(turn: MirrorTurn, began: float) -> Sweep:
    """Return readings of uneven walls."""
    ranges = [3.0 + number % 97 / 10 for number in range(turn.count)]
    return Sweep(turn=turn, began=began, ranges=ranges, intensities=[0.5] * turn.count)


def milliseconds_to_read(client: LaserClient, scans: list[bytes], period: float) -> float:
    """Return the median of the times that `client` takes for one of `scans` [ms]."""
    seconds, now = [], 100.0
    for scan in scans:
        now += period
        began = perf_counter()
        events = [
            client.receive(scan[start : start + PIECE], now) for start in range(0, len(scan), PIECE)
        ]
        seconds.append(perf_counter() - began)
        if not any(isinstance(event, Measured) for event in chain.from_iterable(events)):
            raise AssertionError("a scan has been refused")
    return median(seconds) * 1000


def scip_rows() -> list[Row]:
    """Measure a UTM-30LX: 1081 readings, 40 times a second; the bar is 4 % of a core."""
    scans = [
        row
        for what, wishes in (
            ("ranges", ScanSettings(calibrate_time=False)),
            ("with intensities", ScanSettings(calibrate_time=False, intensities=True)),
        )
        for row in scip_rows_of(what, wishes)
    ]
    noise, client = Random(1).randbytes(1 << 20), ScipClient(0.0)
    client.tick(0.0)
    began = perf_counter()
    for start in range(0, len(noise), PIECE):
        client.receive(noise[start : start + PIECE], 0.0)
    speed = len(noise) / (perf_counter() - began) / 1e6
    return [*scans, Row("SCIP: 1 MB of random bytes", speed, "MB/s", 10.0, more_is_better=True)]


def scip_rows_of(what: str, wishes: ScanSettings) -> list[Row]:
    """Measure client and device with scans of one kind."""
    device = ScipDevice(lasers.load_laser("utm-30lx"))
    host, client = device.connect(), ScipClient(0.0, settings=wishes)
    now = 0.0
    while device.turn is None:
        now = max(now, client.deadline)
        client.tick(now)
        while data := client.outgoing():
            host.receive(data, now)
            client.receive(host.outgoing(now), now)
    turn, scans, seconds = device.turn, [], []
    sweep = walls(turn, now)
    for _ in range(ROUNDS):
        now += turn.period
        began = perf_counter()
        device.measured(sweep, now)
        seconds.append(perf_counter() - began)
        scans.append(host.outgoing(now))
    read = milliseconds_to_read(client, scans, turn.period)
    return [
        Row(f"SCIP: receive a scan of {turn.count} {what}", read, "ms", 1.0),
        Row(f"SCIP: simulate a scan of {turn.count} {what}", median(seconds) * 1000, "ms", 2.5),
    ]


def rows() -> list[Row]:
    """Measure every protocol."""
    return scip_rows()
