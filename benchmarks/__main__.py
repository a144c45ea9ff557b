"""Runs every benchmark, or those named on the command line.

That of navigation takes hours, and is run only where it is named.
"""

import argparse
from importlib.util import find_spec

from benchmarks import (
    bench_behaviors,
    bench_bridge,
    bench_codec,
    bench_firmware,
    bench_fleet,
    bench_gym,
    bench_kernels,
    bench_lasers,
    bench_latency,
    bench_maps,
    bench_physics,
    bench_start,
    bench_web,
    bench_world,
    camera,
    cost,
    fleet_drive,
    hostile,
    laser_link,
    laser_recovery,
    log,
    nav,
    ros1,
    ros2,
)

BENCHMARKS = {
    "latency": bench_latency,
    "start": bench_start,
    "codec": bench_codec,
    "lasers": bench_lasers,
    "behaviors": bench_behaviors,
    "bridge": bench_bridge,
    "kernels": bench_kernels,
    "world": bench_world,
    "physics": bench_physics,
    "maps": bench_maps,
    "firmware": bench_firmware,
    "fleet": bench_fleet,
    "fleet_drive": fleet_drive,
    "gym": bench_gym,
    "ros1": ros1,
    "ros2": ros2,
    "camera": camera,
    "web": bench_web,
    "hostile": hostile,
    "laser_link": laser_link,
    "laser_recovery": laser_recovery,
    "log": log,
    "cost": cost,
}
LONG = {"nav": nav}
"""These are run only where they are named, and have a quick form."""


def main() -> int:
    """Print the table; return 1 if a bar is missed."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks",
        description="Print what was measured beside its bar.",
        epilog="Example: chrt -r 1 python -m benchmarks latency web",
    )
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(BENCHMARKS | LONG))
    parser.add_argument("--quick", action="store_true", help=f"a small {', '.join(LONG)}")
    parser.add_argument("--jobs", type=int, help="processes for that; one for each processor")
    parser.add_argument("--beside", metavar="FOLDER", help="another checkout, for cost")
    given = parser.parse_args()
    names = given.names
    if unknown := set(names) - BENCHMARKS.keys() - LONG.keys():
        name = min(unknown)
        own = find_spec(f"benchmarks.{name}") if name.isidentifier() else None
        advice = f"; it prints a table of its own: python -m benchmarks.{name}" if own else ""
        parser.error(f"no benchmark is called {', '.join(sorted(unknown))}{advice}")
    missed = 0
    for name in names or BENCHMARKS:
        if name in LONG:
            rows = LONG[name].rows(quick=given.quick, jobs=given.jobs)
        elif name == "cost":
            rows = cost.rows(given.beside)
        else:
            rows = BENCHMARKS[name].rows()
        for row in rows:
            print(row, flush=True)
            missed += not row.met
    return int(missed > 0)


if __name__ == "__main__":
    raise SystemExit(main())
