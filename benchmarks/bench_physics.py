"""Real-time factors with physics: wandering robots with sonars and a laser, on one core."""

import time
from collections.abc import Iterator
from importlib.util import find_spec

from benchmarks.bench_world import compiled_wander, crowded, factor, wander
from benchmarks.table import Row
from pioneer3.models import load_model
from pioneer3.sim.dynamics import dynamics_of
from pioneer3.sim.kernels import compiled_kernels
from pioneer3.sim.realism import Realism

BARS = {1: 50.0, 10: 6.0, 20: 2.5}
"""Times real time, of the processor's time, with 16 sonars of 5 rays and 181 beams at 10 Hz."""


def rows() -> Iterator[Row]:
    """Measure worlds of so many robots; nothing where MuJoCo is not installed."""
    if not find_spec("mujoco"):
        return
    control = compiled_wander() if find_spec("numba") else wander
    for model in ("p3at-sh", "p3dx-sh"):
        for count, bar in BARS.items():
            for laser in (True, False):
                world = crowded(
                    compiled_kernels(),
                    count,
                    1,
                    Realism(),
                    model=load_model(model),
                    dynamics=dynamics_of("mujoco"),
                )
                what = "sonars and 181 beams" if laser else "16 sonars"
                measured = factor(world, control, laser=laser, seconds=3.0, clock=time.process_time)
                held = bar if laser and model == "p3at-sh" else None
                yield Row(f"{count} {model}, {what}", measured, "x", held, more_is_better=True)
