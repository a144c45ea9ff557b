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
LOAD = """
import resource, sys, time
from pathlib import Path
from pioneer3.sim.maps import read_map
before, began = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, time.perf_counter()
read_map(Path(sys.argv[1]))
after = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
print(time.perf_counter() - began, (after - before) / 1024)
"""


def rows() -> list[Row]:
    """Measure everything of this file."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "rooms.map"
        path.write_text(_rooms())
        runs = [_load(path) for _ in range(RUNS)]
    seconds, megabytes = zip(*runs, strict=True)
    return [
        Row("map of a million points, loaded", median(seconds), "s", 2),
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


def _load(path: Path) -> tuple[float, float]:
    """Return what one load in a process of its own takes: [s], [MB]."""
    done = subprocess.run(
        [sys.executable, "-c", LOAD, str(path)], check=True, capture_output=True, text=True
    )
    seconds, megabytes = map(float, done.stdout.split())
    return seconds, megabytes
