"""What a map of a million points costs to load: time, and memory besides Python's own."""

import subprocess
import sys
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory

import numpy as np

from benchmarks.table import Row

POINTS = 1_000_000
ROOM, IN_ROW = 400, 40
"""Points along a side of a scanned room, and rooms beside each other."""
STEP_MM = 20
RUNS = 5
LOAD = r"""
import re, sys, time
from pathlib import Path
from pioneer3.maps import read_map
def most():
    return int(re.search(r"VmHWM:\s+(\d+)", Path("/proc/self/status").read_text())[1])
before, began, worked = most(), time.perf_counter(), time.process_time()
read_map(Path(sys.argv[1]))
print(time.perf_counter() - began, time.process_time() - worked, (most() - before) / 1024)
"""


def rows() -> list[Row]:
    """Measure everything of this file."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "rooms.map"
        path.write_text(_rooms())
        runs = [_load(path) for _ in range(RUNS)]
    seconds, worked, megabytes = zip(*runs, strict=True)
    return [
        Row("map of a million points, loaded", median(seconds), "s", 2),
        Row("map of a million points, processor", median(worked), "s", 2),
        Row("map of a million points, memory at most", median(megabytes), "MB", 200),
    ]


def _rooms() -> str:
    """Return the text of a map of square rooms whose walls were scanned with some noise."""
    rng = np.random.default_rng(1)
    side = np.arange(ROOM)
    low, high = np.zeros_like(side), np.full_like(side, ROOM - 1)
    square = np.concatenate(
        [np.stack(pair, axis=1) for pair in ((side, low), (side, high), (low, side), (high, side))]
    )
    rooms = np.arange(-(-POINTS // len(square)))
    corners = np.stack([rooms // IN_ROW, rooms % IN_ROW], axis=1) * (ROOM + 50)
    points = (corners[:, None] + square).reshape(-1, 2)[:POINTS]
    points = (points + rng.integers(0, 2, points.shape)) * STEP_MM
    lines = "\n".join(f"{x} {y}" for x, y in points.tolist())
    return f"2D-Map\nResolution: {STEP_MM}\nDATA\n{lines}\n"


def _load(path: Path) -> tuple[float, float, float]:
    """Return what one load in a process of its own takes: [s], [s] of processor, [MB]."""
    done = subprocess.run(
        [sys.executable, "-c", LOAD, str(path)], check=True, capture_output=True, text=True
    )
    seconds, worked, megabytes = map(float, done.stdout.split())
    return seconds, worked, megabytes
