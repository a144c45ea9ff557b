"""Finds where odometry contradicts the scans of a map: wheels that are counted wrongly."""

from math import hypot

from pioneer3.geometry import Pose2, wrap
from pioneer3.nav.frames import Survey
from pioneer3.nav.odometry import slip
from pioneer3.nav.settings import MapperSettings

COMPARED_FRAMES = 4
"""Key frames over which odometry is compared with the scans: more than one push takes."""
CONTRARY_SIGMAS = 4.0
"""Difference from which on odometry contradicts the scans [standard deviations of odometry]."""
FEWEST_PIECES = 4
"""Pieces of the way, apart from each other, from which on it is the odometry, not a push."""
MOST_SPANS = 4
"""Times that are told at most, the longest ones."""


def contradiction_of(survey: Survey, settings: MapperSettings) -> str | None:
    """Return a sentence about odometry that contradicts the scans, with the times.

    It has no final stop; `None` where odometry is right, or was wrong once or twice.
    """
    frames, poses = survey.frames, survey.poses
    torn = {edge.second for edge in survey.edges if edge.torn}
    spans, pieces, counted, backwards = list[tuple[int, int]](), 0, 0, 0
    for begin in range(len(frames) - COMPARED_FRAMES):
        end = begin + COMPARED_FRAMES
        odometry = frames[begin].beams.robot_in_odom.inverse() @ frames[end].beams.robot_in_odom
        way = poses[begin].inverse() @ poses[end]
        sigmas = slip(
            settings, frames[end].way - frames[begin].way, frames[end].turn - frames[begin].turn
        )
        # how far the robot was moved is not known where the map is torn
        is_torn = not torn.isdisjoint(range(begin + 1, end + 1))
        if not (is_torn or _is_contrary(odometry, way, *sigmas)):
            continue
        if begin >= counted:
            pieces, counted = pieces + 1, end
        begins = spans.pop()[0] if spans and begin <= spans[-1][1] else begin
        spans.append((begins, end))
        if not is_torn:
            backwards += 1 if odometry.x * way.x + odometry.y * way.y < 0 else -1
    if pieces < FEWEST_PIECES:
        return None
    told = sorted(sorted(spans, key=lambda each: each[0] - each[1])[:MOST_SPANS])
    more = f" and {len(spans) - len(told)} times more" if len(spans) > len(told) else ""
    why = ": ways backwards seem to be told as ways ahead" if backwards > 0 else ""
    return f"odometry contradicts the scans at {_times(survey, told)}{more}{why}"


def _times(survey: Survey, spans: list[tuple[int, int]]) -> str:
    """Return the times of spans of key frames; where stamps are too coarse for that, the ways."""
    frames = survey.frames
    start = frames[0].beams.stamp
    clocks = [[_clock(frames[number].beams.stamp - start) for number in span] for span in spans]
    if all(begin != end for begin, end in clocks):
        after = "minutes after the first scan"
    else:
        clocks = [[f"{frames[number].way:.0f}" for number in span] for span in spans]
        after = "metres driven since the first scan"
    return f"{', '.join(' to '.join(each) for each in clocks)} ({after})"


def _is_contrary(odometry: Pose2, way: Pose2, sigma: float, sigma_theta: float) -> bool:
    straight = hypot(odometry.x, odometry.y)
    off = hypot(way.x - odometry.x, way.y - odometry.y) / (sigma + straight * sigma_theta / 2)
    turned = abs(wrap(way.theta - odometry.theta)) / sigma_theta
    return max(off, turned) > CONTRARY_SIGMAS


def _clock(seconds: float) -> str:
    """Return a time as minutes and seconds."""
    return f"{int(seconds) // 60}:{int(seconds) % 60:02d}"
