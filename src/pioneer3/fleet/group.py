"""A mode of the robots that one keyboard drives: started by a key, ended by a stop."""

import asyncio
import logging
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

from pioneer3.behaviors.action import Stack
from pioneer3.behaviors.modes.group import GroupMode
from pioneer3.errors import MotionError
from pioneer3.fleet.places import PlaceOf
from pioneer3.navigation.group import stacks_of
from pioneer3.navigation.traffic import Participant, Traffic
from pioneer3.runtime.driven import Driven

log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True, kw_only=True)
class GroupKey:
    """A mode that a key starts, and the name of its leader; `None` in a mode without one."""

    mode: GroupMode
    leader: str | None = None


class RobotGroup:
    """The robots of some `names` that are connected: they keep apart, and start a mode together."""

    def __init__(self, names: Sequence[str], together: GroupKey | None) -> None:
        self.together = together
        self._names = names
        self._traffic = Traffic()
        self._connected: dict[str, Driven] = {}
        self._started: dict[str, Stack] = {}

    @contextmanager
    def joined(self, name: str, driven: Driven, place: PlaceOf) -> Iterator[None]:
        """Let a robot take part during the block."""
        self._connected[name] = driven
        try:
            with self._traffic.joined(Participant(name, driven, place)):
                yield
        finally:
            del self._connected[name]

    def start(self) -> None:
        """Let all robots that are connected begin; a refusal is logged as a warning."""
        if self.together is None:
            return
        mode, leader = self.together.mode, self.together.leader
        self.end("started anew")
        there = {name: self._connected[name] for name in self._names if name in self._connected}
        try:
            stacks = stacks_of(mode, there, leader, self._traffic)
        except MotionError as error:
            log.warning("%s", error)
            return
        for name in self._names:
            if name not in there:
                log.warning("%s is left out: it is not connected", name)
        for name, stack in stacks.items():
            if refused := there[name].arbiter.start(stack):
                log.warning("%s: %s", name, refused)
        self._started = stacks
        loop = asyncio.get_running_loop()
        loop.call_later(mode.seconds, self._end, stacks, "its time was over")

    def end(self, why: str) -> None:
        """End the mode of each robot that has it still; its motion ends at once."""
        self._end(self._started, why)

    def _end(self, stacks: dict[str, Stack], why: str) -> None:
        for name, stack in stacks.items():
            driven = self._connected.get(name)
            if driven is not None and driven.arbiter.mode is stack:
                driven.arbiter.end_mode(why)
