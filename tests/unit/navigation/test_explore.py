"""A robot that explores without knowing where it is."""

import pytest

from pioneer3.behaviors.engine import resolve
from pioneer3.geometry import ORIGIN
from pioneer3.nav.follower import Follower
from pioneer3.nav.planner import Way, plan
from pioneer3.nav.sightings import Sightings
from pioneer3.navigation.follow_way import FollowWay, follow_way
from pioneer3.navigation.map_builder import ExploreMap
from tests.unit.behaviors.support import LIMITS, P3AT, seen
from tests.unit.nav.offices import costs, room

LOST = "the laser is lost"


def leg(*, done: bool = False, failed: str | None = None) -> FollowWay:
    way = plan(costs(room()), (2.0, 3.0), (8.0, 3.0))
    assert isinstance(way, Way)
    return FollowWay(
        follower=Follower(P3AT, LIMITS, (8.0, 3.0, None), way.cost_to_go),
        odom_in_map=lambda: ORIGIN,
        unsure=lambda: LOST,
        sightings=Sightings(costs(room())),
        walls=room().walls[:, :2],
        done=done,
        failed=failed,
    )


@pytest.mark.parametrize("present", [None, leg(), leg(done=True), leg(failed="in the way")])
def test_without_its_laser_it_lacks_knowledge_on_each_leg_and_between_them(
    present: FollowWay | None,
) -> None:
    explore = ExploreMap(unsure=lambda: LOST, leg=present)
    assert resolve([follow_way(explore)], seen()).lacking == f"not sure where it is: {LOST}"


def test_one_that_looks_for_the_next_leg_lacks_nothing() -> None:
    assert resolve([follow_way(ExploreMap(unsure=lambda: None))], seen()).lacking is None
