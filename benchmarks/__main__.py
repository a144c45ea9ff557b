"""Runs every benchmark, or those named on the command line: see BENCHMARKS."""

import sys

from benchmarks import (
    bench_behaviors,
    bench_codec,
    bench_firmware,
    bench_fleet,
    bench_gym,
    bench_kernels,
    bench_latency,
    bench_start,
    bench_web,
    bench_world,
    ros1,
)

BENCHMARKS = {
    "latency": bench_latency,
    "start": bench_start,
    "codec": bench_codec,
    "behaviors": bench_behaviors,
    "kernels": bench_kernels,
    "world": bench_world,
    "firmware": bench_firmware,
    "fleet": bench_fleet,
    "gym": bench_gym,
    "ros1": ros1,
    "web": bench_web,
}


def main() -> int:
    """Print the table; return 1 if a bar is missed."""
    names = sys.argv[1:] or list(BENCHMARKS)
    missed = 0
    for name in names:
        for row in BENCHMARKS[name].rows():
            print(row, flush=True)
            missed += not row.met
    return int(missed > 0)


if __name__ == "__main__":
    raise SystemExit(main())
