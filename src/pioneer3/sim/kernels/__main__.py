"""Compiles the kernels and keeps the result: `python -m pioneer3.sim.kernels`."""

from importlib.util import find_spec

from pioneer3.sim.kernels.load import load_kernels


def main() -> None:
    """Compile, where numba is installed; seconds the first time, then nothing to do."""
    if find_spec("numba"):
        load_kernels("numba")


if __name__ == "__main__":
    main()
