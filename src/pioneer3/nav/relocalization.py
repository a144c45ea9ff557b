"""Finds the place of a scan that is nowhere near where odometry has it, if only one place fits."""

from collections.abc import Sequence

import numpy as np

from pioneer3.arrays import Float
from pioneer3.geometry import Pose2, wrap
from pioneer3.nav.beams import Beams
from pioneer3.nav.frames import KeyFrame
from pioneer3.nav.matching import Cloud, Match, Prior, Submap, rotation

ASKED_SCANS = 8
"""Scans that a scan is compared with at most."""
BEAMS_APART = 0.04
"""Angle between two beams above which nothing is known of what lies between [rad]."""
BEYOND = 0.3
"""Distance beyond a point as far as which a beam has to go to contradict it [m]."""
BEYOND_SHARE = 0.05
"""Share of the range that is added to that: walls are seen at a flat angle far off."""
CONTRADICTED = 0.2
"""Share of contradictions above which a scan may have been taken elsewhere; half of it are people.
"""
TRIED = 4
"""Headings that are tried at most, the best ones."""
ASKED_POINTS = 60
"""Points of the search, of all that there are."""
SAME_HEADING = 0.2
"""Difference of headings below which two poses are the same one [rad]."""
CLEARLY = 0.1
"""Share of a scan by which the best pose fits better than any other."""
LOOSE = 0.5
"""Standard deviation of a place that was found by its surroundings alone [m]."""
LOOSE_TURN = 10.0
"""Standard deviation of the heading there [rad]: nothing is known."""


class Vicinity:
    """A piece of map that scans are looked for in: key frames and their poses."""

    def __init__(
        self, frames: Sequence[KeyFrame], poses: Sequence[Pose2], submap: Submap | None = None
    ) -> None:
        every = max(1, len(frames) // ASKED_SCANS)
        self._asked = list(zip(frames, poses, strict=True))[::-1][::every]
        self.submap = submap or Submap([frame.cloud for frame in frames], poses)

    def contradiction(self, beams: Beams, pose: Pose2) -> float:
        """Return the share of what two scans could both see that one saw through, at a pose.

        New ground, and what hides something else, is no contradiction.
        """
        seen = through = 0
        for frame, at in self._asked:
            here = at.inverse() @ pose
            for points, to, other in (
                (beams.points, here, frame.beams),
                (frame.beams.points, here.inverse(), beams),
            ):
                moved = points @ rotation(to.theta).T + (to.x, to.y)
                both, beyond = _seen_through(moved, other)
                seen, through = seen + both, through + beyond
        return through / max(1, seen)

    def contradicts(self, beams: Beams, pose: Pose2) -> bool:
        """Whether a scan saw something else there, more than people make it."""
        return self.contradiction(beams, pose) >= CONTRADICTED / 2

    def find(
        self, cloud: Cloud, beams: Beams, guess: Pose2, way: float, fit: float
    ) -> Match | None:
        """Return where a scan fits within `way` [m] of a guess, whatever its heading.

        It is `None` where less than a share `fit` of it fits, or more than one heading fits.
        """
        every = max(1, len(cloud.points) // ASKED_POINTS)
        points = np.ascontiguousarray(cloud.points[::every])
        matches = [
            self.submap.match(cloud, pose, Prior.around(pose, LOOSE, LOOSE_TURN))
            for pose, _ in self.submap.search_all_headings(points, guess, way)[:TRIED]
        ]
        best = max(matches, key=lambda match: match.inliers)
        others = (
            match.inliers
            for match in matches
            if abs(wrap(match.pose.theta - best.pose.theta)) > SAME_HEADING
        )
        if best.inliers < max(fit, CLEARLY + max(others, default=0.0)):
            return None
        return None if self.contradicts(beams, best.pose) else best


def _seen_through(points: Float, beams: Beams) -> tuple[int, int]:
    """Return how many points (N, 2) a scan could see, and how many of them it saw through."""
    ways = beams.points - beams.origin
    bearings, ranges = np.arctan2(ways[:, 1], ways[:, 0]), np.hypot(ways[:, 0], ways[:, 1])
    if len(ranges) < 2:
        return 0, 0
    order = np.argsort(bearings)
    bearings, ranges = bearings[order], ranges[order]
    off = points - beams.origin
    away = np.hypot(off[:, 0], off[:, 1])
    bearing = np.arctan2(off[:, 1], off[:, 0])
    after = np.clip(np.searchsorted(bearings, bearing), 1, len(bearings) - 1)
    known = (bearings[after - 1] <= bearing) & (bearing <= bearings[after])
    known &= bearings[after] - bearings[after - 1] < BEAMS_APART
    free = np.minimum(ranges[after], ranges[after - 1])
    seen = known & (away < free + BEYOND)
    through = seen & (away < free - BEYOND - BEYOND_SHARE * away)
    return int(seen.sum()), int(through.sum())
