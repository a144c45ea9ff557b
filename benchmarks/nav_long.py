"""What two kilometres of mapping cost: run as `python -m benchmarks.nav_long [--metres 2200]`.

A simulated robot drives through a large floor of furnished rooms. What it sees is mapped as it
would be live, and again by `pioneer3 map build --from`, half of it and all.
"""

import argparse
import subprocess
import sys
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from math import hypot
from pathlib import Path
from resource import RUSAGE_CHILDREN, getrusage
from tempfile import TemporaryDirectory
from time import process_time

import numpy as np
from numpy.typing import NDArray

from benchmarks.nav_drives import BOXES, Conditions, Seen, drive
from benchmarks.nav_mapping import IMPROVE, ready
from benchmarks.table import Row
from pioneer3.maps import Extent, LineMap
from pioneer3.nav.beams import beams_of
from pioneer3.nav.logged import NO_ECHO
from pioneer3.nav.mapper import Mapper

Float = NDArray[np.float64]

METRES = 2200.0
"""Length of the drive [m]: more than 8,000 key frames."""
QUICK_METRES = 200.0
WIDE, DEEP = 90.0, 54.0
"""Of the floor [m]."""
CORRIDOR = 2.4
"""Width of the corridors [m]."""
BLOCKS = 3, 3
"""Blocks of rooms between corridors, along and across."""
ROOM = 3.5, 8.0
"""Length of a room along its corridor, at least and at most [m]."""
DOOR = 1.1
"""Width of the doorways [m]."""
FURNITURE = 3
"""Pieces in each room at most."""
LONGEST = 10.0
"""Time in which the robot drives a metre at most, with all of its turns [s]."""
BUILD = """
import atexit, sys
from pathlib import Path
from pioneer3.__main__ import main
log, out = sys.argv[1:]
atexit.register(lambda: print(Path("/proc/self/status").read_text()))
sys.argv = ["pioneer3", "map", "build", "--from", log, "-o", out]
main()
"""
"""Program that makes a map of a log, and then tells the memory that it took."""
GROWTH = 1.25
"""Cost of the second half of a log at most, as a share of that of the first: it closes more loops.
"""


@dataclass(slots=True)
class _Live:
    """A mapper at work, and the worst processor times of a tick and of a step in a thread [ms]."""

    mapper: Mapper
    scans: int = 0
    tick: float = 0.0
    step: float = 0.0

    def take(self, seen: Seen) -> None:
        """Map what was seen; look for loops now and then."""
        beams, began = beams_of(seen.scan), process_time()
        self.mapper.add(beams)
        self.tick = max(self.tick, 1000 * (process_time() - began))
        self.scans += 1
        while self.scans % IMPROVE == 0 and not self.mapper.snapshot.is_looked_through:
            began = process_time()
            self.mapper.apply(self.mapper.snapshot.improve())
            self.step = max(self.step, 1000 * (process_time() - began))


def rows(metres: float = METRES) -> Iterator[Row]:
    """Yield the figures of a drive so long [m]."""
    ready()
    live, driven, before = _Live(Mapper()), 0.0, None
    floor, log = large_floor(0), list[str]()
    BOXES[floor.name] = Extent(0.0, 0.0, WIDE, DEEP)
    for seen in drive(floor.name, floor, LONGEST * metres, 1, Conditions()):
        live.take(seen)
        log.append(_line(seen))
        here = seen.robot_in_world
        driven += hypot(here.x - before.x, here.y - before.y) if before else 0.0
        before = here
        if driven >= metres:
            break
    frames, what = len(live.mapper.survey.frames), f"{driven / 1000:.1f} km"
    yield Row(f"{what}, {frames} key frames: a scan in the tick, worst", live.tick, "ms", 20.0)
    yield Row(f"{what}: loops and graph in a thread, worst", live.step, "ms", 300.0)
    half, _ = _built(log[: len(log) // 2])
    whole, most = _built(log)
    thousands = len(log) / 2000
    yield Row("map build --from: 1000 scans of the first half", half / thousands, "s", None)
    rest = (whole - half) / thousands
    yield Row("the same, of the second half", rest, "s", GROWTH * half / thousands)
    yield Row("its memory, at most", most, "MB", 500.0)


def _line(seen: Seen) -> str:
    """Return a scan as a line of a CARMEN log."""
    scan, robot = seen.scan, seen.scan.robot_in_odom
    laser = robot @ scan.sensor_in_robot
    ranges = " ".join(f"{min(metres, NO_ECHO):.3f}" for metres in scan.ranges)
    poses = " ".join(f"{pose.x:.5f} {pose.y:.5f} {pose.theta:.6f}" for pose in (laser, robot))
    return f"FLASER {len(scan.ranges)} {ranges} {poses} {scan.stamp:.3f} robot {scan.stamp:.3f}\n"


def _built(lines: Iterable[str]) -> tuple[float, float]:
    """Return processor time [s] and memory [MB] of a program that makes a map of a log."""
    with TemporaryDirectory() as folder:
        log = Path(folder) / "drive.log"
        log.write_text("".join(lines))
        began = getrusage(RUSAGE_CHILDREN).ru_utime
        command = [sys.executable, "-c", BUILD, str(log), str(log.with_suffix(".map"))]
        built = subprocess.run(command, check=True, capture_output=True, text=True)
    took = getrusage(RUSAGE_CHILDREN).ru_utime - began
    return took, float(built.stdout.split("VmHWM:")[1].split()[0]) / 1000


def large_floor(seed: int) -> LineMap:
    """Return a floor of corridors around blocks of rooms that differ in size and furniture."""
    rng = np.random.default_rng((seed, 40))
    walls = [_box(0.0, 0.0, WIDE, DEEP)]
    wide, deep = ((side - CORRIDOR) / n for side, n in zip((WIDE, DEEP), BLOCKS, strict=True))
    for column in range(BLOCKS[0]):
        for row in range(BLOCKS[1]):
            left, low = CORRIDOR + column * wide, CORRIDOR + row * deep
            right, high, middle = left + wide - CORRIDOR, low + deep - CORRIDOR, 0.0
            middle = low + float(rng.uniform(0.4, 0.6)) * (high - low)
            walls.append(np.array([[left, low, left, high], [right, low, right, high]]))
            walls.append(np.array([[left, middle, right, middle]]))
            walls += _rooms(rng, left, right, low, middle) + _rooms(rng, left, right, high, middle)
    return LineMap(name="floor", walls=np.vstack(walls))


def _rooms(
    rng: np.random.Generator, left: float, right: float, front: float, back: float
) -> list[Float]:
    """Return the walls of a row of rooms, each with a doorway to its corridor at `front` [m]."""
    walls, x = list[Float](), left
    while x < right:
        end = x + float(rng.uniform(*ROOM))
        end = right if right - end < ROOM[0] else end
        door = float(rng.uniform(x + 0.3, end - 0.3 - DOOR))
        walls.append(
            np.array(
                [[x, front, door, front], [door + DOOR, front, end, front], [end, front, end, back]]
            )
        )
        for _ in range(int(rng.integers(FURNITURE + 1))):
            size = rng.uniform(0.3, 1.2, 2)
            corner = rng.uniform((x, min(front, back)), (end - size[0], max(front, back) - size[1]))
            if abs(corner[1] + size[1] / 2 - front) > 1.6 + size[1] / 2:
                walls.append(_box(*corner.tolist(), *(corner + size).tolist()))
        x = end
    return walls


def _box(left: float, low: float, right: float, high: float) -> Float:
    """Return the sides of a box, shape (4, 4)."""
    return np.array(
        [
            [left, low, right, low],
            [right, low, right, high],
            [right, high, left, high],
            [left, high, left, low],
        ]
    )


def main() -> int:
    """Print the table; return 1 if a bar is missed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--metres", type=float, default=METRES, help="length of the drive")
    missed = 0
    for row in rows(parser.parse_args().metres):
        print(row, flush=True)
        missed += not row.met
    return int(missed > 0)


if __name__ == "__main__":
    raise SystemExit(main())
