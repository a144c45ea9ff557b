"""A simulator in a process of its own, so that its work is not counted as the driver's."""

import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def simulator_process(*options: str) -> Iterator[str]:
    """Run `pioneer3 sim` on a free port; yield its URL."""
    command = [sys.executable, "-m", "pioneer3", "sim", "-p", "0", *options]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            yield process.stdout.readline().split()[-1]
        finally:
            process.terminate()
