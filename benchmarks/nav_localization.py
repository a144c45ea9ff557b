"""How well robots are localized on known maps: `python -m benchmarks.nav_localization`.

Robots drive to random places by their true pose; a localizer listens (`nav_course.py`). A
search for the place counts as taking `SEARCH_TIME`, during which the robot drives on.
"""

import argparse
import sys
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import product
from math import hypot, radians
from multiprocessing import Pool
from time import perf_counter
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from benchmarks.nav_course import (
    EASY,
    HARD,
    Course,
    Hardship,
    Moment,
    known_start,
    map_of,
    maps,
)
from benchmarks.nav_doubtful import FURNISHED, MOVED, ROOMS
from benchmarks.table import Row
from pioneer3.geometry import Pose2
from pioneer3.models import load_model
from pioneer3.nav.beams import beams_of
from pioneer3.nav.global_search import Candidates
from pioneer3.nav.likelihood_sonar import Pings
from pioneer3.nav.localizer import Localizer

Float = NDArray[np.float64]
T = TypeVar("T")

MODELS = ("p3at-sh", "p3dx-sh")
NAMES = "laser", "unknown", "doubtful", "kidnapped", "sonar"
MINUTES = 5.0
"""Of each drive with a known start."""
SEARCH_TIME = 2.0
"""From a scan to the places that look like it [s]."""
RIGHT, WRONG = 0.15, 0.3
"""A sure robot is right, or wrongly sure, within and beyond this [m]."""
FOUND_WITHIN, AGAIN_WITHIN = 15.0, 30.0
"""After an unknown start, and after being carried away [s]."""
TRIALS = 4
"""Unknown starts, or carryings away, in a drive."""
SETTLED = 200
"""Moments of a drive by sonar that are not counted, as its start is not known well."""
PEOPLE = Hardship(people=5)
REACHES = 4.0, 8.0, 32.0
"""Ranges of the laser among identical rooms [m]."""
STARTS, TOLD_STARTS = 100, 60
"""Starts where places look alike, unknown and told."""


@dataclass(frozen=True, slots=True)
class Run:
    """One drive: a map, a model, a seed."""

    where: str
    model: str
    seed: int


@dataclass(frozen=True, slots=True, eq=False)
class Track:
    """What a localizer made of a drive, at each moment.

    Attributes:
        off: From the true position [m], shape (N,).
        turned: From the true heading [rad], shape (N,).
        sure: Whether it was sure, shape (N,).
        took: Time of each update that counted [s].
        searches: Time of each search [s].
        lost: How often it lost its place.
    """

    off: Float
    turned: Float
    sure: NDArray[np.bool_]
    took: list[float]
    searches: list[float]
    lost: int


class Listener:
    """A localizer that is given a course, and searches as a program does."""

    def __init__(self, run: Run, hardship: Hardship = EASY) -> None:
        self.course = Course(run.where, run.model, run.seed, hardship)
        self.rng = np.random.default_rng((run.seed, 9))
        model = load_model(run.model)
        self.localizer = Localizer(map_of(run.where.replace(MOVED, FURNISHED)), model, self.rng)
        self.localizer.prepare()
        self._mounts = np.array([(mount.x, mount.y, mount.theta) for mount in model.sonars])
        self._pending: tuple[float, Candidates] | None = None

    def follow(self, seconds: float, *, sonar: bool = False) -> Track:
        """Drive on for some time [s]; return how well that is followed."""
        rows: list[tuple[float, float, bool]] = []
        took, searches, lost, stage = list[float](), list[float](), 0, ""
        for moment in self.course.moments(seconds):
            before = self.localizer.estimate.odom_in_map
            time = self._take(moment, sonar=sonar)
            if self.localizer.estimate.odom_in_map is not before:
                took.append(time)
            searches += self._search(moment)
            estimate = self.localizer.estimate
            lost += estimate.stage == "lost" and stage == "sure"
            stage = estimate.stage
            off = moment.truth.inverse() @ (estimate.robot_in_map or Pose2(1e3))
            rows.append((hypot(off.x, off.y), abs(off.theta), estimate.sure))
        table = np.array(rows)
        return Track(table[:, 0], table[:, 1], table[:, 2] > 0, took, searches, lost)

    def _take(self, moment: Moment, *, sonar: bool) -> float:
        if sonar:
            pings = Pings(
                stamp=moment.time,
                robot_in_odom=moment.odom,
                mounts=self._mounts[moment.fresh],
                ranges=moment.ranges,
            )
            began = perf_counter()
            self.localizer.take_sonar(pings)
        else:
            beams = beams_of(moment.scan)
            began = perf_counter()
            self.localizer.take(beams)
        return perf_counter() - began

    def _search(self, moment: Moment) -> Iterator[float]:
        if self._pending is None and self.localizer.wants_search:
            search = self.localizer.search()
            assert search is not None
            began = perf_counter()
            self._pending = moment.time + SEARCH_TIME, search.run()
            yield perf_counter() - began
        elif self._pending is not None and moment.time >= self._pending[0]:
            self.localizer.adopt(self._pending[1])
            self._pending = None


def tracked(run: Run, hardship: Hardship = EASY, minutes: float = MINUTES) -> Track:
    """Return how a laser follows a drive with a known start."""
    listener = Listener(run, hardship)
    truth = listener.course.body.robot_in_world
    listener.localizer.start(known_start(truth, listener.rng, 0.3, 0.15))
    return listener.follow(60 * minutes)


def heard(run: Run, minutes: float = MINUTES) -> Track:
    """Return how sonars follow a drive whose start is known within 1 m and 15 degrees."""
    listener = Listener(run)
    truth = listener.course.body.robot_in_world
    start = known_start(truth, listener.rng, 1.0, radians(15))
    listener.localizer.start(start, 0.5, radians(10))
    return listener.follow(60 * minutes, sonar=True)


def found(run: Run, hardship: Hardship = EASY) -> list[Track]:
    """Return how a laser finds unknown starts."""
    listener = Listener(run, hardship)
    tracks = []
    for _ in range(TRIALS):
        listener.course.put(listener.course.random_pose())
        listener.localizer.start_unknown()
        tracks.append(listener.follow(AGAIN_WITHIN))
    return tracks


def told(run: Run) -> list[Track]:
    """Return how a laser finds starts that somebody told."""
    listener = Listener(run)
    tracks = []
    for _ in range(TRIALS):
        listener.course.put(listener.course.random_pose())
        truth = listener.course.body.robot_in_world
        listener.localizer.start(known_start(truth, listener.rng, 0.3, 0.15))
        tracks.append(listener.follow(AGAIN_WITHIN))
    return tracks


def carried(run: Run, hardship: Hardship = EASY) -> list[Track]:
    """Return how a laser notices that its robot was carried away, and finds it again."""
    listener = Listener(run, hardship)
    listener.localizer.start(listener.course.body.robot_in_world)
    listener.follow(3.0)
    tracks = []
    for _ in range(TRIALS):
        here = there = listener.course.body.robot_in_world
        while hypot(there.x - here.x, there.y - here.y) < 2.0:
            there = listener.course.random_pose()
        listener.course.put(there)
        tracks.append(listener.follow(AGAIN_WITHIN))
    return tracks


def _right_after(track: Track) -> float:
    """Return the time until a robot is sure of the right place [s]."""
    right = track.sure & (track.off < RIGHT)
    return 0.1 * float(right.argmax()) if right.any() else np.inf


def _precision(what: str, tracks: Sequence[Track], bars: tuple[float, float]) -> Iterator[Row]:
    off = 100 * np.concatenate([track.off for track in tracks])
    turned = np.degrees(np.concatenate([track.turned for track in tracks]))
    yield Row(f"{what}: median", float(np.median(off)), "cm", bars[0] or None)
    yield Row(f"{what}: 95 %", float(np.quantile(off, 0.95)), "cm", bars[1] or None)
    yield Row(f"{what}: largest", float(off.max()), "cm", None)
    yield Row(f"{what}: heading, 95 %", float(np.quantile(turned, 0.95)), "deg", None)


def _time(what: str, tracks: Sequence[Track], bar: float) -> Iterator[Row]:
    took = 1000 * np.concatenate([track.took for track in tracks])
    yield Row(f"{what}: an update, median", float(np.median(took)), "ms", bar)
    yield Row(f"{what}: an update, 99 %", float(np.quantile(took, 0.99)), "ms", None)


def laser_rows(seeds: int, minutes: float) -> Iterator[Row]:
    """Yield the row "localization, laser", and the same with everything against it."""
    tracks = dict(_all(partial(tracked, minutes=minutes), "laser", seeds))
    for where in maps():
        some = [track for run, track in tracks.items() if run.where == where]
        yield from _precision(f"localization, laser, {where}", some, (1.0, 2.0))
    yield from _time("localization, laser", [*tracks.values()], 1.0)
    lost = sum(track.lost for track in tracks.values())
    yield Row("localization, laser: lost its place", lost, "", 0)
    tracks = dict(_all(partial(tracked, hardship=HARD, minutes=minutes), "laser, hard", seeds))
    yield from _precision("localization, laser, hard", [*tracks.values()], (0.0, 0.0))
    lost = sum(track.lost for track in tracks.values())
    yield Row("localization, laser, hard: lost its place", lost, "", 0)


def unknown_rows(seeds: int) -> Iterator[Row]:
    """Yield the row "unknown start", alone and with everything against it."""
    for name, hardship, bar in (("", EASY, 99.0), (", hard", HARD, None)):
        what = f"unknown start{name}"
        lists = _all(partial(found, hardship=hardship), what, seeds)
        tracks = [track for _, each in lists for track in each]
        times = np.array([_right_after(track) for track in tracks])
        share = 100 * float((times <= FOUND_WITHIN).mean())
        wrong = sum(bool((track.sure & (track.off > WRONG)).any()) for track in tracks)
        yield Row(
            f"{what}: found in {FOUND_WITHIN:g} s, of {len(tracks)}",
            share,
            "%",
            bar,
            more_is_better=True,
        )
        yield Row(f"{what}: median", float(np.median(times)), "s", None)
        yield Row(f"{what}: wrongly sure", wrong, "", 0)
        searches = [time for track in tracks for time in track.searches]
        yield Row(f"{what}: a search, median", float(np.median(searches)), "s", None)


def doubtful_rows(share: float) -> Iterator[Row]:
    """Yield the rows about places that look alike, of a `share` of the starts."""
    starts, told_starts = (round(share * n / TRIALS) for n in (STARTS, TOLD_STARTS))
    rooms = [Run(ROOMS, MODELS[n % 2], n) for n in range(starts)]
    for far in REACHES:
        what = f"identical rooms, laser of {far:g} m"
        lists = _all(partial(found, hardship=Hardship(far=far)), what, rooms)
        yield from _wrongly(what, [track for _, each in lists for track in each])
    what = "furniture moved by 30 %, unknown start"
    moved = [Run(f"{MOVED}:{n}", MODELS[n % 2], n) for n in range(starts)]
    yield from _wrongly(what, [track for _, each in _all(found, what, moved) for track in each])
    what = "furniture moved by 30 %, told start"
    tracks = [t for _, each in _all(told, what, moved[:told_starts]) for t in each]
    yield from _wrongly(what, tracks)
    right = sum(bool(track.sure[-1] and track.off[-1] < RIGHT) for track in tracks)
    bar = 100 * 58 / 60
    named = f"{what}: right in the end, of {len(tracks)}"
    yield Row(named, 100 * right / len(tracks), "%", bar, more_is_better=True)


def _wrongly(what: str, tracks: Sequence[Track]) -> Iterator[Row]:
    """Yield the time that robots are sure of a wrong place, and the share that is found."""
    seconds = sum(0.1 * int((track.sure & (track.off > WRONG)).sum()) for track in tracks)
    yield Row(f"{what}: wrongly sure, of {len(tracks)}", seconds, "s", 0)
    right = 100 * float(np.mean([_right_after(track) < np.inf for track in tracks]))
    yield Row(f"{what}: found in {AGAIN_WITHIN:g} s", right, "%", None)


def carried_rows(seeds: int, hours: float) -> Iterator[Row]:
    """Yield the row "kidnapped"."""
    lists = _all(carried, "kidnapped", seeds)
    tracks = [track for _, each in lists for track in each]
    times = np.array([_right_after(track) for track in tracks])
    share = 100 * float((times <= AGAIN_WITHIN).mean())
    yield Row(
        f"kidnapped: found in {AGAIN_WITHIN:g} s, of {len(tracks)}",
        share,
        "%",
        100 * 58 / 60,
        more_is_better=True,
    )
    yield Row("kidnapped: median", float(np.median(times)), "s", None)
    noticed = [~np.logical_and.accumulate(track.sure) for track in tracks]
    wrong = sum(
        0.1 * int((track.sure & (track.off > WRONG) & since).sum())
        for track, since in zip(tracks, noticed, strict=True)
    )
    yield Row("kidnapped: wrongly sure, once noticed", wrong, "s", 0)
    drives = len(maps()) * len(MODELS)
    drive = partial(tracked, hardship=PEOPLE, minutes=60 * hours / drives)
    lost = sum(track.lost for _, track in _all(drive, "false alarms", 1))
    yield Row(f"kidnapped: false alarms among 5 people in {hours:g} h", lost, "", 0)


def sonar_rows(seeds: int, minutes: float) -> Iterator[Row]:
    """Yield the row "sonar"."""
    tracks = [track for _, track in _all(partial(heard, minutes=minutes), "sonar", seeds)]
    settled = [
        Track(t.off[SETTLED:], t.turned[SETTLED:], t.sure[SETTLED:], t.took, [], t.lost)
        for t in tracks
    ]
    yield from _precision("sonar", settled, (7.0, 20.0))
    yield from _time("sonar", tracks, 3.0)
    good = sum(bool(t.sure[-1] and np.median(t.off[SETTLED:]) < 0.2) for t in tracks)
    share = 100 * good / len(tracks)
    what = f"sonar: start known within 1 m, of {len(tracks)}"
    yield Row(what, share, "%", 100.0, more_is_better=True)
    wrong = sum(bool((t.sure & (t.off > WRONG)).any()) for t in tracks)
    yield Row("sonar: wrongly sure", wrong, "", None)


def _all(
    work: Callable[[Run], T], what: str, seeds: int | Sequence[Run]
) -> Iterator[tuple[Run, T]]:
    """Yield each run with its result: those given, or so many `seeds` on each map."""
    if isinstance(seeds, int):
        runs = [Run(*each) for each in product(maps(), MODELS, range(seeds))]
    else:
        runs = [*seeds]
    with Pool() as pool:
        for number, result in enumerate(pool.imap(work, runs)):
            print(f"\r{what}: {number + 1} of {len(runs)}", end="", file=sys.stderr, flush=True)
            yield runs[number], result
    print("\r\x1b[K", end="", file=sys.stderr, flush=True)


def rows(*, quick: bool = False, names: Collection[str] = NAMES) -> Iterator[Row]:
    """Yield all rows, or those of some `NAMES`."""
    seeds, minutes = (1, 1.0) if quick else (3, MINUTES)
    groups = {
        "laser": lambda: laser_rows(seeds, minutes),
        "unknown": lambda: unknown_rows(1 if quick else 4),
        "doubtful": lambda: doubtful_rows(0.08 if quick else 1.0),
        "kidnapped": lambda: carried_rows(1 if quick else 2, 0.1 if quick else 1.0),
        "sonar": lambda: sonar_rows(seeds, max(2.0, minutes)),
    }
    for name in NAMES:
        if name in names:
            yield from groups[name]()


def main() -> int:
    """Print the table; return 1 if a bar is missed."""
    parser = argparse.ArgumentParser(description=__doc__)
    words = f"{', '.join(NAMES)}; all by default"
    parser.add_argument(
        "names", nargs="*", default=NAMES, choices=NAMES, metavar="NAME", help=words
    )
    parser.add_argument("--quick", action="store_true", help="few seeds, short drives")
    given = parser.parse_args()
    missed = 0
    for row in rows(quick=given.quick, names=given.names):
        print(row, flush=True)
        missed += not row.met
    return int(missed > 0)


if __name__ == "__main__":
    raise SystemExit(main())
