"""How fast bytes become packets: random ones, and a robot's own.

Run it with `python benchmarks/bench_codec.py`.
"""

from random import Random
from time import perf_counter

from pioneer3.arcos import reports
from pioneer3.arcos.packet import PacketReader, encode

SIZE = 1 << 20
CHUNK = 4096
ROUNDS = 7
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


def main() -> None:
    """Print MB/s for each kind of stream."""
    frame = encode(reports.to_payload(SIP))
    sips = frame * (SIZE // len(frame))
    streams = {
        "random bytes": Random(1).randbytes(SIZE),
        "SIPs, frames only": sips,
        "headers all over": b"\xfa\xfb\x40" * (SIZE // 3),
    }
    for name, data in streams.items():
        print(f"{name:20} {megabytes_per_second(data):8.1f} MB/s")
    print(f"{'SIPs, decoded':20} {megabytes_per_second(sips, decode=True):8.1f} MB/s")


if __name__ == "__main__":
    main()
