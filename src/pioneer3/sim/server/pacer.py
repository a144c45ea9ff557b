"""The speed of simulated time: real time, faster, slower, single steps, in step with hosts."""

from collections import deque
from math import inf, isfinite, isnan

from pioneer3.errors import ConfigError

TICK = 0.02
"""Simulated time of one step of the world [s]."""
PATIENCE = 1.0
"""Lock step waits this long for silent hosts [s, real] before it goes on without them."""
LATE = 0.5
"""When the machine could not keep up for this long [s, real], simulated time falls behind."""
EARLY = 5e-4
"""Timers may fire this early [s, real]."""
LATELY = 1.0
"""Period over which :attr:`Pacer.real_time_factor` is measured [s, real]."""


class Pacer:
    """Decides when the next tick is due; every attribute may be changed while the simulation runs.

    The same bytes at the same ticks give the same simulation at any speed: a pacer decides only
    at which real time a tick happens.

    In lock step a cycle of 100 ms begins only when every host has sent a valid packet since its
    last report, or :data:`PATIENCE` has passed. A host whose watchdog has expired is not
    waited for, and without hosts time runs at :attr:`speed`. Bytes of a cycle are taken at its end,
    so one packet, or one write, per report makes a run repeatable.
    """

    def __init__(
        self, speed: float = 1.0, *, lock_step: bool = False, paused: bool = False
    ) -> None:
        self.lock_step = lock_step
        self.speed = speed
        self._paused = paused
        self._granted = 0
        self._ticks = 0
        self._marks: deque[tuple[float, int]] = deque()

    @property
    def speed(self) -> float:
        """Simulated seconds per real one: 1 is real time, `inf` as fast as possible.

        Raises:
            ConfigError: When set to a number that is not above 0.
        """
        return self._speed

    @speed.setter
    def speed(self, speed: float) -> None:
        if isnan(speed) or speed <= 0:
            raise ConfigError(f"speed: {speed:g} is not above 0; pause stops the time")
        self._speed = speed
        self._due: float | None = None

    @property
    def paused(self) -> bool:
        """Whether time stands still. Hosts may still connect and get answers."""
        return self._paused

    @paused.setter
    def paused(self, paused: bool) -> None:
        self._paused, self._granted, self._due = paused, 0, None

    def pause(self) -> None:
        """Stop the time."""
        self.paused = True

    def resume(self) -> None:
        """Let time pass again; the pause is not caught up."""
        self.paused = False

    def step(self, seconds: float = TICK) -> None:
        """Let `seconds` of simulated time pass at once, in whole ticks, then stand still.

        Raises:
            ConfigError: `seconds` is not a time.
        """
        if not isfinite(seconds) or seconds <= 0:
            raise ConfigError(f"step: {seconds:g} is not a time above 0 s")
        self._paused = True
        self._granted += max(1, round(seconds / TICK))

    @property
    def real_time_factor(self) -> float:
        """Simulated seconds per real one, measured over the last second; 0 at the beginning."""
        if len(self._marks) < 2:
            return 0.0
        (since, first), (now, last) = self._marks[0], self._marks[-1]
        return (last - first) * TICK / (now - since)

    @property
    def steady(self) -> bool:
        """Whether time passes between ticks too: it runs at a set speed, and not in lock step."""
        return not (self._paused or self.lock_step) and isfinite(self._speed)

    @property
    def watchdog_factor(self) -> float:
        """Factor by which the robot's watchdog waits longer for a silent host.

        Hosts repeat their commands in real time, ARIA's twice a second. At 10 times the speed that
        is every 5 s of simulated time, the watchdog waits 2 s, and a robot would never keep moving.
        So above real time the watchdog counts real seconds, and at unlimited speed it is off. Below
        real time and in lock step it counts simulated seconds, as the robot does.
        """
        return 1.0 if self.lock_step else max(1.0, self.speed)

    def wait(self, now: float) -> float:
        """Return how long after `now` [s, real] the next tick is due; `inf` while paused."""
        self._mark(now)
        if self._paused:
            return 0.0 if self._granted else inf
        if self._due is None:
            self._due = now
        wait = self._due - now
        return wait if wait > EARLY else 0.0

    def is_late(self, now: float) -> bool:
        """Whether a tick was due before `now` [s, real]."""
        return self.steady and self._due is not None and self._due < now - EARLY

    def elapsed(self, now: float) -> float:
        """Return the simulated time that has passed since the last tick [s], 0 to :data:`TICK`.

        It is 0 where time is not :attr:`steady`.
        """
        if self._due is None or not self.steady:
            return 0.0
        return min(max(TICK - (self._due - now) * self.speed, 0.0), TICK)

    def postpone(self, now: float) -> None:
        """Note that the due tick could not happen; it is not caught up."""
        if self._due is not None:
            self._due = max(self._due, now)

    def passed(self, now: float) -> None:
        """Note that a tick has happened."""
        self._ticks += 1
        if self._paused:
            self._granted = max(0, self._granted - 1)
        elif self._due is not None:
            self._due = max(self._due + TICK / self.speed, now - LATE)

    def _mark(self, now: float) -> None:
        marks = self._marks
        if marks and now - marks[-1][0] < LATELY / 10:
            return
        marks.append((now, self._ticks))
        while len(marks) > 2 and now - marks[1][0] >= LATELY:
            marks.popleft()
