"""Plays logs to the clients of a page: one time for all of them, which they set.

Robots of all logs go by one clock, that of the computers which wrote them.
"""

import asyncio
import time
from collections.abc import Sequence
from contextlib import suppress
from itertools import count
from typing import Final

from pioneer3 import __version__
from pioneer3.errors import CommandError, ConfigError
from pioneer3.log.index import LogIndex
from pioneer3.navigation.recording import MapUsed
from pioneer3.tasks import running
from pioneer3.teleop.gamepad import SCHEME
from pioneer3.web import messages, requests
from pioneer3.web.audience import Audience, Audiences
from pioneer3.web.replay import view
from pioneer3.web.replay.marks import MOST_MARKS, MarkFinder
from pioneer3.web.replay.recorded import FRESH, SECOND, RecordedRobot, robots_of
from pioneer3.web.world import map_message

PERIOD: Final = 0.04
"""Time between two steps of the replay [s]."""
REPEATED: Final = 0.4
"""A snapshot is sent again after this time: by that, pages know that a robot is there [s]."""
GENTLE: Final = 2.0
"""A gentle replay rests for so many times as long as it has looked for marks."""
DETAILS_PERIOD: Final = 0.5
"""Time between two messages with details, marks, and the time of the replay [s]."""


class LogPlayer:
    """Logs on a page, paused at their beginning.

    A `gentle` one leaves two thirds of the processor's time to robots that are driven beside it.

    Raises:
        ConfigError: No robot was connected in one of them.
    """

    def __init__(
        self, logs: Sequence[LogIndex], audiences: Audiences, *, gentle: bool = False
    ) -> None:
        self._gentle = gentle
        numbers = count(1)
        self._by_log = {
            log: robots_of(log, lambda: next(numbers), _label(log.path.stem)) for log in logs
        }
        self.robots = {each.number: each for found in self._by_log.values() for each in found}
        self._details = {n: view.RecordedDetails(robot) for n, robot in self.robots.items()}
        self._audiences = audiences
        self._began = min(robot.began for robot in self.robots.values())
        self._ended = max(log.ended for log in logs)
        self._at, self._speed, self._playing, self._jumps = self._began, 1.0, False, 0
        self._wanted: int | None = self._began
        self._asked = asyncio.Event()
        self._clock = asyncio.get_running_loop().time
        self._shares = dict.fromkeys(self._by_log, 0.0)
        self._marks: list[messages.ReplayMark] = []
        self._closing = False
        self._sent: dict[int, tuple[int, float]] = {}
        self._drawn: tuple[object, str] = (None, messages.encode(messages.Map(None)))
        self._detailed_at = float("-inf")
        self._told: tuple[float, bool, int] | None = None

    def hello(self) -> messages.Hello:
        """Return the message about the robots."""
        return messages.Hello(
            version=__version__,
            robots=tuple(view.listed(robot) for robot in self.robots.values()),
            models=None,
            gamepad=SCHEME,
            class_=None,
        )

    def details(self, number: int | None) -> view.RecordedDetails:
        """Return the details of the robot of a number, the first without one.

        Raises:
            CommandError: There is none.
        """
        found = self._details.get(next(iter(self._details)) if number is None else number)
        if found is None:
            raise CommandError(f"no robot {number}")
        return found

    def all_details(self) -> Sequence[view.RecordedDetails]:
        """Return the details of all robots."""
        return list(self._details.values())

    def ask(self, request: requests.PlayRequest) -> None:
        """Play or pause, change the speed, go to another time."""
        if request.speed is not None:
            self._speed = request.speed
        if request.at is not None:
            self._wanted = min(max(round(request.at * SECOND), self._began), self._ended)
        if request.playing is not None:
            self._playing = request.playing
            if request.playing and self._at >= self._ended and self._wanted is None:
                self._wanted = self._began
        self._asked.set()

    async def run(self) -> None:
        """Play until cancelled."""
        try:
            looks = (asyncio.to_thread(self._look_through, log) for log in self._by_log)
            async with running(*looks):
                before = self._clock()
                while True:
                    now = self._clock()
                    await self._step(now - before)
                    before = now
                    self._publish(now)
                    with suppress(TimeoutError):
                        async with asyncio.timeout(PERIOD):
                            await self._asked.wait()
                    self._asked.clear()
        finally:
            self._closing = True

    async def _step(self, seconds: float) -> None:
        """Go where somebody wants to be, or on by some seconds; files are read in a thread."""
        wanted, self._wanted = self._wanted, None
        try:
            if wanted is not None:
                await asyncio.to_thread(self._seek, wanted)
                self._at = wanted
                self._jumps += 1
                self._sent.clear()
            elif self._playing:
                until = min(self._ended, self._at + round(seconds * self._speed * SECOND))
                await asyncio.to_thread(self._advance, until)
                self._at = until
                self._playing = self._playing and until < self._ended
        except ConfigError as error:  # it is damaged here: other times can be read
            self._playing = False
            self._tell(self._at, str(error))

    def _seek(self, time: int) -> None:
        for robot in self.robots.values():
            robot.seek(time)
        self._draw_map()

    def _advance(self, time: int) -> None:
        for robot in self.robots.values():
            robot.advance(time)
        self._draw_map()

    def _draw_map(self) -> None:
        """Draw the map of the first robot that has one, if it is another than before."""
        maps = (robot.told(MapUsed) for robot in self.robots.values())
        used = next((each for each in maps if each is not None), None)
        if used is not self._drawn[0]:
            self._drawn = used, messages.encode(map_message(view.drawn_map(used)))

    def _publish(self, now: float) -> None:
        """Tell all clients what is new."""
        tells = now - self._detailed_at >= DETAILS_PERIOD
        changes = (self._speed, self._playing, self._jumps)
        retained = {"map": self._drawn[1]}
        if tells or changes != self._told:
            self._told = changes
            retained["replay"] = messages.encode(self._state())
        if tells:
            self._detailed_at = now
            retained["hello"] = messages.encode(self.hello())
            marks = messages.ReplayMarks(tuple(self._marks))
            retained["replay marks"] = messages.encode(marks)
        for audience in self._audiences:
            for key, text in retained.items():
                audience.put(key, text)
        for number, robot in self.robots.items():
            self._publish_robot(number, robot, now)
            if tells:
                self._details[number].publish()

    def _publish_robot(self, number: int, robot: RecordedRobot, now: float) -> None:
        status = messages.encode(view.status(robot))
        for audience in self._audiences:
            audience.put(f"status {number}", status)
        self._audiences.publish(number, "navigation", view.navigation(robot))
        seen, sent_at = self._sent.get(number, (0, float("-inf")))
        fresh = self._at - robot.sequence < FRESH
        if not fresh or (robot.sequence == seen and now - sent_at < REPEATED):
            return
        self._sent[number] = robot.sequence, now
        snapshot = view.snapshot(robot)
        if snapshot is None:
            return
        text = messages.encode(snapshot)
        wanting: list[Audience] = []
        for audience in self._audiences:
            if audience.wants(number):
                audience.snapshots.put(number, text)
                if audience.scans.is_wanted:
                    wanting.append(audience)
        for part in view.sweeps(robot) if wanting else ():
            for audience in wanting:
                audience.scans.put(number, messages.encode(part), part.laser)

    def _state(self) -> messages.ReplayState:
        return messages.ReplayState(
            began=self._began / SECOND,
            ended=self._ended / SECOND,
            at=self._at / SECOND,
            speed=self._speed,
            playing=self._playing,
            jumps=self._jumps,
            looked=round(sum(self._shares.values()) / len(self._shares), 2),
        )

    def _tell(self, at: int, text: str) -> None:
        """Add a mark about the replay itself, once."""
        if all(mark.text != text for mark in self._marks):
            self._marks = [*self._marks, messages.ReplayMark(at / SECOND, None, "note", text)]

    def _look_through(self, log: LogIndex) -> None:
        """Look through a whole log for its marks; to be called in a thread."""
        finder = MarkFinder(self._by_log[log])
        try:
            for begin, end in log.info().gaps:
                lost = (end - begin) / SECOND
                self._tell(begin, f"For {lost:.0f} s nothing is known: a file of the log has gone")
            began = time.perf_counter()
            for share, found in log.chunks(finder.topics):
                new = finder.look(found)
                if self._gentle:
                    time.sleep(GENTLE * (time.perf_counter() - began))
                    began = time.perf_counter()
                self._marks = [*self._marks, *new][:MOST_MARKS] if new else self._marks
                self._shares[log] = share
                if self._closing:
                    return
        except ConfigError as error:  # it is damaged in the middle: what was found stays
            self._tell(log.ended, str(error))
            self._shares[log] = 1.0


def _label(stem: str) -> str:
    """Return a name for a robot that has none: that of its file, without the time."""
    return stem.partition("Z-")[2] or stem
