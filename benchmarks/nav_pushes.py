"""Maps while the robot is pushed, lifted or slips: run as `python -m benchmarks.nav_pushes`.

Odometry misses one motion in each drive. The map is right in the end, or the mapper says that the
robot was moved.
"""

import argparse
from collections.abc import Iterator
from dataclasses import dataclass
from math import cos, degrees, pi, radians, sin
from multiprocessing import Pool

import numpy as np

from benchmarks.nav_drives import Conditions, Places, drive, map_of
from benchmarks.nav_judge import trajectory_errors
from benchmarks.nav_mapping import IMPROVE, MAPS, RANGES, Run, ready
from benchmarks.table import Row
from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.maps import LineMap
from pioneer3.nav.beams import beams_of
from pioneer3.sim.body import Body

SECONDS, PUSHES = 180.0, 40
QUICK_PUSHES = 6
AT = 0.4
"""Share of a drive after which somebody meddles with it."""
KINDS = "lift", "push", "slip"
WAYS, TURNS = (0.05, 1.0), (radians(5), pi)
"""The smallest and the largest motion that odometry misses [m], [rad]."""
LASTS = 1.0
"""Of a push, and of a slip [s]."""
RMSE = 0.02
"""[m]."""
RIGHT = 38 / 40
"""Share of the maps that are to be within that."""


class Meddler:
    """Moves a robot once: a lift in an instant, a push in a second, or wheels that turn in vain."""

    def __init__(self, seed: int) -> None:
        rng = np.random.default_rng((seed, 1))
        self.kind = KINDS[rng.integers(len(KINDS))]
        self.way = float(np.exp(rng.uniform(*np.log(WAYS))))
        self.turn = float(rng.uniform(*TURNS)) * (1 if rng.random() < 0.5 else -1)
        self._course = float(rng.uniform(-pi, pi))
        self._begin: Pose2 | None = None
        self._end = ORIGIN

    def __call__(self, time: float, body: Body, places: Places) -> bool:
        """Move the body, if it is the time for that; return whether it was."""
        since = time - AT * SECONDS
        if not 0 <= since <= LASTS:
            return False
        if self._begin is None:
            self._begin = body.robot_in_world
            self._end = self._begin if self.kind == "slip" else self._target(places, self._begin)
        share = 1.0 if self.kind == "lift" else since / LASTS
        step = self._begin.inverse() @ self._end
        body.robot_in_world = self._begin @ Pose2(share * step.x, share * step.y, share * self.turn)
        if self.kind == "slip":
            body.robot_in_world = self._begin
        body.drive.linear.go(self.way / LASTS if self.kind == "slip" else 0.0)
        body.drive.angular.go(self.turn / LASTS if self.kind == "slip" else 0.0)
        return True

    def _target(self, places: Places, here: Pose2) -> Pose2:
        """Return a free place as far away as possible, with nothing between."""
        for way in np.linspace(self.way, 0.0, 10).tolist():
            for course in self._course + np.linspace(0.0, 2 * pi, 24):
                ahead = cos(course), sin(course)
                steps = np.linspace(0.0, way, 10).tolist()
                if all(places.is_free(here.x + s * ahead[0], here.y + s * ahead[1]) for s in steps):
                    return Pose2(here.x + way * ahead[0], here.y + way * ahead[1], here.theta)
        return here


@dataclass(frozen=True, slots=True, kw_only=True)
class Pushed:
    """A drive with a push, and what came of it: RMSE [m], remarks, processor time [ms].

    `alone` is the RMSE of the same drive without it, where that with it is large.
    """

    what: str
    rmse: float
    alone: float
    remarks: tuple[str, ...]
    live: float
    beside: float

    @classmethod
    def of(cls, seed: int) -> "Pushed | None":
        """Return what comes of a seed; `None` where its map is not here."""
        name, far = MAPS[seed % len(MAPS)], RANGES[seed // len(MAPS) % len(RANGES)]
        line_map, meddler, alone = map_of(name), Meddler(seed), 0.0
        if line_map is None:
            return None
        rmse, run = _mapped(name, line_map, seed, far, meddler)
        if rmse > RMSE:
            alone, _ = _mapped(name, line_map, seed, far, None)
        what = f"{meddler.kind} of {meddler.way:.2f} m, {degrees(meddler.turn):.0f} degrees"
        return cls(
            what=f"{name}, {far:g} m, seed {seed}: {what}",
            rmse=rmse,
            alone=alone,
            remarks=run.mapper.remarks(),
            live=max(run.live),
            beside=max(run.beside),
        )


def _mapped(
    name: str, line_map: LineMap, seed: int, far: float, meddler: Meddler | None
) -> tuple[float, Run]:
    """Return the RMSE of a map [m], and how it was made."""
    run = Run()
    seen_all = drive(name, line_map, SECONDS, seed, Conditions(far=far), meddled=meddler)
    for number, seen in enumerate(seen_all, start=1):
        run.add(beams_of(seen.scan), seen.robot_in_world)
        if number % IMPROVE == 0:
            run.improve()
    run.improve()
    errors = trajectory_errors(run.poses, run.truth)
    return float(np.sqrt((errors**2).mean())), run


def rows(pushes: int = PUSHES, first: int = 0) -> Iterator[Row]:
    """Yield the figures of so many drives: the maps that are right, and the silence about others.

    Args:
        pushes: How many.
        first: Seed of the first.
    """
    with Pool(initializer=ready) as pool:
        drives = pool.imap(Pushed.of, range(first, first + pushes))
        done = [each for each in drives if each is not None]
    right = [each for each in done if each.rmse <= RMSE]
    for each in done:
        if each.rmse > RMSE:
            told = "said" if each.remarks else "not said"
            told += f", without it {100 * each.alone:.1f}"
            yield Row(f"{each.what}: RMSE, {told}", 100 * each.rmse, "cm", None)
    most = f"{len(done)} pushes: maps within {100 * RMSE:g} cm"
    yield Row(most, len(right), "", RIGHT * len(done), more_is_better=True)
    silent = [each for each in done if not each.remarks]
    yield Row("pushes that nobody was told of", len(silent), "", None)
    yield Row("of them, maps not within that", sum(each not in right for each in silent), "", 0)
    yield Row("a scan in the tick, worst", max(each.live for each in done), "ms", 20.0)
    beside = max(each.beside for each in done)
    yield Row("loops and graph in a thread, worst", beside, "ms", 300.0)


def main() -> int:
    """Print the table; return 1 if a bar is missed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pushes", type=int, default=PUSHES, help="how many drives")
    parser.add_argument("--first", type=int, default=0, help="seed of the first")
    given, missed = parser.parse_args(), 0
    for row in rows(given.pushes, given.first):
        print(row, flush=True)
        missed += not row.met
    return int(missed > 0)


if __name__ == "__main__":
    raise SystemExit(main())
