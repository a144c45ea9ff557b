"""A thousand robots in one world, without sockets: arrays in, arrays out.

    .venv/bin/python examples/06_many_robots.py

Without the extra `fast`, which compiles the simulator, this takes minutes.
"""

import time

import numpy as np

from pioneer3.geometry import Pose2
from pioneer3.models import load_model
from pioneer3.sim.body import Body
from pioneer3.sim.kernels import Kernels
from pioneer3.sim.realism import Realism
from pioneer3.sim.world import World

ROWS, GAP, STEP, SECONDS = 32, 2.0, 0.1, 10

model = load_model("p3dx-sh")
places = [Pose2(GAP * (n % ROWS), GAP * (n // ROWS), 0.1 * n) for n in range(1000)]
bodies = [Body(model, place) for place in places]
world = World(None, bodies, Kernels(), seed=1, realism=Realism())
for body in bodies:
    body.enable_motors(on=True)

begin = time.perf_counter()
for _ in range(round(SECONDS / STEP)):
    nearest = world.sonars()[:, 1:7].min(axis=1)  # in front [m]
    near = nearest < 0.7
    world.drives.go(np.where(near, 0.0, 0.3), np.where(near, 1.0, 0.0))  # m/s, rad/s
    world.step(STEP)
took = time.perf_counter() - begin

believed = [place @ body.robot_in_odom for place, body in zip(places, bodies, strict=True)]
true = [body.robot_in_world for body in bodies]
off = np.median([np.hypot(a.x - b.x, a.y - b.y) for a, b in zip(believed, true, strict=True)])
print(f"{SECONDS} s of 1000 robots in {took:.1f} s, compiled: {world.kernels.compiled}")
print(f"half of them are more than {off * 100:.1f} cm from where their wheels say")
