"""Compiles the kernels and keeps the result: `python -m pioneer3.sim.kernels`."""

import os

from pioneer3.sim.kernels.kernels import compiled_kernels

if __name__ == "__main__":  # seconds the first time, where numba is installed; then nothing to do
    if hasattr(os, "nice"):
        os.nice(10)  # a simulator may be running beside
    compiled_kernels()
