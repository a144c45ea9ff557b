"""The same seed gives the same bytes, compiled or not."""

from hashlib import sha256

import numpy as np
import pytest

from pioneer3.geometry import Pose2
from pioneer3.models import load_model
from pioneer3.sim.body import Body
from pioneer3.sim.kernels import Kernels
from pioneer3.sim.realism import Realism
from pioneer3.sim.world import World
from pioneer3.sim.worldfile import load_map

MODELS = load_model("p3at-sh"), load_model("p3dx-sh")


def digest(count: int, *kernels: Kernels) -> str:
    """Simulate so many robots for 10 s, with each of the kernels for an equal part of it."""
    result = sha256()
    bodies = [Body(MODELS[n % 2], Pose2(3.0 + 1.5 * n, 2.0, 0.7 * n)) for n in range(count)]
    world = World(load_map("office"), bodies, seed=3, realism=Realism())
    for body in world.robots:
        body.enable_motors(on=True)
    random = np.random.default_rng(0)
    for step in range(100):
        world.kernels = kernels[step * len(kernels) // 100]
        if step % 5 == 0:
            world.drives.go(random.uniform(-0.5, 0.7, count), random.uniform(-1, 1, count))
        world.step(0.1)
        for array in (world.outlines.state, world.drives.wheels, world.drives.flags):
            result.update(array.tobytes())
        for body in world.robots:
            result.update(np.asarray(world.sonar(body)).tobytes())
        if step % 10 == 0:
            result.update(world.laser(world.robots[0], Pose2(0.1), -1.57, 0.0174, 181).tobytes())
    return result.hexdigest()


@pytest.mark.parametrize("count", [1, 4])
def test_the_same_seed_gives_the_same_bytes_compiled_or_not(count: int) -> None:
    pytest.importorskip("numba")
    plain, compiled = Kernels(compiled=False), Kernels()
    assert not plain.compiled
    assert compiled.compiled
    expected = digest(count, plain)
    assert digest(count, plain) == expected
    assert digest(count, compiled) == expected
    assert digest(count, plain, compiled) == expected
