"""Which robots are near enough to matter: looked up quickly, and the same as by asking each."""

from contextlib import ExitStack
from math import hypot
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pioneer3.behaviors.action import Combined, Weighted
from pioneer3.behaviors.actions import keep_apart
from pioneer3.behaviors.actions.keep_apart import LimiterPeers
from pioneer3.behaviors.peers import Peer
from pioneer3.geometry import Pose2, Twist2
from pioneer3.navigation.traffic import LOOK_UP_EVERY, NEAR_ROBOTS, SLACK, SharedPlace, Traffic
from tests.unit.behaviors.support import seen
from tests.unit.navigation.test_traffic import Fake, participant

NOW = 10.0
places = st.floats(-12, 12)
steps = st.floats(-SLACK / 3, SLACK / 3)
poses = st.builds(Pose2, st.floats(-4, 4), st.floats(-4, 4), st.floats(-3, 3))
twists = st.builds(Twist2, st.floats(-1, 1), st.floats(-2, 2))
peers = st.lists(
    st.builds(
        Peer,
        name=st.sampled_from(["ann", "bob", "carol"]),
        pose=poses,
        stamp=st.floats(NOW - 4, NOW),
        twist=twists,
    ),
    max_size=4,
)


@given(peers, poses, twists, st.none() | st.floats(-2, 2))
def test_to_leave_robots_out_that_are_far_away_changes_nothing(
    peers: list[Peer], pose: Pose2, twist: Twist2, asked: float | None
) -> None:
    higher = Combined() if asked is None else Combined(motion={"w": Weighted(asked)})
    situation = seen(NOW, pose=pose, twist=twist, higher=higher)
    limiter = LimiterPeers(peers=lambda: peers)
    limits = limiter.decide(situation)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(keep_apart, "_matters", lambda *_: True)
        assert limiter.decide(situation) == limits


robots = st.lists(
    st.tuples(places, places, steps, steps, st.sampled_from(["hall", "yard"]), st.booleans()),
    min_size=2,
    max_size=8,
)


@given(robots, st.floats(LOOK_UP_EVERY / 100, 2 * LOOK_UP_EVERY))
def test_the_robots_that_are_near_are_found(robots: list[tuple[Any, ...]], later: float) -> None:
    """Also if all have moved since, by later snapshots; asking each one is the oracle."""
    the, fakes = Traffic(), dict[str, Fake]()
    with ExitStack() as stack:
        for number, (x, y, _, _, frame, _) in enumerate(robots):
            fake = fakes[f"p3-{number}"] = Fake(SharedPlace(frame, Pose2(x, y)))
            stack.enter_context(the.joined(participant(f"p3-{number}", fake)))
        the.peers_of("p3-0", NEAR_ROBOTS)
        here = {}
        for (name, fake), (x, y, dx, dy, frame, leaves) in zip(fakes.items(), robots, strict=True):
            fake.drives(Pose2(dx, dy), 1.0 + later)
            here[name] = frame, x + dx, y + dy
            the.peers_of(name)
            if leaves:
                fake.snapshot = None  # its last news stay
        for name, fake in fakes.items():
            if fake.snapshot is not None:
                found = [peer.name for peer in the.peers_of(name, NEAR_ROBOTS)]
                assert found == [other for other in here if _near(here, name, other)]


def _near(here: dict[str, tuple[str, float, float]], name: str, other: str) -> bool:
    (frame, x, y), (their_frame, their_x, their_y) = here[name], here[other]
    away = hypot(their_x - x, their_y - y)
    return other != name and their_frame == frame and away <= NEAR_ROBOTS
