"""The transducers of robots, laid out for a kernel."""

from collections.abc import Sequence

import numpy as np

from pioneer3.sim.body import Body
from pioneer3.sim.firing import Firing
from pioneer3.sim.kernels import Mounts, sonar_mounts
from pioneer3.sim.realism import SonarErrors


def mounts_of(robots: Sequence[Body], errors: SonarErrors) -> tuple[Mounts, list[Firing]]:
    """Return all transducers, of robots grouped by what they have and fire; and what each does."""
    pairs = [(body.model.sonars, body.firing) for body in robots]
    types = {pair: number for number, pair in enumerate(dict.fromkeys(pairs))}
    tables = [np.array([(m.x, m.y, m.theta) for m in sonars]) for sonars, _ in types]
    mounts = sonar_mounts(
        [table.reshape(-1, 3) for table in tables],
        [types[pair] for pair in pairs],
        rays=errors.rays,
        width=errors.width,
    )
    return mounts, [firing for _, firing in types]
