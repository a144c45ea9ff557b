"""The places of a fleet's robots: a simulator tells them, or they were lined up."""

from collections.abc import AsyncIterator, Callable, Sequence
from contextlib import asynccontextmanager
from functools import partial

from pioneer3.geometry import Pose2
from pioneer3.navigation.simulator import TruePose
from pioneer3.navigation.traffic import SharedPlace
from pioneer3.runtime.driven import Driven
from pioneer3.runtime.robot import Robot
from pioneer3.state import Snapshot
from pioneer3.tasks import running

PlaceOf = Callable[[Snapshot], SharedPlace | str]
PERIOD = 0.5
"""A simulator is asked so often for the place of a robot [s]; wheels tell it in between."""
NOT_TOLD = (
    "no simulator tells it; line the robots up side by side, all looking ahead, in the order of "
    "their numbers from left to right, and start again with --lined-up DISTANCE"
)
MOVED = (
    "its link was lost since the robots were lined up, and it may have moved: line all of them up "
    "anew, and start again"
)


class StartPlaces:
    """Where robots are, each at its first connection.

    They were lined up from left to right, so far `apart` [m, from middle to middle], or `None`.
    """

    def __init__(self, names: Sequence[str], apart: float | None) -> None:
        self._lined_up: dict[str, Pose2] = {}
        if apart is not None:
            self._lined_up = {name: Pose2(0.0, -apart * n) for n, name in enumerate(names)}
        self._connected: set[str] = set()

    @asynccontextmanager
    async def of(self, name: str, driven: Driven) -> AsyncIterator[PlaceOf]:
        """Yield the function that tells the place of a robot which is connected.

        Wheels carry the place of a robot that was lined up on, as long as its link stands.
        """
        again = name in self._connected
        self._connected.add(name)
        if name in self._lined_up:
            yield _lined_up(self._lined_up[name], driven, again=again)
        elif isinstance(driven, Robot):
            true = TruePose(driven, PERIOD)
            async with running(true.follow()):
                yield partial(_true, true)
        else:
            yield lambda snapshot: NOT_TOLD


def _lined_up(start: Pose2, driven: Driven, *, again: bool) -> PlaceOf:
    first = driven.snapshot

    def place(snapshot: Snapshot) -> SharedPlace | str:
        if again or first is None or snapshot.link.sessions != first.link.sessions:
            return MOVED
        return SharedPlace("lined up", start @ first.odometry.robot_in_odom.inverse())

    return place


def _true(true: TruePose, _: Snapshot) -> SharedPlace | str:
    if true.odom_in_world is None:
        return NOT_TOLD
    return SharedPlace(("simulator", true.world), true.odom_in_world, true=True)
