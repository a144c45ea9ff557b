"""The fast heart of the simulator: rays, fans and footprints, by numpy or by numba."""
