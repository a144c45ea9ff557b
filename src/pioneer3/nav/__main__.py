"""Compiles the kernels of navigation and keeps the result: `python -m pioneer3.nav`."""

import os

from pioneer3.nav.warm_up import warm_up

if __name__ == "__main__":  # half a minute the first time; then there is nothing to do
    if hasattr(os, "nice"):
        os.nice(10)  # a robot may be driven beside
    warm_up()
