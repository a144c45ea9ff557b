"""Compiles or loads all kernels, by navigating in a small room.

Compiling takes half a minute and loading a second, in which nothing else of the program goes on.
"""

from functools import cache
from math import cos, hypot, inf, pi, sin

import numpy as np

from pioneer3.geometry import ORIGIN, Pose2, Twist2
from pioneer3.limits import Limits
from pioneer3.maps import LineMap
from pioneer3.models import load_model
from pioneer3.nav.beams import Beams
from pioneer3.nav.clearance import Clearance
from pioneer3.nav.costs import CostMap
from pioneer3.nav.follower import Follower
from pioneer3.nav.frontiers import find_frontiers
from pioneer3.nav.kernels import CACHE
from pioneer3.nav.likelihood_sonar import Pings
from pioneer3.nav.localizer import Localizer
from pioneer3.nav.manoeuvre import Search
from pioneer3.nav.mapper import Mapper
from pioneer3.nav.planner import Way, plan
from pioneer3.nav.rendering import MapRenderer, trodden
from pioneer3.nav.sightings import Sightings

ROOM_SIDE = 4.0
"""Side of the room [m]."""
THING = 0.8, 0.3
"""Place of something in it that is not on the map [m]."""


@cache
@CACHE.compiling()
def warm_up() -> None:
    """Call every kernel, once in the life of this program."""
    model, rng = load_model("p3at-sh"), np.random.default_rng(0)
    half = ROOM_SIDE / 2
    corners = [(-half, -half), (half, -half), (half, half), (-half, half)]
    walls = [[*a, *b] for a, b in zip(corners, [*corners[1:], corners[0]], strict=True)]
    room = LineMap(name="room", walls=np.array(walls))
    costs = CostMap.of(room, model)
    sightings, localizer = Sightings(costs), Localizer(room, model, rng)
    localizer.prepare()
    localizer.start(ORIGIN)
    for step in range(12):
        beams = _beams(Pose2(0.05 * step, 0.0), float(step))
        localizer.take(beams)
        sightings.take(beams, beams.robot_in_odom)
    listener = Localizer(room, model, rng)
    listener.start(ORIGIN)
    for step in range(3):
        listener.take_sonar(
            Pings(
                stamp=float(step),
                robot_in_odom=Pose2(0.2 * step),
                mounts=np.zeros((2, 3)),
                ranges=np.array([half, inf]),
            )
        )
    localizer.start_unknown()
    localizer.take(_beams(ORIGIN, 20.0))
    if (search := localizer.search()) is not None:
        localizer.adopt(search.run())
    seen = sightings.points(20.0)
    way = plan(costs.with_obstacles(seen), (0.0, 0.0), (-1.2, 0.0))
    assert isinstance(way, Way)
    limits = Limits(max_speed=0.5, max_turn_rate=1.0)
    follower = Follower(model, limits, (-1.2, 0.0, None), way.cost_to_go)
    obstacles = sightings.obstacles(0.0, 0.0, np.empty((0, 2)), seen, 20.0)
    follower.step(ORIGIN, Twist2(), obstacles)
    clearance = Clearance(model=model, limits=limits, margin=2 * half)
    clearance.limit(Twist2(0.1, 0.1), Twist2(), np.zeros((1, 5)), 20.0)
    Search(ORIGIN, model, obstacles, way.cost_to_go).go_on()
    _make_map()


def _make_map() -> None:
    """Make a map of the room, go on with it, draw it, and look where it ends."""
    made, renderer = Mapper(), MapRenderer()
    for step in range(3):
        made.add(_beams(Pose2(0.2 * step), float(step)))
    Mapper.of(made.state).add(_beams(ORIGIN, 3.0))
    renderer.update(made.survey)
    find_frontiers(trodden(renderer.grid, made.survey.poses, 0.4), ORIGIN, 0.3)


def _beams(robot_in_room: Pose2, stamp: float) -> Beams:
    """Return a scan of the room, with a thing in it, and a beam that meets nothing."""
    points = [THING]
    for angle in np.linspace(-pi / 2, pi / 2, 60).tolist():
        c, s = cos(angle), sin(angle)
        reach = min(ROOM_SIDE / 2 / max(abs(c), 1e-9), ROOM_SIDE / 2 / max(abs(s), 1e-9))
        points.append((reach * c - robot_in_room.x, reach * s))
    far = max(hypot(*point) for point in points)
    return Beams(
        stamp=stamp,
        robot_in_odom=robot_in_room,
        points=np.array(points),
        clear=np.array([[0.0, far]]),
        origin=np.zeros(2),
        far=far,
    )
