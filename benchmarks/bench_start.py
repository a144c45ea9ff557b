"""How long people wait: for the import, for --help, for the page, for the simulator."""

import os
import socket
import subprocess
import sys
import time
import urllib.request
from statistics import median
from tempfile import TemporaryDirectory

from benchmarks.table import Row

RUNS = 9
GIVE_UP = 30.0
POLL = 0.005
TWENTY = ["-r", "p3dx"] * 20


def rows() -> list[Row]:
    """Measure everything of this file."""
    return [
        Row("import pioneer3", _import_ms(), "ms", 100),
        Row("p3 --help", _command_ms("-m", "pioneer3", "--help"), "ms", 300),
        Row("page up after pioneer3 run", _page_up(), "s", 5),
        Row("pioneer3 sim takes connections", median(_sim_up() for _ in range(RUNS)), "s", 1.5),
        Row("the same, nothing compiled", median(_cold_sim_up() for _ in range(3)), "s", 1.5),
        Row("the same, 20 robots at random", _sim_up("--start", "random", *TWENTY), "s", 1.5),
    ]


def _import_ms() -> float:
    """Median of what the import adds to the start of Python."""
    return _command_ms("-c", "import pioneer3") - _command_ms("-c", "pass")


def _command_ms(*arguments: str) -> float:
    times = []
    for _ in range(RUNS):
        began = time.perf_counter()
        subprocess.run([sys.executable, *arguments], check=True, stdout=subprocess.DEVNULL)
        times.append((time.perf_counter() - began) * 1000)
    return median(times)


def _sim_up(*options: str, environment: dict[str, str] | None = None) -> float:
    """Return how long it takes from the command to the first connection [s]."""
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    command = [sys.executable, "-m", "pioneer3", "sim", "-p", str(port), *options]
    began = time.perf_counter()
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, env=environment) as process:
        try:
            while time.perf_counter() - began < GIVE_UP:
                try:
                    socket.create_connection(("127.0.0.1", port)).close()
                except ConnectionRefusedError:
                    time.sleep(POLL)
                else:
                    return time.perf_counter() - began
        finally:
            process.terminate()
    return GIVE_UP


def _cold_sim_up() -> float:
    """Start without Python's and numba's compiled files, as after an installation."""
    with TemporaryDirectory() as empty:
        caches = {"PYTHONPYCACHEPREFIX": empty, "NUMBA_CACHE_DIR": empty}
        return _sim_up(environment=os.environ | caches)


def _page_up() -> float:
    command = [sys.executable, "-m", "pioneer3", "run", "--sim-port", "0", "--web-port", "0"]
    began = time.perf_counter()
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            for line in process.stdout:
                if "http://" in line and time.perf_counter() - began < GIVE_UP:
                    address = next(word for word in line.split() if word.startswith("http://"))
                    urllib.request.urlopen(address).read()
                    return time.perf_counter() - began
        finally:
            process.terminate()
    return GIVE_UP
