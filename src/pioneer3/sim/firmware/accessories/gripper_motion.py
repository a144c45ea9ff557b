"""How paddles and lift move: from now to now, at constant speed, until something stops them."""

from dataclasses import dataclass
from math import copysign, inf

from pioneer3.errors import ConfigError

OPENING = 0.215
"""Between the open paddles [m]; unverified, like the next two."""
OPENING_TIME = 2.0
"""From open to closed [s]."""
LIFTING_TIME = 3.0
"""From the lower to the upper end [s]."""
CONTACT = 1e-9
"""The paddles touch from this distance on [m]: steps of any length end at the same time."""
SAME = 1e-9
"""Heights and times [s] that differ by less are the same."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Thing:
    """Something between the paddles.

    Attributes:
        width: Across the gripper, from paddle to paddle [m].
        outer: It breaks the beam at the paddles' tips.
        inner: It breaks the beam at their root.
    """

    width: float = 0.05
    outer: bool = True
    inner: bool = True

    def __post_init__(self) -> None:
        """Refuse what no gripper holds."""
        if not 0 < self.width <= OPENING:
            raise ConfigError(f"thing of {self.width} m: a gripper opens to {OPENING} m")


class Paddles:
    """The opening between two paddles that move together.

    Attributes:
        opening: Between them [m].
        squeeze: How long they go on pressing after they have met resistance [s].
    """

    def __init__(self) -> None:
        self.opening = OPENING
        self.squeeze = 0.0
        self._direction = 0
        self._pressed = 0.0

    @property
    def moving(self) -> bool:
        """Whether their motor runs."""
        return self._direction != 0

    def drive(self, direction: int) -> None:
        """Open (1), close (-1) or stop (0)."""
        self._direction, self._pressed = direction, 0.0

    def step(self, dt: float, closest: float) -> None:
        """Move for `dt` [s]; they cannot come closer than `closest` [m]."""
        way = OPENING / OPENING_TIME * dt
        if self._direction > 0:
            self.opening += way
            if self.opening >= OPENING - CONTACT:
                self.opening = OPENING
                self.drive(0)
        elif self._direction < 0:
            free = max(0.0, self.opening - closest)
            self.opening -= min(way, free)
            if way >= free - CONTACT:
                self._pressed += max(0.0, way - free) / OPENING * OPENING_TIME
                if self._pressed >= self.squeeze - SAME:
                    self.drive(0)


class Lift:
    """Where the gripper hangs.

    Attributes:
        height: 0 at the lower end to 1 at the upper.
    """

    def __init__(self) -> None:
        self.height = 0.0
        self._direction = 0
        self._left = inf

    @property
    def moving(self) -> bool:
        """Whether its motor runs."""
        return self._direction != 0

    @property
    def at_limit(self) -> bool:
        """Whether it is all the way up or down."""
        return self.height in (0.0, 1.0)

    def drive(self, direction: int, duration: float = inf) -> None:
        """Go up (1), down (-1) or stop (0), for `duration` [s] at most."""
        self._direction, self._left = direction, duration

    def step(self, dt: float) -> None:
        """Move for `dt` [s]."""
        if not self._direction:
            return
        time = min(dt, self._left)
        self._left -= time
        self.height += copysign(time / LIFTING_TIME, self._direction)
        end = 1.0 if self._direction > 0 else 0.0
        if (self.height - end) * self._direction >= -SAME:
            self.height = end
        if self.height == end or self._left <= SAME:
            self.drive(0)
