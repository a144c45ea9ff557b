"""The simulated camera's pictures over HTTP: when the first one comes, and what they cost.

The simulator is another process: a robot with a camera in the office, whose walls are 396 boxes.
Cost is processor time of the simulator and of the process that renders, less that of the simulator
while nobody looks.

    python -m benchmarks camera            # 20 s
    python -m benchmarks.camera 60         # so many seconds
"""

import asyncio
import os
import subprocess
import sys
import time
from itertools import pairwise
from pathlib import Path
from urllib.request import urlopen

from benchmarks.table import Row, percentile_99
from pioneer3.mjpeg import Parser, parse_url, request
from pioneer3.sim.server.start import simulator
from pioneer3.sim.worldfile import parse_equipment
from pioneer3.sim.worldfile.arguments import WorldOverrides

SECONDS = 20.0
SIZES = ((320, 240), (640, 480))
BARS = {(320, 240): 20.0}
"""Of one core [%]; the larger picture is only good to know."""
TICKS = os.sysconf("SC_CLK_TCK")


async def serve(width: int, height: int) -> None:
    """Simulate the robot; print the URL of its camera, until cancelled."""
    fitted = parse_equipment(f"camera=vcc4,picture-width={width},picture-height={height}")
    overrides = WorldOverrides(equipment=fitted, seed=1, physics=True)
    async with simulator(port=0, overrides=overrides) as running:
        camera = running.robots[0].camera
        print(camera.url if camera else f"# {running.notes[-1]}", flush=True)
        await asyncio.get_running_loop().create_future()


def used(process: int) -> float:
    """Return the processor time of a process and its children so far [s]."""
    children = Path(f"/proc/{process}/task/{process}/children").read_text().split()
    fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    own = (int(fields[11]) + int(fields[12])) / TICKS
    return own + sum(used(int(child)) for child in children)


async def watch(url: str, seconds: float) -> list[float]:
    """Look at a stream; return when each picture came [s]."""
    at, parser, times = parse_url(url), Parser(), list[float]()
    reader, writer = await asyncio.open_connection(at.host, at.port)
    writer.write(request(at))
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        times += [time.monotonic() for _ in parser.receive(await reader.read(1 << 16))]
    writer.close()
    return times


def measure(width: int, height: int, seconds: float) -> list[Row]:
    """Measure pictures of one size."""
    what = f"camera, {width} x {height}"
    command = [sys.executable, "-m", "benchmarks.camera", "serve", str(width), str(height)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            url = process.stdout.readline().strip()
            if not url.startswith("http"):
                raise SystemExit(url)
            time.sleep(3.0)  # kernels are loaded
            began = time.monotonic()
            urlopen(f"{url}snapshot.jpg", timeout=10).read()
            first = time.monotonic() - began
            before = used(process.pid)
            time.sleep(seconds / 2)
            idle = (used(process.pid) - before) / (seconds / 2)
            before = used(process.pid)
            times = asyncio.run(watch(url, seconds))
            busy = (used(process.pid) - before) / seconds
        finally:
            process.terminate()
    gaps = [later - sooner for sooner, later in pairwise(times)]
    bar = BARS.get((width, height))
    return [
        Row(f"{what}: the first picture", first, "s", 1.0),
        Row(f"{what}: pictures a second", len(times) / seconds, "Hz", 9.5, more_is_better=True),
        Row(f"{what}: share of a core while somebody looks", 100 * (busy - idle), "%", bar),
        Row(f"{what}: from one to the next, 99th percentile", percentile_99(gaps), "s", None),
    ]


def rows(seconds: float = SECONDS) -> list[Row]:
    """Measure both sizes."""
    return [row for size in SIZES for row in measure(*size, seconds)]


if __name__ == "__main__":
    if sys.argv[1:2] == ["serve"]:
        asyncio.run(serve(int(sys.argv[2]), int(sys.argv[3])))
    else:
        for row in rows(float(sys.argv[1]) if len(sys.argv) > 1 else SECONDS):
            print(row)
