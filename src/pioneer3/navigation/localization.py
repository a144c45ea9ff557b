"""Keeps track of a robot on a map by its laser or sonars, and the mode that looks around."""

import asyncio
from collections.abc import Awaitable, Callable, Sequence
from contextlib import AbstractContextManager, nullcontext, suppress
from dataclasses import dataclass, field, replace
from functools import partial
from math import inf
from typing import Any, Protocol, Self

import numpy as np

from pioneer3.behaviors.action import MODE, Action, Desire, Ranked, Situation, Stack
from pioneer3.behaviors.modes import wander
from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.limits import Limits
from pioneer3.maps import LineMap
from pioneer3.nav.beams import Beams, LatestBeams
from pioneer3.nav.estimate import Estimate
from pioneer3.nav.likelihood_sonar import Pings
from pioneer3.nav.localizer import Localizer
from pioneer3.nav.settings import NavigationSettings
from pioneer3.robot.devices.laser import LaserSource
from pioneer3.robot.supervisor import Feed
from pioneer3.runtime.driven import Driven
from pioneer3.state import Snapshot

InThread = Callable[..., Awaitable[Any]]
"""Calls a function elsewhere, so that the event loop goes on."""

SPREAD = 0.3
"""Standard deviation of a place that somebody told [m]."""
TURN_SPREAD = 0.15
"""Standard deviation of its heading [rad]."""
SILENT = 2.0
"""A sensor that has told nothing for so long leaves odometry alone, which drifts [s]."""


class Localizable(Driven, Protocol):
    """A robot that can be found on a map."""

    @property
    def laser(self) -> LaserSource:
        """The laser that it looks through, if it is there."""

    @property
    def settings(self) -> NavigationSettings:
        """The settings of its navigation."""


class Localization:
    """Tells a localizer all that a robot senses. :meth:`take` and :meth:`search` do the work.

    The robot looks, `by_laser`, or else listens to its sonars.
    """

    def __init__(
        self, robot: Localizable, localizer: Localizer, in_thread: InThread, *, by_laser: bool
    ) -> None:
        self.line_map, self.by_laser = localizer.line_map, by_laser
        self._robot, self._localizer, self._in_thread = robot, localizer, in_thread
        self._mounts = np.array([(s.x, s.y, s.theta) for s in robot.info.model.sonars])
        self._changed: Feed[Estimate] = Feed()
        self.beams, self._sequence = LatestBeams(), -1
        self._heard = self._now = -inf

    @classmethod
    async def on(
        cls, robot: Localizable, line_map: LineMap, rng: np.random.Generator, in_thread: InThread
    ) -> Self:
        """Return the localization of a robot on a map; it may be anywhere."""
        by_laser = bool(robot.laser.presence.there)
        localizer = Localizer(line_map, robot.info.model, rng, robot.settings.localizer)
        await in_thread(partial(localizer.prepare, sonar=not by_laser))
        return cls(robot, localizer, in_thread, by_laser=by_laser)

    @property
    def estimate(self) -> Estimate:
        """Where the robot is."""
        estimate, scan = self._localizer.estimate, self._robot.laser.latest
        if scan and (askew := self._localizer.mounting.remark(scan.sensor_in_robot)):
            estimate = replace(estimate, remark=askew)
        silent = self._now - self._heard
        if estimate.sure and silent > SILENT:
            sensor = "the laser is" if self.by_laser else "the sonars are"
            reason = f"{sensor} silent for {silent:.0f} s"
            return replace(estimate, sure=False, stage="looking", reason=reason)
        if estimate.stage == "lost" and not self.by_laser:
            words = "sonars alone cannot find a robot that may be anywhere: tell its place"
            return replace(estimate, reason=words)
        return estimate

    @property
    def odom_in_map(self) -> Pose2:
        """The pose of odometry's frame on the map [m, rad]; the origin while it is not known."""
        return self._localizer.odom_in_map or ORIGIN

    def place(
        self,
        robot_in_map: Pose2,
        spread: float = SPREAD,
        turn_spread: float = TURN_SPREAD,
        others: Sequence[Pose2] = (),
    ) -> None:
        """Tell where the robot is, with the standard deviations of that [m, rad].

        It may be at one of the `others` as well.
        """
        self._localizer.start(robot_in_map, spread, turn_spread, others)

    def lose(self) -> None:
        """Forget where the robot is: it has been carried away."""
        self._localizer.start_unknown()

    def sensing(self) -> AbstractContextManager[None]:
        """Keep the sensors awake during the block."""
        return self._robot.laser.wanted() if self.by_laser else nullcontext()

    def take(self, snapshot: Snapshot) -> Beams | None:
        """Take all that is new; return the scan if there is a new one."""
        self._now = snapshot.stamp
        beams = None
        if self.by_laser:
            beams = self._look(snapshot)
        else:
            self._listen(snapshot)
        self._changed.publish(self.estimate)
        return beams

    def _look(self, snapshot: Snapshot) -> Beams | None:
        scan = self._robot.laser.latest
        if scan is None or scan.sequence == self._sequence:
            return None
        self._sequence, self._heard = scan.sequence, snapshot.stamp
        beams = self.beams.of(scan)
        self._localizer.take(beams)
        return beams

    def _listen(self, snapshot: Snapshot) -> None:
        sonar = snapshot.sonar
        known = [n for n in sonar.fresh if n < len(self._mounts) and sonar.ranges[n] >= 0]
        if not known:
            return
        self._heard = snapshot.stamp
        self._localizer.take_sonar(
            Pings(
                stamp=snapshot.stamp,
                robot_in_odom=snapshot.odometry.robot_in_odom,
                mounts=self._mounts[known],
                ranges=np.array([sonar.ranges[n] for n in known]),
            )
        )

    async def search(self) -> None:
        """Search for the robot wherever that is wanted, until cancelled."""
        async for _ in self._changed.values():
            if self._localizer.wants_search and (search := self._localizer.search()) is not None:
                self._localizer.adopt(await self._in_thread(search.run))

    async def find(self, patience: float) -> bool:
        """Wait for up to `patience` [s] until it is sure where the robot is; return whether."""
        with suppress(TimeoutError):
            async with asyncio.timeout(patience):
                async for estimate in self._changed.values(latest_first=True):
                    if estimate.sure:
                        return True
        return self.estimate.sure


LOOK_SPEED = 0.2
"""Speed of a robot that does not know where it is [m/s]."""
LOOK_PATIENCE = 120.0
"""Time after which a robot that has looked around in vain gives up [s]."""


@dataclass(slots=True)
class UntilSure(Action):
    """Ends a mode once it is sure where the robot is, or after a while; asks for no motion."""

    estimate: Callable[[], Estimate]
    name: str = "look around"
    done: bool = False
    failed: str | None = None
    _began: float | None = field(default=None, init=False)

    def decide(self, situation: Situation) -> Desire | None:
        estimate = self.estimate()
        self.done = estimate.sure
        if self._began is None:
            self._began = situation.now
        elif situation.now - self._began > LOOK_PATIENCE:
            self.failed = f"not sure where the robot is: {estimate.reason}"
        return None


def look_around(estimate: Callable[[], Estimate], limits: Limits) -> Stack:
    """Return the mode that wanders slowly until it is sure where the robot is."""
    stack = wander(preset="explore", speed=min(LOOK_SPEED, limits.max_speed))
    actions = [Ranked(1000, UntilSure(estimate)), *stack.actions]
    return Stack.of("look around", MODE, actions, "drives about until it knows where it is")
