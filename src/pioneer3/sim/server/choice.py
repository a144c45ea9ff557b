"""Which kernels a simulation runs on."""

import asyncio
import os
import subprocess
import sys
from importlib.util import find_spec
from typing import Literal

from pioneer3.sim.kernels import Kernels, load_kernels
from pioneer3.sim.kernels.cache import is_ready
from pioneer3.sim.server.pacer import Pacer

KernelChoice = Literal["auto", "numba", "numpy"]
"""`auto`: numba where it pays and is compiled already."""

PAYS = 5
"""Robots from which on loading numba, a second, is worth it in real time."""
MANY = 50
"""Robots from which on threads pay."""
MOST_THREADS = 4


async def chosen_kernels(choice: KernelChoice, robots: int, pace: Pacer | None) -> Kernels:
    """Return the kernels for so many robots; the event loop runs on while numba is loaded.

    What is not compiled yet is compiled by another process, for the next time: nobody waits for it.

    Raises:
        ConfigError: numba is asked for and is not installed.
    """
    threads = min(MOST_THREADS, os.cpu_count() or 1) if robots >= MANY else 1
    if choice == "auto":
        hurries = pace is not None and pace.speed > 1
        if robots < PAYS and not hurries:
            return load_kernels("numpy")
        if not is_ready():
            _compile_for_next_time()
            return load_kernels("numpy")
        choice = "numba"
    return await asyncio.to_thread(load_kernels, choice, threads=threads)


def _compile_for_next_time() -> None:
    if find_spec("numba") is not None:
        subprocess.Popen(
            ["nice", sys.executable, "-m", "pioneer3.sim.kernels"],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )
