"""How fast bytes become packets: random ones, and a robot's own."""

from random import Random
from time import perf_counter

from benchmarks.table import Row
from pioneer3.arcos import reports
from pioneer3.arcos.packet import HEADER, PacketReader, encode

SIZE = 1 << 20
CHUNK = 4096
ROUNDS = 7
LASER = reports.SimLaserExtended(
    total=181, first=0, readings=(reports.LaserReading(1234),) * 34, laser=1, flags=0
)
SIP = reports.Sip(sonar=tuple(reports.SonarReading(number, 1234) for number in range(16)))


def megabytes_per_second(data: bytes, *, decode: bool = False) -> float:
    """Return the best of some rounds over `data`, fed in pieces as links deliver it."""
    best = float("inf")
    for _ in range(ROUNDS):
        reader, began = PacketReader(), perf_counter()
        for start in range(0, len(data), CHUNK):
            for payload in reader.feed(data[start : start + CHUNK]):
                if decode:
                    reports.from_payload(payload)
        best = min(best, perf_counter() - began)
    return len(data) / best / 1e6


def rows() -> list[Row]:
    """Measure everything of this file; a robot at 115200 baud sends 0.012 MB/s."""
    frame = encode(reports.to_payload(SIP))
    sips = frame * (SIZE // len(frame))
    scan = encode(reports.to_payload(LASER))
    worst = HEADER + b"\x40"
    measured = {
        "1 MB of random bytes": (megabytes_per_second(Random(1).randbytes(SIZE)), 10.0),
        "information packets, frames only": (megabytes_per_second(sips), 10.0),
        "information packets, decoded": (megabytes_per_second(sips, decode=True), 1.0),
        "a simulator's laser, decoded": (
            megabytes_per_second(scan * (SIZE // len(scan)), decode=True),
            3.0,
        ),
        "nothing but false headers": (megabytes_per_second(worst * (SIZE // 3)), 1.0),
    }
    return [
        Row(what, figure, "MB/s", bar, more_is_better=True)
        for what, (figure, bar) in measured.items()
    ]
